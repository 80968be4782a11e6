// SPDX-License-Identifier: Apache-2.0
// The data set of Mian, Bennamoun, Owens. Three-Dimensional Model-Based Object Recognition and
// Segmentation in Cluttered Scenes. IEEE TPAMI 28(10), 2006.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/data_set_readers.hpp"
#include "ostraka/io/folder_files.hpp"
#include "ostraka/io/text.hpp"
#include "ostraka/io/uwa_occlusion.hpp"
#include "ostraka/io/xf_file.hpp"

namespace ostraka {
namespace {

using Path = std::filesystem::path;

// "rs12" is 12.
std::optional<int> scan_number(std::string_view stem) {
    return stem.starts_with("rs") ? whole_number(stem.substr(2)) : std::nullopt;
}

// MODEL-rsN.xf.
struct PoseFile {
    std::string model;
    int scene = 0;
};

std::optional<PoseFile> pose_file(const Path& path) {
    if (lower_extension(path) != ".xf") return std::nullopt;
    const std::string stem = path.stem().string();
    const std::size_t dash = stem.rfind('-');
    if (dash == std::string::npos || dash == 0) return std::nullopt;
    const std::optional<int> number = scan_number(std::string_view(stem).substr(dash + 1));
    if (!number) return std::nullopt;
    return PoseFile{stem.substr(0, dash), *number};
}

// Those under a folder "models" if there is one, else every mesh that is no scan.
std::vector<Path> mesh_files(const std::vector<Path>& files) {
    std::vector<Path> all;
    std::vector<Path> in_models;
    for (const Path& file : files) {
        if (!is_mesh_file(file) || scan_number(file.stem().string())) continue;
        all.push_back(file);
        if (name_key(file.parent_path().filename().string()) == "models") in_models.push_back(file);
    }
    return in_models.empty() ? all : in_models;
}

// Truth says "chef", the file may be cheff.ply or chef_high.ply: one name begins with the other.
// Of several the shortest is meant.
const Path* file_of_model(const std::vector<Path>& meshes, const std::string& name) {
    const Path* best = nullptr;
    std::size_t length = 0;
    for (const Path& mesh : meshes) {
        const std::string stem = mesh.stem().string();
        if (!same_or_longer_name(stem, name)) continue;
        if (best == nullptr || stem.size() < length) best = &mesh;
        length = best == &mesh ? stem.size() : length;
    }
    return best;
}

void add_models(const std::vector<Path>& meshes, DataSet& set) {
    std::vector<const Path*> used;
    for (RecordedModel& model : set.models) {
        const Path* file = file_of_model(meshes, model.name);
        if (file == nullptr) continue;
        model.file = *file;
        used.push_back(file);
    }
    // The rhino lies in some scenes, but its poses were never published.
    for (const Path& mesh : meshes) {
        if (std::find(used.begin(), used.end(), &mesh) != used.end()) continue;
        set.models.push_back({.name = mesh.stem().string(), .file = mesh});
    }
}

void add_occlusion(const Path& path, const std::map<int, std::size_t>& scene_of_number,
                   DataSet& set) {
    for (const UwaOcclusion& row : parse_uwa_occlusion(read_file(path).span(), path)) {
        const auto scene = scene_of_number.find(row.scene);
        if (scene == scene_of_number.end()) continue;
        for (RecordedObject& object : set.scenes[scene->second].objects) {
            if (same_or_longer_name(set.models[object.model].name, row.object)) {
                object.visible_fraction = 1.0 - row.percent / 100.0;
            }
        }
    }
}

}  // namespace

std::optional<DataSet> open_uwa(const Path& folder) {
    const std::vector<Path> files = list_files(folder, kDataSetDepth);
    std::map<int, RecordedScene> scenes;
    DataSet set{.kind = DataSetKind::uwa, .unit = Unit::millimeter};
    for (const Path& file : files) {
        const std::optional<PoseFile> pose = pose_file(file);
        if (!pose) continue;
        scenes[pose->scene].objects.push_back(
            {.model = model_of_name(set, pose->model), .T_scene_model = read_xf(file)});
    }
    if (scenes.empty()) return std::nullopt;
    for (const Path& file : files) {
        const std::optional<int> number = scan_number(file.stem().string());
        if (number && is_cloud_file(file)) scenes[*number].scan = file;
    }
    std::map<int, std::size_t> scene_of_number;
    for (auto& [number, scene] : scenes) {
        scene.name = fmt::format("rs{}", number);
        scene.viewpoint = Vec3f::Zero();
        scene.truth_known = !scene.objects.empty();
        scene_of_number[number] = set.scenes.size();
        set.scenes.push_back(std::move(scene));
    }
    for (const Path& file : files) {
        if (name_key(file.filename().string()) == "occlusiontxt") {
            add_occlusion(file, scene_of_number, set);
        }
    }
    add_models(mesh_files(files), set);
    sort_models(set);
    return set;
}

}  // namespace ostraka
