// SPDX-License-Identifier: Apache-2.0
// Data sets in BOP's layout, see bop_scene.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/data_set_readers.hpp"
#include "ostraka/io/folder_files.hpp"
#include "ostraka/io/models_info.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

using Path = std::filesystem::path;

bool is_scene_folder(const Path& folder) {
    return std::filesystem::is_regular_file(folder / "scene_camera.json") ||
           std::filesystem::is_regular_file(folder / "scene_gt.json");
}

std::vector<Path> scene_folders(const Path& split) {
    std::vector<Path> scenes;
    for (const Path& folder : list_folders(split)) {
        if (whole_number(folder.filename().string()) && is_scene_folder(folder)) {
            scenes.push_back(folder);
        }
    }
    return scenes;
}

// Where the parts lie, whichever folder was named.
struct Layout {
    Path root;                 // with models, camera.json, targets
    std::vector<Path> scenes;  // scene folders, in order
    bool many_splits = false;  // their numbers may repeat
};

// Of a root all splits of the kind that one evaluates on: test if there is one, else val, else
// train.
Layout layout_of_root(const Path& root) {
    const std::vector<Path> folders = list_folders(root);
    for (const char* kind : {"test", "val", "train"}) {
        Layout layout{root};
        int splits = 0;
        for (const Path& folder : folders) {
            const std::string name = folder.filename().string();
            if (name != kind && !name.starts_with(std::string(kind) + "_")) continue;
            const std::vector<Path> scenes = scene_folders(folder);
            layout.scenes.insert(layout.scenes.end(), scenes.begin(), scenes.end());
            splits += scenes.empty() ? 0 : 1;
        }
        layout.many_splits = splits > 1;
        if (splits > 0) return layout;
    }
    return {};
}

Layout layout_of(const Path& folder) {
    // "test/.." of a link would be another folder.
    const Path real = std::filesystem::canonical(folder);
    if (is_scene_folder(real)) return {real.parent_path().parent_path(), {real}};
    std::vector<Path> scenes = scene_folders(real);
    if (!scenes.empty()) return {real.parent_path(), std::move(scenes)};
    return layout_of_root(real);
}

// obj_000012.ply is 12.
std::optional<int> object_number(const Path& path) {
    const std::string stem = path.stem().string();
    if (!stem.starts_with("obj_") || !is_mesh_file(path)) return std::nullopt;
    return whole_number(std::string_view(stem).substr(4));
}

// The folder of the meshes that errors are measured on, or else of any; empty if there is none.
Path models_folder(const Path& root) {
    std::vector<Path> folders = {root / "models_eval", root / "models"};
    for (const Path& folder : list_folders(root)) {
        if (folder.filename().string().starts_with("models_")) folders.push_back(folder);
    }
    for (const Path& folder : folders) {
        if (!std::filesystem::is_directory(folder)) continue;
        for (const Path& file : list_files(folder, 0)) {
            if (object_number(file)) return folder;
        }
    }
    return {};
}

std::map<int, RecordedModel> models_of(const Path& root) {
    std::map<int, RecordedModel> models;
    const Path folder = models_folder(root);
    if (folder.empty()) return models;
    for (const Path& file : list_files(folder, 0)) {
        if (const std::optional<int> number = object_number(file)) {
            models[*number] = {file.stem().string(), file, *number};
        }
    }
    if (const Path info = folder / "models_info.json"; std::filesystem::exists(info)) {
        for (const ModelInfo& model : read_models_info(info)) {
            const auto found = models.find(model.number);
            if (found != models.end() && !model.name.empty()) found->second.name = model.name;
        }
    }
    return models;
}

std::map<int, Path> depth_images(const Path& scene) {
    std::map<int, Path> images;
    if (!std::filesystem::is_directory(scene / "depth")) return images;
    for (const Path& file : list_files(scene / "depth", 0)) {
        const std::string extension = lower_extension(file);
        const std::optional<int> number = whole_number(file.stem().string());
        if (!number) continue;
        if (extension == ".png") images[*number] = file;
        if (extension == ".tif" || extension == ".tiff") images.emplace(*number, file);
    }
    return images;
}

// The files don't state the images' size; in a scene it is the same for all.
PngSize size_of_images(const std::map<int, Path>& images) {
    for (const auto& [number, path] : images) {
        if (lower_extension(path) == ".png") return read_png_size(path);
    }
    return {};
}

void add_scene(const Path& folder, bool with_split, std::map<int, RecordedModel>& models,
               DataSet& set) {
    const BopScene truth = read_bop_scene(folder);
    const std::map<int, Path> images = depth_images(folder);
    const PngSize size = size_of_images(images);
    const Path name =
        with_split ? folder.parent_path().filename() / folder.filename() : folder.filename();
    for (const auto& [number, camera] : truth.cameras) {
        RecordedScene scene{.name = fmt::format("{}/{:06}", name.generic_string(), number)};
        scene.scene = whole_number(folder.filename().string()).value_or(0);
        scene.image = number;
        scene.viewpoint = Vec3f::Zero();
        scene.depth =
            DepthCamera{{size.width, size.height, camera.fx, camera.fy, camera.cx, camera.cy},
                        camera.depth_scale,
                        Unit::millimeter};
        if (const auto image = images.find(number); image != images.end()) {
            scene.scan = image->second;
        }
        const auto objects = truth.objects.find(number);
        scene.truth_known = objects != truth.objects.end();
        if (scene.truth_known) {
            for (const BopObject& object : objects->second) {
                // For now the object's number; indices are known once all models are.
                scene.objects.push_back({static_cast<std::uint32_t>(object.number),
                                         object.T_camera_model, object.visible_fraction});
                models.try_emplace(
                    object.number,
                    RecordedModel{fmt::format("obj_{:06}", object.number), {}, object.number});
            }
        }
        set.scenes.push_back(std::move(scene));
    }
}

}  // namespace

std::optional<DataSet> open_bop(const Path& folder) {
    const Layout layout = layout_of(folder);
    if (layout.scenes.empty()) return std::nullopt;
    DataSet set{.kind = DataSetKind::bop, .unit = Unit::millimeter};
    std::map<int, RecordedModel> models = models_of(layout.root);
    for (const Path& scene : layout.scenes) add_scene(scene, layout.many_splits, models, set);
    std::map<int, std::uint32_t> index;
    for (auto& [number, model] : models) {
        index[number] = static_cast<std::uint32_t>(set.models.size());
        set.models.push_back(std::move(model));
    }
    for (RecordedScene& scene : set.scenes) {
        for (RecordedObject& object : scene.objects) {
            object.model = index.at(static_cast<int>(object.model));
        }
    }
    if (const Path path = layout.root / "test_targets_bop19.json"; std::filesystem::exists(path)) {
        set.bop_targets = read_bop_targets(path);
    }
    return set;
}

}  // namespace ostraka
