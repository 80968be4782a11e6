// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/depth_sensor.hpp"

#include <cmath>
#include <limits>

#include "ostraka/base/random.hpp"

namespace ostraka {

double measured_depth(double depth, double cosine, std::uint64_t pixel,
                      const SensorSettings& settings) {
    if (cosine < std::cos(settings.max_grazing_angle)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    const double deviation = settings.noise + settings.noise_per_depth2 * depth * depth;
    if (deviation > 0.0) depth += deviation * Random(settings.seed, pixel).normal();
    if (settings.quantization > 0.0) {
        depth = std::round(depth / settings.quantization) * settings.quantization;
    }
    return depth;
}

}  // namespace ostraka
