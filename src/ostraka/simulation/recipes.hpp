// SPDX-License-Identifier: Apache-2.0
// The kinds of scenes that can be simulated, and one way to make them all.
#pragma once

#include <string_view>
#include <variant>
#include <vector>

#include "ostraka/simulation/drop.hpp"
#include "ostraka/simulation/scene.hpp"

namespace ostraka {

/// Which models a scene shows.
enum class ModelChoice {
    random,   ///< drawn with repetition
    in_turns  ///< each as often as the others: few scenes show all
};

/// Objects on a table, in a grid (simulate_tabletop()).
struct TabletopScenes {
    TabletopSettings settings;
    ModelChoice choice = ModelChoice::random;
};

/// Objects dropped on a table or into a bin.
struct DropScenes {
    int objects = 8;    ///< dropped; some may find no place in a bin
    DropSettings drop;  ///< its seed is the scenes'
    ModelChoice choice = ModelChoice::in_turns;
    double min_elevation = 0.6;  ///< radians of the sensor above the table
    double max_elevation = 1.4;  ///< radians
    double distance = 4.0;       ///< from the sensor to the middle, in mean diameters of all models
    double table_size = 8.0;     ///< side of the table, in the same; 0: none
    PinholeCamera camera;
    SensorModel sensor;
    std::uint64_t seed = 0;
};

/// Given poses: scene i shows the objects of placed[i], seen from `T_camera_world`.
struct LayoutScenes {
    std::vector<std::vector<PlacedModel>> placed;
    Pose T_camera_world = Pose::Identity();
    PinholeCamera camera;
    SensorModel sensor;
};

using SceneRecipe = std::variant<RandomViewSettings, TabletopScenes, DropScenes, LayoutScenes>;

/// Makes scene after scene of the same models. make() is const and safe from many threads.
class SceneSimulator {
  public:
    /// @throws InvalidInput if the recipe can't be followed with these models.
    SceneSimulator(SceneModels models, SceneRecipe recipe);

    const SceneModels& models() const { return models_; }
    /// Scenes that there are; layouts have a last one, of the others there are any number.
    std::size_t limit() const;
    /// @param number  of the scene, below limit(). It depends on the recipe and this number only.
    SimulatedScene make(std::uint64_t number) const;

  private:
    SceneModels models_;
    SceneRecipe recipe_;
    DropModels drop_models_;  // of recipes that drop
};

/// Models of scene `number`. @param models  how many there are; at least 1.
std::vector<std::uint32_t> choose_models(std::size_t models, int objects, std::uint64_t number,
                                         ModelChoice choice, std::uint64_t seed);

}  // namespace ostraka
