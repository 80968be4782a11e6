// SPDX-License-Identifier: Apache-2.0
// Compact coding of an entry's points: 16 bits a coordinate, about the model's center.
#pragma once

#include <array>
#include <cstdint>

#include "ostraka/mesh/shape.hpp"

namespace ostraka {

using EncodedPoint = std::array<std::int16_t, 3>;

/// @param point  model frame, within 1.02 radii of the center (beyond, it is clamped).
EncodedPoint encode_point(const Vec3f& point, const MeshShape& shape);

/// The inverse, to 1/64000 of the radius.
Vec3f decode_point(const EncodedPoint& encoded, const MeshShape& shape);

}  // namespace ostraka
