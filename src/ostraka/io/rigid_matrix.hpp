// SPDX-License-Identifier: Apache-2.0
// Internal to io: rigid motions from the numbers of a file, which are rounded or measured.
#pragma once

#include <span>
#include <string_view>

#include "ostraka/base/types.hpp"

namespace ostraka {

struct RigidMatrix {
    Pose pose = Pose::Identity();  ///< exactly orthonormal
    std::string_view problem;      ///< why it is none: "has ..." or "is ..."; empty if it is one
};

/// A 4 x 4 matrix, row-major. The last row must be 0 0 0 1, the rows of the rotation orthonormal to
/// 0.02, and it must not be a mirror image. @param numbers  16, finite.
RigidMatrix rigid_from(std::span<const double> numbers);

/// A rotation, row-major, and a translation. @param rotation  9. @param translation  3.
RigidMatrix rigid_from(std::span<const double> rotation, std::span<const double> translation);

}  // namespace ostraka
