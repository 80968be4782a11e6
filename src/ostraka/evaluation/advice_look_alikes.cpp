// SPDX-License-Identifier: Apache-2.0
// Which part looks like which other, and from where.
#include <algorithm>
#include <limits>

#include "ostraka/base/parallel.hpp"
#include "ostraka/evaluation/advice_steps.hpp"
#include "ostraka/library/retrieval.hpp"
#include "ostraka/recognition/canvas.hpp"
#include "ostraka/recognition/scan_raster.hpp"
#include "ostraka/views/model_views.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kMinPoints = 10;  // of a piece that can be described: as in protocol S
constexpr int kTile = 240;              // side of a part's picture, pixels
constexpr int kFine = 2;                // rays along a pixel's side
constexpr double kCap = 10.0;           // height of capitals, pixels
constexpr Color kGround{27, 31, 39};
constexpr Color kText{240, 242, 246};

// One part from one side.
struct Look {
    double margin = std::numeric_limits<double>::infinity();
    std::uint32_t other_entry = kNoIndex;  // nearest of another part
    Pose T_camera_frame = Pose::Identity();
    bool seen = false;  // enough was measured to describe it
};

ViewSettings around(const Model& model, const AdviceSettings& settings, double distance) {
    ViewSettings views;
    views.count = settings.viewpoints;
    views.distance = std::max(distance, 1.5 * model.shape.radius) / model.shape.diameter;
    return views;
}

// A part of the sensor's image that holds a ball in its middle.
PinholeCamera cropped(PinholeCamera camera, double radius, double distance) {
    const double sine = radius / distance;
    const double half = std::ceil(camera.fx * sine / std::sqrt(1.0 - sine * sine)) + 2.0;
    camera.width = camera.height = static_cast<int>(2.0 * half) + 1;
    camera.cx = camera.cy = half;
    return camera;
}

Look look_at_part(const EntryIndex& index, const RayScene& scene, const AdviceSettings& settings,
                  double distance, std::uint32_t part, int viewpoint) {
    const ModelLibrary& library = index.library();
    const Model& model = library.models[part];
    const ViewSettings views = around(model, settings, distance);
    SensorModel sensor = settings.sensor.model;
    sensor.ranging.seed = settings.seed + (static_cast<std::uint64_t>(viewpoint) << 32U) + part;
    const PinholeCamera camera =
        cropped(settings.sensor.camera, model.shape.radius, views.distance * model.shape.diameter);
    const RenderedView seen =
        render(scene, camera, view_camera(model.shape, views, viewpoint), sensor);
    Look look;
    const PreparedSegment segment = prepare_segment(remove_invalid(seen.cloud), library.settings);
    if (segment.piece.size() < kMinPoints) return look;
    look.seen = true;
    look.T_camera_frame = principal_frame(segment.piece).T_cloud_frame;
    const std::vector<float> distances = index.fused_distances(segment.piece);
    float own = std::numeric_limits<float>::max();
    float other = own;
    for (std::uint32_t e = 0; e < distances.size(); ++e) {
        float& least = library.entries[e].model == part ? own : other;
        if (distances[e] >= least) continue;
        least = distances[e];
        if (library.entries[e].model != part) look.other_entry = e;
    }
    if (look.other_entry != kNoIndex) {
        look.margin = double{other} / std::max(double{own}, 1e-9);
    }
    return look;
}

// A shaded part whose ball of `radius` fills the tile. @param R_camera_model  how it is turned.
void draw_part(Image& image, int left, const Model& model, const Mat3d& R_camera_model,
               double radius, Color color) {
    const double distance = 6.0 * radius;
    const int side = kFine * kTile;
    const double focal = 0.46 * side * distance / radius;
    const double middle = 0.5 * (side - 1);
    Pose T_camera_model = Pose::Identity();
    T_camera_model.linear() = R_camera_model;
    T_camera_model.translation() = Vec3d(0.0, 0.0, distance) - R_camera_model * model.shape.center;
    const RenderedView view =
        render(RayScene({model.mesh}), {side, side, focal, focal, middle, middle}, T_camera_model);
    const Color dark = mix({0, 0, 0}, color, 0.2);
    for (int y = 0; y < kTile; ++y) {
        for (int x = 0; x < kTile; ++x) {
            double hits = 0.0;
            double shade = 0.0;
            for (int k = 0; k < kFine * kFine; ++k) {
                const int pixel = (kFine * y + k / kFine) * side + kFine * x + k % kFine;
                const Vec3f& normal = view.normals[static_cast<std::size_t>(pixel)];
                if (!normal.allFinite()) continue;
                hits += 1.0;
                shade += shade_of(normal.cast<double>());
            }
            if (hits == 0.0) continue;
            blend(image, left + x, y, mix(dark, color, shade / hits), hits / (kFine * kFine));
        }
    }
    draw_text(image, {left + 10.0, kTile - 10.0 - kCap}, shortened(model.name, kCap, kTile - 20.0),
              kCap, kText);
}

Image draw_pair(const ModelLibrary& library, const AdviceSettings& settings, double distance,
                std::uint32_t part, int viewpoint, const Look& look) {
    const Model& model = library.models[part];
    const Entry& entry = library.entries[look.other_entry];
    const Model& other = library.models[entry.model];
    const Pose T_camera_model =
        view_camera(model.shape, around(model, settings, distance), viewpoint);
    // As its entry lies on the piece when their frames are laid onto each other.
    const Pose T_camera_other = look.T_camera_frame * entry.frame.T_cloud_frame.inverse();
    const double radius = std::max(model.shape.radius, other.shape.radius);
    Image image = blank_image(2 * kTile + 4, kTile, kGround);
    draw_part(image, 0, model, T_camera_model.linear(), radius, object_color(0));
    draw_part(image, kTile + 4, other, T_camera_other.linear(), radius, object_color(1));
    return image;
}

}  // namespace

std::vector<LookAlike> look_alikes(const ModelLibrary& library, const AdviceSettings& settings,
                                   double distance, const Progress& progress) {
    const EntryIndex index(library);
    const auto count = static_cast<std::size_t>(settings.viewpoints);
    std::vector<LookAlike> result;
    for (std::uint32_t part = 0; part < library.models.size(); ++part) {
        const RayScene scene({library.models[part].mesh});
        std::vector<Look> looks(count);
        parallel_for(count, [&](std::size_t v) {
            looks[v] = look_at_part(index, scene, settings, distance, part, static_cast<int>(v));
        });
        LookAlike alike{.part = part};
        std::size_t closest = 0;
        for (std::size_t v = 0; v < count; ++v) {
            alike.viewpoints += looks[v].seen ? 1U : 0U;
            alike.confused += looks[v].margin < 1.0 ? 1U : 0U;
            if (looks[v].margin < looks[closest].margin) closest = v;
        }
        if (looks[closest].other_entry != kNoIndex) {
            alike.other = library.entries[looks[closest].other_entry].model;
            alike.viewpoint = static_cast<int>(closest);
            alike.margin = looks[closest].margin;
            if (settings.pictures) {
                alike.picture =
                    draw_pair(library, settings, distance, part, alike.viewpoint, looks[closest]);
            }
        }
        result.push_back(std::move(alike));
        report(progress, "look-alikes", part + 1, library.models.size());
    }
    return result;
}

}  // namespace ostraka
