// SPDX-License-Identifier: Apache-2.0
// What a depth sensor makes of true distances.
// Khoshelham, Elberink. Accuracy and Resolution of Kinect Depth Data. Sensors 12(2), 2012.
#pragma once

#include <cstdint>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// An ideal sensor by default. All lengths in the unit of the scene.
struct SensorSettings {
    double noise = 0.0;  ///< standard deviation of the depth, at any depth
    double noise_per_depth2 =
        0.0;                    ///< added deviation, times depth squared (triangulation), 1/unit
    double quantization = 0.0;  ///< depth is rounded to multiples of this; 0: not at all
    double max_grazing_angle =
        1.5;                 ///< radians between ray and normal beyond which nothing returns
    std::uint64_t seed = 0;  ///< same seed, same noise, any number of threads
};

/// The depth that the sensor reports for a true depth, or a NaN where nothing returns.
/// @param depth   along the camera's z axis, positive.
/// @param cosine  between the reversed ray and the surface normal, 0 to 1.
/// @param pixel   number of the pixel: with the seed it selects the random numbers.
double measured_depth(double depth, double cosine, std::uint64_t pixel,
                      const SensorSettings& settings);

}  // namespace ostraka
