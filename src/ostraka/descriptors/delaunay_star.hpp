// SPDX-License-Identifier: Apache-2.0
// Private to this module: the triangles around one point, in its tangent plane.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// The neighbors around a point, counter-clockwise; a triangle lies between each and its successor.
struct Star {
    static constexpr std::size_t kLargest = 16;

    std::array<std::uint32_t, kLargest> neighbors{};
    std::uint8_t count = 0;
    bool closed = false;  ///< the last and the first neighbor make a triangle, too
    float nearest =
        0.0F;  ///< distance of the nearest neighbor in the plane, in search radii; 0 if none

    /// Whether there is a triangle with neighbor b after neighbor a.
    bool holds(std::uint32_t a, std::uint32_t b) const;
};

/// Candidates for the stars of all points of a cell, as columns.
struct Nearby {
    std::vector<float> x, y, z, nx, ny, nz, weight;
    std::vector<std::uint32_t> index;

    void clear();
    void add(const Vec3f& point, const Vec3f& normal, float point_weight, std::uint32_t i);
    std::size_t size() const { return index.size(); }
};

/// Memory that stars share.
struct StarScratch {
    std::vector<float> u, v, squared;  // of all candidates
    std::vector<std::int32_t> usable;
    std::vector<float> flat_u, flat_v, flat_squared;  // of those in the star's reach
    std::vector<std::uint32_t> flat_index;
    std::size_t count = 0;
};

/// A tiny weight for each point, from its coordinates, in squared search radii. It makes the
/// Delaunay triangulation a regular one, in which four points on a circle (as on a grid) are cut
/// the same way in every star.
float star_weight(const Vec3f& point);

/// @param radius  candidates farther away are ignored.
Star delaunay_star(const Vec3f& point, const Vec3f& normal, float radius, const Nearby& nearby,
                   StarScratch& scratch);

}  // namespace ostraka
