// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/recognition/canvas.hpp"
#include "ostraka/recognition/label_layout.hpp"
#include "ostraka/recognition/object_layer.hpp"
#include "ostraka/recognition/scan_raster.hpp"

namespace ostraka {
namespace {

constexpr Color kBackground{17, 20, 26};
constexpr Color kDarkScan{30, 33, 40};
constexpr Color kLightScan{232, 234, 238};
constexpr Color kOverlayScan{170, 172, 178};
constexpr Color kPlate{27, 31, 39};
constexpr Color kText{240, 242, 246};
constexpr Color kQuietText{150, 157, 170};
constexpr double kGhost = 0.2;           // opacity of the part that the scan doesn't show
constexpr double kHiddenOutline = 0.55;  // opacity of its outline
constexpr float kScanCost = 0.12F;       // of hiding a pixel of the scan, against one of an object
constexpr float kGhostCost = 0.35F;      // of hiding a part that the scan does not show

// Sizes that grow with the picture.
struct Layout {
    double scale;  // 1 at 1280 pixels
    int header;
    int margin;
    double cap;   // height of capitals in labels
    int padding;  // around a label's text

    explicit Layout(const PictureSettings& settings)
        : scale(std::max(0.6, settings.width / 1280.0)),
          header(settings.header ? static_cast<int>(std::lround(46 * scale)) : 0),
          margin(static_cast<int>(std::lround(12 * scale))),
          cap(13.0 * scale),
          padding(static_cast<int>(std::lround(9 * scale))) {}
};

// The scan's gray or an object's color under the same light.
Color lit(Color color, double shade) {
    const double share = std::clamp(shade, 0.0, 1.0);
    const Color dark = mix(Color{0, 0, 0}, color, 0.22);
    if (share < 0.72) return mix(dark, color, share / 0.72);
    return mix(color, Color{255, 255, 255}, 0.9 * (share - 0.72));
}

Image draw_scan(const ScanRaster& scan, const std::vector<ObjectLayer>& layers,
                const PictureCamera& camera) {
    Image image = blank_image(camera.pinhole.width, camera.pinhole.height, kBackground);
    const auto width = static_cast<std::size_t>(image.width);
    parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t row) {
        for (std::size_t column = 0; column < width; ++column) {
            const std::size_t pixel = row * width + column;
            if (!(scan.coverage[pixel] > 0.0F)) continue;
            const double shade = scan.shade[pixel];
            Color color = mix(kDarkScan, kLightScan, shade);
            for (std::size_t k = layers.size(); k-- > 0;) {
                const auto x = static_cast<int>(column);
                const auto y = static_cast<int>(row);
                if (!layers[k].area.contains(x, y)) continue;
                const double visible = layers[k].visible[layers[k].index(x, y)];
                if (visible > 0.0) color = mix(color, lit(object_color(k), shade), visible);
            }
            image.pixels[pixel] = mix(kBackground, color, scan.coverage[pixel]);
        }
    });
    return image;
}

// Share of each pixel that some object's visible part covers.
std::vector<float> visible_parts(const std::vector<ObjectLayer>& layers, const Image& image) {
    std::vector<float> parts(image.pixels.size(), 0.0F);
    for (const ObjectLayer& layer : layers) {
        for (std::size_t i = 0; i < layer.visible.size(); ++i) {
            float& part = parts[layer.pixel(i, image.width)];
            part = std::max(part, layer.visible[i]);
        }
    }
    return parts;
}

// The faint part of a model, and its outline.
void draw_layer(Image& image, const ObjectLayer& layer, Color color,
                const std::vector<float>& parts) {
    const Color outline = mix(color, Color{255, 255, 255}, 0.25);
    for (int y = layer.area.y; y < layer.area.bottom(); ++y) {
        for (int x = layer.area.x; x < layer.area.right(); ++x) {
            const std::size_t i = layer.index(x, y);
            const double covered = layer.silhouette[i];
            if (!(covered > 0.0)) continue;
            const double part =
                parts[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                      static_cast<std::size_t>(x)];
            blend(image, x, y, color, kGhost * covered * (1.0 - part));
            const double edge = std::clamp(1.6 * (1.0 - std::abs(2.0 * covered - 1.0)), 0.0, 1.0);
            const double own = std::min(1.0, 2.0 * double{layer.visible[i]});
            blend(image, x, y, outline, edge * (kHiddenOutline + (1.0 - kHiddenOutline) * own));
        }
    }
}

// Rounded down: only certainty is 100 %.
std::string percent(double share) {
    return fmt::format("{:.0f}%", std::floor(100.0 * share));
}

struct LabelText {
    std::string name;
    std::string confidence;
    double name_width = 0.0;
    int width = 0;
    int height = 0;
};

LabelText label_text(const RecognizedObject& object, const Layout& layout) {
    LabelText text;
    text.name = shortened(object.model, layout.cap, 260.0 * layout.scale);
    text.confidence = percent(object.confidence);
    text.name_width = text_width(text.name, layout.cap);
    const double width = text.name_width + text_width(text.confidence, layout.cap) +
                         3.2 * layout.padding + layout.cap;
    text.width = static_cast<int>(std::ceil(width));
    text.height = static_cast<int>(std::ceil(layout.cap + 2.2 * layout.padding));
    return text;
}

void draw_label(Image& image, const LabelText& text, const Rectangle& box, Color color,
                const Layout& layout) {
    const double radius = 5.0 * layout.scale;
    const int rim = std::max(1, static_cast<int>(std::lround(1.5 * layout.scale)));
    fill_rounded(image, {box.x - rim, box.y - rim, box.width + 2 * rim, box.height + 2 * rim},
                 radius + rim, color);
    fill_rounded(image, box, radius, kPlate);
    const double top = box.y + 0.5 * (box.height - layout.cap) - 0.5;
    const Vec2d dot(box.x + layout.padding + 0.4 * layout.cap, top + 0.5 * layout.cap);
    draw_line(image, dot, dot, 0.75 * layout.cap, color);
    const double left = box.x + layout.padding + 1.35 * layout.cap;
    draw_text(image, {left, top}, text.name, layout.cap, kText);
    draw_text(image, {left + text.name_width + 0.6 * layout.padding, top}, text.confidence,
              layout.cap, mix(color, Color{255, 255, 255}, 0.2));
}

void draw_leader(Image& image, const Rectangle& box, const Vec2d& anchor, Color color,
                 const Layout& layout) {
    const Vec2d start = leader_start(box, anchor);
    draw_line(image, start, anchor, 4.5 * layout.scale, kPlate, 0.75);
    draw_line(image, anchor, anchor, 10.0 * layout.scale, kPlate, 0.9);
    draw_line(image, start, anchor, 2.0 * layout.scale, mix(color, Color{255, 255, 255}, 0.3));
    draw_line(image, anchor, anchor, 6.0 * layout.scale, Color{255, 255, 255});
}

void draw_labels(Image& image, const Recognition& recognition,
                 const std::vector<ObjectLayer>& layers, const ScanRaster& scan,
                 const Rectangle& area, const Layout& layout) {
    std::vector<float> cost = visible_parts(layers, image);
    for (std::size_t i = 0; i < cost.size(); ++i) {
        cost[i] = std::max(cost[i], kScanCost * scan.coverage[i]);
    }
    for (const ObjectLayer& layer : layers) {
        for (std::size_t i = 0; i < layer.silhouette.size(); ++i) {
            float& pixel = cost[layer.pixel(i, image.width)];
            pixel = std::max(pixel, kGhostCost * layer.silhouette[i]);
        }
    }
    const int margin = layout.margin;
    const Rectangle inside{area.x + margin, area.y + margin, area.width - 2 * margin,
                           area.height - 2 * margin};
    std::vector<LabelText> texts;
    std::vector<LabelRequest> requests;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        texts.push_back(label_text(recognition.objects[k], layout));
        const Vec2d anchor(std::clamp<double>(layers[k].anchor.x(), inside.x, inside.right()),
                           std::clamp<double>(layers[k].anchor.y(), inside.y, inside.bottom()));
        requests.push_back({anchor, texts[k].width, texts[k].height});
    }
    const auto boxes = place_labels(requests, {inside, image.width, std::move(cost)});
    for (std::size_t k = 0; k < boxes.size(); ++k) {
        if (boxes[k]) draw_leader(image, *boxes[k], requests[k].anchor, object_color(k), layout);
    }
    for (std::size_t k = 0; k < boxes.size(); ++k) {
        if (boxes[k]) draw_label(image, texts[k], *boxes[k], object_color(k), layout);
    }
}

// 289541 -> "289,541".
std::string grouped(std::size_t number) {
    if (number < 1000) return fmt::format("{}", number);
    return fmt::format("{},{:03}", grouped(number / 1000), number % 1000);
}

std::string plural(std::size_t count, const std::string& noun) {
    return fmt::format("{} {}{}", grouped(count), noun, count == 1 ? "" : "s");
}

double draw_key(Image& image, double right, double middle, const std::string& text, bool solid,
                const Layout& layout) {
    const double cap = 0.85 * layout.cap;
    const double left = right - text_width(text, cap);
    const int side = static_cast<int>(std::lround(1.3 * cap));
    const Rectangle swatch{static_cast<int>(left) - side - layout.padding,
                           static_cast<int>(std::lround(middle - 0.5 * side)), side, side};
    draw_text(image, {left, middle - 0.5 * cap}, text, cap, kQuietText);
    fill_rounded(image, swatch, 3.0 * layout.scale, kQuietText);
    const Rectangle hollow{swatch.x + 2, swatch.y + 2, side - 4, side - 4};
    if (!solid) fill_rounded(image, hollow, 2.0 * layout.scale, mix(kPlate, kQuietText, 0.25));
    return swatch.x - 2.0 * layout.padding;
}

void draw_header(Image& image, const PointCloud& scene, const ModelLibrary& library,
                 const Recognition& recognition, const Layout& layout) {
    fill(image, {0, 0, image.width, layout.header}, kPlate);
    const double cap = 1.08 * layout.cap;
    const double middle = 0.5 * layout.header - 0.5;
    const std::size_t found = recognition.objects.size();
    const std::string title =
        found == 0 ? "Nothing recognized" : plural(found, "object") + " recognized";
    const auto points = static_cast<std::size_t>(
        std::count_if(scene.points.begin(), scene.points.end(),
                      [](const Vec3f& point) { return point.allFinite(); }));
    const std::string counts = fmt::format("{}, library of {}", plural(points, "scan point"),
                                           plural(library.models.size(), "model"));
    double left = 1.5 * layout.margin;
    draw_text(image, {left, middle - 0.5 * cap}, title, cap, kText);
    left += text_width(title, cap) + 2.0 * layout.margin;
    draw_text(image, {left, middle - 0.425 * layout.cap}, counts, 0.85 * layout.cap, kQuietText);
    left += text_width(counts, 0.85 * layout.cap);
    if (found == 0 || left > image.width - 480.0 * layout.scale) return;
    const double right = image.width - 1.5 * layout.margin;
    const double next = draw_key(image, right, middle, "model only", false, layout);
    draw_key(image, next, middle, "seen in the scan", true, layout);
}

void draw_notice(Image& image, const Rectangle& area, const std::string& text,
                 const Layout& layout) {
    const double cap = 1.5 * layout.cap;
    const double width = text_width(text, cap);
    const int box_width = static_cast<int>(width + 3.0 * cap);
    const int box_height = static_cast<int>(3.0 * cap);
    const Rectangle box{area.x + (area.width - box_width) / 2,
                        area.bottom() - box_height - 2 * layout.margin, box_width, box_height};
    fill_rounded(image, box, 8.0 * layout.scale, kPlate, 0.92);
    draw_text(image, {box.x + 1.5 * cap, box.y + cap - 0.5}, text, cap, kText);
}

std::vector<Vec3f> placed_vertices(const ModelLibrary& library, const Recognition& recognition) {
    std::vector<Vec3f> vertices;
    for (const RecognizedObject& object : recognition.objects) {
        if (object.model_index >= library.models.size()) {
            throw InvalidInput(fmt::format("\"{}\" is not in the library", object.model));
        }
        for (const Vec3f& vertex : library.models[object.model_index].mesh.vertices) {
            vertices.push_back(Vec3d(object.T_scene_model * vertex.cast<double>()).cast<float>());
        }
    }
    return vertices;
}

double agreement_distance(const ModelLibrary& library, const PictureSettings& settings) {
    double sampling = library.settings.sampling;
    if (!(sampling > 0.0) && !library.models.empty()) {
        sampling = 0.01 * library.models.front().shape.diameter;
    }
    return settings.tolerance * sampling;
}

}  // namespace

Image draw_recognition(const PointCloud& scene, const ModelLibrary& library,
                       const Recognition& recognition, const PictureSettings& settings) {
    if (settings.width < 320 || settings.width > 8192) {
        throw InvalidInput("the picture's width must be 320 to 8192 pixels");
    }
    const Layout layout(settings);
    const PictureCamera camera =
        fit_camera(scene, placed_vertices(library, recognition), settings.width, layout.header);
    const ScanRaster scan = rasterize_scan(scene, camera);
    const std::vector<ObjectLayer> layers =
        object_layers(library, recognition, scan, camera, agreement_distance(library, settings));
    Image image = draw_scan(scan, layers, camera);
    const std::vector<float> parts = visible_parts(layers, image);
    for (std::size_t k = layers.size(); k-- > 0;) {
        draw_layer(image, layers[k], object_color(k), parts);
    }
    if (settings.header) draw_header(image, scene, library, recognition, layout);
    if (settings.labels) draw_labels(image, recognition, layers, scan, camera.scan, layout);
    if (recognition.objects.empty() && (settings.header || settings.labels)) {
        const bool measured = std::any_of(scan.depth.begin(), scan.depth.end(),
                                          [](float depth) { return depth > 0.0F; });
        draw_notice(image, camera.scan,
                    measured ? "No object of the library was recognized" : "The scan is empty",
                    layout);
    }
    return image;
}

PointCloud overlay_cloud(const PointCloud& scene, const ModelLibrary& library,
                         const Recognition& recognition) {
    PointCloud overlay;
    overlay.viewpoint = scene.viewpoint;
    for (const Vec3f& point : scene.points) {
        if (point.allFinite()) overlay.points.push_back(point);
    }
    overlay.colors.assign(overlay.points.size(), kOverlayScan);
    for (std::size_t k = 0; k < recognition.objects.size(); ++k) {
        const RecognizedObject& object = recognition.objects[k];
        if (object.model_index >= library.models.size()) {
            throw InvalidInput(fmt::format("\"{}\" is not in the library", object.model));
        }
        for (const Vec3f& point : library.models[object.model_index].surface.points) {
            const Vec3d placed = object.T_scene_model * point.cast<double>();
            overlay.points.push_back(placed.cast<float>());
            overlay.colors.push_back(object_color(k));
        }
    }
    return overlay;
}

}  // namespace ostraka
