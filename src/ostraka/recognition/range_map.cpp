// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/range_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

constexpr double kMaxCells = 4e6;  // beyond it cells are made larger
constexpr int kGapFillPasses = 2;
constexpr float kSteady = 0.9F;  // cosine between the normals of neighboring cells

constexpr std::size_t kBlock = 4096;  // points that a thread takes at a time

std::size_t blocks_of(std::size_t count) {
    return (count + kBlock - 1) / kBlock;
}

Mat3f rotation_to(const Vec3d& forward) {
    return Mat3d(Eigen::Quaterniond::FromTwoVectors(forward, Eigen::Vector3d::UnitZ())
                     .toRotationMatrix())
        .cast<float>();
}

}  // namespace

RangeMap::RangeMap(const PointCloud& raw, std::span<const float> wall_extents,
                   const PointCloud& resampled, double side)
    : viewpoint_(raw.viewpoint) {
    const std::vector<float> ranges = place_axis(raw);
    std::vector<float> sorted;
    for (const float range : ranges) {
        if (std::isfinite(range)) sorted.push_back(range);
    }
    if (sorted.empty()) return;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    if (!(*middle > 0.0F)) throw InvalidInput("the viewpoint lies on the scan");
    set_extent(raw, *middle, side);
    fill(raw, ranges, wall_extents);
    place_points(resampled);
    fill_gaps();
    // The angle of a cell in the map's middle.
    const CellRows rows{width_, height_, 2.0 / double{cells_per_radian_}};
    mark_shadows(cells_, rows, measure_baselines(cells_, rows));
    look_around(resampled);
}

// Turns the map toward the scan. Returns the points' distances; NaN of invalid ones.
std::vector<float> RangeMap::place_axis(const PointCloud& raw) {
    std::vector<float> ranges(raw.size(), std::numeric_limits<float>::quiet_NaN());
    std::vector<Vec3d> sums(blocks_of(raw.size()), Vec3d::Zero());
    parallel_for(sums.size(), [&](std::size_t block) {
        for (std::size_t i = block * kBlock; i < std::min(raw.size(), (block + 1) * kBlock); ++i) {
            if (!raw.points[i].allFinite()) continue;
            const Vec3f offset = raw.points[i] - viewpoint_;
            ranges[i] = offset.norm();
            if (ranges[i] > 0.0F) sums[block] += (offset / ranges[i]).cast<double>();
        }
    });
    Vec3d forward = Vec3d::Zero();
    for (const Vec3d& sum : sums) forward += sum;
    R_map_scene_ = rotation_to(forward.norm() > 0.0 ? forward.normalized() : Vec3d::UnitZ());
    return ranges;
}

void RangeMap::set_extent(const PointCloud& raw, float middle, double side) {
    // Of the projection, in units where the focal length is 1.
    struct Box {
        Vec2f low = Vec2f::Constant(1e9F);
        Vec2f high = Vec2f::Constant(-1e9F);
    };
    std::vector<Box> boxes(blocks_of(raw.size()));
    parallel_for(boxes.size(), [&](std::size_t block) {
        for (std::size_t i = block * kBlock; i < std::min(raw.size(), (block + 1) * kBlock); ++i) {
            if (!raw.points[i].allFinite()) continue;
            const Vec3f offset = R_map_scene_ * (raw.points[i] - viewpoint_);
            const float depth =
                std::max(offset.norm() + offset.z(), 0.02F * offset.norm() + 1e-12F);
            const Vec2f at = Vec2f(offset.x(), offset.y()) / depth;
            boxes[block].low = boxes[block].low.cwiseMin(at);
            boxes[block].high = boxes[block].high.cwiseMax(at);
        }
    });
    Box all;
    for (const Box& box : boxes) {
        all.low = all.low.cwiseMin(box.low);
        all.high = all.high.cwiseMax(box.high);
    }
    cells_per_radian_ = static_cast<float>(2.0 * double{middle} / side);
    const Vec2f extent = all.high - all.low;
    const double cells = double{extent.x()} * double{extent.y()} * double{cells_per_radian_} *
                         double{cells_per_radian_};
    if (cells > kMaxCells) cells_per_radian_ *= static_cast<float>(std::sqrt(kMaxCells / cells));
    constexpr float kBorder = 2.0F;
    low_u_ = all.low.x() * cells_per_radian_ - kBorder;
    low_v_ = all.low.y() * cells_per_radian_ - kBorder;
    width_ = static_cast<std::uint32_t>(extent.x() * cells_per_radian_ + 2.0F * kBorder) + 1;
    height_ = static_cast<std::uint32_t>(extent.y() * cells_per_radian_ + 2.0F * kBorder) + 1;
    cells_.resize(std::size_t{width_} * height_);
}

void RangeMap::fill(const PointCloud& raw, std::span<const float> ranges,
                    std::span<const float> wall_extents) {
    std::vector<std::uint32_t> places(raw.size(), kNoIndex);
    parallel_for(
        raw.size(),
        [&](std::size_t i) {
            if (std::isfinite(ranges[i])) places[i] = cell_of(raw.points[i]);
        },
        kBlock);
    for (std::size_t i = 0; i < raw.size(); ++i) {
        if (places[i] == kNoIndex) continue;
        RangeCell& cell = cells_[places[i]];
        cell.near = cell.measured() ? std::min(cell.near, ranges[i]) : ranges[i];
        cell.far = std::max(cell.far, ranges[i]);
        if (!wall_extents.empty()) cell.wall = std::max(cell.wall, wall_extents[i]);
    }
}

// Of several points in a cell it shows the nearest.
void RangeMap::place_points(const PointCloud& resampled) {
    for (std::uint32_t i = 0; i < resampled.size(); ++i) {
        const std::uint32_t index = cell_of(resampled.points[i]);
        if (index == kNoIndex) continue;
        RangeCell& cell = cells_[index];
        const float range = (resampled.points[i] - viewpoint_).norm();
        const bool closer =
            cell.point == kNoIndex || range < (resampled.points[cell.point] - viewpoint_).norm();
        if (closer) cell.point = i;
    }
}

// What a cell shows may as well be seen a cell beside it, as rays and points don't coincide.
void RangeMap::look_around(const PointCloud& resampled) {
    if (width_ < 3 || height_ < 3) return;
    parallel_for(height_ - 2, [&](std::size_t row) {
        const auto v = static_cast<std::uint32_t>(row) + 1;
        for (std::uint32_t u = 1; u + 1 < width_; ++u) look_around(resampled, u, v);
    });
}

void RangeMap::look_around(const PointCloud& resampled, std::uint32_t u, std::uint32_t v) {
    RangeCell& cell = cells_[v * width_ + u];
    cell.steady = cell.point != kNoIndex && !resampled.normals.empty();
    for (std::uint32_t n = 0; n < 9; ++n) {
        const RangeCell& other = cells_[(v + n / 3 - 1) * width_ + u + n % 3 - 1];
        if (other.measured()) {
            cell.nearest_around =
                cell.nearest_around > 0.0F ? std::min(cell.nearest_around, other.near) : other.near;
        }
        cell.steady = cell.steady && other.measured() && other.point != kNoIndex &&
                      resampled.normals[cell.point].dot(resampled.normals[other.point]) > kSteady;
    }
}

// Single empty cells between measured ones are sampling gaps, not free space; cells that no
// resampled point fell into borrow one from beside them.
void RangeMap::fill_gaps() {
    if (width_ < 3 || height_ < 3) return;
    for (int pass = 0; pass < kGapFillPasses; ++pass) {
        std::vector<RangeCell> filled = cells_;
        parallel_for(height_ - 2, [&](std::size_t row) {
            const auto v = static_cast<std::uint32_t>(row) + 1;
            for (std::uint32_t u = 1; u + 1 < width_; ++u) fill_gap(u, v, filled[v * width_ + u]);
        });
        cells_ = std::move(filled);
    }
}

void RangeMap::fill_gap(std::uint32_t u, std::uint32_t v, RangeCell& cell) const {
    if (cell.measured() && (cell.point != kNoIndex || cell.wall > 0.0F)) return;
    int measured = 0;
    float near = 0.0F;
    float far = 0.0F;
    std::uint32_t point = kNoIndex;
    for (std::uint32_t n = 0; n < 9; ++n) {
        const RangeCell& other = cells_[(v + n / 3 - 1) * width_ + u + n % 3 - 1];
        if (point == kNoIndex) point = other.point;
        if (!other.measured()) continue;
        ++measured;
        near = near > 0.0F ? std::min(near, other.near) : other.near;
        far = std::max(far, other.far);
    }
    if (!cell.measured() && measured >= 5) {
        cell.near = near;
        cell.far = far;
    }
    const bool may_borrow = cell.measured() && cell.wall == 0.0F;
    if (may_borrow && cell.point == kNoIndex) cell.point = point;
}

Vec3d RangeMap::direction(std::uint32_t cell) const {
    const double u = (double(cell % width_) + 0.5 + double{low_u_}) / double{cells_per_radian_};
    const double v = (double(cell / width_) + 0.5 + double{low_v_}) / double{cells_per_radian_};
    // Inverse of (x, y) / (1 + z) on the unit sphere.
    const double squared = u * u + v * v;
    const Vec3d local(2.0 * u / (1.0 + squared), 2.0 * v / (1.0 + squared),
                      (1.0 - squared) / (1.0 + squared));
    return R_map_scene_.cast<double>().transpose() * local;
}

std::vector<std::uint32_t> RangeMap::cells_around(const Vec3d& center, double radius) const {
    const Vec3d offset = R_map_scene_.cast<double>() * (center - viewpoint_.cast<double>());
    const double distance = offset.norm();
    const double angle = distance > radius ? std::asin(radius / distance) : kPi;
    const double tilt = std::acos(std::clamp(offset.z() / std::max(distance, 1e-300), -1.0, 1.0));
    Vec2d low(-1e9, -1e9);
    Vec2d high(1e9, 1e9);
    if (tilt + angle < 0.9 * kPi) {
        // A circle of directions projects to a circle: its ends lie on the line through the middle.
        const double inner = std::tan((tilt - angle) / 2.0);
        const double outer = std::tan((tilt + angle) / 2.0);
        Vec2d axis(offset.x(), offset.y());
        axis = axis.norm() > 0.0 ? Vec2d(axis.normalized()) : Vec2d(1.0, 0.0);
        const double scale = double{cells_per_radian_};
        const Vec2d middle = scale * (inner + outer) / 2.0 * axis;
        const double extent = scale * (outer - inner) / 2.0 + 1.0;
        const Vec2d origin(double{low_u_}, double{low_v_});
        low = middle - origin - Vec2d::Constant(extent);
        high = middle - origin + Vec2d::Constant(extent);
    }
    const auto clamped = [](double value, std::uint32_t size) {
        return static_cast<std::uint32_t>(std::clamp(value, 0.0, static_cast<double>(size)));
    };
    std::vector<std::uint32_t> cells;
    for (std::uint32_t v = clamped(low.y(), height_); v < clamped(high.y() + 1.0, height_); ++v) {
        for (std::uint32_t u = clamped(low.x(), width_); u < clamped(high.x() + 1.0, width_); ++u) {
            cells.push_back(v * width_ + u);
        }
    }
    return cells;
}

}  // namespace ostraka
