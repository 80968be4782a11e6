// SPDX-License-Identifier: Apache-2.0
// GASD with color: a 6 x 6 x 6 grid of points and a 4 x 4 x 4 grid of hues in the aligned frame.
// Lima, Teichrieb. An Efficient Global Point Cloud Descriptor for Object Recognition and Pose
// Estimation. SIBGRAPI 2016.
// As PCL 1.13 by default: no interpolation, 12 hues a cell, gray points count as red, and a point
// on the grid's upper border lies outside. From PCL: the sign of the x axis, as in gasd.hpp.
#pragma once

#include <vector>

#include "ostraka/descriptors/gasd.hpp"

namespace ostraka {

inline constexpr std::size_t kGasdColorLength = 984;

struct GasdColorSettings {
    GasdSettings::AxisSign x_sign = GasdSettings::AxisSign::third_moment;  ///< see gasd.hpp
};

/// The hue of a color: 0 red, 120 green, 240 blue.
/// @return degrees from 0 to below 360; 0 for grays.
float hue_of(const Color& color);

/// @param cloud  at least 1 point, finite, with colors; cloud.viewpoint is used, normals are not.
/// @return kGasdColorLength non-negative floats: 216 shares of the points (x slowest, z fastest),
///         then for each of 64 cells its 12 hues; both sum to at most 100 n / (n - 1) for n points.
///         All 0 if all points coincide. The same bits for any order of the points; up to points
///         that change cells for any rigid motion and scale.
/// @throws InvalidInput if there are no points or no colors, or a point is not finite.
std::vector<float> describe_gasd_color(const PointCloud& cloud,
                                       const GasdColorSettings& settings = {});

}  // namespace ostraka
