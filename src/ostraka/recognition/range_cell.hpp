// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// One direction's measurement.
struct RangeCell {
    float near = 0.0F;  ///< least distance from the viewpoint to a point; 0: nothing measured
    float far = 0.0F;   ///< greatest distance of such a point
    float nearest_around = 0.0F;  ///< least `near` of this and the eight cells around it; 0: none
    std::uint32_t point =
        kNoIndex;       ///< a point of the resampled cloud in or beside this cell, or kNoIndex
    float wall = 0.0F;  ///< extent of the wall or table that was seen here; 0: of none
    float shadow = std::numeric_limits<float>::infinity();
    ///< of a cell where nothing was measured: distance from which on surface may be in the shadow
    ///< that something nearer, in its row or column, casts for the sensor's light or second camera
    bool steady = false;  ///< normals of this and the cells around it agree: they can be relied on
    bool measured() const { return near > 0.0F; }
};

}  // namespace ostraka
