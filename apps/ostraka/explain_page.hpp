// SPDX-License-Identifier: Apache-2.0
// The page of `recognize --explain`: why each object was reported, and each near miss was not.
#pragma once

#include <string>

#include "ostraka/recognition/recognize.hpp"

namespace ostraka::app {

struct ExplainedScan {
    const ModelLibrary& library;
    const PointCloud& scene;         ///< in the library's unit, as given to recognize()
    const Recognition& recognition;  ///< with its candidates
    const RecognitionSettings& settings;
    std::string scene_name;
    std::string library_name;
};

/// The whole HTML document.
std::string explain_page(const ExplainedScan& scan);

}  // namespace ostraka::app
