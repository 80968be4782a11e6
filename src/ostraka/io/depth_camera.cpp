// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/depth_camera.hpp"

#include <fmt/format.h>

#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/json_reader.hpp"

namespace ostraka {
namespace {

constexpr int kMostPixels = 1'000'000;

double positive(const nlohmann::json& root, const char* key, const JsonPlace& place) {
    const double value = json_number_of(root, key, place);
    if (!(value > 0.0)) place.fail(fmt::format("\"{}\" is not positive", key));
    return value;
}

int pixels(const nlohmann::json& root, const char* key, const JsonPlace& place) {
    const int value = json_integer_of(root, key, place);
    if (value < 1 || value > kMostPixels) place.fail(fmt::format("\"{}\" is out of range", key));
    return value;
}

// NaN is not positive.
bool usable(const DepthCamera& depth) {
    return depth.camera.fx > 0.0 && depth.camera.fy > 0.0 && depth.depth_scale > 0.0;
}

}  // namespace

DepthCamera read_camera_json(const std::filesystem::path& path) {
    const nlohmann::json root = read_json_object(path);
    const JsonPlace place{path, "camera"};
    DepthCamera result;
    result.camera = {.width = pixels(root, "width", place),
                     .height = pixels(root, "height", place),
                     .fx = positive(root, "fx", place),
                     .fy = positive(root, "fy", place),
                     .cx = json_number_of(root, "cx", place),
                     .cy = json_number_of(root, "cy", place)};
    if (root.contains("depth_scale")) result.depth_scale = positive(root, "depth_scale", place);
    if (const std::string unit = json_text_or_empty(root, "unit", place); !unit.empty()) {
        result.unit = parse_unit(unit);
        if (!result.unit) place.fail("\"unit\" is not mm, cm, m or in");
    }
    return result;
}

void write_camera_json(const std::filesystem::path& path, const DepthCamera& camera) {
    const PinholeCamera& pinhole = camera.camera;
    if (!usable(camera) || pinhole.width < 1 || pinhole.height < 1) {
        throw InvalidInput("camera.json: a size, focal length or scale is not positive");
    }
    nlohmann::ordered_json root = {{"width", pinhole.width},
                                   {"height", pinhole.height},
                                   {"fx", pinhole.fx},
                                   {"fy", pinhole.fy},
                                   {"cx", pinhole.cx},
                                   {"cy", pinhole.cy},
                                   {"depth_scale", camera.depth_scale}};
    if (camera.unit) root["unit"] = unit_name(*camera.unit);
    write_file_atomically(path, root.dump(2) + "\n");
}

PointCloud depth_cloud(const DepthImage16& image, const DepthCamera& camera) {
    const PinholeCamera& pinhole = camera.camera;
    if (!usable(camera)) {
        throw InvalidInput("depth_cloud: a focal length or the depth scale is not positive");
    }
    if (pinhole.width != 0 && (pinhole.width != image.width || pinhole.height != image.height)) {
        throw InvalidInput(fmt::format("depth image of {} x {} pixels of a camera of {} x {}",
                                       image.width, image.height, pinhole.width, pinhole.height));
    }
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    PointCloud cloud;
    cloud.width = image.width;
    cloud.height = image.height;
    cloud.points.assign(image.values.size(), Vec3f(kNone, kNone, kNone));
    std::size_t pixel = 0;
    for (int row = 0; row < image.height; ++row) {
        for (int column = 0; column < image.width; ++column, ++pixel) {
            if (image.values[pixel] == 0) continue;
            const double depth = camera.depth_scale * image.values[pixel];
            cloud.points[pixel] = (depth * pinhole.ray(column, row)).cast<float>();
        }
    }
    return cloud;
}

}  // namespace ostraka
