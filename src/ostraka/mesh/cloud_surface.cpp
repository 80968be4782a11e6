// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/cloud_surface.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/normal_orientation.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/mesh/repair.hpp"
#include "ostraka/mesh/surface_nets.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kFewPoints = 50;
constexpr std::size_t kNeighbors = 8;  // that tell the spacing

void check_settings(const CloudSurfaceSettings& settings) {
    const auto between = [](double value, double low, double high) {
        return value >= low && value <= high;
    };
    if (!between(settings.voxel, 0.5, 2.0) || !between(settings.smoothing, 1.0, 2.0) ||
        !between(settings.open_edge, 0.3, 1.5) || settings.most_across < 10) {
        throw InvalidInput("cloud surface: a setting is out of range");
    }
}

void require_enough(std::size_t points) {
    if (points >= kFewPoints) return;
    throw InvalidInput(
        fmt::format("{} usable points are no surface: at least {} are needed", points, kFewPoints));
}

// Finite points, each once. Normals stay if all of them are directions.
PointCloud usable_points(const PointCloud& cloud) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (cloud.points[i].allFinite()) order.push_back(i);
    }
    const auto place = [&](std::uint32_t i) {
        const Vec3f& p = cloud.points[i];
        return std::array{p.x(), p.y(), p.z()};
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const auto of_a = place(a);
        const auto of_b = place(b);
        return of_a != of_b ? of_a < of_b : a < b;
    });
    order.erase(std::unique(order.begin(), order.end(),
                            [&](std::uint32_t a, std::uint32_t b) { return place(a) == place(b); }),
                order.end());
    PointCloud usable = select(cloud, order);
    usable.colors.clear();
    for (Vec3f& normal : usable.normals) {
        const float length = normal.norm();
        if (!(length > 0.0F) || !std::isfinite(length)) {
            usable.normals.clear();
            break;
        }
        normal /= length;
    }
    return usable;
}

// The longest side of the box that holds the middle 98 % along each axis: no stray point counts.
double extent_without_strays(const PointCloud& cloud) {
    double extent = 0.0;
    std::vector<float> values(cloud.size());
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < cloud.size(); ++i) values[i] = cloud.points[i][axis];
        const auto skip = static_cast<std::ptrdiff_t>(cloud.size() / 100);
        std::nth_element(values.begin(), values.begin() + skip, values.end());
        const double low = double{values[static_cast<std::size_t>(skip)]};
        std::nth_element(values.begin(), values.end() - 1 - skip, values.end());
        extent = std::max(extent, double{*(values.end() - 1 - skip)} - low);
    }
    return extent;
}

// Distance between points around each: the k nearest fill a disk of k spacings squared.
std::vector<float> local_spacings(const PointCloud& cloud) {
    const KdTree tree(cloud.points);
    std::vector<float> spacings(cloud.size());
    parallel_for(
        cloud.size(),
        [&](std::size_t i) {
            thread_local std::vector<Neighbor> near;
            tree.nearest(cloud.points[i], kNeighbors + 1, near);
            // Fewer are found where a distance overflows.
            const float squared = near.size() == kNeighbors + 1
                                      ? near.back().squared_distance
                                      : std::numeric_limits<float>::infinity();
            spacings[i] =
                std::sqrt(squared * static_cast<float>(kPi) / static_cast<float>(kNeighbors));
        },
        256);
    return spacings;
}

double median(std::vector<float> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return double{*middle};
}

// Deviation of points from the planes of those around them, in the median.
double thickness(const PointCloud& cloud) {
    constexpr std::size_t kAround = 12;
    constexpr std::size_t kSamples = 2000;
    const KdTree tree(cloud.points);
    const std::size_t step = std::max<std::size_t>(1, cloud.size() / kSamples);
    std::vector<float> deviations(cloud.size() / step);
    parallel_for(
        deviations.size(),
        [&](std::size_t s) {
            thread_local std::vector<Neighbor> near;
            tree.nearest(cloud.points[s * step], kAround, near);
            Vec3d mean = Vec3d::Zero();
            for (const Neighbor& n : near) mean += cloud.points[n.index].cast<double>();
            mean /= static_cast<double>(near.size());
            Mat3d covariance = Mat3d::Zero();
            for (const Neighbor& n : near) {
                const Vec3d off = cloud.points[n.index].cast<double>() - mean;
                covariance += off * off.transpose() / static_cast<double>(near.size());
            }
            const Eigen::SelfAdjointEigenSolver<Mat3d> solver(covariance, Eigen::EigenvaluesOnly);
            deviations[s] =
                static_cast<float>(std::sqrt(std::max(0.0, double{solver.eigenvalues()[0]})));
        },
        32);
    return median(std::move(deviations));
}

struct SpacedCloud {
    PointCloud cloud;
    std::vector<float> local;  // spacing around each point
    double spacing = 0.0;      // median of these
};

void require_spacing(double spacing) {
    if (spacing > 0.0) return;
    throw InvalidInput("most points coincide");
}

// At a density that the grid can hold and that noise doesn't blur.
SpacedCloud spaced(PointCloud cloud, const CloudSurfaceSettings& settings) {
    constexpr double kMostNoise = 0.42;  // in spacings: of noise of 0.7 spacings; never above 0.5
    constexpr double kCoarser = 1.5;
    constexpr int kAttempts = 3;  // a thin part must survive
    const double least = extent_without_strays(cloud) / settings.most_across;
    const auto enough = static_cast<std::size_t>(10 * settings.most_across) *
                        static_cast<std::size_t>(settings.most_across);
    if (cloud.size() > enough) cloud = resample(cloud, least);
    SpacedCloud result{std::move(cloud), {}, 0.0};
    for (int attempt = 0;; ++attempt) {
        require_enough(result.cloud.size());
        result.local = local_spacings(result.cloud);
        result.spacing = median(result.local);
        require_spacing(result.spacing);
        const double noise = thickness(result.cloud);
        const bool dense = result.spacing < 0.9 * least;
        const bool noisy = noise > kMostNoise * result.spacing;
        if (attempt == kAttempts || !(dense || noisy)) return result;
        result.cloud =
            resample(result.cloud, std::max(least, noisy ? kCoarser * result.spacing : 0.0));
    }
}

// Points far from all others, which are no surface.
void drop_strays(SpacedCloud& spaced) {
    constexpr double kStray = 5.0;  // spacings
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < spaced.local.size(); ++i) {
        if (double{spaced.local[i]} <= kStray * spaced.spacing) kept.push_back(i);
    }
    std::vector<float> local;
    for (const std::uint32_t i : kept) local.push_back(spaced.local[i]);
    spaced.cloud = select(spaced.cloud, kept);
    spaced.local = std::move(local);
    require_enough(spaced.cloud.size());
}

void require_volume(const SpacedCloud& spaced) {
    const Vec3d mean = centroid(spaced.cloud.points);
    Mat3d covariance = Mat3d::Zero();
    for (const Vec3f& point : spaced.cloud.points) {
        const Vec3d off = point.cast<double>() - mean;
        covariance += off * off.transpose() / static_cast<double>(spaced.cloud.size());
    }
    const Eigen::SelfAdjointEigenSolver<Mat3d> solver(covariance, Eigen::EigenvaluesOnly);
    const double deviation = std::sqrt(std::max(0.0, double{solver.eigenvalues()[0]}));
    if (deviation > 0.6 * spaced.spacing) return;
    throw InvalidInput(
        fmt::format("all points lie in one plane or on a line (to {:.4g}, at a spacing of {:.4g}): "
                    "a model needs a body",
                    deviation, spaced.spacing));
}

// Given normals stay unless many of them are on the wrong side, as those of a file may be whose
// sensor positions were unknown.
void settle_normals(PointCloud& cloud) {
    constexpr double kMostWrong = 0.1;
    const std::vector<Vec3f> given = cloud.normals;
    const OrientationResult result = orient_normals(cloud);
    const auto count = static_cast<double>(cloud.size());
    if (!given.empty() && static_cast<double>(result.turned) < kMostWrong * count) {
        cloud.normals = given;
    }
}

std::vector<Splat> splats_of(const SpacedCloud& spaced, const Vec3d& low, double cell,
                             double smoothing) {
    std::vector<Splat> splats;
    splats.reserve(spaced.cloud.size());
    for (std::size_t i = 0; i < spaced.cloud.size(); ++i) {
        if (!spaced.cloud.normals[i].allFinite()) continue;
        const double local = std::max(double{spaced.local[i]}, spaced.spacing);
        const double radius =
            std::min(smoothing * local / cell, static_cast<double>(kLongReach / kReach));
        const Vec3d place = (spaced.cloud.points[i].cast<double>() - low) / cell;
        splats.push_back(
            {place.cast<float>(), spaced.cloud.normals[i], static_cast<float>(radius)});
    }
    return splats;
}

// Without pieces of a few points' area.
void drop_crumbs(TriangleMesh& mesh) {
    constexpr double kCrumb = 30.0;  // cells squared
    std::vector<std::uint32_t> piece(mesh.vertices.size());
    std::iota(piece.begin(), piece.end(), 0U);
    const auto root = [&](std::uint32_t v) {
        while (piece[v] != v) v = piece[v] = piece[piece[v]];
        return v;
    };
    for (const Triangle& t : mesh.triangles) {
        for (const std::uint32_t v : {t[1], t[2]}) {
            const std::uint32_t a = root(t[0]);
            const std::uint32_t b = root(v);
            piece[std::max(a, b)] = std::min(a, b);
        }
    }
    std::vector<double> area(mesh.vertices.size(), 0.0);
    for (const Triangle& t : mesh.triangles) area[root(t[0])] += 0.5 * area_vector(mesh, t).norm();
    std::erase_if(mesh.triangles, [&](const Triangle& t) { return area[root(t[0])] < kCrumb; });
}

}  // namespace

CloudSurface rebuild_surface(const PointCloud& cloud, const CloudSurfaceSettings& settings) {
    check(cloud);
    check_settings(settings);
    PointCloud usable = usable_points(cloud);
    require_enough(usable.size());
    SpacedCloud points = spaced(std::move(usable), settings);
    drop_strays(points);
    require_volume(points);
    settle_normals(points.cloud);
    Vec3d low = points.cloud.points.front().cast<double>();
    for (const Vec3f& point : points.cloud.points) low = low.cwiseMin(point.cast<double>());
    const double cell = settings.voxel * points.spacing;
    const std::vector<Splat> splats = splats_of(points, low, cell, settings.smoothing);
    CloudSurface surface{surface_nets(splats, settings.open_edge), points.spacing, splats.size()};
    drop_crumbs(surface.mesh);
    if (surface.mesh.triangles.empty()) throw InvalidInput("the points are no surface");
    for (Vec3f& vertex : surface.mesh.vertices) {
        vertex = (low + cell * vertex.cast<double>()).cast<float>();
    }
    surface.mesh = repair(surface.mesh).mesh;
    return surface;
}

}  // namespace ostraka
