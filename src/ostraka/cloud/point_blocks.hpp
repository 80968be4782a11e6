// SPDX-License-Identifier: Apache-2.0
// The points in a ball, in the cloud's own order: for clouds whose neighbors in space are mostly
// neighbors in order too, as resample() leaves them.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// The bounding boxes of runs of consecutive points.
class PointBlocks {
  public:
    PointBlocks() = default;
    /// @param points  finite.
    explicit PointBlocks(std::span<const Vec3f> points);

    /// Calls use(i) for each point closer than `radius`, ascending.
    /// @param points  those that the blocks were made of.
    template <class Use>
    void for_each_within(std::span<const Vec3f> points, const Vec3f& center, float radius,
                         const Use& use) const {
        const float limit = radius * radius;
        for (std::size_t b = 0; b < boxes_.size(); ++b) {
            const Vec3f beside = (boxes_[b].low - center).cwiseMax(center - boxes_[b].high);
            // A box is widened beyond what rounding does to a distance.
            if (beside.cwiseMax(0.0F).squaredNorm() > kWiden * limit) continue;
            const std::size_t end = std::min(points.size(), (b + 1) * kPoints);
            for (std::size_t i = b * kPoints; i < end; ++i) {
                if ((points[i] - center).squaredNorm() < limit) use(i);
            }
        }
    }

  private:
    static constexpr std::size_t kPoints = 32;
    static constexpr float kWiden = 1.0001F;
    struct Box {
        Vec3f low;
        Vec3f high;
    };
    std::vector<Box> boxes_;
};

}  // namespace ostraka
