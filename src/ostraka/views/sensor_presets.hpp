// SPDX-License-Identifier: Apache-2.0
// Common kinds of depth cameras, by name.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ostraka/base/unit.hpp"
#include "ostraka/cloud/pinhole_camera.hpp"
#include "ostraka/views/sensor_model.hpp"

namespace ostraka {

/// A kind of depth camera. docs/sensors.md says where each number comes from.
struct SensorPreset {
    std::string name;         ///< as for `--sensor`
    std::string description;  ///< one line
    PinholeCamera camera;
    SensorModel model;
    double distance = 0.0;  ///< usual distance from its objects
};

/// All presets, lengths in `unit`: "ideal", "structured-light", "structured-light-fine", "stereo",
/// "time-of-flight" and "laser-line".
std::vector<SensorPreset> sensor_presets(Unit unit);

/// The preset of that name.
std::optional<SensorPreset> find_sensor_preset(std::string_view name, Unit unit);

}  // namespace ostraka
