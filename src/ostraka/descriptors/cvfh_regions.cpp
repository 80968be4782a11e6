// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/cvfh_regions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/vector_clones.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/plane_fits.hpp"

namespace ostraka {
namespace {

constexpr double kDefaultRadius = 3.0;  // mesh resolutions
constexpr float kHalfTurn = 3.14159265F;

// The settings with their derived lengths filled in; a radius of 0 where points have no extent.
CvfhRegionSettings completed(std::span<const Vec3f> points, CvfhRegionSettings settings) {
    if (!(settings.normal_radius >= 0.0F) || !(settings.tolerance >= 0.0F) ||
        !(settings.normal_radius <= kLargestCoordinate) ||
        !(settings.tolerance <= kLargestCoordinate)) {
        throw InvalidInput("cvfh: radius and tolerance must not be negative");
    }
    if (settings.normal_radius == 0.0F) {
        const double derived = kDefaultRadius * mesh_resolution(points);
        settings.normal_radius = static_cast<float>(std::min(derived, double{kLargestCoordinate}));
    }
    if (settings.tolerance == 0.0F) settings.tolerance = settings.normal_radius;
    return settings;
}

// Points that wait for a region, as columns in the order of the cells. A taken point's normal is
// NaN, so that nothing is like it.
struct Waiting {
    std::vector<float> nx, ny, nz;
    std::vector<std::int32_t> joins;  // of the run that was looked at last: 1 where a point joins

    Waiting(std::span<const Vec3f> normals, const CellOrder& cells) {
        const std::size_t padded = normals.size() + kVectorLanes;
        for (auto* column : {&nx, &ny, &nz}) column->assign(padded, kTaken);
        joins.resize(padded);
        for (std::size_t k = 0; k < normals.size(); ++k) {
            const Vec3f& normal = normals[cells.order()[k]];
            nx[k] = normal.x();
            ny[k] = normal.y();
            nz[k] = normal.z();
        }
    }
    static constexpr float kTaken = std::numeric_limits<float>::quiet_NaN();
};

struct JoinRule {
    float squared_tolerance;
    float min_cosine;
};

struct Query {
    float x, y, z, nx, ny, nz;
};

// Marks those of the waiting points at [first, end) that are close to the query and face the same
// way. @return whether there are any.
OSTRAKA_VECTOR_CLONES
bool find_joins(const OrderedPoints& points, Waiting& waiting, std::size_t first, std::size_t end,
                const Query& query, const JoinRule& rule) {
    Int8 any{};
    for (std::size_t k = first; k < end; k += kVectorLanes) {
        Float8 x;
        Float8 y;
        Float8 z;
        Float8 nx;
        Float8 ny;
        Float8 nz;
        load8(points.x.data() + k, x);
        load8(points.y.data() + k, y);
        load8(points.z.data() + k, z);
        load8(waiting.nx.data() + k, nx);
        load8(waiting.ny.data() + k, ny);
        load8(waiting.nz.data() + k, nz);
        x -= query.x;
        y -= query.y;
        z -= query.z;
        const Int8 near = x * x + y * y + z * z < rule.squared_tolerance;
        const Int8 alike = query.nx * nx + query.ny * ny + query.nz * nz > rule.min_cosine;
        const Int8 both = near & alike;
        any |= both;
        std::memcpy(waiting.joins.data() + k, &both, sizeof(both));
    }
    std::int32_t found = 0;
    for (std::size_t lane = 0; lane < kVectorLanes; ++lane) found |= any[lane];
    return found != 0;
}

// The positions of all points that one of them joins, each looked at once.
void grow_from(std::uint32_t seed, const OrderedPoints& points, const JoinRule& rule, float reach,
               Waiting& waiting, std::vector<Query>& queries,
               std::vector<std::uint32_t>& positions) {
    queries.clear();
    positions.clear();
    const auto take = [&](std::uint32_t k) {
        queries.push_back(
            {points.x[k], points.y[k], points.z[k], waiting.nx[k], waiting.ny[k], waiting.nz[k]});
        positions.push_back(k);
        waiting.nx[k] = Waiting::kTaken;
    };
    take(seed);
    for (std::size_t head = 0; head < queries.size(); ++head) {
        const Query query = queries[head];
        const Vec3f center(query.x, query.y, query.z);
        points.cells.for_runs(center, reach, [&](std::size_t first, std::size_t end) {
            if (!find_joins(points, waiting, first, end, query, rule)) return;
            for (std::size_t k = first; k < end; ++k) {
                if (waiting.joins[k] != 0) take(static_cast<std::uint32_t>(k));
            }
        });
    }
}

// Groups of at least min_points, as ascending indices into the points.
std::vector<std::vector<std::uint32_t>> grow(const OrderedPoints& points,
                                             std::span<const Vec3f> normals,
                                             const CvfhRegionSettings& settings) {
    const JoinRule rule{settings.tolerance * settings.tolerance,
                        std::cos(std::min(settings.max_angle, kHalfTurn))};
    Waiting waiting(normals, points.cells);
    std::vector<Query> queries;
    std::vector<std::uint32_t> positions;
    std::vector<std::vector<std::uint32_t>> groups;
    std::vector<std::uint32_t> group_of(normals.size(), kNoIndex);
    for (std::uint32_t seed = 0; seed < normals.size(); ++seed) {
        if (!(waiting.nx[seed] == waiting.nx[seed])) continue;  // taken, or without a normal
        grow_from(seed, points, rule, settings.tolerance, waiting, queries, positions);
        if (positions.size() < settings.min_points) continue;
        for (const std::uint32_t k : positions) {
            group_of[points.cells.order()[k]] = static_cast<std::uint32_t>(groups.size());
        }
        groups.emplace_back().reserve(positions.size());
    }
    // In ascending order without sorting.
    for (std::uint32_t i = 0; i < normals.size(); ++i) {
        if (group_of[i] != kNoIndex) groups[group_of[i]].push_back(i);
    }
    return groups;
}

// Mean point and direction of the mean normal of a group.
void summarize(std::span<const Vec3f> points, std::span<const Vec3f> normals,
               SmoothRegion& region) {
    Vec3d point = Vec3d::Zero();
    Vec3d normal = Vec3d::Zero();
    for (const std::uint32_t i : region.points) {
        point += points[i].cast<double>();
        normal += normals[i].cast<double>();
    }
    region.centroid = (point / static_cast<double>(region.points.size())).cast<float>();
    const double length = normal.norm();
    region.normal = length > 0.0 ? Vec3f((normal / length).cast<float>())
                                 : Vec3f(normals[region.points.front()]);
}

// Leaves the points whose normals are near the region's.
void refine(std::span<const Vec3f> normals, float max_angle, SmoothRegion& region) {
    const float min_cosine = max_angle < kHalfTurn ? std::cos(max_angle) : -2.0F;
    std::erase_if(region.points,
                  [&](std::uint32_t i) { return !(region.normal.dot(normals[i]) > min_cosine); });
}

std::vector<std::uint32_t> smooth_points(std::span<const float> curvatures, float limit) {
    std::vector<std::uint32_t> kept;
    kept.reserve(curvatures.size());
    for (std::uint32_t i = 0; i < curvatures.size(); ++i) {
        if (!(curvatures[i] > limit)) kept.push_back(i);
    }
    return kept;
}

// Unit normals of the points, fitted among themselves, on the viewpoint's side.
std::vector<Vec3f> fitted_normals(std::span<const Vec3f> points, const OrderedPoints& ordered,
                                  float radius, const Vec3f& viewpoint) {
    std::vector<Vec3f> normals = fit_planes(ordered, radius).normals;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (normals[i].dot(viewpoint - points[i]) < 0.0F) normals[i] = -normals[i];
    }
    return normals;
}

}  // namespace

std::vector<float> surface_variations(std::span<const Vec3f> points, float radius) {
    if (!(radius > 0.0F)) throw InvalidInput("surface variation: radius must be positive");
    return fit_planes(OrderedPoints(points, radius), radius).variations;
}

std::vector<SmoothRegion> smooth_regions(const PointCloud& cloud, std::span<const float> curvatures,
                                         const CvfhRegionSettings& given, float refinement) {
    require_points(cloud, "cvfh");
    if (!curvatures.empty() && curvatures.size() != cloud.size()) {
        throw InvalidInput(
            fmt::format("cvfh: {} curvatures for {} points", curvatures.size(), cloud.size()));
    }
    const CvfhRegionSettings settings = completed(cloud.points, given);
    if (!(settings.normal_radius > 0.0F)) return {};
    std::vector<float> computed;
    if (curvatures.empty()) {
        computed = surface_variations(cloud.points, settings.normal_radius);
        curvatures = computed;
    }
    const std::vector<std::uint32_t> kept = smooth_points(curvatures, settings.max_curvature);
    if (kept.empty() || kept.size() < settings.min_points) return {};
    std::vector<Vec3f> points(kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) points[i] = cloud.points[kept[i]];
    const OrderedPoints ordered(points, settings.normal_radius);
    const std::vector<Vec3f> normals =
        fitted_normals(points, ordered, settings.normal_radius, cloud.viewpoint);
    std::vector<SmoothRegion> regions;
    for (auto& group : grow(ordered, normals, settings)) {
        SmoothRegion region;
        region.points = std::move(group);
        summarize(points, normals, region);
        if (refinement > 0.0F) {
            refine(normals, refinement * settings.max_angle, region);
            if (region.points.empty()) continue;
            summarize(points, normals, region);
        }
        for (std::uint32_t& i : region.points) i = kept[i];
        regions.push_back(std::move(region));
    }
    std::stable_sort(regions.begin(), regions.end(), [](const auto& a, const auto& b) {
        return a.points.size() != b.points.size() ? a.points.size() > b.points.size()
                                                  : a.points.front() < b.points.front();
    });
    return regions;
}

}  // namespace ostraka
