// SPDX-License-Identifier: Apache-2.0
// Which part of a model's surface a piece shows (method, 2.5a): the surface is divided into
// elements of about equal area, and a piece is the bit set of the elements that it touches. Since
// all pieces of a model share its frame, overlap is exact: a popcount of two bit sets.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

inline constexpr std::size_t kSurfaceElements = 1024;
using ElementSet = std::array<std::uint64_t, kSurfaceElements / 64>;

/// Where a turn takes each element: the number of the element there, or kNoIndex.
using ElementMap = std::vector<std::uint32_t>;

/// The elements that those of a set are taken to.
ElementSet mapped(const ElementSet& set, const ElementMap& map);

/// Intersection over union of two sets, 0 to 1; 0 if both are empty.
double overlap(const ElementSet& a, const ElementSet& b);

/// Number of elements in a set.
int count_elements(const ElementSet& set);

/// The Voronoi cells of evenly spread points on a surface.
class SurfaceElements {
  public:
    /// @param surface  a model's visible surface with normals; at least 1 point. The elements'
    /// centers
    ///                 are a farthest-point subset of it.
    explicit SurfaceElements(const PointCloud& surface);

    /// The element of each point: the nearest one that faces the same way, so that the two sides of
    /// a thin wall differ. kNoIndex where no near one does.
    /// @param cloud  points with normals in the surface's frame.
    std::vector<std::uint32_t> label(const PointCloud& cloud) const;

    /// @param T_surface_surface  a symmetry of the surface, in its frame.
    ElementMap map(const Pose& T_surface_surface) const;

  private:
    std::vector<Vec3f> centers_;
    std::vector<Vec3f> normals_;
    KdTree tree_;
};

/// The set of the elements that label the points at `indices`.
ElementSet element_set(std::span<const std::uint32_t> labels,
                       std::span<const std::uint32_t> indices);

}  // namespace ostraka
