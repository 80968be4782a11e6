// SPDX-License-Identifier: Apache-2.0
// Whether what agrees with a placed model would agree as well if the model were moved a little: a
// bulge agrees with any other, a face with its nose in the right place agrees with nothing else.
// Nothing of it depends on where the scan was seen from.
#pragma once

#include <span>

#include "ostraka/recognition/hypothesis.hpp"

namespace ostraka {

/// How much worse the normals of scan and model agree (mean of 1 - cosine; 1 of a point with no
/// model near) when the model is moved by 4 sampling distances along or about a principal direction
/// of the points: of the twelve ways that in which they get worse least. Below 0 if they get
/// better; about 0 where the surface is plane, or goes on beyond the points as that of a cylinder.
/// @param points  of scan.cloud, that agree with the model; 0 if there is none. Looks at 300.
double sharpness(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                 std::span<const std::uint32_t> points);

}  // namespace ostraka
