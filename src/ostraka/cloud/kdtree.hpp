// SPDX-License-Identifier: Apache-2.0
// Exact nearest-neighbor search in three dimensions.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

struct Neighbor {
    std::uint32_t index = kNoIndex;  ///< into the points given to the tree
    float squared_distance = 0.0F;   ///< in the points' unit, squared
};

/// A k-d tree over points. Results are ordered by distance, then index, so they are repeatable.
/// The points must be finite and outlive the tree. Queries are const and safe from many threads.
class KdTree {
  public:
    explicit KdTree(std::span<const Vec3f> points);
    ~KdTree();
    KdTree(KdTree&&) noexcept;
    KdTree& operator=(KdTree&&) noexcept;

    std::size_t size() const;
    /// The nearest point; index kNoIndex if the tree is empty.
    Neighbor nearest(const Vec3f& query) const;
    /// The min(k, size()) nearest points, nearest first, into `neighbors` (replaced).
    void nearest(const Vec3f& query, std::size_t k, std::vector<Neighbor>& neighbors) const;
    /// All points closer than `radius`, nearest first, into `neighbors` (replaced).
    void within(const Vec3f& query, float radius, std::vector<Neighbor>& neighbors) const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace ostraka
