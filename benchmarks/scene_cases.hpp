// SPDX-License-Identifier: Apache-2.0
// What to recognize, in which scenes, from the command line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ostraka/evaluation/test_scenes.hpp"

namespace ostraka::bench {

struct SceneCases {
    std::vector<std::string> inputs;  // one library, or meshes
    std::string unit = "mm";          // of the meshes
    std::string on = "drop";          // or tabletop, random-views, layout, scans
    std::string data;                 // folder of a data set
    std::string data_unit;            // where it states none
    std::string peers = "open3d,opencv";
    std::string json;
    int scenes = 6;
    int objects = 0;     // 0: the kind's own
    int threads = 1;     // of every method
    int width = 0;       // of the image; 0: the camera's own
    double noise = 0.0;  // standard deviation of depth, library unit
    double opencv_step = 0.04;
    std::uint64_t seed = 0;
    bool time_build = true;
    bool help = false;
};

std::string_view scene_cases_help();

/// @throws InvalidInput for what isn't in the help.
SceneCases parse_scene_cases(int count, char** arguments);

/// @throws InvalidInput, FileError, FormatError.
TestSet test_set_of(const SceneCases& cases, const ModelLibrary& library);

/// All that decides the scenes, in one line.
std::string scene_text(const SceneCases& cases);

}  // namespace ostraka::bench
