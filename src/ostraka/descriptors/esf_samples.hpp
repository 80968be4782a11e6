// SPDX-License-Identifier: Apache-2.0
// Private to this module: the random triangles of ESF and what is measured on them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/esf.hpp"

namespace ostraka {

/// A point in the frame of the voxel grid: centroid at 0, farthest point at distance 32.
struct EsfPoint {
    float x, y, z;
    std::uint32_t voxel;  ///< see pack_voxel()
};

/// @return empty if all points coincide.
std::vector<EsfPoint> into_esf_grid(const PointCloud& cloud);

/// Measures of triangles, as columns. Sides are pq, pr, qr; the angle of a side is opposite to it.
struct EsfSamples {
    std::size_t count = 0;
    float longest = 0.0F;                              ///< the largest length
    float widest = 0.0F;                               ///< the largest area
    std::array<std::vector<float>, 3> length;          ///< of each side, in voxels
    std::vector<float> area;                           ///< PCL's: the square root of the area
    std::array<std::vector<std::uint8_t>, 3> angle;    ///< bin of each angle, 0 to 63
    std::array<std::vector<std::uint8_t>, 3> visited;  ///< voxels on each side
    std::array<std::vector<std::uint8_t>, 3> inside;   ///< set ones among them

    /// Empties it and makes room.
    void reset(std::size_t capacity);
};

/// Draws triples until settings.samples of them make a triangle of noticeable area, or hope is
/// gone: then there are fewer.
/// @param samples  replaced; its memory is used again.
void draw_esf_samples(const std::vector<EsfPoint>& points, const EsfSettings& settings,
                      EsfSamples& samples);

}  // namespace ostraka
