// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/point_blocks.hpp"

namespace ostraka {

PointBlocks::PointBlocks(std::span<const Vec3f> points) {
    for (std::size_t first = 0; first < points.size(); first += kPoints) {
        Box box{points[first], points[first]};
        for (const Vec3f& point : points.subspan(first, std::min(kPoints, points.size() - first))) {
            box.low = box.low.cwiseMin(point);
            box.high = box.high.cwiseMax(point);
        }
        boxes_.push_back(box);
    }
}

}  // namespace ostraka
