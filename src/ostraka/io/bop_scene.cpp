// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/bop_scene.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/json_reader.hpp"
#include "ostraka/io/rigid_matrix.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

using Json = nlohmann::json;
using Path = std::filesystem::path;

constexpr std::size_t kMostImages = 10'000'000;
constexpr std::size_t kMostObjects = 100'000;  // in an image
constexpr double kNoSkew = 1e-6;

// Calls visit(number, value, place) for each image of a file. The keys' order is that of texts.
template <class Visit>
void for_each_image(std::span<const char> bytes, const Path& path, const Visit& visit) {
    const Json root = parse_json(bytes, path);
    const JsonPlace file{path, "JSON"};
    if (!root.is_object()) file.fail("is not an object of images");
    if (root.size() > kMostImages) file.fail("has too many images");
    for (const auto& [key, value] : root.items()) {
        const JsonPlace place{path, "image " + quote_word(key)};
        const std::optional<int> number = whole_number(key);
        if (!number) place.fail("is not named by a number");
        visit(*number, value, place);
    }
}

BopCamera camera_from(const Json& value, const JsonPlace& place) {
    const std::vector<double> K = json_numbers_of(value, "cam_K", 9, place);
    BopCamera camera{.fx = K[0], .fy = K[4], .cx = K[2], .cy = K[5]};
    const bool simple = std::abs(K[1]) <= kNoSkew * std::abs(K[0]) && K[3] == 0.0 && K[6] == 0.0 &&
                        K[7] == 0.0 && K[8] == 1.0;
    if (!simple || !(K[0] > 0.0) || !(K[4] > 0.0)) {
        place.fail("\"cam_K\" is not fx 0 cx 0 fy cy 0 0 1 with positive fx and fy");
    }
    // Missing in sets of color images alone.
    if (value.contains("depth_scale")) {
        camera.depth_scale = json_number_of(value, "depth_scale", place);
    }
    if (!(camera.depth_scale > 0.0)) place.fail("\"depth_scale\" is not positive");
    return camera;
}

BopObject object_from(const Json& value, const JsonPlace& place) {
    BopObject object{.number = json_integer_of(value, "obj_id", place)};
    if (object.number < 1) place.fail("\"obj_id\" is below 1");
    const RigidMatrix matrix = rigid_from(json_numbers_of(value, "cam_R_m2c", 9, place),
                                          json_numbers_of(value, "cam_t_m2c", 3, place));
    if (!matrix.problem.empty()) place.fail(fmt::format("\"cam_R_m2c\" {}", matrix.problem));
    object.T_camera_model = matrix.pose;
    return object;
}

int count_of(const Json& value, const char* key, const JsonPlace& place) {
    if (!value.contains(key)) return -1;
    const int count = json_integer_of(value, key, place);
    if (count < 0) place.fail(fmt::format("\"{}\" is negative", key));
    return count;
}

PixelBox box_of(const Json& value, const char* key, const JsonPlace& place) {
    if (!value.contains(key)) return {};
    const std::vector<double> numbers = json_numbers_of(value, key, 4, place);
    std::array<int, 4> box;
    for (std::size_t k = 0; k < 4; ++k) box[k] = static_cast<int>(std::lround(numbers[k]));
    return {box[0], box[1], box[2], box[3]};
}

void add_info(const Json& value, const JsonPlace& place, BopObject& object) {
    if (!value.is_object()) place.fail("is not an object");
    if (value.contains("visib_fract")) {
        object.visible_fraction = json_number_of(value, "visib_fract", place);
        if (object.visible_fraction < 0.0 || object.visible_fraction > 1.0) {
            place.fail("\"visib_fract\" is not from 0 to 1");
        }
    }
    object.pixels_all = count_of(value, "px_count_all", place);
    object.pixels_valid = count_of(value, "px_count_valid", place);
    object.pixels_visible = count_of(value, "px_count_visib", place);
    object.box_all = box_of(value, "bbox_obj", place);
    object.box_visible = box_of(value, "bbox_visib", place);
}

}  // namespace

std::map<int, BopCamera> parse_scene_camera(std::span<const char> bytes, const Path& path) {
    std::map<int, BopCamera> cameras;
    for_each_image(bytes, path, [&](int number, const Json& value, const JsonPlace& place) {
        if (!cameras.emplace(number, camera_from(value, place)).second) {
            place.fail("is there twice");
        }
    });
    return cameras;
}

std::map<int, std::vector<BopObject>> parse_scene_gt(std::span<const char> bytes,
                                                     const Path& path) {
    std::map<int, std::vector<BopObject>> images;
    for_each_image(bytes, path, [&](int number, const Json& value, const JsonPlace& place) {
        if (!value.is_array() || value.size() > kMostObjects) {
            place.fail("is not a usable list of objects");
        }
        std::vector<BopObject> objects;
        for (const Json& item : value) {
            objects.push_back(object_from(
                item, {path, fmt::format("{}, object {}", place.part, objects.size())}));
        }
        if (!images.emplace(number, std::move(objects)).second) place.fail("is there twice");
    });
    return images;
}

void parse_scene_gt_info(std::span<const char> bytes, const Path& path,
                         std::map<int, std::vector<BopObject>>& objects) {
    for_each_image(bytes, path, [&](int number, const Json& value, const JsonPlace& place) {
        const auto image = objects.find(number);
        if (image == objects.end()) return;
        if (!value.is_array() || value.size() != image->second.size()) {
            place.fail(fmt::format("is not a list of {} objects, as in scene_gt.json",
                                   image->second.size()));
        }
        for (std::size_t i = 0; i < value.size(); ++i) {
            add_info(value[i], {path, fmt::format("{}, object {}", place.part, i)},
                     image->second[i]);
        }
    });
}

BopScene read_bop_scene(const Path& folder) {
    const auto with_bytes = [&](const char* name, const auto& use) {
        const Path path = folder / name;
        if (!std::filesystem::exists(path)) return false;
        use(read_file(path).span(), path);
        return true;
    };
    BopScene scene;
    const Path camera_path = folder / "scene_camera.json";
    scene.cameras = parse_scene_camera(read_file(camera_path).span(), camera_path);
    scene.truth_known = with_bytes("scene_gt.json", [&](auto bytes, const Path& path) {
        scene.objects = parse_scene_gt(bytes, path);
    });
    with_bytes("scene_gt_info.json", [&](auto bytes, const Path& path) {
        parse_scene_gt_info(bytes, path, scene.objects);
    });
    for (const auto& [number, objects] : scene.objects) {
        if (!scene.cameras.contains(number)) {
            throw FormatError(camera_path, "JSON",
                              fmt::format("has no image \"{}\", but scene_gt.json does", number));
        }
    }
    return scene;
}

std::vector<BopTarget> read_bop_targets(const Path& path) {
    const FileBytes bytes = read_file(path);
    const Json root = parse_json(bytes.span(), path);
    if (!root.is_array()) throw FormatError(path, "JSON", "is not a list of targets");
    std::vector<BopTarget> targets;
    for (const Json& item : root) {
        const JsonPlace place{path, fmt::format("target {}", targets.size())};
        const BopTarget target{.scene = json_integer_of(item, "scene_id", place),
                               .image = json_integer_of(item, "im_id", place),
                               .object = json_integer_of(item, "obj_id", place),
                               .instances = json_integer_of(item, "inst_count", place)};
        if (target.scene < 0 || target.image < 0 || target.object < 1 || target.instances < 0) {
            place.fail("has a number that is too small");
        }
        targets.push_back(target);
    }
    return targets;
}

}  // namespace ostraka
