// SPDX-License-Identifier: Apache-2.0
// What `ostraka simulate` writes: scene_NUMBER.json beside a cloud or a depth image. Other names
// are fine, too.
#include <fmt/format.h>

#include <algorithm>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/data_set_readers.hpp"
#include "ostraka/io/folder_files.hpp"
#include "ostraka/io/json_reader.hpp"
#include "ostraka/io/rigid_matrix.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

using Json = nlohmann::json;
using Path = std::filesystem::path;

constexpr std::size_t kMostObjects = 1'000'000;

bool is_scan(const Path& path) {
    return is_cloud_file(path) || lower_extension(path) == ".png";
}

// As `ostraka simulate` names them, or of the same name as a scan.
bool may_be_truth(const Path& path, const std::vector<Path>& files) {
    if (lower_extension(path) != ".json") return false;
    return std::any_of(files.begin(), files.end(), [&](const Path& file) {
        return is_scan(file) && file.stem() == path.stem();
    });
}

bool has_simulated_name(const Path& path) {
    const std::string stem = path.stem().string();
    return lower_extension(path) == ".json" && stem.starts_with("scene_") &&
           whole_number(std::string_view(stem).substr(6));
}

RecordedObject object_from(const Json& item, const JsonPlace& place, DataSet& set) {
    const RigidMatrix matrix = rigid_from(json_numbers_of(item, "T_scene_model", 16, place));
    if (!matrix.problem.empty()) {
        place.fail(fmt::format("\"T_scene_model\" {}", matrix.problem));
    }
    const std::string name = json_text_or_empty(item, "model", place);
    if (name.empty()) place.fail("has no \"model\"");
    RecordedObject object{.model = model_of_name(set, name), .T_scene_model = matrix.pose};
    if (item.contains("visible_fraction")) {
        object.visible_fraction = json_number_of(item, "visible_fraction", place);
        if (object.visible_fraction < 0.0 || object.visible_fraction > 1.0) {
            place.fail("\"visible_fraction\" is not from 0 to 1");
        }
    }
    return object;
}

// The unit is the same in all files.
void take_unit(const Json& root, bool first, const JsonPlace& place, DataSet& set) {
    const std::string name = json_text_or_empty(root, "unit", place);
    const std::optional<Unit> unit = parse_unit(name);
    if (!name.empty() && !unit) place.fail("\"unit\" is not mm, cm, m or in");
    if (!first && unit != set.unit) place.fail("\"unit\" is another one than in the files before");
    set.unit = unit;
}

// camera.json of the folder, its lengths in the set's unit.
DepthCamera camera_of(const Path& folder, const DataSet& set) {
    DepthCamera camera = read_camera_json(folder / "camera.json");
    if (camera.unit && set.unit) {
        camera.depth_scale *= unit_factor(*camera.unit, *set.unit);
        camera.unit = set.unit;
    }
    return camera;
}

RecordedScene scene_from(const Path& path, const Json& root, DataSet& set) {
    const JsonPlace place{path, "scene"};
    take_unit(root, set.scenes.empty(), place, set);
    RecordedScene scene{.name = path.stem().string(), .viewpoint = Vec3f::Zero()};
    // Only beside the truth: a file from elsewhere must not point to anywhere on this disk.
    const Path scan =
        path.parent_path() / Path(json_text_or_empty(root, "scene", place)).filename();
    std::error_code ignored;
    if (std::filesystem::is_regular_file(scan, ignored)) scene.scan = scan;
    if (lower_extension(scan) == ".png") scene.depth = camera_of(path.parent_path(), set);
    const Json& items = json_list_or_empty(root, "objects", kMostObjects, place);
    if (!root.contains("objects")) place.fail("has no \"objects\"");
    for (std::size_t i = 0; i < items.size(); ++i) {
        scene.objects.push_back(object_from(items[i], {path, fmt::format("object {}", i)}, set));
    }
    return scene;
}

// A model named as a mesh beside the scans or in models/ is taken to be that one.
void find_model_files(const Path& folder, DataSet& set) {
    std::vector<Path> places = {folder};
    if (std::filesystem::is_directory(folder / "models")) places.push_back(folder / "models");
    for (const Path& place : places) {
        for (const Path& file : list_files(place, 0)) {
            if (!is_mesh_file(file)) continue;
            for (RecordedModel& model : set.models) {
                if (file.stem() == model.name) model.file = file;
            }
        }
    }
}

}  // namespace

std::optional<DataSet> open_ostraka(const Path& folder) {
    DataSet set{.kind = DataSetKind::ostraka};
    const std::vector<Path> files = list_files(folder, 0);
    for (const Path& file : files) {
        const bool simulated = has_simulated_name(file);
        if (!simulated && !may_be_truth(file, files)) continue;
        const Json root = read_json_object(file);
        // JSON beside a scan may also say something else.
        if (!simulated && !(root.contains("scene") && root.contains("objects"))) continue;
        set.scenes.push_back(scene_from(file, root, set));
    }
    if (set.scenes.empty()) return std::nullopt;
    sort_models(set);
    find_model_files(folder, set);
    return set;
}

}  // namespace ostraka
