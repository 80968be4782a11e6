// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/bop_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/depth_camera.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/io/models_info.hpp"
#include "ostraka/io/png_file.hpp"

namespace ostraka {
namespace {

using Path = std::filesystem::path;

constexpr double kMostSteps = 65535.0;

void make_folder(const Path& path) {
    std::error_code problem;
    std::filesystem::create_directories(path, problem);
    if (problem) throw FileError(path, "can't be made: " + problem.message());
}

std::size_t pixels_of(const PinholeCamera& camera) {
    if (camera.width < 1 || camera.height < 1) {
        throw InvalidInput("BOP image: the camera has no pixels");
    }
    return static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
}

void check_image(const BopImage& image, int models) {
    const std::size_t pixels = pixels_of(image.camera);
    const auto fail = [](const std::string& problem) {
        throw InvalidInput("BOP image: " + problem);
    };
    if (image.depth.size() != pixels) {
        fail(fmt::format("{} depths for {} pixels", image.depth.size(), pixels));
    }
    if (!image.masks.empty() && image.masks.size() != image.objects.size()) {
        fail(fmt::format("masks of {} objects for {}", image.masks.size(), image.objects.size()));
    }
    for (const BopMasks& masks : image.masks) {
        for (const auto* mask : {&masks.all, &masks.visible}) {
            if (!mask->empty() && mask->size() != pixels) fail("a mask of another size");
        }
    }
    for (const BopObject& object : image.objects) {
        if (object.number < 1 || object.number > models) {
            fail(fmt::format("there is no model {}", object.number));
        }
        if (!object.T_camera_model.matrix().allFinite() ||
            !std::isfinite(object.visible_fraction)) {
            fail("an object has a number that is not finite");
        }
    }
}

std::vector<std::uint16_t> depth_steps(const BopImage& image, double depth_scale) {
    std::vector<std::uint16_t> steps(image.depth.size(), 0);
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (std::isnan(image.depth[i])) continue;
        const double step = std::round(image.depth[i] / depth_scale);
        if (!(step >= 0.0 && step <= kMostSteps)) {
            throw InvalidInput(fmt::format(
                "BOP image: a depth of {} mm doesn't fit in 16 bits with a depth scale of {}",
                image.depth[i], depth_scale));
        }
        steps[i] = static_cast<std::uint16_t>(step);
    }
    return steps;
}

void write_mask(const Path& path, const PinholeCamera& camera,
                const std::vector<std::uint8_t>& mask) {
    if (mask.empty()) return;
    std::vector<std::uint8_t> values(mask.size());
    std::transform(mask.begin(), mask.end(), values.begin(),
                   [](std::uint8_t inside) { return inside != 0 ? 255 : 0; });
    write_plain_file(path, encode_gray_png8(camera.width, camera.height, values));
}

PixelBox box_of(const std::vector<std::uint8_t>& mask, const PinholeCamera& camera) {
    int left = camera.width;
    int right = -1;
    int top = -1;
    int bottom = -1;
    for (int row = 0; row < camera.height; ++row) {
        const std::uint8_t* pixels = mask.data() + static_cast<std::ptrdiff_t>(row) * camera.width;
        // Most rows are empty; this loop, unlike a search, runs on vectors.
        unsigned any = 0;
        for (int column = 0; column < camera.width; ++column) any |= pixels[column];
        if (any == 0) continue;
        for (int column = 0; column < left; ++column) {
            if (pixels[column] != 0) left = column;
        }
        for (int column = camera.width - 1; column > right; --column) {
            if (pixels[column] != 0) right = column;
        }
        top = top < 0 ? row : top;
        bottom = row;
    }
    return right < 0 ? PixelBox{} : PixelBox{left, top, right - left, bottom - top};
}

int count(const std::vector<std::uint8_t>& mask) {
    return static_cast<int>(mask.size()) -
           static_cast<int>(std::count(mask.begin(), mask.end(), 0));
}

void write_models(const Path& root, std::span<const BopModel> models, Unit unit) {
    std::vector<ModelInfo> infos;
    for (const BopModel& model : models) {
        infos.push_back(model_info(static_cast<int>(infos.size()) + 1, model.name, model.mesh,
                                   model.symmetry, unit));
    }
    const double mm = unit_factor(unit, Unit::millimeter);
    for (const char* folder : {"models", "models_eval"}) {
        make_folder(root / folder);
        for (std::size_t i = 0; i < models.size(); ++i) {
            write_mesh(root / folder / fmt::format("obj_{:06}.ply", i + 1),
                       scaled(models[i].mesh, mm));
        }
        write_models_info(root / folder / "models_info.json", infos);
    }
}

}  // namespace

void measure_masks(BopImage& image) {
    check_image(image, std::numeric_limits<int>::max());
    for (std::size_t i = 0; i < image.objects.size(); ++i) {
        if (image.masks.empty() || image.masks[i].all.empty() || image.masks[i].visible.empty()) {
            throw InvalidInput(fmt::format("BOP image: object {} has no masks", i));
        }
        const BopMasks& masks = image.masks[i];
        BopObject& object = image.objects[i];
        object.pixels_all = count(masks.all);
        object.pixels_visible = count(masks.visible);
        object.pixels_valid = 0;
        for (std::size_t pixel = 0; pixel < masks.all.size(); ++pixel) {
            object.pixels_valid += static_cast<int>(masks.all[pixel] != 0) &
                                   static_cast<int>(image.depth[pixel] > 0.0F);
        }
        object.visible_fraction =
            object.pixels_all == 0
                ? 0.0
                : std::min(1.0, static_cast<double>(object.pixels_visible) / object.pixels_all);
        // As in the toolkit, what is not seen has no boxes at all.
        const bool seen = object.pixels_visible > 0;
        object.box_all = seen ? box_of(masks.all, image.camera) : PixelBox{};
        object.box_visible = box_of(masks.visible, image.camera);
    }
}

BopWriter::BopWriter(const Path& root, std::span<const BopModel> models, Unit unit,
                     const BopWriterSettings& settings)
    : root_(root), settings_(settings), models_(static_cast<int>(models.size())) {
    const bool plain = !settings.split.empty() && Path(settings.split).filename() == settings.split;
    if (models.empty() || settings.images_per_scene < 1 || !(settings.depth_scale > 0.0) ||
        !plain) {
        throw InvalidInput(
            "BOP writer: needs a model, an image or more a scene, a positive depth scale and the "
            "name of a folder for the split");
    }
    make_folder(root);
    if (!std::filesystem::is_empty(root)) {
        throw FileError(root, "is not empty; a data set is written to a new folder");
    }
    write_models(root, models, unit);
}

Path BopWriter::scene_folder(int scene) const {
    return root_ / settings_.split / fmt::format("{:06}", scene);
}

void BopWriter::write_files(int scene, int number, const BopImage& image) const {
    const Path folder = scene_folder(scene);
    const PinholeCamera& camera = image.camera;
    write_plain_file(
        folder / "depth" / fmt::format("{:06}.png", number),
        encode_depth_png16(camera.width, camera.height, depth_steps(image, settings_.depth_scale)));
    for (std::size_t i = 0; i < image.masks.size(); ++i) {
        const std::string name = fmt::format("{:06}_{:06}.png", number, i);
        write_mask(folder / "mask" / name, camera, image.masks[i].all);
        write_mask(folder / "mask_visib" / name, camera, image.masks[i].visible);
    }
}

void BopWriter::write(std::size_t index, const BopImage& image) {
    check_image(image, models_);
    const auto per_scene = static_cast<std::size_t>(settings_.images_per_scene);
    const int scene = static_cast<int>(index / per_scene) + 1;
    const int number = static_cast<int>(index % per_scene);
    for (const char* folder : {"depth", "mask", "mask_visib"}) {
        make_folder(scene_folder(scene) / folder);
    }
    write_files(scene, number, image);
    const std::scoped_lock lock(mutex_);
    record(index, scene, number, image);
}

void BopWriter::record(std::size_t index, int scene, int number, const BopImage& image) {
    const PinholeCamera& camera = image.camera;
    BopScene& images = scenes_[scene];
    const bool is_new = images.objects.emplace(number, image.objects).second;
    if (!is_new || complete_.contains(scene)) {
        throw InvalidInput(fmt::format("BOP writer: image {} was written before", index));
    }
    images.cameras[number] = {camera.fx, camera.fy, camera.cx, camera.cy, settings_.depth_scale};
    add_targets(scene, number, image.objects);
    if (index < first_index_) {
        first_index_ = index;
        first_camera_ = camera;
    }
    if (images.objects.size() == static_cast<std::size_t>(settings_.images_per_scene)) {
        write_bop_scene(scene_folder(scene), images);
        complete_.insert(scene);
        scenes_.erase(scene);
    }
}

void BopWriter::add_targets(int scene, int number, const std::vector<BopObject>& objects) {
    std::map<int, int> instances;
    for (const BopObject& object : objects) {
        const bool stated = object.visible_fraction >= 0.0;
        if (!stated || object.visible_fraction >= settings_.min_target_visible) {
            ++instances[object.number];
        }
    }
    for (const auto& [object, count] : instances) {
        targets_.push_back({scene, number, object, count});
    }
}

void BopWriter::finish() {
    const std::scoped_lock lock(mutex_);
    if (scenes_.empty() && complete_.empty()) throw InvalidInput("BOP writer: there is no image");
    for (const auto& [scene, images] : scenes_) write_bop_scene(scene_folder(scene), images);
    write_camera_json(root_ / "camera.json",
                      {.camera = first_camera_, .depth_scale = settings_.depth_scale, .unit = {}});
    std::sort(targets_.begin(), targets_.end(), [](const BopTarget& a, const BopTarget& b) {
        return std::tie(a.scene, a.image, a.object) < std::tie(b.scene, b.image, b.object);
    });
    write_bop_targets(root_ / "test_targets_bop19.json", targets_);
}

}  // namespace ostraka
