// SPDX-License-Identifier: Apache-2.0
#include "fuzzing.hpp"
#include "ostraka/io/xf_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return ostraka::fuzzing::run(data, size,
                                 [](auto bytes) { return ostraka::parse_xf(bytes, "fuzz.xf"); });
}
