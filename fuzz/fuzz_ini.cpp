// SPDX-License-Identifier: Apache-2.0
// The two small texts of published data sets: Bologna's configurations and UWA's occlusions.
#include "fuzzing.hpp"
#include "ostraka/io/ini_file.hpp"
#include "ostraka/io/uwa_occlusion.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    ostraka::fuzzing::run(data, size,
                          [](auto bytes) { return ostraka::parse_ini(bytes, "fuzz.ini"); });
    return ostraka::fuzzing::run(
        data, size, [](auto bytes) { return ostraka::parse_uwa_occlusion(bytes, "fuzz.txt"); });
}
