// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/point_cloud.hpp"

#include <fmt/format.h>

#include "ostraka/base/error.hpp"

namespace ostraka {

void check(const PointCloud& cloud) {
    const std::size_t count = cloud.size();
    if (!cloud.normals.empty() && cloud.normals.size() != count) {
        throw InvalidInput(
            fmt::format("cloud: {} normals for {} points", cloud.normals.size(), count));
    }
    if (!cloud.colors.empty() && cloud.colors.size() != count) {
        throw InvalidInput(
            fmt::format("cloud: {} colors for {} points", cloud.colors.size(), count));
    }
    const auto cells =
        static_cast<std::size_t>(cloud.width) * static_cast<std::size_t>(cloud.height);
    if (cloud.width < 0 || cloud.height < 0 || (cells != 0 && cells != count)) {
        throw InvalidInput(fmt::format("cloud: a grid of {} x {} for {} points", cloud.width,
                                       cloud.height, count));
    }
}

PointCloud select(const PointCloud& cloud, std::span<const std::uint32_t> indices) {
    PointCloud result;
    result.viewpoint = cloud.viewpoint;
    result.points.reserve(indices.size());
    for (const std::uint32_t i : indices) result.points.push_back(cloud.points[i]);
    if (!cloud.normals.empty()) {
        result.normals.reserve(indices.size());
        for (const std::uint32_t i : indices) result.normals.push_back(cloud.normals[i]);
    }
    if (!cloud.colors.empty()) {
        result.colors.reserve(indices.size());
        for (const std::uint32_t i : indices) result.colors.push_back(cloud.colors[i]);
    }
    return result;
}

PointCloud remove_invalid(const PointCloud& cloud) {
    std::vector<std::uint32_t> valid;
    valid.reserve(cloud.size());
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        const bool has_normal = cloud.normals.empty() || cloud.normals[i].allFinite();
        if (cloud.points[i].allFinite() && has_normal) valid.push_back(i);
    }
    return select(cloud, valid);
}

PointCloud transformed(const PointCloud& cloud, const Pose& T_new_old) {
    PointCloud result = cloud;
    const Mat3d R_new_old = T_new_old.linear();
    for (Vec3f& point : result.points) point = (T_new_old * point.cast<double>()).cast<float>();
    for (Vec3f& normal : result.normals) normal = (R_new_old * normal.cast<double>()).cast<float>();
    result.viewpoint = (T_new_old * cloud.viewpoint.cast<double>()).cast<float>();
    return result;
}

PointCloud scaled(PointCloud cloud, double factor) {
    if (factor == 1.0) return cloud;
    const auto scale = static_cast<float>(factor);
    for (Vec3f& point : cloud.points) point *= scale;
    cloud.viewpoint *= scale;
    return cloud;
}

Vec3d centroid(std::span<const Vec3f> points) {
    Vec3d sum = Vec3d::Zero();
    for (const Vec3f& point : points) sum += point.cast<double>();
    return sum / static_cast<double>(points.size());
}

}  // namespace ostraka
