// SPDX-License-Identifier: Apache-2.0
// OpenCV's detector of point pair features with its ICP: a peer here, no part of the product.
// Drost, Ulrich, Navab, Ilic. Model Globally, Match Locally. CVPR 2010.
#include <algorithm>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <opencv2/surface_matching.hpp>
#include <opencv2/surface_matching/ppf_helpers.hpp>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/resample.hpp"
#include "scene_peers.hpp"

namespace ostraka::bench {
namespace {

namespace ppf = cv::ppf_match_3d;

constexpr std::size_t kCandidates = 10;      // most voted poses that are refined
constexpr double kSceneStep = 1.0 / 5.0;     // of the scene's points are reference points
constexpr double kRotationThreshold = 0.2;   // radians, of poses that are one
constexpr double kSurroundings = 0.6;        // diameters around a pose that its ICP sees
constexpr std::size_t kMostIcpPoints = 700;  // of a model

struct Trained {
    std::unique_ptr<ppf::PPF3DDetector> detector;
    double step = 0.0;   // between points, library unit
    PointCloud surface;  // for ICP
};

struct State {
    std::vector<Trained> models;
    const PointCloud* scan = nullptr;
};

// One row a point: position and normal.
cv::Mat opencv_cloud(const PointCloud& cloud) {
    cv::Mat rows(static_cast<int>(cloud.size()), 6, CV_32F);
    for (int i = 0; i < rows.rows; ++i) {
        Eigen::Map<Eigen::Matrix<float, 6, 1>>(rows.ptr<float>(i))
            << cloud.points[static_cast<std::size_t>(i)],
            cloud.normals[static_cast<std::size_t>(i)];
    }
    return rows;
}

double diagonal_of(const PointCloud& cloud) {
    Eigen::AlignedBox3f box;
    for (const Vec3f& point : cloud.points) box.extend(point);
    return box.diagonal().norm();
}

// Its own sampling divides each side of the bounding box by the same number: points are brought to
// the same distance in all directions before, in model and scene alike.
Trained train(const Model& model, double step) {
    Trained trained{.detector = std::make_unique<ppf::PPF3DDetector>(step, step, 30)};
    const double diagonal = diagonal_of(model.surface);
    trained.step = step * diagonal;
    // Its own thresholds take the relative step for a length, and any rotation for the same.
    trained.detector->setSearchParams(trained.step, kRotationThreshold, false);
    trained.detector->trainModel(opencv_cloud(resample(model.surface, trained.step)));
    trained.surface = model.surface;
    return trained;
}

Pose pose_of(const cv::Matx44d& matrix) {
    Pose pose;
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) pose.matrix()(row, column) = matrix(row, column);
    }
    return pose;
}

// The side of the model that faces the sensor, thinned out evenly.
PointCloud visible_side(const PointCloud& surface, const Pose& T_scene_model, const Vec3f& eye) {
    const PointCloud placed = transformed(surface, T_scene_model);
    std::vector<std::uint32_t> facing;
    for (std::uint32_t i = 0; i < placed.size(); ++i) {
        if (placed.normals[i].dot(eye - placed.points[i]) > 0.0F) facing.push_back(i);
    }
    const std::size_t stride = facing.size() / kMostIcpPoints + 1;
    std::vector<std::uint32_t> chosen;
    for (std::size_t i = 0; i < facing.size(); i += stride) chosen.push_back(facing[i]);
    return select(placed, chosen);
}

PointCloud near_points(const PointCloud& scan, const Vec3d& center, double reach) {
    std::vector<std::uint32_t> near;
    for (std::uint32_t i = 0; i < scan.size(); ++i) {
        if ((scan.points[i].cast<double>() - center).norm() < reach) near.push_back(i);
    }
    return select(scan, near);
}

// Nothing but the visible side and the pose's surroundings: its ICP rejects outliers by the spread
// of all distances.
Pose refine(const Trained& trained, const Model& model, const PointCloud& scan, const Pose& guess) {
    const PointCloud side = visible_side(trained.surface, guess, scan.viewpoint);
    const Vec3d center = guess * model.shape.center;
    const PointCloud around = near_points(scan, center, kSurroundings * model.shape.diameter);
    if (side.size() < 20 || around.size() < 20) return guess;
    ppf::ICP icp(100, 0.005F, 2.5F, 4);
    double residual = 0.0;
    cv::Matx44d correction = cv::Matx44d::eye();
    icp.registerModelToScene(opencv_cloud(side), opencv_cloud(around), residual, correction);
    return pose_of(correction) * guess;
}

std::vector<Pose> find(const State& state, const Model& model, const Trained& trained,
                       const std::vector<bool>& taken) {
    const PointCloud scan = free_points(*state.scan, taken);
    const PointCloud sparse = resample(scan, trained.step);
    if (sparse.size() < 20) return {};
    std::vector<ppf::Pose3DPtr> results;
    trained.detector->match(opencv_cloud(sparse), results, kSceneStep,
                            std::min(1.0, trained.step / diagonal_of(sparse)));
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < std::min(kCandidates, results.size()); ++i) {
        poses.push_back(refine(trained, model, scan, pose_of(results[i]->pose)));
    }
    return poses;
}

}  // namespace

std::vector<ScenePeer> opencv_scene_peers(const ModelLibrary& library,
                                          const PeerSettings& settings) {
    const auto state = std::make_shared<State>();
    const double step = settings.opencv_step;
    if (!(step > 0.0 && step < 0.5)) throw InvalidInput("--opencv-step must be in (0, 0.5)");
    cv::setNumThreads(settings.threads);
    ScenePeer peer{.name = "OpenCV " CV_VERSION " PPF"};
    peer.settings = cv::format(
        "step %.3f of the diagonal, 30 angles, every 5th scene point; ICP of the 10 most "
        "voted poses on their visible side",
        step);
    peer.train = [=, &library] {
        for (const Model& model : library.models) state->models.push_back(train(model, step));
    };
    peer.look = [=](const PointCloud& scan) { state->scan = &scan; };
    peer.find = [=, &library](std::uint32_t model, const std::vector<bool>& taken) {
        return find(*state, library.models[model], state->models[model], taken);
    };
    return {peer};
}

}  // namespace ostraka::bench
