// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ostraka/recognition/scan.hpp"

namespace ostraka {

/// What is below the table, where no object can be. Nothing if the scan shows no table.
class Ground {
  public:
    /// @param tolerance  of agreement, scan's unit: up to two of it below the table's plane counts
    ///                   as on it.
    Ground(const Scan& scan, double tolerance) {
        if (!scan.table) return;
        up_ = scan.table->normal.cast<float>();
        height_ = static_cast<float>(scan.table->offset - 2.0 * tolerance);
    }
    /// @param point  scene frame.
    bool covers(const Vec3f& point) const { return up_.dot(point) < height_; }
    /// Of a placed model's points, the share that it covers. @param points  model frame.
    double share(std::span<const Vec3f> points, const Pose& T_scene_model) const {
        if (points.empty()) return 0.0;
        const Vec3f up = T_scene_model.linear().cast<float>().transpose() * up_;
        const float height = height_ - up_.dot(Vec3f(T_scene_model.translation().cast<float>()));
        std::size_t covered = 0;
        for (const Vec3f& point : points) covered += up.dot(point) < height ? 1 : 0;
        return static_cast<double>(covered) / static_cast<double>(points.size());
    }

  private:
    Vec3f up_ = Vec3f::Zero();
    float height_ = 0.0F;
};

}  // namespace ostraka
