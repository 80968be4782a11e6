// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/rectangle.hpp"

#include <algorithm>
#include <limits>

namespace ostraka {
namespace {

double turn(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// Andrew. Another Efficient Algorithm for Convex Hulls in Two Dimensions. 1979.
std::vector<Vec2d> convex_hull(std::vector<Vec2d> points) {
    std::sort(points.begin(), points.end(), [](const Vec2d& a, const Vec2d& b) {
        return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    });
    if (points.size() < 3) return points;
    std::vector<Vec2d> hull;
    const auto append = [&](const Vec2d& point, std::size_t keep) {
        while (hull.size() >= keep + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0.0) {
            hull.pop_back();
        }
        hull.push_back(point);
    };
    for (const Vec2d& point : points) append(point, 0);
    const std::size_t lower = hull.size() - 1;
    for (std::size_t i = points.size() - 1; i-- > 0;) append(points[i], lower);
    hull.pop_back();  // the first point once more
    return hull;
}

Rectangle rectangle_along(const std::vector<Vec2d>& hull, const Vec2d& along) {
    const Vec2d across(-along.y(), along.x());
    Vec2d low = Vec2d::Constant(std::numeric_limits<double>::infinity());
    Vec2d high = -low;
    for (const Vec2d& point : hull) {
        const Vec2d local(point.dot(along), point.dot(across));
        low = low.cwiseMin(local);
        high = high.cwiseMax(local);
    }
    const Vec2d middle = 0.5 * (low + high);
    const Vec2d center = middle.x() * along + middle.y() * across;
    const Vec2d size = high - low;
    if (size.x() >= size.y()) return {center, along, size};
    return {center, across, {size.y(), size.x()}};
}

}  // namespace

Rectangle smallest_rectangle(std::vector<Vec2d> points) {
    const std::vector<Vec2d> hull = convex_hull(std::move(points));
    Rectangle best = rectangle_along(hull, Vec2d::UnitX());
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vec2d edge = hull[(i + 1) % hull.size()] - hull[i];
        if (!(edge.norm() > 0.0)) continue;
        const Rectangle rectangle = rectangle_along(hull, edge.normalized());
        const double area = rectangle.extents.prod();
        if (area < least) {
            least = area;
            best = rectangle;
        }
    }
    return best;
}

}  // namespace ostraka
