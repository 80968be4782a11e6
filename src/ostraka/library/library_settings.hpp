// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ostraka/base/unit.hpp"
#include "ostraka/descriptors/descriptor.hpp"
#include "ostraka/library/selection.hpp"
#include "ostraka/subparts/cuts.hpp"
#include "ostraka/views/model_views.hpp"

namespace ostraka {

/// Everything that decides a library's content. Distances of 0 are derived from `sampling`.
struct LibrarySettings {
    Unit unit = Unit::millimeter;  ///< of the models' files and of every length in the library
    double sampling =
        0.0;             ///< distance between points, library unit; 0: 1 % of the median diameter
    ViewSettings views;  ///< `views.sampling` is set from `sampling`
    CutSettings cuts;    ///< `cuts.cluster_tolerance` 0: 2 sampling distances
    bool full_views_only = false;  ///< the traditional library: whole views, no cuts, no selection
    SelectionSettings selection;   ///< redundancy and budget
    std::vector<AnyDescriptor> descriptors = global_descriptors();  ///< rows stored for each entry
    double keypoint_spacing = 3.5;  ///< between keypoints, in sampling distances
    double keypoint_radius = 10.0;  ///< support of their descriptors, in sampling distances
    std::uint64_t seed = 0;         ///< for every random step
};

}  // namespace ostraka
