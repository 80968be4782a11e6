// SPDX-License-Identifier: Apache-2.0
// Random numbers are a hash of the seed and a counter, so that they are computed side by side:
// Wellons. Prospecting for Hash Functions ("lowbias32"). 2018.
#include "ostraka/descriptors/esf_samples.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/exact_sum.hpp"
#include "ostraka/descriptors/fast_math.hpp"
#include "ostraka/descriptors/voxel_lines.hpp"

namespace ostraka {
namespace {

constexpr float kTopBin = 63.0F;
constexpr float kHalfGrid = 32.0F;
constexpr float kSmallestArea = 0.001F;      // squared area in voxels^4 below which PCL draws again
constexpr std::size_t kBlock = 512;          // triangles handled together
constexpr std::size_t kTriesPerSample = 32;  // bounds the work where nearly all are slivers

using Floats = std::array<float, kBlock>;
using Words = std::array<std::uint32_t, kBlock>;

// The corners p, q, r of drawn triangles, and their measures.
struct Triangles {
    std::array<Words, 3> drawn;  // point indices
    Floats px, py, pz, qx, qy, qz, rx, ry, rz;
    Floats pq, pr, qr, area;  // lengths; area is PCL's sqrt of the area
    Words at_p, at_q, at_r;   // bins of the angles
    Words wide;               // 1 if the triangle is no sliver
    Words p_voxel, q_voxel, r_voxel;
};

inline std::uint32_t hash(std::uint32_t x) {
    x = (x ^ x >> 16U) * 0x7feb352dU;
    x = (x ^ x >> 15U) * 0x846ca68bU;
    return x ^ x >> 16U;
}

inline std::uint32_t below(std::uint32_t bits, std::uint32_t count) {
    return static_cast<std::uint32_t>(std::uint64_t{bits} * count >> 32U);
}

// Three different indices below `count` for each triangle, uniformly. @param count at least 3.
OSTRAKA_VECTOR_CLONES
void draw(std::uint64_t seed, std::uint32_t first, std::uint32_t count, Triangles& t) {
    const auto low = static_cast<std::uint32_t>(seed);
    const auto high = static_cast<std::uint32_t>(seed >> 32U);
    for (std::size_t i = 0; i < kBlock; ++i) {
        const std::uint32_t counter = 3 * (first + static_cast<std::uint32_t>(i));
        const std::uint32_t p = below(hash(hash(counter ^ low) + high), count);
        const std::uint32_t q_draw = below(hash(hash((counter + 1) ^ low) + high), count - 1);
        const std::uint32_t r_draw = below(hash(hash((counter + 2) ^ low) + high), count - 2);
        const std::uint32_t q = q_draw + (q_draw >= p ? 1U : 0U);
        const std::uint32_t lower = p < q ? p : q;
        const std::uint32_t upper = p < q ? q : p;
        const std::uint32_t r = r_draw + (r_draw >= lower ? 1U : 0U);
        t.drawn[0][i] = p;
        t.drawn[1][i] = q;
        t.drawn[2][i] = r + (r >= upper ? 1U : 0U);
    }
}

void fetch(const std::vector<EsfPoint>& points, Triangles& t) {
    for (std::size_t i = 0; i < kBlock; ++i) {
        const EsfPoint& p = points[t.drawn[0][i]];
        const EsfPoint& q = points[t.drawn[1][i]];
        const EsfPoint& r = points[t.drawn[2][i]];
        t.px[i] = p.x;
        t.py[i] = p.y;
        t.pz[i] = p.z;
        t.p_voxel[i] = p.voxel;
        t.qx[i] = q.x;
        t.qy[i] = q.y;
        t.qz[i] = q.z;
        t.q_voxel[i] = q.voxel;
        t.rx[i] = r.x;
        t.ry[i] = r.y;
        t.rz[i] = r.z;
        t.r_voxel[i] = r.voxel;
    }
}

inline std::uint32_t angle_bin(float twice_area, float dot) {
    constexpr float kScale = kTopBin / 1.57079632679F;
    const float bin = fast_atan2(twice_area, std::fabs(dot)) * kScale + 0.5F;
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(bin < kTopBin ? bin : kTopBin));
}

OSTRAKA_VECTOR_CLONES
void measure_block(Triangles& t) {
    for (std::size_t i = 0; i < kBlock; ++i) {
        const float ax = t.qx[i] - t.px[i];
        const float ay = t.qy[i] - t.py[i];
        const float az = t.qz[i] - t.pz[i];
        const float bx = t.rx[i] - t.px[i];
        const float by = t.ry[i] - t.py[i];
        const float bz = t.rz[i] - t.pz[i];
        const float cx = t.qx[i] - t.rx[i];
        const float cy = t.qy[i] - t.ry[i];
        const float cz = t.qz[i] - t.rz[i];
        const float a = std::sqrt(ax * ax + ay * ay + az * az);
        const float b = std::sqrt(bx * bx + by * by + bz * bz);
        const float c = std::sqrt(cx * cx + cy * cy + cz * cz);
        const float nx = ay * bz - az * by;
        const float ny = az * bx - ax * bz;
        const float nz = ax * by - ay * bx;
        const float squared_area = 0.25F * (nx * nx + ny * ny + nz * nz);
        const bool wide = squared_area > kSmallestArea;
        const float area = std::sqrt(wide ? squared_area : 0.0F);
        t.pq[i] = a;
        t.pr[i] = b;
        t.qr[i] = c;
        t.area[i] = std::sqrt(area);
        t.at_p[i] = angle_bin(2.0F * area, ax * bx + ay * by + az * bz);
        t.at_r[i] = angle_bin(2.0F * area, cx * bx + cy * by + cz * bz);
        t.at_q[i] = angle_bin(2.0F * area, cx * ax + cy * ay + cz * az);
        t.wide[i] = wide ? 1 : 0;
    }
}

// Moves the triangles that are no slivers to the front. @return how many there are.
std::size_t compact(Triangles& t) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < kBlock; ++i) kept += t.wide[i];
    if (kept == kBlock) return kept;
    kept = 0;
    for (std::size_t i = 0; i < kBlock; ++i) {
        for (Floats* column : {&t.pq, &t.pr, &t.qr, &t.area}) (*column)[kept] = (*column)[i];
        for (Words* column : {&t.at_p, &t.at_q, &t.at_r, &t.p_voxel, &t.q_voxel, &t.r_voxel}) {
            (*column)[kept] = (*column)[i];
        }
        kept += t.wide[i];
    }
    return kept;
}

void append(const Triangles& t, std::size_t count, const VoxelGrid& grid, EsfSamples& samples) {
    const std::array<const Floats*, 3> lengths = {&t.pq, &t.pr, &t.qr};
    const std::array<const Words*, 3> angles = {&t.at_r, &t.at_q, &t.at_p};
    const std::array<const Words*, 3> starts = {&t.p_voxel, &t.p_voxel, &t.q_voxel};
    const std::array<const Words*, 3> ends = {&t.q_voxel, &t.r_voxel, &t.r_voxel};
    std::array<std::uint32_t, 3 * kBlock> from;
    std::array<std::uint32_t, 3 * kBlock> to;
    std::array<std::uint8_t, 3 * kBlock> visited;
    std::array<std::uint8_t, 3 * kBlock> inside;
    for (std::size_t side = 0; side < 3; ++side) {
        std::copy_n(starts[side]->data(), count, from.data() + side * count);
        std::copy_n(ends[side]->data(), count, to.data() + side * count);
    }
    const std::size_t lines = 3 * count;
    trace_lines(grid, {from.data(), lines}, {to.data(), lines}, {visited.data(), lines},
                {inside.data(), lines});
    const std::size_t first = samples.count;
    std::copy_n(t.area.data(), count, samples.area.data() + first);
    for (std::size_t side = 0; side < 3; ++side) {
        std::copy_n(lengths[side]->data(), count, samples.length[side].data() + first);
        std::copy_n(visited.data() + side * count, count, samples.visited[side].data() + first);
        std::copy_n(inside.data() + side * count, count, samples.inside[side].data() + first);
        const std::uint32_t* bins = angles[side]->data();
        std::uint8_t* small = samples.angle[side].data() + first;
        for (std::size_t i = 0; i < count; ++i) small[i] = static_cast<std::uint8_t>(bins[i]);
    }
    samples.count += count;
}

OSTRAKA_VECTOR_CLONES
float largest(const float* values, std::size_t count) {
    Float8 lanes = {};
    std::size_t i = 0;
    for (; i + kVectorLanes <= count; i += kVectorLanes) {
        Float8 value;
        load8(values + i, value);
        lanes = value > lanes ? value : lanes;
    }
    float result = 0.0F;
    for (std::size_t lane = 0; lane < kVectorLanes; ++lane) {
        result = std::max<float>(result, lanes[lane]);
    }
    for (; i < count; ++i) result = std::max(result, values[i]);
    return result;
}

// The voxel of a coordinate in [-32, 32], as PCL rounds: away from 0, and 0 up.
inline std::uint32_t voxel_of(float coordinate) {
    const auto whole = static_cast<std::int32_t>(coordinate);  // toward 0
    const auto shortened = static_cast<float>(whole);
    const std::int32_t below = whole + 32 - (shortened > coordinate ? 1 : 0);
    const std::int32_t above = whole + 31 + (shortened < coordinate ? 1 : 0);
    const std::int32_t voxel = coordinate < 0.0F ? below : above;
    const std::int32_t low = voxel > 0 ? voxel : 0;
    return static_cast<std::uint32_t>(low < 63 ? low : 63);
}

OSTRAKA_VECTOR_CLONES
void into_grid(const float* xyz, std::size_t count, const Vec3d& center, double scale,
               EsfPoint* points) {
    const double cx = center.x();
    const double cy = center.y();
    const double cz = center.z();
    for (std::size_t i = 0; i < count; ++i) {
        const auto x = static_cast<float>((xyz[3 * i] - cx) * scale);
        const auto y = static_cast<float>((xyz[3 * i + 1] - cy) * scale);
        const auto z = static_cast<float>((xyz[3 * i + 2] - cz) * scale);
        points[i] = {x, y, z, pack_voxel(voxel_of(x), voxel_of(y), voxel_of(z))};
    }
}

}  // namespace

std::vector<EsfPoint> into_esf_grid(const PointCloud& cloud) {
    const Vec3d center = exact_centroid(cloud.points);
    const double radius = largest_distance(cloud.points, center);
    if (!(radius > 0.0)) return {};
    std::vector<EsfPoint> points(cloud.size());
    into_grid(cloud.points.front().data(), cloud.size(), center, double{kHalfGrid} / radius,
              points.data());
    return points;
}

void EsfSamples::reset(std::size_t capacity) {
    count = 0;
    longest = 0.0F;
    widest = 0.0F;
    if (area.size() >= capacity) return;
    area.resize(capacity);
    for (auto& column : length) column.resize(capacity);
    for (auto* columns : {&angle, &visited, &inside}) {
        for (auto& column : *columns) column.resize(capacity);
    }
}

void draw_esf_samples(const std::vector<EsfPoint>& points, const EsfSettings& settings,
                      EsfSamples& samples) {
    const auto wanted = static_cast<std::size_t>(settings.samples);
    samples.reset(wanted);
    VoxelGrid grid;
    for (const EsfPoint& point : points) grid.set(point.voxel);
    grid.dilate();
    Triangles triangles;
    const std::size_t blocks = wanted * kTriesPerSample / kBlock + 1;
    for (std::size_t block = 0; block < blocks && samples.count < wanted; ++block) {
        if (block == 16 && samples.count == 0) break;  // a line or a point: no triangle at all
        draw(settings.seed, static_cast<std::uint32_t>(block * kBlock),
             static_cast<std::uint32_t>(points.size()), triangles);
        fetch(points, triangles);
        measure_block(triangles);
        const std::size_t kept = std::min(compact(triangles), wanted - samples.count);
        append(triangles, kept, grid, samples);
    }
    for (const auto& column : samples.length) {
        samples.longest = std::max(samples.longest, largest(column.data(), samples.count));
    }
    samples.widest = largest(samples.area.data(), samples.count);
}

}  // namespace ostraka
