// SPDX-License-Identifier: Apache-2.0
// Our clouds as PCL's.
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <span>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka::bench {

using PclPoints = pcl::PointCloud<pcl::PointXYZ>;
using PclNormals = pcl::PointCloud<pcl::Normal>;
using PclTree = pcl::search::KdTree<pcl::PointXYZ>;

inline constexpr const char* kPcl = "PCL 1.13";

inline PclPoints::Ptr pcl_points(std::span<const Vec3f> points) {
    PclPoints::Ptr result(new PclPoints);
    for (const Vec3f& p : points) result->emplace_back(p.x(), p.y(), p.z());
    return result;
}

inline PclNormals::Ptr pcl_normals(const PointCloud& cloud) {
    PclNormals::Ptr result(new PclNormals);
    for (const Vec3f& n : cloud.normals) result->emplace_back(n.x(), n.y(), n.z());
    return result;
}

}  // namespace ostraka::bench
