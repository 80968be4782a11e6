// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/surfel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

// Beyond any point that is usable, and small enough that its square is finite.
constexpr float kFarAway = 1e18F;
// Measured on FPFH: finer cells have fewer points to look at, which pays for less than copying
// them more often costs: 3 cells take 7 % longer, 4 cells 20 %.
constexpr double kCellsPerRadius = 2.0;

struct Reach {
    float low_x, low_y, low_z, high_x, high_y, high_z, squared_radius;
};

// Writes the slots in [first, last) that are within reach to `slots`; returns how many.
OSTRAKA_VECTOR_CLONES
std::size_t select_within(const SurfelColumns& c, std::size_t first, std::size_t last,
                          const Reach& reach, std::uint32_t* slots) {
    constexpr std::size_t kBlock = 128;
    float squares[kBlock];
    std::size_t found = 0;
    for (std::size_t start = first; start < last; start += kBlock) {
        const std::size_t count = std::min(kBlock, last - start);
        const float* x = c.x.data() + start;
        const float* y = c.y.data() + start;
        const float* z = c.z.data() + start;
        for (std::size_t i = 0; i < count; ++i) {
            const float below_x = reach.low_x - x[i];
            const float below_y = reach.low_y - y[i];
            const float below_z = reach.low_z - z[i];
            const float above_x = x[i] - reach.high_x;
            const float above_y = y[i] - reach.high_y;
            const float above_z = z[i] - reach.high_z;
            const float out_x = below_x > above_x ? below_x : above_x;
            const float out_y = below_y > above_y ? below_y : above_y;
            const float out_z = below_z > above_z ? below_z : above_z;
            const float dx = out_x > 0.0F ? out_x : 0.0F;
            const float dy = out_y > 0.0F ? out_y : 0.0F;
            const float dz = out_z > 0.0F ? out_z : 0.0F;
            squares[i] = dx * dx + dy * dy + dz * dz;
        }
        for (std::size_t i = 0; i < count; ++i) {
            slots[found] = static_cast<std::uint32_t>(start + i);
            found += squares[i] < reach.squared_radius ? 1U : 0U;
        }
    }
    return found;
}

}  // namespace

void SurfelColumns::resize(std::size_t points) {
    count = points;
    const std::size_t padded = points + kVectorLanes - 1;
    if (x.size() >= padded) return;
    for (auto* column : {&x, &y, &z, &nx, &ny, &nz}) column->resize(padded);
    slot.resize(padded);
}

void SurfelColumns::pad() {
    for (std::size_t i = count; i < count + kVectorLanes - 1; ++i) {
        x[i] = y[i] = z[i] = kFarAway;
        nx[i] = ny[i] = nz[i] = 0.0F;
        slot[i] = 0;
    }
}

SurfelGrid::SurfelGrid(std::span<const Vec3f> points, std::span<const Vec3f> normals, float radius)
    : radius_(radius) {
    Vec3f low = Vec3f::Zero();
    Vec3f high = Vec3f::Zero();
    if (!points.empty()) low = high = points.front();
    for (const Vec3f& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    low_ = low.cast<double>();
    const Vec3d extent = high.cast<double>() - low_;
    // Few points in a wide box get larger cells, so that the table of cells stays small.
    const double most_cells = 8.0 * static_cast<double>(points.size()) + 4096.0;
    for (cell_ = double{radius} / kCellsPerRadius;; cell_ *= 1.25) {
        const Vec3d cells = (extent / cell_).array().floor() + 1.0;
        if (!(cells.prod() <= most_cells)) continue;
        dims_ = cells.cast<std::int64_t>();
        break;
    }
    sort_points(points, normals);
}

std::int64_t SurfelGrid::cell_along(int axis, double coordinate) const {
    const double cell = (coordinate - low_[axis]) / cell_;
    if (!(cell > 0.0)) return 0;
    const auto last = static_cast<double>(dims_[axis] - 1);
    return static_cast<std::int64_t>(std::min(cell, last));
}

void SurfelGrid::sort_points(std::span<const Vec3f> points, std::span<const Vec3f> normals) {
    const auto cells = static_cast<std::size_t>(dims_.prod());
    constexpr std::uint32_t kLeftOut = kNoIndex;
    std::vector<std::uint32_t> cell_of(points.size(), kLeftOut);
    starts_.assign(cells + 1, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!normals.empty() && !normals[i].allFinite()) continue;
        const std::int64_t x = cell_along(0, points[i].x());
        const std::int64_t y = cell_along(1, points[i].y());
        const std::int64_t z = cell_along(2, points[i].z());
        cell_of[i] = static_cast<std::uint32_t>((z * dims_[1] + y) * dims_[0] + x);
        ++starts_[cell_of[i] + 1];
    }
    for (std::size_t c = 0; c < cells; ++c) {
        if (starts_[c + 1] > 0) cells_.push_back(starts_[c]);
        starts_[c + 1] += starts_[c];
    }
    cells_.push_back(starts_[cells]);
    index_.resize(starts_[cells]);
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (cell_of[i] != kLeftOut) index_[next[cell_of[i]]++] = i;
    }
    const auto key = [&](std::uint32_t i) {
        const Vec3f& p = points[i];
        const Vec3f n = normals.empty() ? Vec3f(Vec3f::Zero()) : normals[i];
        return std::tuple(p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
    };
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
        return points[a].x() != points[b].x() ? points[a].x() < points[b].x() : key(a) < key(b);
    };
    for (std::size_t c = 0; c + 1 < cells_.size(); ++c) {
        std::sort(index_.begin() + cells_[c], index_.begin() + cells_[c + 1], before);
    }
    columns_.resize(index_.size());
    for (std::uint32_t s = 0; s < index_.size(); ++s) {
        const Vec3f& p = points[index_[s]];
        const Vec3f n = normals.empty() ? Vec3f(Vec3f::Zero()) : normals[index_[s]];
        columns_.x[s] = p.x();
        columns_.y[s] = p.y();
        columns_.z[s] = p.z();
        columns_.nx[s] = n.x();
        columns_.ny[s] = n.y();
        columns_.nz[s] = n.z();
        columns_.slot[s] = s;
    }
    columns_.pad();
}

void SurfelGrid::gather(std::size_t first, std::size_t last, SurfelColumns& found) const {
    Box box{Vec3f(columns_.x[first], columns_.y[first], columns_.z[first]), Vec3f::Zero()};
    box.high = box.low;
    for (std::size_t s = first + 1; s < last; ++s) {
        const Vec3f point(columns_.x[s], columns_.y[s], columns_.z[s]);
        box.low = box.low.cwiseMin(point);
        box.high = box.high.cwiseMax(point);
    }
    gather_box(box, radius_, found);
}

void SurfelGrid::gather(const Vec3f& center, SurfelColumns& found) const {
    gather_box({center, center}, radius_, found);
}

void SurfelGrid::gather(const Vec3f& center, float radius, SurfelColumns& found) const {
    gather_box({center, center}, radius, found);
}

void SurfelGrid::gather_box(const Box& box, float radius, SurfelColumns& found) const {
    found.resize(0);
    if (size() == 0) return;
    // A little wider than the radius, so that rounding can't lose a cell.
    const double reach = double{radius} * (1.0 + 1e-6);
    std::int64_t from[3];
    std::int64_t to[3];
    for (int axis = 0; axis < 3; ++axis) {
        from[axis] = cell_along(axis, double{box.low[axis]} - reach);
        to[axis] = cell_along(axis, double{box.high[axis]} + reach);
    }
    const Reach near{box.low.x(),  box.low.y(),  box.low.z(),    box.high.x(),
                     box.high.y(), box.high.z(), radius * radius};
    std::size_t count = 0;
    for (std::int64_t z = from[2]; z <= to[2]; ++z) {
        for (std::int64_t y = from[1]; y <= to[1]; ++y) {
            // Cells along x are consecutive, and so are their points.
            const std::int64_t row = (z * dims_[1] + y) * dims_[0];
            const std::uint32_t first = starts_[static_cast<std::size_t>(row + from[0])];
            const std::uint32_t last = starts_[static_cast<std::size_t>(row + to[0] + 1)];
            if (first == last) continue;
            if (found.slot.size() < count + (last - first))
                found.resize(2 * (count + last - first));
            count += select_within(columns_, first, last, near, found.slot.data() + count);
        }
    }
    found.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t s = found.slot[i];
        found.x[i] = columns_.x[s];
        found.y[i] = columns_.y[s];
        found.z[i] = columns_.z[s];
        found.nx[i] = columns_.nx[s];
        found.ny[i] = columns_.ny[s];
        found.nz[i] = columns_.nz[s];
    }
    found.pad();
}

}  // namespace ostraka
