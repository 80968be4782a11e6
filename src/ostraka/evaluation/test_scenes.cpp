// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/test_scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/kdtree.hpp"

namespace ostraka {
namespace {

// Index into the names for each model of the data set, kNoIndex where there is none.
std::vector<std::uint32_t> models_in(const DataSet& data, std::span<const std::string> names) {
    std::map<std::string, std::uint32_t> by_name;
    for (std::uint32_t m = 0; m < names.size(); ++m) by_name[names[m]] = m;
    std::vector<std::uint32_t> indices;
    for (const RecordedModel& model : data.models) {
        // Files may have been renamed for the library: the mesh's own name is tried, too.
        auto found = by_name.find(model.name);
        if (found == by_name.end()) found = by_name.find(model.file.stem().string());
        indices.push_back(found == by_name.end() ? kNoIndex : found->second);
    }
    return indices;
}

std::vector<std::string> names_of(const ModelLibrary& library) {
    std::vector<std::string> names;
    for (const Model& model : library.models) names.push_back(model.name);
    return names;
}

double factor_of(const DataSet& data, const ModelLibrary& library, std::optional<Unit> unit) {
    const std::optional<Unit> from = data.unit ? data.unit : unit;
    if (!from) throw InvalidInput("the data set doesn't state its unit: say which (mm, cm, m, in)");
    return unit_factor(*from, library.settings.unit);
}

Pose scaled_pose(Pose pose, double factor) {
    pose.translation() *= factor;
    return pose;
}

std::vector<std::string> missing_notes(const DataSet& data,
                                       const std::vector<std::uint32_t>& indices) {
    std::set<std::string> missing;
    for (const RecordedScene& scene : data.scenes) {
        for (const RecordedObject& object : scene.objects) {
            if (indices[object.model] == kNoIndex) missing.insert(data.models[object.model].name);
        }
    }
    std::vector<std::string> notes;
    for (const std::string& name : missing) {
        notes.push_back("not in the library, left out: " + name);
    }
    return notes;
}

std::vector<TrueObject> truth_of(const RecordedScene& scene,
                                 const std::vector<std::uint32_t>& indices, double factor) {
    std::vector<TrueObject> objects;
    for (const RecordedObject& object : scene.objects) {
        if (indices[object.model] == kNoIndex) continue;
        objects.push_back({indices[object.model], scaled_pose(object.T_scene_model, factor),
                           object.visible_fraction < 0.0 ? 1.0 : object.visible_fraction});
    }
    return objects;
}

// Which object's surface each point lies on.
void label_by_surface(TestScene& scene, const ModelLibrary& library) {
    const std::size_t count = scene.cloud.size();
    scene.labels.assign(count, kNoIndex);
    const auto limit = static_cast<float>(library.settings.sampling);
    std::vector<float> nearest(count, limit * limit);
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
        const Model& model = library.models[scene.objects[o].model];
        const KdTree tree(model.surface.points);
        const Pose T_model_scene = scene.objects[o].T_scene_model.inverse();
        const double reach = model.shape.radius + library.settings.sampling;
        for (std::size_t i = 0; i < count; ++i) {
            if (!scene.cloud.points[i].allFinite()) continue;
            const Vec3d point = T_model_scene * scene.cloud.points[i].cast<double>();
            if ((point - model.shape.center).squaredNorm() > reach * reach) continue;
            const float distance = tree.nearest(point.cast<float>()).squared_distance;
            if (distance >= nearest[i]) continue;
            nearest[i] = distance;
            scene.labels[i] = o;
        }
    }
}

TestScene load_recorded(const RecordedScene& recorded, const ModelLibrary& library,
                        const std::vector<std::uint32_t>& indices, double factor) {
    TestScene scene{.name = recorded.name, .scene = recorded.scene, .image = recorded.image};
    scene.cloud = scaled(read_scan(recorded), factor);
    scene.viewpoint_known =
        recorded.depth || recorded.viewpoint || !scene.cloud.viewpoint.isZero(0.0F);
    scene.objects = truth_of(recorded, indices, factor);
    if (recorded.depth) {
        scene.camera = recorded.depth->camera;
        scene.camera->width = scene.cloud.width;
        scene.camera->height = scene.cloud.height;
    }
    label_by_surface(scene, library);
    return scene;
}

}  // namespace

SceneModels scene_models_of(const ModelLibrary& library) {
    std::vector<TriangleMesh> meshes;
    std::vector<MeshShape> shapes;
    for (const Model& model : library.models) {
        meshes.push_back(model.mesh);
        shapes.push_back(model.shape);
    }
    return scene_models(std::move(meshes), std::move(shapes));
}

double mean_diameter(const ModelLibrary& library) {
    double sum = 0.0;
    for (const Model& model : library.models) sum += model.shape.diameter;
    return sum / static_cast<double>(library.models.size());
}

TestSet simulated_set(const ModelLibrary& library, const SceneRecipe& recipe, std::size_t count) {
    const auto simulator = std::make_shared<const SceneSimulator>(scene_models_of(library), recipe);
    TestSet set{.count = std::min(count, simulator->limit())};
    set.load = [simulator](std::size_t number) {
        SimulatedScene made = simulator->make(number);
        return TestScene{.name = fmt::format("scene_{:04}", number),
                         .scene = 1,
                         .image = static_cast<int>(number),
                         .cloud = std::move(made.cloud),
                         .objects = std::move(made.objects),
                         .labels = std::move(made.labels),
                         .camera = made.camera};
    };
    return set;
}

TestSet for_library(TestSet set, const ModelLibrary& from, const ModelLibrary& to) {
    std::vector<std::uint32_t> number(from.models.size(), kNoIndex);
    for (std::size_t i = 0; i < from.models.size(); ++i) {
        for (std::uint32_t k = 0; k < to.models.size(); ++k) {
            if (to.models[k].name == from.models[i].name) number[i] = k;
        }
    }
    const auto known = std::count_if(number.begin(), number.end(),
                                     [](std::uint32_t index) { return index != kNoIndex; });
    if (known == 0) throw InvalidInput("the scenes show none of the library's models");
    set.description +=
        fmt::format(", {} of {} models are in the library", known, from.models.size());
    set.load = [load = std::move(set.load), number](std::size_t i) {
        TestScene scene = load(i);
        std::vector<std::uint32_t> place(scene.objects.size(), kNoIndex);
        std::vector<TrueObject> objects;
        for (std::size_t k = 0; k < scene.objects.size(); ++k) {
            if (number[scene.objects[k].model] == kNoIndex) continue;
            place[k] = static_cast<std::uint32_t>(objects.size());
            objects.push_back(scene.objects[k]);
            objects.back().model = number[scene.objects[k].model];
        }
        for (std::uint32_t& label : scene.labels) {
            if (label != kNoIndex) label = place[label];
        }
        scene.objects = std::move(objects);
        return scene;
    };
    return set;
}

TestSet recorded_set(const DataSet& data, const ModelLibrary& library, std::optional<Unit> unit) {
    const double factor = factor_of(data, library, unit);
    const std::vector<std::uint32_t> indices = models_in(data, names_of(library));
    TestSet set{.notes = missing_notes(data, indices)};
    auto usable = std::make_shared<std::vector<RecordedScene>>();
    std::size_t without_scan = 0;
    for (const RecordedScene& scene : data.scenes) {
        if (scene.scan.empty()) ++without_scan;
        if (scene.scan.empty() || !scene.truth_known) continue;
        if (!truth_of(scene, indices, factor).empty()) usable->push_back(scene);
    }
    if (without_scan > 0) set.notes.push_back(fmt::format("{} scenes have no scan", without_scan));
    if (usable->empty()) {
        throw InvalidInput("the data set has no scan of an object that is in the library");
    }
    set.count = usable->size();
    set.load = [usable, &library, indices, factor](std::size_t number) {
        return load_recorded((*usable)[number], library, indices, factor);
    };
    return set;
}

std::vector<std::vector<PlacedModel>> layout_of(const DataSet& data,
                                                std::span<const std::string> names, double factor,
                                                std::vector<std::string>* notes) {
    const std::vector<std::uint32_t> indices = models_in(data, names);
    if (notes != nullptr) *notes = missing_notes(data, indices);
    std::vector<std::vector<PlacedModel>> scenes;
    for (const RecordedScene& scene : data.scenes) {
        std::vector<PlacedModel> placed;
        for (const TrueObject& object : truth_of(scene, indices, factor)) {
            placed.push_back({object.model, object.T_scene_model});
        }
        if (!placed.empty()) scenes.push_back(std::move(placed));
    }
    if (scenes.empty()) throw InvalidInput("the data set places none of the models");
    return scenes;
}

Pose layout_camera(const DataSet& data) {
    // UWA's scanner stood at the origin and looked along -z; the others' scenes are in the frame of
    // a camera.
    if (data.kind == DataSetKind::uwa)
        return look_at(Vec3d::Zero(), -Vec3d::UnitZ(), Vec3d::UnitY());
    return Pose::Identity();
}

}  // namespace ostraka
