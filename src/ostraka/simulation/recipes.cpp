// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/recipes.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

template <class... Ts>
struct Overloaded : Ts... {
    using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

// A permutation of the models for each round of turns.
std::vector<std::uint32_t> shuffled(std::size_t models, std::uint64_t round, std::uint64_t seed) {
    std::vector<std::uint32_t> order(models);
    std::iota(order.begin(), order.end(), 0U);
    Random random(seed ^ 0x7047, round);
    for (std::size_t i = models; i > 1; --i) {
        std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
    }
    return order;
}

SimulatedScene make_drop(const SceneModels& models, const DropModels& prepared,
                         const DropScenes& recipe, std::uint64_t number) {
    const auto chosen =
        choose_models(models.meshes.size(), recipe.objects, number, recipe.choice, recipe.seed);
    DropSettings settings = recipe.drop;
    settings.seed = recipe.seed;
    const DropResult heap = drop(prepared, chosen, number, settings);
    const double diameter = mean_diameter(models);
    Random random(recipe.seed ^ 0xca3e7a, number);
    const ViewFromAbove from{recipe.min_elevation, recipe.max_elevation,
                             recipe.distance * diameter};
    SceneView view{.camera = recipe.camera,
                   .T_camera_world = view_from_above(random, Vec3d(0.0, 0.0, 0.3 * diameter), from),
                   .sensor = recipe.sensor,
                   .table_size = recipe.table_size * diameter};
    if (recipe.drop.bin) view.furniture.emplace_back(bin_mesh(*recipe.drop.bin));
    view.sensor.ranging.seed += number << 32U;
    return simulate_scene(models, heap.placed, view);
}

SimulatedScene make_layout(const SceneModels& models, const LayoutScenes& recipe,
                           std::uint64_t number) {
    SceneView view{
        .camera = recipe.camera, .T_camera_world = recipe.T_camera_world, .sensor = recipe.sensor};
    view.sensor.ranging.seed += number << 32U;
    return simulate_scene(models, recipe.placed.at(number), view);
}

}  // namespace

std::vector<std::uint32_t> choose_models(std::size_t models, int objects, std::uint64_t number,
                                         ModelChoice choice, std::uint64_t seed) {
    std::vector<std::uint32_t> chosen;
    const auto count = static_cast<std::uint64_t>(std::max(0, objects));
    if (choice == ModelChoice::random) {
        Random random(seed ^ 0x7ab1e, number);
        for (std::uint64_t i = 0; i < count; ++i) {
            chosen.push_back(random.below(static_cast<std::uint32_t>(models)));
        }
        return chosen;
    }
    std::uint64_t round = std::numeric_limits<std::uint64_t>::max();
    std::vector<std::uint32_t> order;
    for (std::uint64_t turn = number * count; turn < (number + 1) * count; ++turn) {
        if (turn / models != round) {
            round = turn / models;
            order = shuffled(models, round, seed);
        }
        chosen.push_back(order[turn % models]);
    }
    return chosen;
}

SceneSimulator::SceneSimulator(SceneModels models, SceneRecipe recipe)
    : models_(std::move(models)), recipe_(std::move(recipe)) {
    if (models_.meshes.empty()) throw InvalidInput("scenes need at least one model");
    if (std::holds_alternative<DropScenes>(recipe_)) drop_models_ = drop_models(models_);
    if (const auto* layout = std::get_if<LayoutScenes>(&recipe_)) {
        for (const std::vector<PlacedModel>& scene : layout->placed) {
            for (const PlacedModel& placed : scene) {
                if (placed.model >= models_.meshes.size()) {
                    throw InvalidInput("a layout names a model that isn't there");
                }
            }
        }
    }
}

std::size_t SceneSimulator::limit() const {
    const auto* layout = std::get_if<LayoutScenes>(&recipe_);
    return layout != nullptr ? layout->placed.size() : std::numeric_limits<std::size_t>::max();
}

SimulatedScene SceneSimulator::make(std::uint64_t number) const {
    return std::visit(
        Overloaded{
            [&](const RandomViewSettings& recipe) {
                return simulate_random_view(models_, number, recipe);
            },
            [&](const TabletopScenes& recipe) {
                const auto chosen = choose_models(models_.meshes.size(), recipe.settings.objects,
                                                  number, recipe.choice, recipe.settings.seed);
                return simulate_tabletop(models_, chosen, number, recipe.settings);
            },
            [&](const DropScenes& recipe) {
                return make_drop(models_, drop_models_, recipe, number);
            },
            [&](const LayoutScenes& recipe) { return make_layout(models_, recipe, number); }},
        recipe_);
}

}  // namespace ostraka
