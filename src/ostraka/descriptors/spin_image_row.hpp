// SPDX-License-Identifier: Apache-2.0
// Private to this module: one spin image, for any axis and support. See spin_image.hpp.
#pragma once

#include <span>
#include <vector>

#include "ostraka/descriptors/surfel_grid.hpp"

namespace ostraka {

/// The cylinder that an image covers: radius and half height are `width` bins.
struct SpinCylinder {
    Vec3f center, axis;  ///< the axis is of unit length
    double bin = 0.0;    ///< side of a bin
    std::int32_t width = 0;
    float support_cosine = 0.0F;  ///< least cosine between the axis and a point's normal
    bool either_side = true;      ///< whether normals may point the other way
};

/// Memory that images share.
struct SpinScratch {
    std::vector<std::int32_t> column, line;
    std::vector<double> past_column, past_line, image;
};

/// Fills the row, (width + 1) x (2 width + 1) floats with sum 1; all 0 if no point counts.
/// @param around  all points of the cylinder, and others.
void draw_spin_image(const SurfelColumns& around, const SpinCylinder& cylinder,
                     SpinScratch& scratch, std::span<float> row);

}  // namespace ostraka
