// SPDX-License-Identifier: Apache-2.0
// Private to this module: which points share an edge or a triangle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"
#include "ostraka/descriptors/triangulation.hpp"

namespace ostraka {

/// A list of numbers for each point, all in one array.
struct PointLists {
    std::vector<std::uint32_t> starts;  // one more than points
    std::vector<std::uint32_t> items;

    std::span<const std::uint32_t> of(std::size_t point) const {
        return std::span(items).subspan(starts[point], starts[point + 1] - starts[point]);
    }
};

/// The neighbors of each point, each once, in the order of their coordinates, so that sums over a
/// ring don't depend on the order of the points.
/// @param triangles  indices into `points`, checked already.
PointLists vertex_rings(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles);

/// The triangles at each point, in rising order.
PointLists vertex_triangles(std::size_t points, std::span<const IndexTriangle> triangles);

/// Steps along edges from each point to the nearest point on a border: 0 where the directions to
/// the ring leave a gap of more than 135 degrees around the normal (single missing triangles are no
/// border), `most` where it is that far or farther.
std::vector<int> border_distances(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                                  const PointLists& rings, int most);

/// @throws InvalidInput if an index is out of range.
void require_triangles(std::span<const IndexTriangle> triangles, std::size_t points,
                       const char* descriptor);

}  // namespace ostraka
