// SPDX-License-Identifier: Apache-2.0
// Normals, Euclidean clusters and registration against PCL.
#include <pcl/features/normal_3d.h>
#include <pcl/registration/icp.h>
#include <pcl/segmentation/extract_clusters.h>

#include <memory>

#include "benchmark.hpp"
#include "ostraka/cloud/clusters.hpp"
#include "ostraka/cloud/normals.hpp"
#include "pcl_clouds.hpp"
#include "registration_job.hpp"

namespace ostraka::bench {
namespace {

std::vector<float> flat(std::span<const Vec3f> vectors) {
    std::vector<float> result;
    for (const Vec3f& v : vectors) result.insert(result.end(), {v.x(), v.y(), v.z()});
    return result;
}

Contest normals(const BenchCloud& cloud) {
    struct State {
        PclPoints::Ptr points;
        PclNormals pcl;
        std::vector<Vec3f> ours;
    };
    auto state = std::make_shared<State>();
    state->points = pcl_points(cloud.cloud.points);
    const auto run_pcl = [state, &cloud] {
        pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
        estimation.setInputCloud(state->points);
        estimation.setSearchMethod(PclTree::Ptr(new PclTree));
        estimation.setKSearch(NormalSettings{}.neighbors);
        const Vec3f& eye = cloud.cloud.viewpoint;
        estimation.setViewPoint(eye.x(), eye.y(), eye.z());
        estimation.compute(state->pcl);
    };
    const auto pcl_answer = [state] {
        std::vector<float> result;
        for (const pcl::Normal& n : state->pcl) {
            result.insert(result.end(), {n.normal_x, n.normal_y, n.normal_z});
        }
        return result;
    };
    return {{[state, &cloud] { state->ours = estimate_normals(cloud.cloud); },
             [state] { return flat(state->ours); }},
            {run_pcl, pcl_answer}};
}

// The cluster of each point, from 1; 0 for none.
template <class Clusters, class IndicesOf>
std::vector<float> labels(std::size_t points, const Clusters& clusters, const IndicesOf& indices) {
    std::vector<float> result(points, 0.0F);
    float label = 0.0F;
    for (const auto& cluster : clusters) {
        label += 1.0F;
        for (const auto i : indices(cluster)) result[static_cast<std::size_t>(i)] = label;
    }
    return result;
}

Contest clusters(const BenchCloud& cloud) {
    struct State {
        PclPoints::Ptr points;
        std::vector<pcl::PointIndices> pcl;
        Clusters ours;
    };
    constexpr std::size_t kMinSize = 20;
    const double tolerance = 2.5 * cloud.mr;  // about the library's 2 sampling distances
    auto state = std::make_shared<State>();
    state->points = pcl_points(cloud.cloud.points);
    const auto run_pcl = [state, tolerance] {
        pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
        extraction.setClusterTolerance(tolerance);
        extraction.setMinClusterSize(kMinSize);
        PclTree::Ptr tree(new PclTree);
        tree->setInputCloud(state->points);
        extraction.setSearchMethod(tree);
        extraction.setInputCloud(state->points);
        state->pcl.clear();
        extraction.extract(state->pcl);
    };
    const std::size_t count = cloud.cloud.size();
    return {{[state, tolerance, &cloud] {
                 state->ours = euclidean_clusters(cloud.cloud.points, tolerance, kMinSize);
             },
             [state, count] {
                 return labels(
                     count, state->ours, [](const auto& c) -> auto& { return c; });
             }},
            {run_pcl, [state, count] {
                 return labels(
                     count, state->pcl, [](const auto& c) -> auto& { return c.indices; });
             }}};
}

// Point to point, 30 iterations, as PCL's users begin. The rows are the moved points; ours are
// compared with the truth.
Contest registration(const BenchCloud& cloud) {
    auto job = std::make_shared<RegistrationJob>(cloud);
    const PclPoints::Ptr points = pcl_points(job->points.points);
    const auto peer = [job, points] {
        pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
        icp.setInputTarget(points);
        icp.setInputSource(points);
        icp.setMaximumIterations(30);
        PclPoints aligned;
        icp.align(aligned, job->guess.matrix().cast<float>());
        job->peer.matrix() = icp.getFinalTransformation().cast<double>();
    };
    return {{[job] { job->ours = align_clouds(job->points, job->points, job->guess); },
             [job] { return job->moved(job->ours.T_target_source); }},
            {peer, [job] { return job->moved(Pose::Identity()); }},
            [job] { return job->note(); }};
}

}  // namespace

std::vector<Benchmark> pcl_geometry_benchmarks() {
    return {
        {.name = "normals, k = 20", .peer = kPcl, .goal = 6, .in_mean = true, .prepare = normals},
        {.name = "Euclidean clusters",
         .peer = kPcl,
         .goal = 10,
         .in_mean = true,
         .prepare = clusters},
        {.name = "ICP", .peer = kPcl, .goal = 20, .in_mean = true, .prepare = registration},
    };
}

}  // namespace ostraka::bench
