// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/metrics.hpp"

#include <cmath>
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

}  // namespace ostraka
