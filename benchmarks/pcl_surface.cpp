// SPDX-License-Identifier: Apache-2.0
#include "pcl_surface.hpp"

#include <pcl/common/io.h>
#include <pcl/surface/gp3.h>

namespace ostraka::bench {

std::vector<pcl::Vertices> pcl_triangles(const PclPoints& points, const PclNormals& normals,
                                         double edge) {
    pcl::PointCloud<pcl::PointNormal>::Ptr both(new pcl::PointCloud<pcl::PointNormal>);
    pcl::concatenateFields(points, normals, *both);
    pcl::search::KdTree<pcl::PointNormal>::Ptr tree(new pcl::search::KdTree<pcl::PointNormal>);
    tree->setInputCloud(both);
    pcl::GreedyProjectionTriangulation<pcl::PointNormal> greedy;
    greedy.setSearchRadius(edge);
    greedy.setMu(2.5);
    greedy.setMaximumNearestNeighbors(100);
    greedy.setMaximumSurfaceAngle(M_PI / 4);
    greedy.setMinimumAngle(M_PI / 18);
    greedy.setMaximumAngle(2 * M_PI / 3);
    greedy.setNormalConsistency(false);
    greedy.setInputCloud(both);
    greedy.setSearchMethod(tree);
    std::vector<pcl::Vertices> triangles;
    greedy.reconstruct(triangles);
    return triangles;
}

}  // namespace ostraka::bench
