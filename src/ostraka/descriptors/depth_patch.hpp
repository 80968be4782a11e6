// SPDX-License-Identifier: Apache-2.0
// Private to this module: a small depth image of a surface, and its SIFT descriptor.
#pragma once

#include <array>
#include <span>

#include "ostraka/base/types.hpp"

namespace ostraka {

inline constexpr int kPatchSide = 21;

/// Heights above the tangent plane, in half sides of the patch; row-major, y upward.
struct DepthPatch {
    std::array<float, kPatchSide * kPatchSide> height;

    DepthPatch();  // all pixels empty
    float& at(int x, int y) { return height[index(x, y)]; }
    float at(int x, int y) const { return height[index(x, y)]; }

    static std::size_t index(int x, int y) {
        return static_cast<std::size_t>(y) * kPatchSide + static_cast<std::size_t>(x);
    }
};

/// Draws a triangle seen from above: of all surfaces on a pixel the highest stays.
/// @param corners  x and y in [-1, 1] lie on the patch; z is the height.
void draw_triangle(const std::array<Vec3d, 3>& corners, DepthPatch& patch);

/// Fills empty pixels with the lowest height, as the background, and the middle pixel (the
/// keypoint's own vertex) with the mean of the four around it.
/// @return false if all pixels are empty.
bool fill_background(DepthPatch& patch);

/// Adds the descriptor of the patch (norm 1, or 0 if the patch is flat) to `row`: bin ((row of
/// squares x 4 + column) x 8 + direction).
void add_sift(const DepthPatch& patch, std::span<float> row);

/// The patch turned by half.
DepthPatch turned_by_half(const DepthPatch& patch);

}  // namespace ostraka
