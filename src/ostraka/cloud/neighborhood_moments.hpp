// SPDX-License-Identifier: Apache-2.0
// Private to this module: what a plane or a covariance needs of the neighbors of every point.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Sums over the neighborhoods of a few points, of the neighbors' offsets from each; as columns, so
/// that planes can be fitted to all at a time.
struct MomentBatch {
    static constexpr std::size_t kCapacity = 16;

    std::size_t count = 0;                       ///< neighborhoods; the lanes beyond it hold 0
    std::array<std::uint32_t, kCapacity> index;  ///< of the point each belongs to
    double neighbors = 0.0;                      ///< points in each, its own included
    /// x y z xx xy xz yy yz zz of the offsets, in the points' unit.
    alignas(32) std::array<std::array<double, kCapacity>, 9> sums;
};

/// Visits every point once with the min(k, size) nearest points to it, itself included; of equally
/// distant ones those with the lowest indices. Exact. Batches are visited from any thread in any
/// order; what a batch holds of a point doesn't depend on that.
/// @param points  finite. @param k  at least 1.
void visit_nearest_moments(std::span<const Vec3f> points, std::size_t k,
                           const std::function<void(const MomentBatch&)>& visit);

}  // namespace ostraka
