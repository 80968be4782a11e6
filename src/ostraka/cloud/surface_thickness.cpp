// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/surface_thickness.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/plane_fit.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kPoints = 2000;  // that are looked at
constexpr double kNoPlane = -1.0;

double deviation_from_plane(const PointCloud& cloud, const Vec3f& at,
                            const std::vector<Neighbor>& around) {
    Moments moments;
    for (const Neighbor& neighbor : around) {
        const Vec3d offset = (cloud.points[neighbor.index] - at).cast<double>();
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

}  // namespace

double surface_thickness(const PointCloud& cloud, double radius) {
    const KdTree tree(cloud.points);
    const std::size_t stride = 1 + cloud.size() / kPoints;
    std::vector<double> found(cloud.size() / stride, kNoPlane);
    parallel_for(found.size(), [&](std::size_t k) {
        thread_local std::vector<Neighbor> around;
        const Vec3f& at = cloud.points[k * stride];
        tree.within(at, static_cast<float>(radius), around);
        found[k] = deviation_from_plane(cloud, at, around);
    });
    std::erase(found, kNoPlane);
    if (found.empty()) return 0.0;
    const auto middle = found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2);
    std::nth_element(found.begin(), middle, found.end());
    return *middle;
}

}  // namespace ostraka
