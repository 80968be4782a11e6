// SPDX-License-Identifier: Apache-2.0
// Private to this module: the planes of neighborhoods.
#pragma once

#include "ostraka/cloud/neighborhood_moments.hpp"

namespace ostraka {

/// Sums of a neighborhood's offsets from one of its points: enough for its plane.
struct Moments {
    Vec3d first = Vec3d::Zero();
    Mat3d second = Mat3d::Zero();
    double count = 0.0;
};

/// Ratio of the two larger variances below which the points lie on a line.
inline constexpr double kLineRatio = 1e-10;
inline constexpr double kLineRatioSingle = 1e-6;  ///< where the sums are in single precision

/// Unit direction of least variance, of either sign; NaN if there are fewer than 3 points or they
/// lie on a line.
Vec3f fit_normal(const Moments& moments, double line_ratio);

/// The same for all of a batch, to 1e-9 the same values but not the same bits.
void fit_normals(const MomentBatch& batch, std::array<Vec3f, MomentBatch::kCapacity>& normals);

}  // namespace ostraka
