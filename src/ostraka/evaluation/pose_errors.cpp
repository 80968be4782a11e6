// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/pose_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "ostraka/cloud/kdtree.hpp"

namespace ostraka {

double adi_error(std::span<const Vec3f> model_points, const Pose& T_scene_model_true,
                 const Pose& T_scene_model_estimated) {
    if (model_points.empty()) return 0.0;
    // Distances don't change if both placed models are moved back by the estimated pose.
    const Pose T_estimated_true = T_scene_model_estimated.inverse() * T_scene_model_true;
    const KdTree tree(model_points);
    double sum = 0.0;
    for (const Vec3f& point : model_points) {
        const Vec3f moved = Vec3d(T_estimated_true * point.cast<double>()).cast<float>();
        sum += std::sqrt(double{tree.nearest(moved).squared_distance});
    }
    return sum / static_cast<double>(model_points.size());
}

double mssd_error(std::span<const Vec3f> model_points, std::span<const Pose> symmetries,
                  const Pose& T_scene_model_true, const Pose& T_scene_model_estimated) {
    if (model_points.empty()) return 0.0;
    double least = std::numeric_limits<double>::infinity();
    for (const Pose& symmetry : symmetries) {
        const Pose T_scene_model = T_scene_model_true * symmetry;
        // Squared; a symmetry that is already worse than the best needs no more points.
        double greatest = 0.0;
        for (const Vec3f& point : model_points) {
            const Vec3d p = point.cast<double>();
            greatest =
                std::max(greatest, (T_scene_model * p - T_scene_model_estimated * p).squaredNorm());
            if (greatest >= least) break;
        }
        least = std::min(least, greatest);
    }
    return std::sqrt(least);
}

double mspd_error(std::span<const Vec3f> model_points, std::span<const Pose> symmetries,
                  const Pose& T_camera_model_true, const Pose& T_camera_model_estimated,
                  const PinholeCamera& camera) {
    if (model_points.empty()) return 0.0;
    const double infinity = std::numeric_limits<double>::infinity();
    double least = infinity;
    for (const Pose& symmetry : symmetries) {
        const Pose T_camera_model = T_camera_model_true * symmetry;
        double greatest = 0.0;
        for (const Vec3f& point : model_points) {
            const Vec3d a = T_camera_model * point.cast<double>();
            const Vec3d b = T_camera_model_estimated * point.cast<double>();
            if (!(a.z() > 0.0) || !(b.z() > 0.0)) {
                greatest = infinity;
                break;
            }
            greatest = std::max(greatest, (camera.project(a) - camera.project(b)).squaredNorm());
            if (greatest >= least) break;
        }
        least = std::min(least, greatest);
    }
    return std::sqrt(least);
}

std::vector<double> distance_image(const RayModel& model, const PinholeCamera& camera,
                                   const Pose& T_camera_model) {
    const RayScene scene(std::vector<PlacedRayModel>{{model, T_camera_model}});
    const auto width = static_cast<std::size_t>(camera.width);
    std::vector<double> distances(width * static_cast<std::size_t>(camera.height), 0.0);
    std::vector<Vec3d> rays(width);
    for (int row = 0; row < camera.height; ++row) {
        for (std::size_t column = 0; column < width; ++column) {
            rays[column] = camera.ray(static_cast<double>(column), row);
        }
        const std::vector<RayHit> hits = scene.cast(Vec3d::Zero(), rays);
        for (std::size_t column = 0; column < width; ++column) {
            if (!hits[column].hit()) continue;
            distances[static_cast<std::size_t>(row) * width + column] =
                std::max(0.0, hits[column].distance) * rays[column].norm();
        }
    }
    return distances;
}

std::vector<double> vsd_errors(std::span<const double> scan, std::span<const double> truth,
                               std::span<const double> estimate, double diameter,
                               const VsdSettings& settings) {
    // Seen where the scan has nothing nearer, or nothing at all.
    const auto visible = [&](double model, double scanned) {
        return model > 0.0 && (model - scanned <= settings.delta || scanned == 0.0);
    };
    std::size_t one_only = 0;
    std::vector<double> differences;  // in diameters, where both are visible
    for (std::size_t pixel = 0; pixel < scan.size(); ++pixel) {
        const bool true_visible = visible(truth[pixel], scan[pixel]);
        // What the true object shows, the estimated one may cover.
        const bool estimated_visible =
            visible(estimate[pixel], scan[pixel]) || (true_visible && estimate[pixel] > 0.0);
        if (true_visible && estimated_visible) {
            differences.push_back(std::abs(truth[pixel] - estimate[pixel]) / diameter);
        } else if (true_visible || estimated_visible) {
            ++one_only;
        }
    }
    const std::size_t either = differences.size() + one_only;
    std::vector<double> errors;
    for (const double tolerance : settings.tolerances) {
        const auto far = std::count_if(differences.begin(), differences.end(),
                                       [&](double value) { return value >= tolerance; });
        errors.push_back(either == 0
                             ? 1.0
                             : static_cast<double>(static_cast<std::size_t>(far) + one_only) /
                                   static_cast<double>(either));
    }
    return errors;
}

}  // namespace ostraka
