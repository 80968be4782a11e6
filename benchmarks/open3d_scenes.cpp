// SPDX-License-Identifier: Apache-2.0
// Open3D's global registration: FPFH, RANSAC over matched features, point-to-plane ICP.
// Rusu, Blodow, Beetz. Fast Point Feature Histograms (FPFH) for 3D Registration. ICRA 2009.
#include <omp.h>
#include <open3d/geometry/KDTreeFlann.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/Feature.h>
#include <open3d/pipelines/registration/Registration.h>
#include <open3d/utility/Random.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "ostraka/cloud/kdtree.hpp"
#include "scene_peers.hpp"

namespace ostraka::bench {
namespace {

namespace o3d = open3d::pipelines::registration;
using Cloud = std::shared_ptr<open3d::geometry::PointCloud>;
using Rows = std::shared_ptr<o3d::Feature>;

constexpr double kVoxel = 2.0;          // sampling distances between points that are described
constexpr double kFeatureRadius = 5.0;  // voxels
constexpr int kFeatureNeighbors = 100;
constexpr int kTries = 3;  // of RANSAC, each with its own seed and ICP
constexpr int kIterations = 100'000;

struct Described {
    Cloud points;
    Rows rows;
};

struct State {
    std::vector<Described> models;
    Described scene;
    std::vector<std::uint32_t> in_scan;  // per point of the scene: the scan's point nearest to it
    const PointCloud* scan = nullptr;
};

Cloud open3d_cloud(const PointCloud& cloud) {
    auto result = std::make_shared<open3d::geometry::PointCloud>();
    for (const Vec3f& p : cloud.points) result->points_.emplace_back(p.cast<double>());
    for (const Vec3f& n : cloud.normals) result->normals_.emplace_back(n.cast<double>());
    return result;
}

Described describe(const Cloud& cloud, double voxel) {
    Described described{.points = cloud->VoxelDownSample(voxel)};
    described.points->NormalizeNormals();
    described.rows = o3d::ComputeFPFHFeature(
        *described.points,
        open3d::geometry::KDTreeSearchParamHybrid(kFeatureRadius * voxel, kFeatureNeighbors));
    return described;
}

// What of the scene isn't taken.
Described free_part(const State& state, const std::vector<bool>& taken) {
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < state.in_scan.size(); ++i) {
        if (!taken[state.in_scan[i]]) free.push_back(i);
    }
    Described part{.points = state.scene.points->SelectByIndex(free),
                   .rows = std::make_shared<o3d::Feature>()};
    part.rows->Resize(static_cast<int>(state.scene.rows->Dimension()),
                      static_cast<int>(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i) {
        part.rows->data_.col(static_cast<Eigen::Index>(i)) =
            state.scene.rows->data_.col(static_cast<Eigen::Index>(free[i]));
    }
    return part;
}

// For each point of the model the scene's with the most similar row. Open3D's own matching does the
// same again for every try.
o3d::CorrespondenceSet matches_of(const Described& model, const Described& scene) {
    const open3d::geometry::KDTreeFlann tree(*scene.rows);
    o3d::CorrespondenceSet matches;
    std::vector<int> nearest(1);
    std::vector<double> distance(1);
    for (int i = 0; i < static_cast<int>(model.rows->Num()); ++i) {
        if (tree.SearchKNN(Eigen::VectorXd(model.rows->data_.col(i)), 1, nearest, distance) < 1)
            continue;
        matches.emplace_back(i, nearest[0]);
    }
    return matches;
}

Eigen::Matrix4d ransac(const Described& model, const Described& scene,
                       const o3d::CorrespondenceSet& matches, double voxel) {
    const o3d::CorrespondenceCheckerBasedOnEdgeLength edges(0.9);
    const o3d::CorrespondenceCheckerBasedOnDistance distance(1.5 * voxel);
    return o3d::RegistrationRANSACBasedOnCorrespondence(
               *model.points, *scene.points, matches, 1.5 * voxel,
               o3d::TransformationEstimationPointToPoint(false), 3, {edges, distance},
               o3d::RANSACConvergenceCriteria(kIterations, 0.999))
        .transformation_;
}

Pose refine(const Cloud& model, const Cloud& scan, const Eigen::Matrix4d& guess, double sampling) {
    Eigen::Matrix4d pose = guess;
    for (const double reach : {3.0, 1.5}) {
        pose = o3d::RegistrationICP(*model, *scan, reach * sampling, pose,
                                    o3d::TransformationEstimationPointToPlane(),
                                    o3d::ICPConvergenceCriteria(1e-6, 1e-6, 50))
                   .transformation_;
    }
    Pose result;
    result.matrix() = pose;
    return result;
}

void look(State& state, const PointCloud& scan, double voxel) {
    state.scan = &scan;
    state.scene = describe(open3d_cloud(scan), voxel);
    const KdTree tree(scan.points);
    state.in_scan.clear();
    for (const Eigen::Vector3d& point : state.scene.points->points_) {
        state.in_scan.push_back(tree.nearest(point.cast<float>()).index);
    }
}

std::vector<Pose> find(const State& state, std::uint32_t model, const std::vector<bool>& taken,
                       double sampling) {
    const Described scene = free_part(state, taken);
    if (scene.points->points_.size() < 10) return {};
    const Cloud scan = open3d_cloud(free_points(*state.scan, taken));
    const o3d::CorrespondenceSet matches = matches_of(state.models[model], scene);
    std::vector<Pose> poses;
    for (int i = 0; i < kTries; ++i) {
        const Eigen::Matrix4d guess =
            ransac(state.models[model], scene, matches, kVoxel * sampling);
        poses.push_back(refine(state.models[model].points, scan, guess, sampling));
    }
    return poses;
}

}  // namespace

std::vector<ScenePeer> open3d_scene_peers(const ModelLibrary& library,
                                          const PeerSettings& settings) {
    const auto state = std::make_shared<State>();
    const double sampling = library.settings.sampling;
    // Where this isn't set, Open3D takes all cores whatever OpenMP was told.
    setenv("OMP_NUM_THREADS", std::to_string(settings.threads).c_str(), 1);
    omp_set_num_threads(settings.threads);
    ScenePeer peer{.name = "Open3D 0.16"};
    peer.settings =
        "FPFH at 2 sampling distances, radius 10; best of 3 tries of RANSAC (100,000 "
        "iterations at most); point-to-plane ICP at 3, then 1.5";
    peer.train = [=, &library] {
        for (const Model& model : library.models) {
            const Cloud surface = open3d_cloud(model.surface);
            state->models.push_back(describe(surface, kVoxel * sampling));
        }
    };
    peer.look = [=](const PointCloud& scan) {
        open3d::utility::random::Seed(static_cast<int>(settings.seed));
        look(*state, scan, kVoxel * sampling);
    };
    peer.find = [=](std::uint32_t model, const std::vector<bool>& taken) {
        return find(*state, model, taken, sampling);
    };
    return {peer};
}

}  // namespace ostraka::bench
