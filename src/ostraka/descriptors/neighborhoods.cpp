// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/neighborhoods.hpp"

#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/checks.hpp"

namespace ostraka {
namespace {

constexpr float kCellsPerRadius = 2.0F;

struct Columns {
    const float *x, *y, *z;
};

// Appends the positions in [first, end) whose points are closer than the radius to the list,
// without branches; columns may be read, and the list written, up to seven places further.
// @return the list's new length.
OSTRAKA_VECTOR_CLONES
std::size_t append_near(const Columns& points, std::size_t first, std::size_t end,
                        const Vec3f& center, float squared_radius, std::uint32_t* list,
                        std::size_t length) {
    const float cx = center.x();
    const float cy = center.y();
    const float cz = center.z();
    const Int8 lanes = {0, 1, 2, 3, 4, 5, 6, 7};
    for (std::size_t i = first; i < end; i += kVectorLanes) {
        Float8 x;
        Float8 y;
        Float8 z;
        load8(points.x + i, x);
        load8(points.y + i, y);
        load8(points.z + i, z);
        x -= cx;
        y -= cy;
        z -= cz;
        Int8 near = x * x + y * y + z * z < squared_radius;
        if (end - i < kVectorLanes) near &= lanes < static_cast<std::int32_t>(end - i);
        std::uint64_t pairs[4];
        std::memcpy(&pairs, &near, sizeof(pairs));
        if ((pairs[0] | pairs[1] | pairs[2] | pairs[3]) == 0) continue;
        for (std::size_t pair = 0; pair < 4; ++pair) {
            list[length] = static_cast<std::uint32_t>(i + 2 * pair);
            length += pairs[pair] & 1U;
            list[length] = static_cast<std::uint32_t>(i + 2 * pair + 1);
            length += pairs[pair] >> 63U;
        }
    }
    return length;
}

// Offsets of the listed points from the center, and their lengths.
OSTRAKA_VECTOR_CLONES
void copy_offsets(const Columns& points, const std::uint32_t* list, std::size_t count,
                  const Vec3f& center, float* x, float* y, float* z, float* distance) {
    const float cx = center.x();
    const float cy = center.y();
    const float cz = center.z();
    for (std::size_t i = 0; i < count; ++i) {
        x[i] = points.x[list[i]] - cx;
        y[i] = points.y[list[i]] - cy;
        z[i] = points.z[list[i]] - cz;
    }
    for (std::size_t i = 0; i < count; ++i) {
        distance[i] = std::sqrt(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
    }
}

std::vector<float> column(std::span<const Vec3f> vectors, std::span<const std::uint32_t> order,
                          int axis) {
    std::vector<float> result(order.size() + kVectorLanes);  // vectors may read beyond the end
    for (std::size_t i = 0; i < order.size(); ++i) result[i] = vectors[order[i]][axis];
    return result;
}

}  // namespace

void require_search(const PointCloud& cloud, std::span<const Vec3f> keypoints, float radius,
                    std::string_view descriptor) {
    check(cloud);
    if (!cloud.empty()) require_points(cloud, descriptor);
    if (!(radius > 0.0F) || !(radius <= kLargestCoordinate)) {
        throw InvalidInput(fmt::format("{}: radius {:g}, must be positive", descriptor, radius));
    }
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
        if (usable(keypoints[i])) continue;
        throw InvalidInput(fmt::format("{}: keypoint {} is not finite or too far", descriptor, i));
    }
}

Neighborhoods::Neighborhoods(const PointCloud& cloud, float radius, bool with_normals)
    : radius_(radius),
      order_(cloud.points, radius / kCellsPerRadius),
      x_(column(cloud.points, order_.order(), 0)),
      y_(column(cloud.points, order_.order(), 1)),
      z_(column(cloud.points, order_.order(), 2)) {
    if (!with_normals || cloud.normals.empty()) return;
    nx_ = column(cloud.normals, order_.order(), 0);
    ny_ = column(cloud.normals, order_.order(), 1);
    nz_ = column(cloud.normals, order_.order(), 2);
}

void Neighborhoods::find(const Vec3f& keypoint, Support& support) const {
    const Columns points{x_.data(), y_.data(), z_.data()};
    const float squared_radius = radius_ * radius_;
    std::size_t count = 0;
    order_.for_runs(keypoint, radius_, [&](std::size_t first, std::size_t end) {
        const std::size_t most = count + (end - first) + kVectorLanes;
        if (support.list.size() < most) support.list.resize(2 * most);
        count =
            append_near(points, first, end, keypoint, squared_radius, support.list.data(), count);
    });
    const bool with_normals = !nx_.empty();
    support.resize(count, with_normals);
    const std::uint32_t* list = support.list.data();
    copy_offsets(points, list, count, keypoint, support.x.data(), support.y.data(),
                 support.z.data(), support.distance.data());
    if (!with_normals) return;
    for (std::size_t i = 0; i < count; ++i) {
        support.nx[i] = nx_[list[i]];
        support.ny[i] = ny_[list[i]];
        support.nz[i] = nz_[list[i]];
    }
}

}  // namespace ostraka
