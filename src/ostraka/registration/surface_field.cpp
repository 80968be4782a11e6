// SPDX-License-Identifier: Apache-2.0
// Vector distance transform by sweeps: Danielsson. Euclidean Distance Mapping. 1980.
#include "ostraka/registration/surface_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

constexpr double kMaxCells = 2097152.0;
constexpr int kRounds = 2;  // the first reaches every cell, the second mends most of its errors

}  // namespace

SurfaceField::SurfaceField(const PointCloud& surface, double cell, double margin) {
    if (surface.empty() || surface.normals.size() != surface.size() || !(cell > 0.0)) {
        throw InvalidInput("surface field: needs points with normals and a positive cell");
    }
    elements_.reserve(surface.size());
    for (std::size_t i = 0; i < surface.size(); ++i) {
        elements_.push_back({surface.points[i], surface.normals[i]});
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
    // A flat surface has no volume, yet it may span too many cells.
    while (((extent / cell).array().floor() + 1.0).prod() > kMaxCells) cell *= 1.05;
    inverse_cell_ = static_cast<float>(1.0 / cell);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        size_[axis] = 1 + static_cast<int>(extent[static_cast<Eigen::Index>(axis)] / cell);
    }
    std::vector<float> squared;
    seed_cells(cell, squared);
    for (int round = 0; round < kRounds; ++round) sweep(cell, squared);
}

Vec3f SurfaceField::center(int x, int y, int z, double cell) const {
    return low_ + Vec3f(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F,
                        static_cast<float>(z) + 0.5F) *
                      static_cast<float>(cell);
}

// Cells that hold surface points know the one nearest to their centers.
void SurfaceField::seed_cells(double cell, std::vector<float>& squared) {
    nearest_.assign(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                        static_cast<std::size_t>(size_[2]),
                    kNoIndex);
    squared.assign(nearest_.size(), std::numeric_limits<float>::infinity());
    for (std::uint32_t i = 0; i < elements_.size(); ++i) {
        const Vec3f at = (elements_[i].point - low_) * inverse_cell_;
        const auto x = std::clamp(static_cast<int>(at.x()), 0, size_[0] - 1);
        const auto y = std::clamp(static_cast<int>(at.y()), 0, size_[1] - 1);
        const auto z = std::clamp(static_cast<int>(at.z()), 0, size_[2] - 1);
        offer(offset(x, y, z), i, center(x, y, z, cell), squared);
    }
}

// Each cell takes over a neighbor's point if it is nearer: forward along all axes, then back.
void SurfaceField::sweep(double cell, std::vector<float>& squared) {
    for (const int direction : {1, -1}) {
        const auto at = [&](int step, int axis) {
            return direction > 0 ? step : size_[static_cast<std::size_t>(axis)] - 1 - step;
        };
        for (int sz = 0; sz < size_[2]; ++sz) {
            for (int sy = 0; sy < size_[1]; ++sy) {
                sweep_row(at(sy, 1), at(sz, 2), direction, cell, squared);
            }
        }
    }
}

void SurfaceField::sweep_row(int y, int z, int direction, double cell,
                             std::vector<float>& squared) {
    const int back_y = y - direction;
    const int back_z = z - direction;
    const bool has_y = back_y >= 0 && back_y < size_[1];
    const bool has_z = back_z >= 0 && back_z < size_[2];
    for (int x = 0; x < size_[0]; ++x) {
        const Vec3f middle = center(x, y, z, cell);
        const std::size_t own = offset(x, y, z);
        if (x > 0) offer(own, nearest_[own - 1], middle, squared);
        if (has_y) offer(own, nearest_[offset(x, back_y, z)], middle, squared);
        if (has_z) offer(own, nearest_[offset(x, y, back_z)], middle, squared);
    }
    for (int x = size_[0] - 2; x >= 0; --x) {
        const std::size_t own = offset(x, y, z);
        offer(own, nearest_[own + 1], center(x, y, z, cell), squared);
    }
}

void SurfaceField::offer(std::size_t own, std::uint32_t other, const Vec3f& middle,
                         std::vector<float>& squared) {
    if (other == kNoIndex || other == nearest_[own]) return;
    const float distance = (elements_[other].point - middle).squaredNorm();
    if (distance < squared[own]) {
        squared[own] = distance;
        nearest_[own] = other;
    }
}

}  // namespace ostraka
