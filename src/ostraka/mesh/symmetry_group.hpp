// SPDX-License-Identifier: Apache-2.0
// Private to mesh: from measured turns, which are nearly symmetries, to an exact group.
#pragma once

#include <span>
#include <vector>

#include "ostraka/mesh/turns.hpp"

namespace ostraka {

/// The direction or its opposite: the one that points to positive z; else, if it is across z, to
/// positive y; else to positive x.
Vec3d upward(const Vec3d& direction);

/// The cyclic group of `order` turns about `main`, the identity first.
std::vector<Mat3d> cyclic_group(const Vec3d& main, int order);
/// The same and as many half turns across, one of them about `across`.
std::vector<Mat3d> dihedral_group(const Vec3d& main, const Vec3d& across, int order);
/// The group of 12, 24 or 60 turns that two turns nearly generate, exactly; empty if there is none.
std::vector<Mat3d> polyhedral_group(const Mat3d& first, const Mat3d& second);

}  // namespace ostraka
