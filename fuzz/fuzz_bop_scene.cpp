// SPDX-License-Identifier: Apache-2.0
// One input is taken for each of the three files of a scene, and for both files of one.
#include "fuzzing.hpp"
#include "ostraka/io/bop_scene.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace ostraka;
    fuzzing::run(data, size, [](auto bytes) { return parse_scene_camera(bytes, "fuzz.json"); });
    fuzzing::run(data, size, [](auto bytes) {
        std::map<int, std::vector<BopObject>> objects = {{0, {BopObject{}}}, {1, {}}};
        parse_scene_gt_info(bytes, "fuzz.json", objects);
        return objects;
    });
    return fuzzing::run(data, size, [](auto bytes) {
        auto objects = parse_scene_gt(bytes, "fuzz.json");
        parse_scene_gt_info(bytes, "fuzz.json", objects);
        return objects;
    });
}
