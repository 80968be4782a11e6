// SPDX-License-Identifier: Apache-2.0
// Private to this module: the triangles around one point, in its tangent plane.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ostraka/base/types.hpp"
#include "ostraka/base/vector_clones.hpp"

namespace ostraka {

/// The neighbors around a point, counter-clockwise; a triangle lies between each and its successor.
struct Star {
    static constexpr std::size_t kLargest = 16;

    Star() { neighbors.fill(kNoIndex); }

    /// Of a closed star the first one is repeated after the last; then kNoIndex.
    std::array<std::uint32_t, kLargest + 1> neighbors;
    std::uint8_t triangles = 0;
    float nearest =
        0.0F;  ///< distance of the nearest neighbor in the plane, in search radii; 0 if none
};

/// Whether the star has a triangle with neighbor b after neighbor a. Without branches.
__attribute__((always_inline)) inline bool holds(const Star& star, std::uint32_t a,
                                                 std::uint32_t b) {
    static_assert(Star::kLargest == 2 * kVectorLanes);
    Word8 first;
    Word8 second;
    load8(star.neighbors.data(), first);
    load8(star.neighbors.data() + 1, second);
    Int8 found = (first == a) & (second == b);
    load8(star.neighbors.data() + kVectorLanes, first);
    load8(star.neighbors.data() + kVectorLanes + 1, second);
    found |= (first == a) & (second == b);
    std::uint64_t pairs[4];
    std::memcpy(&pairs, &found, sizeof(pairs));
    return (pairs[0] | pairs[1] | pairs[2] | pairs[3]) != 0;
}

/// Points with normals as columns, padded for vectors that read beyond the end.
struct StarPoints {
    std::array<std::vector<float>, 7> columns;  ///< x, y, z, normal x, y, z, weight
    std::vector<std::uint32_t> index;           ///< what stars call the points
    std::size_t count = 0;

    void resize(std::size_t points);
    Vec3f position(std::size_t i) const { return {columns[0][i], columns[1][i], columns[2][i]}; }
    Vec3f normal(std::size_t i) const { return {columns[3][i], columns[4][i], columns[5][i]}; }
    void set(std::size_t at, const Vec3f& point, const Vec3f& normal, std::uint32_t i);
};

/// Appends to `found` the points in [first, end) that are closer than the radius to a box.
void append_near_box(const StarPoints& points, std::size_t first, std::size_t end, const Vec3f& low,
                     const Vec3f& high, float radius, std::vector<std::uint32_t>& list,
                     StarPoints& found);

/// Memory that stars share.
struct StarScratch {
    std::vector<float> all_u, all_v, all_squared;  // of the nearby points, in the tangent plane
    std::vector<std::uint32_t> list;               // positions of those in the star's reach
    std::vector<float> u, v, squared;              // of these
    std::size_t count = 0;
};

/// A tiny weight for each point, from its coordinates, in squared search radii. It makes the
/// Delaunay triangulation a regular one, in which four points on a circle (as on a grid) are cut
/// the same way in every star.
float star_weight(const Vec3f& point);

/// @param radius  points farther away from it are ignored.
Star delaunay_star(const StarPoints& nearby, const Vec3f& point, const Vec3f& normal, float radius,
                   StarScratch& scratch);

}  // namespace ostraka
