// SPDX-License-Identifier: Apache-2.0
// Places labels in a picture so that they hide little and never each other.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "ostraka/recognition/canvas.hpp"

namespace ostraka {

struct LabelRequest {
    Vec2d anchor = Vec2d::Zero();  ///< what the label points at, pixels
    int width = 0;                 ///< of its box, pixels
    int height = 0;                ///< of its box, pixels
};

/// Where labels may lie, and what it costs to hide a pixel.
struct LabelSpace {
    Rectangle area;  ///< all boxes lie inside
    int width = 0;   ///< of the picture, pixels
    std::vector<float>
        cost;  ///< per pixel of the picture, row-major: 0 nothing to see, 1 an object
};

/// Greedy, in the order of the requests: each takes the cheapest free place near its anchor.
/// @return one box a request; nothing where no free place is left.
std::vector<std::optional<Rectangle>> place_labels(std::span<const LabelRequest> requests,
                                                   const LabelSpace& space);

/// Where the line from a label to its anchor leaves the box: the box's nearest point.
Vec2d leader_start(const Rectangle& box, const Vec2d& anchor);

}  // namespace ostraka
