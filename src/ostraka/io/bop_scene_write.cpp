// SPDX-License-Identifier: Apache-2.0
// Writes the files of a BOP scene. As text, a line an image, as BOP's toolkit writes them; all
// values are numbers, so nothing needs escapes.
#include <fmt/format.h>

#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/bop_scene.hpp"

namespace ostraka {
namespace {

std::string camera_text(const BopCamera& camera) {
    return fmt::format(
        R"({{"cam_K": [{}, 0.0, {}, 0.0, {}, {}, 0.0, 0.0, 1.0], "depth_scale": {}}})", camera.fx,
        camera.cx, camera.fy, camera.cy, camera.depth_scale);
}

std::string pose_text(const BopObject& object) {
    const Pose& T = object.T_camera_model;
    return fmt::format(
        R"({{"cam_R_m2c": [{}, {}, {}, {}, {}, {}, {}, {}, {}], "cam_t_m2c": [{}, {}, {}], )"
        R"("obj_id": {}}})",
        T(0, 0), T(0, 1), T(0, 2), T(1, 0), T(1, 1), T(1, 2), T(2, 0), T(2, 1), T(2, 2), T(0, 3),
        T(1, 3), T(2, 3), object.number);
}

std::string box_text(const char* key, const PixelBox& box) {
    return fmt::format("\"{}\": [{}, {}, {}, {}]", key, box.x, box.y, box.width, box.height);
}

// What isn't stated has no key; boxes always have one, as -1 means "none" there.
std::string info_text(const BopObject& object) {
    std::string text = fmt::format("{{{}, {}", box_text("bbox_obj", object.box_all),
                                   box_text("bbox_visib", object.box_visible));
    const auto add_count = [&](const char* key, int count) {
        if (count >= 0) text += fmt::format(", \"{}\": {}", key, count);
    };
    add_count("px_count_all", object.pixels_all);
    add_count("px_count_valid", object.pixels_valid);
    add_count("px_count_visib", object.pixels_visible);
    if (object.visible_fraction >= 0.0) {
        text += fmt::format(", \"visib_fract\": {}", object.visible_fraction);
    }
    return text + "}";
}

template <class Items, class Text>
std::string joined(const Items& items, const char* separator, const Text& text) {
    std::string all;
    for (const auto& item : items) {
        if (!all.empty()) all += separator;
        all += text(item);
    }
    return all;
}

void write_images(const std::filesystem::path& path, const auto& images, const auto& text) {
    const auto line = [&](const auto& image) {
        return fmt::format("  \"{}\": {}", image.first, text(image.second));
    };
    write_file_atomically(path, fmt::format("{{\n{}\n}}\n", joined(images, ",\n", line)));
}

void check_finite(const BopScene& scene) {
    for (const auto& [number, camera] : scene.cameras) {
        if (!std::isfinite(camera.fx + camera.fy + camera.cx + camera.cy + camera.depth_scale)) {
            throw InvalidInput(fmt::format("BOP scene: camera of image {} is not finite", number));
        }
    }
    for (const auto& [number, objects] : scene.objects) {
        for (const BopObject& object : objects) {
            if (object.T_camera_model.matrix().allFinite() &&
                std::isfinite(object.visible_fraction)) {
                continue;
            }
            throw InvalidInput(fmt::format(
                "BOP scene: an object of image {} has a number that is not finite", number));
        }
    }
}

}  // namespace

void write_bop_scene(const std::filesystem::path& folder, const BopScene& scene) {
    check_finite(scene);
    const auto objects_text = [](const auto& object_text) {
        return [&object_text](const std::vector<BopObject>& objects) {
            return fmt::format("[{}]", joined(objects, ", ", object_text));
        };
    };
    write_images(folder / "scene_gt_info.json", scene.objects, objects_text(info_text));
    write_images(folder / "scene_gt.json", scene.objects, objects_text(pose_text));
    write_images(folder / "scene_camera.json", scene.cameras, camera_text);
}

void write_bop_targets(const std::filesystem::path& path, std::span<const BopTarget> targets) {
    const auto line = [](const BopTarget& target) {
        return fmt::format(R"(  {{"im_id": {}, "inst_count": {}, "obj_id": {}, "scene_id": {}}})",
                           target.image, target.instances, target.object, target.scene);
    };
    write_file_atomically(path, fmt::format("[\n{}\n]\n", joined(targets, ",\n", line)));
}

}  // namespace ostraka
