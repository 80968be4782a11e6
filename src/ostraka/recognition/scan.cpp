// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/farthest_points.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/range_smoothing.hpp"
#include "ostraka/cloud/resample.hpp"

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

// A plane of the scan is a table if it reaches farther than a model could.
bool is_table(const PointCloud& cloud, const Plane& plane, double model_diameter) {
    return extent_of(select(cloud, plane.inliers)) > 1.2 * model_diameter;
}

}  // namespace

Scan prepare_scan(const PointCloud& raw, double sampling, double model_diameter,
                  const RecognitionSettings& settings) {
    PointCloud points = raw;
    points.normals.clear();  // worked out anew at the library's density, as for its views
    const PointCloud valid = remove_invalid(points);
    check_size(valid, raw.size(), model_diameter);
    PointCloud cloud = resample(smooth_ranges(valid, {.spacing = sampling}), sampling);
    cloud.colors.clear();
    cloud.normals = estimate_normals_within(cloud, kNormalRadius * sampling);
    cloud = remove_invalid(cloud);
    if (cloud.size() < kMinPoints) {
        throw InvalidInput(
            fmt::format("the scan has {} points at the library's sampling distance "
                        "{:.4g}: at least {} are needed",
                        cloud.size(), sampling, kMinPoints));
    }
    RangeMap ranges(valid, cloud, sampling);
    std::optional<Plane> table;
    if (settings.remove_plane) {
        const auto least =
            static_cast<std::size_t>(settings.plane_share * static_cast<double>(cloud.size()));
        table = find_plane(cloud, least, {.tolerance = sampling, .seed = settings.seed});
        if (table && !is_table(cloud, *table, model_diameter)) table.reset();
    }
    std::vector<std::uint32_t> foreground;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        const bool on_table =
            table && table->normal.dot(cloud.points[i].cast<double>()) < table->offset + sampling;
        if (!on_table) foreground.push_back(i);
    }
    Scan scan{.cloud = std::move(cloud),
              .tree = KdTree({}),
              .ranges = std::move(ranges),
              .table = std::move(table),
              .foreground = std::move(foreground),
              .sampling = sampling};
    scan.tree = KdTree(scan.cloud.points);
    return scan;
}

}  // namespace ostraka
