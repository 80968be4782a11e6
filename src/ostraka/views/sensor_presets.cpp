// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/sensor_presets.hpp"

namespace ostraka {
namespace {

PinholeCamera centered(int width, int height, double focal_length) {
    return {width, height, focal_length, focal_length, (width - 1) / 2.0, (height - 1) / 2.0};
}

// All lengths below are in mm; a projector on the right stands at positive x.

SensorPreset ideal() {
    return {"ideal", "no faults, 640 x 480", centered(640, 480, 575.0), {}, 800.0};
}

// Kinect v1 and its kind. Khoshelham and Elberink 2012: deviation 1.425e-3 z^2, step 2.85e-3 z^2
// (z in m), 75 mm between projector and camera.
SensorPreset structured_light() {
    SensorModel model;
    model.ranging = {.noise_per_depth2 = 1.425e-6, .max_grazing_angle = 1.40};
    model.grazing_noise = 1.0;
    model.inverse_depth_step = 2.85e-6;
    model.free_grazing_angle = 1.05;
    model.min_depth = 400.0;
    model.max_depth = 4000.0;
    model.projector = Vec3d(75.0, 0.0, 0.0);
    model.edge_step = 10.0;
    model.edge_dropout = 0.5;
    model.holes = 0.01;
    return {"structured-light",
            "a projected pattern, Kinect v1 and its kind: 640 x 480, 75 mm baseline",
            centered(640, 480, 575.0), model, 800.0};
}

// Industrial cameras that project several patterns: the makers state 0.02 to 0.1 mm at 0.7 m.
SensorPreset structured_light_fine() {
    SensorModel model;
    model.ranging = {.noise_per_depth2 = 1.2e-7, .max_grazing_angle = 1.45};
    model.grazing_noise = 1.0;
    model.free_grazing_angle = 1.15;
    model.min_depth = 300.0;
    model.max_depth = 1800.0;
    model.projector = Vec3d(120.0, 0.0, 0.0);
    model.edge_step = 3.0;
    model.edge_dropout = 0.2;
    model.mixed_pixels = 0.05;
    model.dropout = 0.002;
    return {"structured-light-fine",
            "several projected patterns, industrial: 1224 x 1024, 120 mm baseline",
            centered(1224, 1024, 1300.0), model, 700.0};
}

// RealSense D435 and its kind: 50 mm baseline, 0.08 pixels of disparity noise, 1/32 pixel steps,
// alike within the matching window.
SensorPreset stereo() {
    constexpr double kPixelMillimeters = 425.0 * 50.0;  // focal length times baseline
    SensorModel model;
    model.ranging = {.noise_per_depth2 = 0.08 / kPixelMillimeters, .max_grazing_angle = 1.40};
    model.noise_window = 5;
    model.inverse_depth_step = 1.0 / 32.0 / kPixelMillimeters;
    model.free_grazing_angle = 1.10;
    model.min_depth = 200.0;
    model.max_depth = 3000.0;
    model.projector = Vec3d(50.0, 0.0, 0.0);
    model.edge_step = 15.0;
    model.edge_dropout = 0.2;
    model.mixed_pixels = 0.4;
    model.holes = 0.01;
    model.hole_size = 4.0;
    return {"stereo",
            "two cameras and a pattern, RealSense D435 and its kind: 848 x 480, 50 mm baseline",
            centered(848, 480, 425.0), model, 600.0};
}

// Azure Kinect (narrow, unbinned): 1 mm steps, deviation about 1 mm at 1 m, flying pixels.
SensorPreset time_of_flight() {
    SensorModel model;
    model.ranging = {.noise = 0.3, .quantization = 1.0, .max_grazing_angle = 1.45};
    model.noise_per_depth = 7e-4;
    model.grazing_noise = 1.0;
    model.free_grazing_angle = 1.20;
    model.min_depth = 250.0;
    model.max_depth = 5000.0;
    model.edge_step = 20.0;
    model.edge_dropout = 0.1;
    model.mixed_pixels = 0.6;
    return {"time-of-flight",
            "runtime of light, Azure Kinect and its kind: 640 x 576, flying pixels",
            centered(640, 576, 504.0), model, 800.0};
}

// Minolta Vivid 910 (the scanner of the UWA scenes): 640 x 480, about 0.1 mm, a wide baseline.
SensorPreset laser_line() {
    SensorModel model;
    model.ranging = {.noise = 0.1, .max_grazing_angle = 1.40};
    model.grazing_noise = 1.0;
    model.free_grazing_angle = 1.05;
    model.min_depth = 500.0;
    model.max_depth = 2500.0;
    model.projector = Vec3d(0.0, 210.0, 0.0);
    model.edge_step = 3.0;
    model.edge_dropout = 0.3;
    model.mixed_pixels = 0.05;
    return {"laser-line",
            "a swept laser line, Minolta Vivid and its kind: 640 x 480, 210 mm baseline",
            centered(640, 480, 1000.0), model, 1000.0};
}

}  // namespace

std::vector<SensorPreset> sensor_presets(Unit unit) {
    std::vector<SensorPreset> presets = {ideal(),  structured_light(), structured_light_fine(),
                                         stereo(), time_of_flight(),   laser_line()};
    const double factor = unit_factor(Unit::millimeter, unit);
    for (SensorPreset& preset : presets) {
        preset.model = scaled(preset.model, factor);
        preset.distance *= factor;
    }
    return presets;
}

std::optional<SensorPreset> find_sensor_preset(std::string_view name, Unit unit) {
    for (SensorPreset& preset : sensor_presets(unit)) {
        if (preset.name == name) return std::move(preset);
    }
    return std::nullopt;
}

}  // namespace ostraka
