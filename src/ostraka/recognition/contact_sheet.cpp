// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/contact_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/recognition/canvas.hpp"
#include "ostraka/recognition/scan_raster.hpp"
#include "ostraka/views/ray_scene.hpp"

namespace ostraka {
namespace {

constexpr Color kBackground{17, 20, 26};
constexpr Color kTile{27, 31, 39};
constexpr Color kModel{214, 218, 226};
constexpr Color kView{72, 176, 240};     // a whole view
constexpr Color kSubpart{245, 158, 11};  // a part of one
constexpr Color kText{240, 242, 246};
constexpr Color kQuietText{150, 157, 170};
constexpr double kFaint = 0.2;           // opacity of the model around an entry
constexpr double kCap = 9.0;             // height of capitals in captions, pixels
constexpr std::size_t kFineModels = 10;  // more are drawn with one ray a pixel, to save time
constexpr int kGap = 8;                  // pixels between tiles
constexpr int kMargin = 20;              // pixels around the sheet
constexpr int kTitle = 34;               // rows above a model's tiles
constexpr int kCaption = 22;             // rows below an entry's tile

// What the rays through a tile's samples hit.
struct TileImage {
    int side = 0;
    PinholeCamera camera;
    Pose T_camera_model = Pose::Identity();
    std::vector<float> depth;  // 0: nothing
    std::vector<float> shade;  // brightness, 0 to 1
};

// A camera at `eye` whose picture just holds the model's ball.
TileImage place_tile(const Model& model, const Vec3d& eye, int side) {
    TileImage tile;
    tile.side = side;
    const double distance = std::max((eye - model.shape.center).norm(), 1.01 * model.shape.radius);
    const double sine = std::min(model.shape.radius / distance, 0.99);
    const double focal = 0.47 * side * std::sqrt(1.0 - sine * sine) / sine;
    const double middle = 0.5 * (side - 1);
    tile.camera = {side, side, focal, focal, middle, middle};
    tile.T_camera_model = look_at(eye, model.shape.center, model.shape.axes.col(2));
    return tile;
}

void cast_tile(TileImage& tile, const RayScene& scene) {
    const auto side = static_cast<std::size_t>(tile.side);
    tile.depth.assign(side * side, 0.0F);
    tile.shade.assign(side * side, 0.0F);
    const Pose T_model_camera = tile.T_camera_model.inverse();
    std::vector<Vec3d> directions(side);
    for (std::size_t row = 0; row < side; ++row) {
        for (std::size_t column = 0; column < side; ++column) {
            const Vec3d ray =
                tile.camera.ray(static_cast<double>(column), static_cast<double>(row));
            directions[column] = T_model_camera.linear() * ray;
        }
        const std::vector<RayHit> hits = scene.cast(T_model_camera.translation(), directions);
        for (std::size_t column = 0; column < side; ++column) {
            if (!hits[column].hit()) continue;
            Vec3d normal = scene.normal(hits[column]);
            if (normal.dot(directions[column]) > 0.0) normal = -normal;
            const std::size_t i = row * side + column;
            tile.depth[i] = static_cast<float>(hits[column].distance);
            tile.shade[i] =
                static_cast<float>(shade_of(Vec3d(tile.T_camera_model.linear() * normal)));
        }
    }
}

// Share of each pixel that an entry's points cover, each a disk as large as its surroundings.
std::vector<float> splat(const TileImage& tile, const PointCloud& cloud, double spacing) {
    const auto side = static_cast<std::size_t>(tile.side);
    std::vector<float> covered(side * side, 0.0F);
    for (const Vec3f& point : cloud.points) {
        const Vec3d seen = tile.T_camera_model * point.cast<double>();
        if (!(seen.z() > 0.0)) continue;
        const Vec2d pixel = tile.camera.project(seen);
        const double radius = std::max(0.6, 0.75 * spacing * tile.camera.fx / seen.z());
        const int reach = static_cast<int>(std::ceil(radius)) + 1;
        const int x0 = static_cast<int>(std::lround(pixel.x()));
        const int y0 = static_cast<int>(std::lround(pixel.y()));
        for (int y = std::max(0, y0 - reach); y <= std::min(tile.side - 1, y0 + reach); ++y) {
            for (int x = std::max(0, x0 - reach); x <= std::min(tile.side - 1, x0 + reach); ++x) {
                const double distance = (pixel - Vec2d(x, y)).norm();
                float& share =
                    covered[static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x)];
                share = std::max(share,
                                 static_cast<float>(std::clamp(radius + 0.5 - distance, 0.0, 1.0)));
            }
        }
    }
    return covered;
}

Color lit(Color color, double shade) {
    const Color dark = mix(Color{0, 0, 0}, color, 0.2);
    if (shade < 0.8) return mix(dark, color, shade / 0.8);
    return mix(color, Color{255, 255, 255}, shade - 0.8);
}

// Averages the samples of each pixel, for smooth edges.
void draw_tile(Image& image, const Rectangle& area, const TileImage& tile,
               const std::vector<float>& covered, Color color) {
    const int fine = tile.side / area.width;
    const double share = 1.0 / (fine * fine);
    for (int y = 0; y < area.height; ++y) {
        for (int x = 0; x < area.width; ++x) {
            double hits = 0.0;
            double shade = 0.0;
            double inside = 0.0;
            for (int k = 0; k < fine * fine; ++k) {
                const std::size_t i = static_cast<std::size_t>(fine * y + k / fine) *
                                          static_cast<std::size_t>(tile.side) +
                                      static_cast<std::size_t>(fine * x + k % fine);
                if (!(tile.depth[i] > 0.0F)) continue;
                hits += 1.0;
                shade += double{tile.shade[i]};
                inside += covered.empty() ? 0.0 : double{covered[i]};
            }
            Color mean = kTile;
            if (hits > 0.0) {
                const Color model =
                    mix(kTile, lit(kModel, shade / hits), covered.empty() ? 1.0 : kFaint);
                const Color whole = mix(model, lit(color, shade / hits), inside / hits);
                mean = mix(kTile, whole, hits * share);
            }
            blend(image, area.x + x, area.y + y, mean);
        }
    }
}

std::string entry_caption(const Entry& entry, const LibrarySettings& settings) {
    if (entry.direction < 0) return fmt::format("view {}", entry.view);
    const auto index = static_cast<std::size_t>(std::max(0, entry.fraction));
    const double fraction =
        index < settings.cuts.fractions.size() ? settings.cuts.fractions[index] : 0.0;
    return fmt::format("view {} cut {} {:.0f}%", entry.view, entry.direction, 100.0 * fraction);
}

// A model's place on the sheet and what is shown of it.
struct Block {
    std::size_t model = 0;
    std::size_t first = 0;  // its entries in the library
    std::size_t count = 0;
    std::vector<std::size_t> shown;  // indices into ModelLibrary::entries
    int top = 0;
    int model_side = 0;  // of the model's tile, pixels
    int height = 0;
};

struct Sheet {
    int width = 0;
    int height = 0;
    int fine = 2;  // samples along a pixel's side
    std::vector<Block> blocks;
};

Sheet plan(const ModelLibrary& library, const ContactSheetSettings& settings) {
    Sheet sheet;
    const int step = settings.tile + kGap;
    const int line = settings.tile + kCaption;
    const int model_side = 2 * settings.tile + kCaption;
    sheet.width = 2 * kMargin + model_side + settings.columns * step;
    int top = kMargin + kTitle;
    for (std::size_t m = 0; m < std::min(library.models.size(), settings.models); ++m) {
        Block block;
        block.model = m;
        while (block.first < library.entries.size() && library.entries[block.first].model != m) {
            ++block.first;
        }
        for (const Entry& entry : library.entries) block.count += entry.model == m ? 1U : 0U;
        const std::size_t shown = std::min(block.count, settings.entries);
        for (std::size_t i = 0; i < shown; ++i) {
            block.shown.push_back(block.first + i * block.count / shown);
        }
        const auto columns = static_cast<std::size_t>(settings.columns);
        const int lines = static_cast<int>((shown + columns - 1) / columns);
        block.top = top;
        block.model_side = model_side;
        block.height = kTitle + std::max(2, lines) * line + kGap;
        top += block.height;
        sheet.blocks.push_back(std::move(block));
    }
    sheet.height = top + kMargin;
    sheet.fine = sheet.blocks.size() > kFineModels ? 1 : 2;
    return sheet;
}

void draw_title(Image& image, const Block& block, const ModelLibrary& library) {
    const Model& model = library.models[block.model];
    std::size_t views = 0;
    for (std::size_t e = block.first; e < block.first + block.count; ++e) {
        views += library.entries[e].direction < 0 ? 1U : 0U;
    }
    const double cap = 1.4 * kCap;
    const std::string name = shortened(model.name, cap, 0.5 * image.width);
    const double top = block.top + 0.5 * kTitle - 0.5 * cap;
    draw_text(image, {double(kMargin), top}, name, cap, kText);
    std::string counts =
        fmt::format("{} entries: {} views, {} subparts", block.count, views, block.count - views);
    if (model.counts.views > 0) {
        counts += fmt::format(" (of {} views and {} cuts), coverage {:.0f}%", model.counts.views,
                              model.counts.cuts, 100.0 * model.counts.coverage);
    }
    const double left = kMargin + text_width(name, cap) + 2.0 * cap;
    draw_text(image, {left, top + cap - kCap}, counts, kCap, kQuietText);
}

// The direction from a model's center to a camera that shows three of its sides.
Vec3d three_quarter(const MeshShape& shape) {
    return shape.axes * Vec3d(0.45, -0.75, 0.5).normalized();
}

void draw_block(Image& image, const Block& block, const ModelLibrary& library,
                const ContactSheetSettings& settings, int fine) {
    const Model& model = library.models[block.model];
    const RayScene scene({model.mesh});
    const int first_row = block.top + kTitle;
    const Rectangle model_area{kMargin, first_row, block.model_side, block.model_side};
    const Vec3d eye = model.shape.center + 3.0 * model.shape.diameter * three_quarter(model.shape);
    const auto columns = static_cast<std::size_t>(settings.columns);
    // The model's own tile is item 0, entry i is item i + 1: all write their own pixels.
    parallel_for(block.shown.size() + 1, [&](std::size_t item) {
        if (item == 0) {
            TileImage tile = place_tile(model, eye, fine * model_area.width);
            cast_tile(tile, scene);
            draw_tile(image, model_area, tile, {}, kModel);
            return;
        }
        const std::size_t i = item - 1;
        const Entry& entry = library.entries[block.shown[i]];
        const Rectangle area{kMargin + block.model_side + kGap +
                                 static_cast<int>(i % columns) * (settings.tile + kGap),
                             first_row + static_cast<int>(i / columns) * (settings.tile + kCaption),
                             settings.tile, settings.tile};
        TileImage tile = place_tile(model, entry.cloud.viewpoint.cast<double>(), fine * area.width);
        cast_tile(tile, scene);
        draw_tile(image, area, tile, splat(tile, entry.cloud, library.settings.sampling),
                  entry.direction < 0 ? kView : kSubpart);
        const std::string caption = entry_caption(entry, library.settings);
        draw_text(image, {double(area.x), area.bottom() + 5.0},
                  shortened(caption, kCap, area.width), kCap, kQuietText);
    });
    const std::size_t more = block.count - block.shown.size();
    if (more == 0) return;
    const std::string text = fmt::format("+{} more", more);
    const double right = image.width - kMargin - kGap - text_width(text, kCap);
    draw_text(image, {right, block.top + 0.5 * kTitle}, text, kCap, kQuietText);
}

void draw_heading(Image& image, const ModelLibrary& library, const Sheet& sheet) {
    const std::string title =
        fmt::format("{} models, {} entries", library.models.size(), library.entries.size());
    const double cap = 1.6 * kCap;
    draw_text(image, {double(kMargin), double(kMargin)}, title, cap, kText);
    double left = kMargin + text_width(title, cap) + 3.0 * cap;
    const auto key = [&](Color color, const std::string& text) {
        fill_rounded(image, {static_cast<int>(left), kMargin + 2, 12, 12}, 3.0, color);
        draw_text(image, {left + 20.0, kMargin + 3.5}, text, kCap, kQuietText);
        left += 20.0 + text_width(text, kCap) + 2.0 * cap;
    };
    key(kView, "whole view");
    key(kSubpart, "subpart");
    const std::size_t more = library.models.size() - sheet.blocks.size();
    if (more == 0) return;
    draw_text(image, {left, kMargin + 3.5}, fmt::format("+{} more models", more), kCap, kText);
}

}  // namespace

Image draw_contact_sheet(const ModelLibrary& library, const ContactSheetSettings& settings) {
    if (settings.tile < 48 || settings.tile > 512 || settings.columns < 1 ||
        settings.columns > 32) {
        throw InvalidInput("a contact sheet has tiles of 48 to 512 pixels in 1 to 32 columns");
    }
    const Sheet sheet = plan(library, settings);
    Image image = blank_image(sheet.width, sheet.height, kBackground);
    draw_heading(image, library, sheet);
    for (const Block& block : sheet.blocks) {
        draw_title(image, block, library);
        draw_block(image, block, library, settings, sheet.fine);
    }
    return image;
}

}  // namespace ostraka
