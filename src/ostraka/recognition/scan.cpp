// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/farthest_points.hpp"
#include "ostraka/cloud/normal_orientation.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/range_smoothing.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/cloud/surface_thickness.hpp"
#include "ostraka/recognition/backdrop.hpp"
#include "ostraka/recognition/surface_roughness.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kMinPoints = 10;
constexpr double kMaxModelsAcross = 500.0;  // a scan wider than so many models has another unit
constexpr double kMinModelsAcross = 0.02;   // as has one narrower than this

// The distance of two points that are about the farthest from each other: never more than the
// diameter, hardly less, and the same however the scan is turned.
double extent_of(const PointCloud& cloud) {
    const std::vector<Vec3f>& points = cloud.points;
    Vec3f a = points[farthest_from(points, centroid(points).cast<float>())];
    double extent = 0.0;
    for (int sweep = 0; sweep < 3; ++sweep) {
        const Vec3f b = points[farthest_from(points, a)];
        extent = std::max(extent, (b - a).cast<double>().norm());
        a = b;
    }
    return extent;
}

void check_size(const PointCloud& valid, std::size_t given, double model_diameter) {
    if (valid.size() < kMinPoints) {
        throw InvalidInput(
            fmt::format("the scan has {} finite points of {}: at least {} are needed", valid.size(),
                        given, kMinPoints));
    }
    const double extent = extent_of(valid);
    if (!(extent > 0.0)) throw InvalidInput("all points of the scan coincide");
    if (extent > kMaxModelsAcross * model_diameter || extent < kMinModelsAcross * model_diameter) {
        throw InvalidInput(
            fmt::format("the scan is {:.4g} across and the largest model {:.4g} (in the library's "
                        "unit): is the "
                        "scan's unit right?",
                        extent, model_diameter));
    }
}

constexpr double kWallExtent = 1.2;      // of the largest model's diameter
constexpr double kSmallestExtent = 0.3;  // of the largest model's diameter: smaller flat surfaces
                                         // could be any model's

void check_density(const PointCloud& cloud, double sampling) {
    if (cloud.size() >= kMinPoints) return;
    throw InvalidInput(
        fmt::format("the scan has {} points at the library's sampling distance {:.4g}: at least {} "
                    "are needed",
                    cloud.size(), sampling, kMinPoints));
}

constexpr double kMergedCell = 1.0;  // sampling distances: side of a cell of a merged scan's field
constexpr double kMergedMargin = 4.0;  // sampling distances that the field reaches beyond the scan

// Planes fitted to curved surface move it: noise is only taken out where it would hide the shape,
// and as little as will do. What is left averages out over a whole object.
constexpr double kSmoothTarget = 0.2;   // deviation left in each point, in sampling distances
constexpr double kSmoothRadius = 1.0;   // of the window, in sampling distances
constexpr double kNormalPitches = 1.8;  // radius of the planes that normals come from, in distances
                                        // of pixels, where these are far apart: the eight around

constexpr double kThicknessRadius = 3.0;    // sampling distances
constexpr double kNormalThicknesses = 4.6;  // radius of the planes that normals of merged scans
                                            // come from, at least

constexpr double kPitchDeviation = 0.17;  // in distances of pixels; fitted to simulated scans

// What becomes of a scan's points.
struct Sorted {
    PointCloud objects;               // what may be objects
    std::vector<float> wall_extents;  // of every point: 0, or that of the wall or table it is on
};

Sorted sort_points(const PointCloud& scan, const Backdrop& backdrop, const FlatPiece* table,
                   double wall_extent) {
    Sorted sorted;
    sorted.objects.viewpoint = scan.viewpoint;
    sorted.wall_extents.assign(scan.size(), 0.0F);
    std::vector<char> below(scan.size(), 0);
    parallel_for(
        scan.size(),
        [&](std::size_t i) {
            const Vec3f& point = scan.points[i];
            const double extent = backdrop.extent_at(point);
            if (extent > wall_extent) sorted.wall_extents[i] = static_cast<float>(extent);
            below[i] = table != nullptr && table->plane.normal.dot(point.cast<double>()) <
                                               table->plane.offset + backdrop.slack;
        },
        1024);
    for (std::size_t i = 0; i < scan.size(); ++i) {
        if (sorted.wall_extents[i] == 0.0F && !below[i]) {
            sorted.objects.points.push_back(scan.points[i]);
        }
    }
    return sorted;
}

RangeSmoothingSettings smoothing_to(double sampling) {
    return {.spacing = sampling, .target = kSmoothTarget, .max_radius = kSmoothRadius};
}

// At the library's density, with normals.
// @param pitch  distance between pixels of the scan.
PointCloud at_density(const PointCloud& points, double sampling, double pitch) {
    PointCloud cloud = resample(smooth_ranges(points, smoothing_to(sampling)), sampling);
    const double radius = std::max(kNormalRadius * sampling, kNormalPitches * pitch);
    cloud.normals = estimate_normals_within(cloud, radius);
    return remove_invalid(cloud);
}

// Of a point at the library's density: points are averaged by smoothing, or if there was none by
// resampling; and far apart, none is in the middle of its cell.
double deviation_left(const RangeNoise& noise, double sampling) {
    double left = remaining_deviation(noise, smoothing_to(sampling));
    const double per_side = noise.pitch > 0.0 ? sampling / noise.pitch : 1.0;
    left = std::min(left, noise.deviation / std::max(1.0, per_side));
    return std::hypot(left, kPitchDeviation * noise.pitch);
}

std::vector<float> extents_at(const PointCloud& cloud, const Backdrop& backdrop) {
    std::vector<float> extents(cloud.size());
    parallel_for(
        cloud.size(),
        [&](std::size_t i) {
            extents[i] = static_cast<float>(backdrop.extent_at(cloud.points[i]));
        },
        1024);
    return extents;
}

std::optional<TablePlane> table_plane(const FlatPiece* table) {
    if (table == nullptr) return std::nullopt;
    return TablePlane{table->plane.normal, table->plane.offset};
}

Scan prepare_merged(const PointCloud& valid, double sampling, double model_diameter,
                    const RecognitionSettings& settings) {
    const double wall_extent = kWallExtent * model_diameter;
    Backdrop backdrop;
    if (settings.remove_plane) {
        backdrop = find_backdrop(valid, {.sampling = sampling,
                                         .least = kSmallestExtent * model_diameter,
                                         .wall = wall_extent,
                                         .merged = true});
    }
    const FlatPiece* table = backdrop.table(wall_extent);
    const PointCloud objects = sort_points(valid, backdrop, table, wall_extent).objects;
    PointCloud cloud = resample(objects, sampling);
    const double thickness = surface_thickness(objects, kThicknessRadius * sampling);
    // The plane of a ball that noise fills has any direction.
    cloud.normals = estimate_normals_within(
        cloud, std::max(kNormalRadius * sampling, kNormalThicknesses * thickness));
    cloud = remove_invalid(cloud);
    if (backdrop.pieces.empty()) check_density(cloud, sampling);
    orient_normals(cloud);
    std::vector<RangeMap> views;
    for (const Vec3f& viewpoint : settings.viewpoints) {
        PointCloud seen = valid;
        seen.viewpoint = viewpoint;
        views.emplace_back(seen, std::span<const float>(), PointCloud(), sampling);
    }
    std::optional<SurfaceField> field;
    if (!cloud.empty()) field.emplace(cloud, kMergedCell * sampling, kMergedMargin * sampling);
    std::vector<float> extents = extents_at(cloud, backdrop);
    const double deviation = cloud.empty() ? 0.0 : surface_roughness(cloud);
    PointBlocks blocks(cloud.points);
    return {.cloud = std::move(cloud),
            .blocks = std::move(blocks),
            .plane_extents = std::move(extents),
            .ranges = RangeMap({}, {}, {}, sampling),
            .merged = std::move(field),
            .views = std::move(views),
            .table = table_plane(table),
            .sampling = sampling,
            .cell = sampling,
            .deviation = deviation,
            .thickness = thickness};
}

}  // namespace

Scan prepare_scan(const PointCloud& raw, double sampling, double model_diameter,
                  const RecognitionSettings& settings) {
    PointCloud points;
    points.points = raw.points;
    points.viewpoint = raw.viewpoint;
    const PointCloud valid = remove_invalid(points);
    check_size(valid, raw.size(), model_diameter);
    if (!settings.viewpoint_known || !settings.viewpoints.empty()) {
        return prepare_merged(valid, sampling, model_diameter, settings);
    }
    const double wall_extent = kWallExtent * model_diameter;
    Backdrop backdrop;
    const RangeNoise noise = measure_range_noise(valid, sampling);
    if (settings.remove_plane) {
        backdrop = find_backdrop(valid, {.sampling = sampling,
                                         .noise = noise,
                                         .least = kSmallestExtent * model_diameter,
                                         .wall = wall_extent});
    }
    const FlatPiece* table = backdrop.table(wall_extent);
    const Sorted sorted = sort_points(valid, backdrop, table, wall_extent);
    PointCloud cloud = at_density(sorted.objects, sampling, noise.pitch);
    if (backdrop.pieces.empty()) check_density(cloud, sampling);
    std::vector<float> extents = extents_at(cloud, backdrop);
    const double cell = std::max(sampling, noise.pitch);
    RangeMap ranges(valid, sorted.wall_extents, cloud, cell);
    PointBlocks blocks(cloud.points);
    Scan scan{.cloud = std::move(cloud),
              .blocks = std::move(blocks),
              .plane_extents = std::move(extents),
              .ranges = std::move(ranges),
              .table = table_plane(table),
              .sampling = sampling,
              .cell = cell};
    scan.deviation = deviation_left(noise, sampling);
    return scan;
}

}  // namespace ostraka
