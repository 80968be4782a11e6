// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/verdict_picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/recognition/canvas.hpp"
#include "ostraka/recognition/picture_camera.hpp"
#include "ostraka/recognition/scan_raster.hpp"

namespace ostraka {
namespace {

constexpr Color kBackground{17, 20, 26};
constexpr Color kDarkScan{30, 33, 40};
constexpr Color kLightScan{232, 234, 238};
constexpr Color kOutline{255, 255, 255};
constexpr double kAround = 1.5;   // of the model's extent that a picture shows
constexpr double kTint = 0.72;    // of a verdict's color in what is measured,
constexpr double kUnseen = 0.55;  // and where nothing is

struct Box {
    Vec2d low = Vec2d::Constant(std::numeric_limits<double>::max());
    Vec2d high = Vec2d::Constant(std::numeric_limits<double>::lowest());
};

// What the placed model covers of the plane at distance 1 from the camera.
Box extent_of(const Model& model, const Pose& T_camera_model) {
    Box box;
    for (const Vec3f& vertex : model.mesh.vertices) {
        const Vec3d at = T_camera_model * vertex.cast<double>();
        if (!(at.z() > 0.0)) continue;
        box.low = box.low.cwiseMin(at.head<2>() / at.z());
        box.high = box.high.cwiseMax(at.head<2>() / at.z());
    }
    if (!(box.low.x() <= box.high.x())) return {Vec2d::Constant(-0.5), Vec2d::Constant(0.5)};
    return box;
}

PictureCamera zoomed(const Pose& T_camera_scene, const Box& box,
                     const VerdictPictureSettings& settings) {
    const Vec2d size = (kAround * (box.high - box.low)).cwiseMax(1e-6);
    const Vec2d middle = 0.5 * (box.low + box.high);
    const double focal = std::min(settings.width / size.x(), settings.height / size.y());
    PictureCamera camera;
    camera.T_camera_scene = T_camera_scene;
    camera.pinhole = {.width = settings.width,
                      .height = settings.height,
                      .fx = focal,
                      .fy = focal,
                      .cx = 0.5 * (settings.width - 1) - focal * middle.x(),
                      .cy = 0.5 * (settings.height - 1) - focal * middle.y()};
    camera.scan = {0, 0, settings.width, settings.height};
    return camera;
}

// The scan where the picture or its surroundings show it; no return elsewhere.
PointCloud cropped(const PointCloud& scene, const PictureCamera& camera) {
    PointCloud part;
    part.points = scene.points;
    part.width = scene.width;
    part.height = scene.height;
    part.viewpoint = scene.viewpoint;
    const PinholeCamera& lens = camera.pinhole;
    parallel_for(part.points.size(), [&](std::size_t i) {
        const Vec3d at = camera.T_camera_scene * scene.points[i].cast<double>();
        const double x = lens.fx * at.x() / at.z() + lens.cx;
        const double y = lens.fy * at.y() / at.z() + lens.cy;
        const bool inside = at.z() > 0.0 && x > -0.25 * lens.width && x < 1.25 * lens.width &&
                            y > -0.25 * lens.height && y < 1.25 * lens.height;
        if (!inside) part.points[i].setConstant(std::numeric_limits<float>::quiet_NaN());
    });
    return part;
}

// The verdict in each pixel.
std::vector<CellVerdict> pixel_verdicts(const Scan& scan, const CellVerdicts& cells,
                                        const PictureCamera& camera, double depth) {
    std::vector<CellVerdict> of_cell(scan.ranges.size(), CellVerdict::outside);
    for (std::size_t i = 0; i < cells.cells.size(); ++i) {
        of_cell[cells.cells[i]] = cells.verdicts[i];
    }
    const PinholeCamera& lens = camera.pinhole;
    const Pose T_scene_camera = camera.T_camera_scene.inverse();
    const auto width = static_cast<std::size_t>(lens.width);
    std::vector<CellVerdict> verdicts(width * static_cast<std::size_t>(lens.height));
    parallel_for(static_cast<std::size_t>(lens.height), [&](std::size_t row) {
        for (std::size_t column = 0; column < width; ++column) {
            const Vec3d ray((static_cast<double>(column) - lens.cx) / lens.fx,
                            (static_cast<double>(row) - lens.cy) / lens.fy, 1.0);
            const Vec3d at = T_scene_camera * Vec3d(depth * ray);
            const std::uint32_t cell = scan.ranges.cell_of(at.cast<float>());
            verdicts[row * width + column] =
                cell == kNoIndex ? CellVerdict::outside : of_cell[cell];
        }
    });
    return verdicts;
}

Image draw_gray(const ScanRaster& raster, int width, int height) {
    Image image = blank_image(width, height, kBackground);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const Color gray = mix(kDarkScan, kLightScan, raster.shade[i]);
        image.pixels[i] = mix(kBackground, gray, raster.coverage[i]);
    }
    return image;
}

// The color in the scan's light.
Color lit(Color color, double shade) {
    return mix(mix(Color{0, 0, 0}, color, 0.4), color, std::min(1.0, 1.3 * shade));
}

Image draw_tinted(const Image& gray, const ScanRaster& raster,
                  const std::vector<CellVerdict>& verdicts) {
    Image image = gray;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        if (verdicts[i] == CellVerdict::outside) continue;
        const Color color = verdict_color(verdicts[i]);
        const Color seen = mix(gray.pixels[i], lit(color, raster.shade[i]), kTint);
        const Color unseen = mix(gray.pixels[i], color, kUnseen);
        image.pixels[i] = mix(unseen, seen, raster.coverage[i]);
    }
    return image;
}

void draw_outline(Image& image, const std::vector<CellVerdict>& verdicts) {
    const auto inside = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= image.width || y >= image.height) return false;
        return verdicts[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                        static_cast<std::size_t>(x)] != CellVerdict::outside;
    };
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (!inside(x, y)) continue;
            const bool border =
                !inside(x - 1, y) || !inside(x + 1, y) || !inside(x, y - 1) || !inside(x, y + 1);
            if (border) blend(image, x, y, kOutline, 0.8);
        }
    }
}

VerdictPicture draw_one(const PointCloud& scene, const ModelLibrary& library, const Scan& scan,
                        const Explanation& one, const Pose& T_camera_scene,
                        const VerdictPictureSettings& settings) {
    if (one.object.model_index >= library.models.size()) {
        throw InvalidInput("\"" + one.object.model + "\" is not in the library");
    }
    const Model& model = library.models[one.object.model_index];
    const Pose T_camera_model = T_camera_scene * one.object.T_scene_model;
    const PictureCamera camera = zoomed(T_camera_scene, extent_of(model, T_camera_model), settings);
    const ScanRaster raster = rasterize_scan(cropped(scene, camera), camera);
    VerdictPicture picture;
    picture.scan = draw_gray(raster, settings.width, settings.height);
    const double depth = Vec3d(T_camera_model * model.shape.center).z();
    const std::vector<CellVerdict> verdicts = pixel_verdicts(scan, one.cells, camera, depth);
    picture.verdicts = draw_tinted(picture.scan, raster, verdicts);
    draw_outline(picture.verdicts, verdicts);
    return picture;
}

}  // namespace

Color verdict_color(CellVerdict verdict) {
    switch (verdict) {
        case CellVerdict::support:
            return {0, 178, 122};
        case CellVerdict::hidden:
            return {128, 134, 148};
        case CellVerdict::violation:
            return {222, 52, 40};
        case CellVerdict::backdrop:
            return {240, 146, 20};
        case CellVerdict::missing:
            return {52, 122, 226};
        case CellVerdict::unsure:
        case CellVerdict::taken:
            return {242, 222, 70};
        case CellVerdict::outside:
            break;
    }
    return kBackground;
}

std::vector<VerdictPicture> draw_verdicts(const PointCloud& scene, const ModelLibrary& library,
                                          const Scan& scan,
                                          std::span<const Explanation> explanations,
                                          const VerdictPictureSettings& settings) {
    if (settings.width < 1 || settings.height < 1) {
        throw InvalidInput("a picture's width and height must be positive");
    }
    const Pose T_camera_scene = fit_camera(scene, {}, settings.width, 0).T_camera_scene;
    std::vector<VerdictPicture> pictures;
    for (const Explanation& one : explanations) {
        pictures.push_back(draw_one(scene, library, scan, one, T_camera_scene, settings));
    }
    return pictures;
}

}  // namespace ostraka
