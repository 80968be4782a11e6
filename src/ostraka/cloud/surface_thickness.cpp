// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/surface_thickness.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/cell_grid.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/plane_fit.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kPoints = 2000;     // that are looked at
constexpr std::size_t kMostInCell = 500;  // of a grid as wide as the radius; scans have fewer
constexpr double kNoPlane = -1.0;

double deviation_from_plane(const std::vector<Vec3f>& points, const Vec3f& at,
                            const std::vector<Neighbor>& around) {
    Moments moments;
    for (const Neighbor& neighbor : around) {
        const Vec3d offset = (points[neighbor.index] - at).cast<double>();
        moments.first += offset;
        moments.second += offset * offset.transpose();
        moments.count += 1.0;
    }
    const Vec3d normal = fit_normal(moments, kLineRatio).cast<double>();
    if (!normal.allFinite()) return kNoPlane;
    const double mean = normal.dot(moments.first) / moments.count;
    const double square = normal.dot(moments.second * normal) / moments.count;
    return std::sqrt(std::max(0.0, square - mean * mean));
}

// Evenly thinned where many points are in one place: all of them would be looked at for each point.
std::vector<Vec3f> thinned(const std::vector<Vec3f>& points, double side) {
    const CellGrid grid(points, side);
    std::vector<char> kept(points.size(), 0);
    for (std::size_t c = 0; c < grid.cell_count(); ++c) {
        const auto members = grid.members(c);
        const std::size_t stride = 1 + (members.size() - 1) / kMostInCell;
        for (std::size_t i = 0; i < members.size(); i += stride) kept[members[i]] = 1;
    }
    std::vector<Vec3f> some;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (kept[i]) some.push_back(points[i]);
    }
    return some;
}

}  // namespace

double surface_thickness(const PointCloud& cloud, double radius) {
    const std::vector<Vec3f> points = thinned(cloud.points, radius);
    const KdTree tree(points);
    const std::size_t stride = 1 + points.size() / kPoints;
    std::vector<double> found(points.size() / stride, kNoPlane);
    parallel_for(found.size(), [&](std::size_t k) {
        thread_local std::vector<Neighbor> around;
        const Vec3f& at = points[k * stride];
        tree.within(at, static_cast<float>(radius), around);
        found[k] = deviation_from_plane(points, at, around);
    });
    std::erase(found, kNoPlane);
    if (found.empty()) return 0.0;
    const auto middle = found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2);
    std::nth_element(found.begin(), middle, found.end());
    return *middle;
}

}  // namespace ostraka
