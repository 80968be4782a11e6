// SPDX-License-Identifier: Apache-2.0
// What a real depth camera makes of a true depth image: noise, steps, and pixels without an answer.
// Khoshelham, Elberink. Accuracy and Resolution of Kinect Depth Data. Sensors 12(2), 2012.
// Nguyen, Izadi, Lovell. Modeling Kinect Sensor Noise. 3DIMPVT 2012.
// Keselman et al. Intel RealSense Stereoscopic Depth Cameras. CVPRW 2017.
// docs/sensors.md describes each fault with its formula.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// The faults that each ray has by itself; none by default but for grazing rays. All lengths in the
/// unit of the scene.
struct SensorSettings {
    double noise = 0.0;  ///< standard deviation of the depth, at any depth
    double noise_per_depth2 =
        0.0;                    ///< added deviation, times depth squared (triangulation), 1/unit
    double quantization = 0.0;  ///< depth is rounded to multiples of this; 0: not at all
    double max_grazing_angle =
        1.5;                 ///< radians between ray and normal beyond which nothing returns
    std::uint64_t seed = 0;  ///< same seed, same noise, any number of threads
};

/// A whole sensor, ideal by default. Lengths in the unit of the scene. In this order: range,
/// grazing angles, shadow, edges, holes; then mixed pixels, noise, rounding of what is left.
struct SensorModel {
    /// Noise, rounding, the grazing angle where everything is lost, and the seed.
    SensorSettings ranging;
    double noise_per_depth = 0.0;     ///< added deviation, times depth (time of flight)
    double grazing_noise = 0.0;       ///< the deviation is divided by cos(angle) to this power
    int noise_window = 1;             ///< pixels: noise is alike within such a square (stereo); odd
    double inverse_depth_step = 0.0;  ///< 1 / depth is rounded to multiples of this (disparity)
    double free_grazing_angle = 1.5;  ///< radians: up to here nothing is lost to grazing; from here
                                      ///< to ranging.max_grazing_angle the loss grows linearly
    double min_depth = 0.0;           ///< nearer surface gives nothing
    double max_depth = std::numeric_limits<double>::infinity();  ///< farther surface gives nothing
    /// Camera frame: a projector or second camera that must see a point as well; 0: there is none.
    Vec3d projector = Vec3d::Zero();
    double edge_step = 0.0;     ///< depths of neighboring pixels that differ by more make an edge
    double edge_dropout = 0.0;  ///< probability that a pixel beside an edge is lost
    double mixed_pixels = 0.0;  ///< probability that it lies between both sides
    double dropout = 0.0;       ///< probability that any pixel is lost
    double holes = 0.0;         ///< share of the image lost in round patches
    double hole_size = 6.0;     ///< their mean radius, pixels
};

/// A depth image without faults.
struct DepthImage {
    int width = 0;
    int height = 0;
    std::vector<double> depths;   ///< width * height, row-major; 0: nothing there
    std::vector<double> cosines;  ///< between the reversed ray and the surface normal, 0 to 1
};

/// The depths that the sensor reports; 0 where it reports none.
/// @param shadowed  1 a pixel that the projector doesn't reach; may be empty. The same for any
///                  number of threads.
std::vector<double> measured_depths(const DepthImage& truth, const std::vector<char>& shadowed,
                                    const SensorModel& sensor);

/// The standard deviation of the noise at a depth. @param cosine  as in DepthImage.
double noise_deviation(double depth, double cosine, const SensorModel& sensor);

/// The same sensor, its lengths multiplied by `factor`: from one unit to another.
SensorModel scaled(SensorModel sensor, double factor);

}  // namespace ostraka
