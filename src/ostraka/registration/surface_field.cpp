// SPDX-License-Identifier: Apache-2.0
// Vector distance transform by sweeps: Danielsson. Euclidean Distance Mapping. 1980.
#include "ostraka/registration/surface_field.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

constexpr double kMaxCells = 2097152.0;
constexpr int kRounds = 2;  // the first reaches every cell, the second mends most of its errors

}  // namespace

SurfaceField::SurfaceField(const PointCloud& surface, double cell, double margin)
    : surface_(surface) {
    if (surface.empty() || surface.normals.size() != surface.size() || !(cell > 0.0)) {
        throw InvalidInput("surface field: needs points with normals and a positive cell");
    }
    Vec3f high = surface.points.front();
    low_ = high;
    for (const Vec3f& point : surface.points) {
        low_ = low_.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    const auto border = static_cast<float>(margin);
    low_.array() -= border;
    high.array() += border;
    const Vec3d extent = (high - low_).cast<double>();
    cell = std::max(cell, std::cbrt(extent.x() * extent.y() * extent.z() / kMaxCells));
    inverse_cell_ = static_cast<float>(1.0 / cell);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        size_[axis] = 1 + static_cast<int>(extent[static_cast<Eigen::Index>(axis)] / cell);
    }
    seed_cells(cell);
    for (int round = 0; round < kRounds; ++round) sweep(cell);
}

Vec3f SurfaceField::center(int x, int y, int z, double cell) const {
    return low_ + Vec3f(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F,
                        static_cast<float>(z) + 0.5F) *
                      static_cast<float>(cell);
}

// Cells that hold surface points know the one nearest to their centers.
void SurfaceField::seed_cells(double cell) {
    nearest_.assign(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                        static_cast<std::size_t>(size_[2]),
                    kNoIndex);
    for (std::uint32_t i = 0; i < surface_.size(); ++i) {
        const Vec3f at = (surface_.points[i] - low_) * inverse_cell_;
        const auto x = std::clamp(static_cast<int>(at.x()), 0, size_[0] - 1);
        const auto y = std::clamp(static_cast<int>(at.y()), 0, size_[1] - 1);
        const auto z = std::clamp(static_cast<int>(at.z()), 0, size_[2] - 1);
        offer(nearest_[offset(x, y, z)], i, center(x, y, z, cell));
    }
}

// Each cell takes over a neighbor's point if it is nearer: forward along all axes, then back.
void SurfaceField::sweep(double cell) {
    for (const int direction : {1, -1}) {
        const auto at = [&](int step, int axis) {
            return direction > 0 ? step : size_[static_cast<std::size_t>(axis)] - 1 - step;
        };
        for (int sz = 0; sz < size_[2]; ++sz) {
            for (int sy = 0; sy < size_[1]; ++sy) {
                sweep_row(at(sy, 1), at(sz, 2), direction, cell);
            }
        }
    }
}

void SurfaceField::sweep_row(int y, int z, int direction, double cell) {
    const int back_y = y - direction;
    const int back_z = z - direction;
    for (const int along : {1, -1}) {
        for (int step = 0; step < size_[0]; ++step) {
            const int x = along > 0 ? step : size_[0] - 1 - step;
            const Vec3f middle = center(x, y, z, cell);
            std::uint32_t& own = nearest_[offset(x, y, z)];
            if (step > 0) offer(own, nearest_[offset(x - along, y, z)], middle);
            if (back_y >= 0 && back_y < size_[1])
                offer(own, nearest_[offset(x, back_y, z)], middle);
            if (back_z >= 0 && back_z < size_[2])
                offer(own, nearest_[offset(x, y, back_z)], middle);
        }
    }
}

void SurfaceField::offer(std::uint32_t& own, std::uint32_t other, const Vec3f& middle) const {
    if (other == kNoIndex || other == own) return;
    const bool nearer = own == kNoIndex || (surface_.points[other] - middle).squaredNorm() <
                                               (surface_.points[own] - middle).squaredNorm();
    if (nearer) own = other;
}

}  // namespace ostraka
