// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/pinhole_camera.hpp"

namespace ostraka {

PinholeCamera resized(const PinholeCamera& camera, int width) {
    if (width == 0) return camera;
    const double factor = static_cast<double>(width) / camera.width;
    PinholeCamera other = camera;
    other.width = width;
    other.height = static_cast<int>(camera.height * factor);
    other.fx *= factor;
    other.fy *= factor;
    other.cx = (other.width - 1) / 2.0;
    other.cy = (other.height - 1) / 2.0;
    return other;
}

}  // namespace ostraka
