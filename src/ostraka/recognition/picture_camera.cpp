// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/picture_camera.hpp"

#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr double kGrowth = 0.12;     // of the scan's side, at each end, for objects
constexpr double kMargin = 0.025;    // of the scan's larger side, on each side
constexpr double kOutliers = 0.001;  // share of points at each end that needn't be in the picture
constexpr double kWidest = 2.5;      // tangent of the angle from the axis beyond which we step back

std::vector<Vec3d> finite_points(const PointCloud& scene) {
    std::vector<Vec3d> points;
    points.reserve(scene.size());
    for (const Vec3f& point : scene.points) {
        if (point.allFinite()) points.push_back(point.cast<double>());
    }
    return points;
}

// Sum of the steps from each pixel to the next one in its row; zero for an unorganized cloud.
Vec3d row_direction(const PointCloud& scene) {
    Vec3d sum = Vec3d::Zero();
    if (!scene.organized()) return sum;
    for (std::size_t i = 1; i < scene.size(); ++i) {
        if (i % static_cast<std::size_t>(scene.width) == 0) continue;
        const Vec3f from = scene.points[i - 1] - scene.viewpoint;
        const Vec3f to = scene.points[i] - scene.viewpoint;
        if (!from.allFinite() || !to.allFinite()) continue;
        sum += Vec3f(to.normalized() - from.normalized()).cast<double>();
    }
    return sum;
}

Vec3d up_direction(const PointCloud& scene, const Vec3d& forward) {
    const Vec3d row = row_direction(scene);
    const Vec3d right = row - row.dot(forward) * forward;
    if (right.norm() > 1e-9) return right.cross(forward);
    if (std::abs(forward.z()) < std::sqrt(0.5)) return Vec3d::UnitZ();
    return forward.z() > 0.0 ? Vec3d(-Vec3d::UnitY()) : Vec3d(Vec3d::UnitY());
}

struct Extent {
    double low = 0.0;
    double high = 0.0;
    double size() const { return high - low; }
    double middle() const { return 0.5 * (low + high); }
    // Grows to hold a value, but not beyond a limit.
    void hold(double value, const Extent& limit) {
        low = std::min(low, std::max(value, limit.low));
        high = std::max(high, std::min(value, limit.high));
    }
};

Extent grown(const Extent& extent) {
    return {extent.low - kGrowth * extent.size(), extent.high + kGrowth * extent.size()};
}

Extent extent_of(std::vector<double> values) {
    const auto skipped =
        static_cast<std::ptrdiff_t>(kOutliers * static_cast<double>(values.size()));
    std::nth_element(values.begin(), values.begin() + skipped, values.end());
    const double low = values[static_cast<std::size_t>(skipped)];
    std::nth_element(values.begin(), values.end() - 1 - skipped, values.end());
    return {low, *(values.end() - 1 - skipped)};
}

Pose place_camera(const PointCloud& scene, const std::vector<Vec3d>& points) {
    const Vec3d eye = scene.viewpoint.cast<double>();
    Vec3d middle = Vec3d::Zero();
    Vec3d direction = Vec3d::Zero();
    for (const Vec3d& point : points) {
        middle += point / static_cast<double>(points.size());
        direction += (point - eye).normalized() / static_cast<double>(points.size());
    }
    if (!(direction.norm() > 1e-6) || !direction.allFinite()) direction = Vec3d::UnitZ();
    const Vec3d forward = direction.normalized();
    std::size_t sideways = 0;
    double radius = 0.0;
    for (const Vec3d& point : points) {
        const double depth = (point - eye).dot(forward);
        if (!((point - eye).norm() < kWidest * depth)) ++sideways;
        radius = std::max(radius, (point - middle).norm());
    }
    const bool step_back = sideways * 50 > points.size();
    const Vec3d from = step_back ? Vec3d(middle - 2.5 * std::max(radius, 1e-6) * forward) : eye;
    return look_at(from, from + forward, up_direction(scene, forward));
}

}  // namespace

PictureCamera fit_camera(const PointCloud& scene, std::span<const Vec3f> objects, int width,
                         int top) {
    PictureCamera camera;
    const std::vector<Vec3d> points = finite_points(scene);
    std::vector<double> columns;
    std::vector<double> rows;
    if (!points.empty()) camera.T_camera_scene = place_camera(scene, points);
    for (const Vec3d& point : points) {
        const Vec3d seen = camera.T_camera_scene * point;
        if (!(seen.z() > 0.0)) continue;
        columns.push_back(seen.x() / seen.z());
        rows.push_back(seen.y() / seen.z());
    }
    const bool empty = columns.empty();
    Extent across = empty ? Extent{-1.0, 1.0} : extent_of(std::move(columns));
    Extent down = empty ? Extent{-0.5, 0.5} : extent_of(std::move(rows));
    const Extent most_across = grown(across);
    const Extent most_down = grown(down);
    for (const Vec3f& point : objects) {
        const Vec3d seen = camera.T_camera_scene * point.cast<double>();
        if (!(seen.z() > 0.0)) continue;
        across.hold(seen.x() / seen.z(), most_across);
        down.hold(seen.y() / seen.z(), most_down);
    }
    const double margin = kMargin * std::max({across.size(), down.size(), 1e-6});
    const double wide = across.size() + 2.0 * margin;
    const double high = down.size() + 2.0 * margin;
    const int height = static_cast<int>(std::lround(width * std::clamp(high / wide, 0.45, 0.72)));
    const double focal = std::min(width / wide, height / high);
    camera.pinhole = {.width = width,
                      .height = top + height,
                      .fx = focal,
                      .fy = focal,
                      .cx = 0.5 * (width - 1) - focal * across.middle(),
                      .cy = top + 0.5 * (height - 1) - focal * down.middle()};
    camera.scan = {0, top, width, height};
    return camera;
}

}  // namespace ostraka
