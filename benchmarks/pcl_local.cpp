// SPDX-License-Identifier: Apache-2.0
// Local descriptors at 200 keypoints, radius 15 mesh resolutions, against PCL.
#include <pcl/features/fpfh.h>
#include <pcl/features/pfh.h>
#include <pcl/features/rops_estimation.h>
#include <pcl/features/shot.h>
#include <pcl/features/spin_image.h>

#include <memory>

#include "benchmark.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/descriptors/fpfh.hpp"
#include "ostraka/descriptors/pfh.hpp"
#include "ostraka/descriptors/rops.hpp"
#include "ostraka/descriptors/shot.hpp"
#include "ostraka/descriptors/spin_image.hpp"
#include "pcl_clouds.hpp"
#include "pcl_surface.hpp"

namespace ostraka::bench {
namespace {

constexpr double kRadius = 15.0;           // of the supports, in mesh resolutions
constexpr std::size_t kPfhKeypoints = 20;  // PCL takes seconds for 200

template <class Output>
struct State {
    explicit State(const BenchCloud& cloud)
        : points(pcl_points(cloud.cloud.points)),
          normals(pcl_normals(cloud.cloud)),
          keypoints(pcl_points(cloud.keypoints)),
          radius(kRadius * cloud.mr) {}
    PclPoints::Ptr points;
    PclNormals::Ptr normals;
    PclPoints::Ptr keypoints;
    double radius;  // the cloud's unit
    std::vector<float> ours;
    Output pcl;

    // What all of PCL's local descriptors want.
    template <class Estimation>
    void compute(Estimation& estimation) {
        estimation.setInputCloud(keypoints);
        estimation.setSearchSurface(points);
        estimation.setRadiusSearch(radius);
        estimation.setSearchMethod(PclTree::Ptr(new PclTree));
        estimation.compute(pcl);
    }
};

Contest shot(const BenchCloud& cloud) {
    auto state = std::make_shared<State<pcl::PointCloud<pcl::SHOT352>>>(cloud);
    const auto ours = [state, &cloud] {
        const ShotSettings settings{.radius = static_cast<float>(state->radius)};
        state->ours = describe_shot(cloud.cloud, cloud.keypoints, settings).rows;
    };
    const auto peer = [state] {
        pcl::SHOTEstimation<pcl::PointXYZ, pcl::Normal> estimation;
        estimation.setInputNormals(state->normals);
        estimation.setLRFRadius(static_cast<float>(state->radius));
        state->compute(estimation);
    };
    const auto peer_rows = [state] {
        std::vector<float> rows;
        for (const auto& row : state->pcl) {
            rows.insert(rows.end(), std::begin(row.descriptor), std::end(row.descriptor));
        }
        return rows;
    };
    return {{ours, [state] { return state->ours; }}, {peer, peer_rows}};
}

template <class Histograms>
std::vector<float> rows_of(const Histograms& histograms) {
    std::vector<float> rows;
    for (const auto& row : histograms) {
        rows.insert(rows.end(), std::begin(row.histogram), std::end(row.histogram));
    }
    return rows;
}

// Each side makes its own triangles, so the rows differ with them.
Contest rops(const BenchCloud& cloud) {
    auto state = std::make_shared<State<pcl::PointCloud<pcl::Histogram<135>>>>(cloud);
    const auto ours = [state, &cloud] {
        const auto triangles = triangulate(cloud.cloud);
        const RopsSettings settings{.radius = static_cast<float>(state->radius)};
        state->ours = describe_rops(cloud.cloud, triangles, cloud.keypoints, settings).rows;
    };
    const auto peer = [state, edge = 4.0 * cloud.mr] {
        pcl::ROPSEstimation<pcl::PointXYZ, pcl::Histogram<135>> estimation;
        estimation.setTriangles(pcl_triangles(*state->points, *state->normals, edge));
        estimation.setSupportRadius(static_cast<float>(state->radius));
        state->compute(estimation);
    };
    return {{ours, [state] { return state->ours; }},
            {peer, [state] { return rows_of(state->pcl); }}};
}

Contest fpfh(const BenchCloud& cloud) {
    auto state = std::make_shared<State<pcl::PointCloud<pcl::FPFHSignature33>>>(cloud);
    const auto ours = [state, &cloud] {
        const FpfhSettings settings{.radius = static_cast<float>(state->radius)};
        state->ours = describe_fpfh(cloud.cloud, cloud.keypoints, settings).rows;
    };
    const auto peer = [state] {
        pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal> estimation;
        estimation.setInputNormals(state->normals);
        state->compute(estimation);
    };
    return {{ours, [state] { return state->ours; }},
            {peer, [state] { return rows_of(state->pcl); }}};
}

Contest pfh(const BenchCloud& cloud) {
    auto state = std::make_shared<State<pcl::PointCloud<pcl::PFHSignature125>>>(cloud);
    const std::vector<Vec3f> keypoints(cloud.keypoints.begin(),
                                       cloud.keypoints.begin() + kPfhKeypoints);
    state->keypoints = pcl_points(keypoints);
    const auto ours = [state, keypoints, &cloud] {
        const PfhSettings settings{.radius = static_cast<float>(state->radius)};
        state->ours = describe_pfh(cloud.cloud, keypoints, settings).rows;
    };
    const auto peer = [state] {
        pcl::PFHEstimation<pcl::PointXYZ, pcl::Normal> estimation;
        estimation.setInputNormals(state->normals);
        state->compute(estimation);
    };
    return {{ours, [state] { return state->ours; }},
            {peer, [state] { return rows_of(state->pcl); }}};
}

Contest spin_image(const BenchCloud& cloud) {
    auto state = std::make_shared<State<pcl::PointCloud<pcl::Histogram<153>>>>(cloud);
    const auto ours = [state, &cloud] {
        const KdTree tree(cloud.cloud.points);
        const SpinImageSettings settings{.radius = static_cast<float>(state->radius)};
        state->ours = describe_spin_images(cloud.cloud, tree, cloud.keypoints, settings).rows;
    };
    // PCL takes the axes from the normals of the input, so keypoints are indices into it.
    const auto indices = pcl::make_shared<pcl::Indices>();
    const std::size_t count = cloud.cloud.size();
    for (std::size_t k = 0; k < cloud.keypoints.size(); ++k) {
        indices->push_back(static_cast<int>(k * count / cloud.keypoints.size()));
    }
    const auto peer = [state, indices] {
        pcl::SpinImageEstimation<pcl::PointXYZ, pcl::Normal, pcl::Histogram<153>> estimation(8, 0);
        estimation.setInputCloud(state->points);
        estimation.setInputNormals(state->normals);
        estimation.setIndices(indices);
        estimation.setRadiusSearch(state->radius);
        estimation.setSearchMethod(PclTree::Ptr(new PclTree));
        estimation.compute(state->pcl);
    };
    return {{ours, [state] { return state->ours; }},
            {peer, [state] { return rows_of(state->pcl); }}};
}

}  // namespace

std::vector<Benchmark> pcl_local_benchmarks() {
    std::vector<Benchmark> list;
    list.push_back(
        {.name = "SHOT, 200 keypoints", .peer = kPcl, .goal = 8, .in_mean = true, .prepare = shot});
    list.push_back({.name = "RoPS, 200 keypoints",
                    .peer = kPcl,
                    .goal = 10,
                    .in_mean = true,
                    .prepare = rops});
    list.push_back({.name = "FPFH, 200 keypoints",
                    .peer = kPcl,
                    .goal = 40,
                    .in_mean = true,
                    .prepare = fpfh});
    list.push_back({.name = "PFH, 20 keypoints", .peer = kPcl, .prepare = pfh});
    list.push_back({.name = "spin images, 200 keypoints", .peer = kPcl, .prepare = spin_image});
    return list;
}

}  // namespace ostraka::bench
