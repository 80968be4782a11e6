// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/exact_sum.hpp"

#include <algorithm>

namespace ostraka {

Vec3d exact_centroid(std::span<const Vec3f> points) {
    float largest = 0.0F;
    for (const Vec3f& point : points) {
        for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(point[axis]));
    }
    const TermRounder rounded(points.size(), largest);
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    for (const Vec3f& point : points) {
        x += rounded(point.x());
        y += rounded(point.y());
        z += rounded(point.z());
    }
    return Vec3d(x, y, z) / static_cast<double>(points.size());
}

Mat3d exact_scatter(std::span<const Vec3f> points, const Vec3d& origin) {
    const double radius = largest_distance(points, origin);
    const TermRounder rounded(points.size(), radius * radius);
    double xx = 0.0;
    double xy = 0.0;
    double xz = 0.0;
    double yy = 0.0;
    double yz = 0.0;
    double zz = 0.0;
    for (const Vec3f& point : points) {
        const double x = point.x() - origin.x();
        const double y = point.y() - origin.y();
        const double z = point.z() - origin.z();
        xx += rounded(x * x);
        xy += rounded(x * y);
        xz += rounded(x * z);
        yy += rounded(y * y);
        yz += rounded(y * z);
        zz += rounded(z * z);
    }
    Mat3d scatter;
    scatter << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return scatter;
}

double largest_distance(std::span<const Vec3f> points, const Vec3d& origin) {
    double largest = 0.0;
    for (const Vec3f& point : points) {
        const double x = point.x() - origin.x();
        const double y = point.y() - origin.y();
        const double z = point.z() - origin.z();
        largest = std::max(largest, x * x + y * y + z * z);
    }
    return std::sqrt(largest);
}

}  // namespace ostraka
