// SPDX-License-Identifier: Apache-2.0
// Normals, FPFH and registration against Open3D.
#include <omp.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/Feature.h>
#include <open3d/pipelines/registration/Registration.h>

#include <memory>

#include "benchmark.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/descriptors/fpfh.hpp"
#include "registration_job.hpp"

namespace ostraka::bench {
namespace {

constexpr const char* kOpen3d = "Open3D 0.16";

std::shared_ptr<open3d::geometry::PointCloud> open3d_cloud(const PointCloud& cloud) {
    auto result = std::make_shared<open3d::geometry::PointCloud>();
    for (const Vec3f& p : cloud.points) result->points_.emplace_back(p.cast<double>());
    for (const Vec3f& n : cloud.normals) result->normals_.emplace_back(n.cast<double>());
    return result;
}

Contest normals(const BenchCloud& cloud) {
    struct State {
        std::shared_ptr<open3d::geometry::PointCloud> points;
        std::vector<Vec3f> ours;
    };
    auto state = std::make_shared<State>();
    state->points = open3d_cloud(cloud.cloud);
    state->points->normals_.clear();
    const auto peer = [state, &cloud] {
        const Eigen::Vector3d eye = cloud.cloud.viewpoint.cast<double>();
        state->points->normals_.clear();
        state->points->EstimateNormals(
            open3d::geometry::KDTreeSearchParamKNN(NormalSettings{}.neighbors));
        state->points->OrientNormalsTowardsCameraLocation(eye);
    };
    const auto answer = [](const auto& vectors) {
        std::vector<float> flat;
        for (const auto& v : vectors) {
            for (int axis = 0; axis < 3; ++axis) flat.push_back(static_cast<float>(v[axis]));
        }
        return flat;
    };
    return {{[state, &cloud] { state->ours = estimate_normals(cloud.cloud); },
             [state, answer] { return answer(state->ours); }},
            {peer, [state, answer] { return answer(state->points->normals_); }}};
}

// Of all points; Open3D's rows are scaled otherwise, so their values aren't compared.
Contest fpfh(const BenchCloud& cloud) {
    struct State {
        std::shared_ptr<open3d::geometry::PointCloud> points;
        std::shared_ptr<open3d::pipelines::registration::Feature> rows;
        LocalDescriptors ours;
    };
    auto state = std::make_shared<State>();
    state->points = open3d_cloud(cloud.cloud);
    const double radius = 15.0 * cloud.mr;
    const auto ours = [state, radius, &cloud] {
        state->ours = describe_fpfh(cloud.cloud, {.radius = static_cast<float>(radius)});
    };
    const auto peer = [state, radius] {
        state->rows = open3d::pipelines::registration::ComputeFPFHFeature(
            *state->points, open3d::geometry::KDTreeSearchParamRadius(radius));
    };
    return {{ours, [state] { return state->ours.rows; }},
            {peer, [] { return std::vector<float>(); }}};
}

// Point to plane, until it is as exact as ours; the target's normals included, as in ours.
Contest registration(const BenchCloud& cloud) {
    namespace o3d = open3d::pipelines::registration;
    auto job = std::make_shared<RegistrationJob>(cloud);
    const auto points = open3d_cloud(job->points);
    const auto peer = [job, points] {
        points->normals_.clear();
        points->EstimateNormals(
            open3d::geometry::KDTreeSearchParamKNN(CloudIcpSettings{}.neighbors));
        const auto result =
            o3d::RegistrationICP(*points, *points, 0.15 * job->radius, job->guess.matrix(),
                                 o3d::TransformationEstimationPointToPlane(),
                                 o3d::ICPConvergenceCriteria(1e-9, 1e-9, 50));
        job->peer.matrix() = result.transformation_;
    };
    return {{[job] { job->ours = align_clouds(job->points, job->points, job->guess); },
             [job] { return job->moved(job->ours.T_target_source); }},
            {peer, [job] { return job->moved(Pose::Identity()); }},
            [job] { return job->note(); }};
}

}  // namespace

std::vector<Benchmark> open3d_benchmarks() {
    omp_set_num_threads(1);
    return {{.name = "normals, k = 20", .peer = kOpen3d, .goal = 4, .prepare = normals},
            {.name = "FPFH, all points", .peer = kOpen3d, .goal = 4, .prepare = fpfh},
            {.name = "ICP, point to plane", .peer = kOpen3d, .goal = 2, .prepare = registration}};
}

}  // namespace ostraka::bench
