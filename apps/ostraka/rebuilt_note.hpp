// SPDX-License-Identifier: Apache-2.0
// Says which models are clouds.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "common.hpp"
#include "ostraka/library/model_source.hpp"

namespace ostraka::app {

/// The same model; when it is read first and has no faces, a line says what was made of it.
inline ModelInput tell_rebuilt(ModelInput input) {
    input.load = [load = std::move(input.load), told = std::make_shared<bool>(false)] {
        ModelSource model = load();
        if (model.cloud_points > 0 && !std::exchange(*told, true)) {
            say(
                fmt::format("{} has no faces: its surface was rebuilt from {} points at a spacing "
                            "of {:.4g}",
                            model.file, model.cloud_points, model.cloud_spacing));
        }
        return model;
    };
    return input;
}

}  // namespace ostraka::app
