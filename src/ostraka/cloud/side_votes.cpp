// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/side_votes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kAxes = 16;         // each is looked along both ways
constexpr float kDepthTolerance = 0.75F;  // spacings before the tangent plane: noise and curvature
constexpr double kMostCells = 1024.0;     // along a side of a picture

// Half of a spiral over the sphere: evenly spread lines.
Vec3f axis_of(std::size_t number) {
    const double z = 1.0 - (static_cast<double>(number) + 0.5) / static_cast<double>(kAxes);
    const double turn = kPi * (3.0 - std::sqrt(5.0)) * static_cast<double>(number);
    const double rim = std::sqrt(1.0 - z * z);
    return Vec3d(rim * std::cos(turn), rim * std::sin(turn), z).cast<float>();
}

// The points as two cameras see them that face each other along an axis.
struct Picture {
    Vec3f axis;
    std::vector<std::uint32_t> cell;   // of each point
    std::vector<std::uint32_t> first;  // of each cell: the point farthest along the axis
    std::vector<std::uint32_t> last;   // of each cell: the point least far along it

    Picture(std::span<const Vec3f> points, const Vec3f& along, double side)
        : axis(along), cell(points.size()) {
        const Vec3f right = axis.unitOrthogonal();
        const Vec3f up = axis.cross(right);
        std::vector<Vec3f> seen(points.size());
        Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max());
        Vec3f high = -low;
        for (std::size_t i = 0; i < points.size(); ++i) {
            seen[i] = Vec3f(points[i].dot(right), points[i].dot(up), points[i].dot(axis));
            low = low.cwiseMin(seen[i]);
            high = high.cwiseMax(seen[i]);
        }
        const double extent = static_cast<double>((high - low).head<2>().maxCoeff());
        side = std::max(side, extent / kMostCells);
        const auto scale = static_cast<float>(1.0 / side);
        const auto columns = static_cast<std::uint32_t>((high.x() - low.x()) * scale) + 1;
        const auto rows = static_cast<std::uint32_t>((high.y() - low.y()) * scale) + 1;
        first.assign(std::size_t{columns} * rows, kNoIndex);
        last = first;
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            const auto x = static_cast<std::uint32_t>((seen[i].x() - low.x()) * scale);
            const auto y = static_cast<std::uint32_t>((seen[i].y() - low.y()) * scale);
            const std::uint32_t c = std::min(y, rows - 1) * columns + std::min(x, columns - 1);
            cell[i] = c;
            if (first[c] == kNoIndex || seen[i].z() > seen[first[c]].z()) first[c] = i;
            if (last[c] == kNoIndex || seen[i].z() < seen[last[c]].z()) last[c] = i;
        }
    }
};

void add_votes(const Picture& picture, std::span<const Vec3f> points,
               std::span<const Vec3f> normals, float tolerance, std::vector<SideVotes>& votes) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const float cosine = normals[i].dot(picture.axis);
        const float ahead = normals[i].dot(points[picture.first[picture.cell[i]]] - points[i]);
        const float behind = normals[i].dot(points[picture.last[picture.cell[i]]] - points[i]);
        // The side that faces a camera is that of the normal or the other one.
        const bool from_front = cosine > 0.0F ? ahead < tolerance : behind < tolerance;
        const bool from_back = cosine > 0.0F ? behind > -tolerance : ahead > -tolerance;
        if (from_front) votes[i].front += std::abs(cosine);
        if (from_back) votes[i].back += std::abs(cosine);
    }
}

}  // namespace

std::vector<SideVotes> vote_for_sides(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                                      double spacing) {
    constexpr double kCellSpacings = 2.4;  // a cell of a surface face on is empty once in 300
    constexpr std::size_t kAtOnce = 4;     // pictures in memory
    const auto tolerance = kDepthTolerance * static_cast<float>(spacing);
    std::array<std::vector<SideVotes>, kAtOnce> sums;
    parallel_for(kAtOnce, [&](std::size_t share) {
        sums[share].resize(points.size());
        for (std::size_t axis = share; axis < kAxes; axis += kAtOnce) {
            const Picture picture(points, axis_of(axis), kCellSpacings * spacing);
            add_votes(picture, points, normals, tolerance, sums[share]);
        }
    });
    for (std::size_t share = 1; share < kAtOnce; ++share) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            sums[0][i].front += sums[share][i].front;
            sums[0][i].back += sums[share][i].back;
        }
    }
    return std::move(sums[0]);
}

}  // namespace ostraka
