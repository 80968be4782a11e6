// SPDX-License-Identifier: Apache-2.0
// The rigid motion that best maps points onto their partners.
// Arun, Huang, Blostein. Least-Squares Fitting of Two 3-D Point Sets. PAMI 9(5), 1987.
#pragma once

#include <span>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// T_target_source that minimizes the sum of weight * |target - T source|^2.
/// @param source,target  equally long, at least 3 pairs not on a line for a unique answer (with
/// fewer,
///                       one of the best motions is returned).
/// @param weights        empty (all 1) or as long; non-negative.
/// @throws InvalidInput if the lengths differ or there is no pair.
Pose fit_rigid(std::span<const Vec3f> source, std::span<const Vec3f> target,
               std::span<const float> weights = {});

}  // namespace ostraka
