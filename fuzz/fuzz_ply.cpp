// SPDX-License-Identifier: Apache-2.0
#include "fuzzing.hpp"
#include "ostraka/io/ply.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    ostraka::fuzzing::run(data, size,
                          [](auto bytes) { return ostraka::parse_ply_mesh(bytes, "fuzz.ply"); });
    return ostraka::fuzzing::run(
        data, size, [](auto bytes) { return ostraka::parse_ply_cloud(bytes, "fuzz.ply").cloud; });
}
