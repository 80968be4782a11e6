// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/plane_fits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr float kFar = 1e18F;               // beyond any point; its square is finite
constexpr std::size_t kBlock = 128;         // moments that are solved together
constexpr double kLeastArea = 1e-7;         // below this share of the squared trace: a line
constexpr std::size_t kCellsAtATime = 256;  // of one thread

void copy8(const float* from, float* to) {
    std::memcpy(to, from, kVectorLanes * sizeof(float));
}

// All points that may be near those of one cell, as columns padded to whole vectors.
struct Candidates {
    std::vector<float> x, y, z;
    std::size_t count = 0;

    void append(const OrderedPoints& points, std::size_t first, std::size_t end) {
        const std::size_t more = end - first;
        if (x.size() < count + more + 2 * kVectorLanes) {
            for (auto* column : {&x, &y, &z}) column->resize(2 * (count + more + kVectorLanes));
        }
        // Runs are short: whole vectors, beyond the run's end, are faster than exact copies.
        for (std::size_t k = 0; k < more; k += kVectorLanes) {
            copy8(points.x.data() + first + k, x.data() + count + k);
            copy8(points.y.data() + first + k, y.data() + count + k);
            copy8(points.z.data() + first + k, z.data() + count + k);
        }
        count += more;
    }
    void pad() {
        std::fill_n(x.data() + count, kVectorLanes, kFar);
        std::fill_n(y.data() + count, kVectorLanes, kFar);
        std::fill_n(z.data() + count, kVectorLanes, kFar);
    }
};

// Sums over a neighborhood of offsets from its center: x y z, xx xy xz yy yz zz, and the count.
using Sums = std::array<float, 10>;

// Single precision is enough: offsets from the center itself, few and of like size.
OSTRAKA_VECTOR_CLONES
void sum_moments(const float* px, const float* py, const float* pz, std::size_t count,
                 const Vec3f& center, float squared_radius, Sums& sums) {
    std::array<Float8, 9> lanes{};
    Int8 inside{};
    for (std::size_t k = 0; k < count; k += kVectorLanes) {
        Float8 x;
        Float8 y;
        Float8 z;
        load8(px + k, x);
        load8(py + k, y);
        load8(pz + k, z);
        x -= center.x();
        y -= center.y();
        z -= center.z();
        const Int8 mask = x * x + y * y + z * z < squared_radius;
        inside -= mask;  // -1 where true
        x = mask ? x : Float8{};
        y = mask ? y : Float8{};
        z = mask ? z : Float8{};
        lanes[0] += x;
        lanes[1] += y;
        lanes[2] += z;
        lanes[3] += x * x;
        lanes[4] += x * y;
        lanes[5] += x * z;
        lanes[6] += y * y;
        lanes[7] += y * z;
        lanes[8] += z * z;
    }
    std::int32_t total = 0;
    for (std::size_t lane = 0; lane < kVectorLanes; ++lane) total += inside[lane];
    for (std::size_t s = 0; s < lanes.size(); ++s) {
        float sum = 0.0F;
        for (std::size_t lane = 0; lane < kVectorLanes; ++lane) sum += lanes[s][lane];
        sums[s] = sum;
    }
    sums[9] = static_cast<float>(total);
}

// Scatter matrices side by side, and the planes that come out.
struct Block {
    std::array<double, kBlock> xx, xy, xz, yy, yz, zz;
    std::array<double, kBlock> nx, ny, nz, variation;
};

// The least eigenvalue and its direction. Laguerre's method on the characteristic polynomial starts
// left of all roots, which are real, and so climbs to the first one without overshooting; also
// where roots are nearly equal it takes few steps.
OSTRAKA_VECTOR_CLONES
void solve_block(Block& b, std::size_t count) {
    constexpr int kSteps = 5;
    for (std::size_t i = 0; i < count; ++i) {
        const double trace = b.xx[i] + b.yy[i] + b.zz[i];
        const double scale = 1.0 / (trace > 0.0 ? trace : 1.0);
        const double xx = b.xx[i] * scale;
        const double xy = b.xy[i] * scale;
        const double xz = b.xz[i] * scale;
        const double yy = b.yy[i] * scale;
        const double yz = b.yz[i] * scale;
        const double zz = b.zz[i] * scale;
        const double minors = (xx * yy - xy * xy) + (xx * zz - xz * xz) + (yy * zz - yz * yz);
        const double determinant =
            xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
        double root = 0.0;
        for (int step = 0; step < kSteps; ++step) {
            const double value = ((root - 1.0) * root + minors) * root - determinant;
            const double slope = (3.0 * root - 2.0) * root + minors;
            const double bend = 6.0 * root - 2.0;
            const double square = 4.0 * slope * slope - 6.0 * value * bend;
            const double below = slope + std::sqrt(square > 0.0 ? square : 0.0);
            root -= 3.0 * value / (below > 1e-30 ? below : 1.0);
        }
        // Rows of A - root I span the plane: the longest of their cross products is the normal.
        const double ax = xx - root;
        const double by = yy - root;
        const double cz = zz - root;
        const double ux = xy * yz - xz * by;
        const double uy = xz * xy - ax * yz;
        const double uz = ax * by - xy * xy;
        const double vx = xy * cz - xz * yz;
        const double vy = xz * xz - ax * cz;
        const double vz = ax * yz - xy * xz;
        const double wx = by * cz - yz * yz;
        const double wy = yz * xz - xy * cz;
        const double wz = xy * yz - by * xz;
        const double uu = ux * ux + uy * uy + uz * uz;
        const double vv = vx * vx + vy * vy + vz * vz;
        const double ww = wx * wx + wy * wy + wz * wz;
        const bool v_longer = vv > uu;
        const double best = v_longer ? vv : uu;
        const double tx = v_longer ? vx : ux;
        const double ty = v_longer ? vy : uy;
        const double tz = v_longer ? vz : uz;
        const bool w_longest = ww > best;
        const double longest = w_longest ? ww : best;
        const double inverse = 1.0 / std::sqrt(longest > kLeastArea * kLeastArea ? longest : 1.0);
        const bool plane = longest > kLeastArea * kLeastArea;  // false for NaN
        const double none = std::numeric_limits<double>::quiet_NaN();
        b.nx[i] = plane ? (w_longest ? wx : tx) * inverse : none;
        b.ny[i] = plane ? (w_longest ? wy : ty) * inverse : none;
        b.nz[i] = plane ? (w_longest ? wz : tz) * inverse : none;
        b.variation[i] = root > 0.0 ? root : 0.0;
    }
}

void load_scatter(const Sums& sums, std::size_t k, Block& block) {
    const double count = sums[9];
    const double share = count >= 3.0 ? 1.0 / count : 0.0;  // too few: no scatter, so no plane
    const double x = sums[0] * share;
    const double y = sums[1] * share;
    const double z = sums[2] * share;
    block.xx[k] = sums[3] * share - x * x;
    block.xy[k] = sums[4] * share - x * y;
    block.xz[k] = sums[5] * share - x * z;
    block.yy[k] = sums[6] * share - y * y;
    block.yz[k] = sums[7] * share - y * z;
    block.zz[k] = sums[8] * share - z * z;
}

// The points that wait for their plane to be solved with others.
struct Pending {
    Block block;
    std::array<std::uint32_t, kBlock> index;
    std::size_t count = 0;

    void flush(PlaneFits& fits) {
        solve_block(block, count);
        for (std::size_t k = 0; k < count; ++k) {
            fits.normals[index[k]] = Vec3d(block.nx[k], block.ny[k], block.nz[k]).cast<float>();
            fits.variations[index[k]] = static_cast<float>(block.variation[k]);
        }
        count = 0;
    }
};

// The points around a cell's.
void gather(const OrderedPoints& points, std::size_t cell, float radius, Candidates& near) {
    const std::size_t first = points.cells.begin(cell);
    Vec3f low(points.x[first], points.y[first], points.z[first]);
    Vec3f high = low;
    for (std::size_t k = first + 1; k < points.cells.begin(cell + 1); ++k) {
        const Vec3f point(points.x[k], points.y[k], points.z[k]);
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    const Vec3f reach = Vec3f::Constant(radius * 1.000001F);
    near.count = 0;
    points.cells.for_runs(low - reach, high + reach,
                          [&](std::size_t from, std::size_t to) { near.append(points, from, to); });
    near.pad();
}

}  // namespace

OrderedPoints::OrderedPoints(std::span<const Vec3f> points, float cell) : cells(points, cell) {
    const std::size_t padded = points.size() + kVectorLanes;
    for (auto* column : {&x, &y, &z}) column->assign(padded, kFar);
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Vec3f& point = points[cells.order()[k]];
        x[k] = point.x();
        y[k] = point.y();
        z[k] = point.z();
    }
}

PlaneFits fit_planes(const OrderedPoints& points, float radius) {
    const CellOrder& cells = points.cells;
    PlaneFits fits;
    fits.normals.resize(cells.order().size());
    fits.variations.resize(cells.order().size());
    const std::size_t groups = (cells.cell_count() + kCellsAtATime - 1) / kCellsAtATime;
    parallel_for(groups, [&](std::size_t group) {
        Pending pending;
        Candidates near;
        const std::size_t end = std::min(cells.cell_count(), (group + 1) * kCellsAtATime);
        for (std::size_t c = group * kCellsAtATime; c < end; ++c) {
            if (cells.begin(c) == cells.begin(c + 1)) continue;
            gather(points, c, radius, near);
            for (std::size_t k = cells.begin(c); k < cells.begin(c + 1); ++k) {
                const Vec3f center(points.x[k], points.y[k], points.z[k]);
                Sums sums;
                sum_moments(near.x.data(), near.y.data(), near.z.data(), near.count, center,
                            radius * radius, sums);
                load_scatter(sums, pending.count, pending.block);
                pending.index[pending.count++] = cells.order()[k];
                if (pending.count == kBlock) pending.flush(fits);
            }
        }
        pending.flush(fits);
    });
    return fits;
}

}  // namespace ostraka
