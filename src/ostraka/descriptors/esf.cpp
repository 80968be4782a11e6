// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/esf.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ostraka/base/random.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/exact_sum.hpp"
#include "ostraka/descriptors/fast_math.hpp"
#include "ostraka/descriptors/vector_clones.hpp"
#include "ostraka/descriptors/voxel_lines.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kBins = 64;
constexpr float kTopBin = 63.0F;
constexpr float kHalfGrid = 32.0F;
constexpr float kSmallestArea = 0.001F;  // squared area in voxels^4 below which PCL draws again
constexpr std::size_t kBlock = 256;
constexpr int kTriesPerSample =
    32;  // keeps the work bounded where nearly all triangles are slivers

// Ten histograms, in the row's order.
enum Block {
    angle_in,
    angle_out,
    angle_mixed,
    area_in,
    area_out,
    area_mixed,
    line_in,
    line_out,
    line_mixed,
    line_ratio
};
// PCL's weights of a vote; angles vote with traced lengths in units of 32 voxels.
constexpr std::array<float, 10> kWeights = {0.5F / 32, 0.5F / 32, 0.5F / 32, 0.5F, 0.5F,
                                            1.0F,      0.5F,      2.0F,      2.0F, 1.0F};

// The corners p, q, r of drawn triangles, and their measures.
struct Triangles {
    std::array<float, kBlock> px, py, pz, qx, qy, qz, rx, ry, rz;
    std::array<float, kBlock> pq, pr, qr, area;         // lengths; area is PCL's sqrt of the area
    std::array<std::int32_t, kBlock> at_p, at_q, at_r;  // bins of the angles
    std::array<std::int32_t, kBlock> wide;              // whether the triangle is no sliver
};

struct Samples {
    std::vector<float> lengths;            // 3 a triangle: pq, pr, qr
    std::vector<float> areas;              // 1 a triangle
    std::vector<std::int32_t> angle_bins;  // 3 a triangle, each opposite to the length
    std::vector<VoxelLine> lines;          // 3 a triangle, along the lengths
};

inline std::int32_t angle_bin(float twice_area, float dot) {
    constexpr float kScale = kTopBin / 1.57079632679F;
    const float bin = fast_atan2(twice_area, std::fabs(dot)) * kScale + 0.5F;
    return static_cast<std::int32_t>(bin < kTopBin ? bin : kTopBin);
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

// Three different indices below `count`, uniformly. @param count at least 3.
std::array<std::uint32_t, 3> draw_triple(Random& random, std::uint32_t count) {
    const auto draw = [&random](std::uint64_t below) {
        return static_cast<std::uint32_t>(random.bits() * below >> 32U);
    };
    const std::uint32_t p = draw(count);
    std::uint32_t q = draw(count - 1);
    if (q >= p) ++q;
    std::uint32_t r = draw(count - 2);
    if (r >= std::min(p, q)) ++r;
    if (r >= std::max(p, q)) ++r;
    return {p, q, r};
}

// The voxel of a coordinate in [-32, 32], as PCL rounds.
inline std::int32_t voxel_of(float coordinate) {
    const float voxel = coordinate < 0.0F ? std::floor(coordinate) + kHalfGrid
                                          : std::ceil(coordinate) + (kHalfGrid - 1.0F);
    return static_cast<std::int32_t>(std::clamp(voxel, 0.0F, kTopBin));
}

// A point in the grid's frame: centroid at 0, farthest point at distance 32.
struct GridPoint {
    Vec3f position;
    std::array<std::int32_t, 3> voxel;
};

std::vector<GridPoint> into_grid(const PointCloud& cloud) {
    const Vec3d center = exact_centroid(cloud.points);
    const double radius = largest_distance(cloud.points, center);
    if (!(radius > 0.0)) return {};
    const double scale = double{kHalfGrid} / radius;
    std::vector<GridPoint> points(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const Vec3f p = ((cloud.points[i].cast<double>() - center) * scale).cast<float>();
        points[i] = {p, {voxel_of(p.x()), voxel_of(p.y()), voxel_of(p.z())}};
    }
    return points;
}

void keep(const GridPoint& p, const GridPoint& q, const GridPoint& r, const Triangles& t,
          std::size_t i, Samples& samples) {
    samples.lengths.insert(samples.lengths.end(), {t.pq[i], t.pr[i], t.qr[i]});
    samples.areas.push_back(t.area[i]);
    samples.angle_bins.insert(samples.angle_bins.end(), {t.at_r[i], t.at_q[i], t.at_p[i]});
    samples.lines.push_back(voxel_line(p.voxel, q.voxel));
    samples.lines.push_back(voxel_line(p.voxel, r.voxel));
    samples.lines.push_back(voxel_line(q.voxel, r.voxel));
}

Samples draw_samples(std::span<const GridPoint> points, const EsfSettings& settings) {
    const auto wanted = static_cast<std::size_t>(settings.samples);
    Samples samples;
    samples.lengths.reserve(3 * wanted);
    samples.areas.reserve(wanted);
    samples.angle_bins.reserve(3 * wanted);
    samples.lines.reserve(3 * wanted);
    Random random(settings.seed);
    Triangles triangles;
    std::array<std::array<std::uint32_t, 3>, kBlock> drawn{};
    const std::size_t blocks = wanted * kTriesPerSample / kBlock + 1;
    for (std::size_t block = 0; block < blocks && samples.areas.size() < wanted; ++block) {
        if (block == 16 && samples.areas.empty()) break;  // a line or a point: no triangle at all
        for (std::size_t i = 0; i < kBlock; ++i) {
            drawn[i] = draw_triple(random, static_cast<std::uint32_t>(points.size()));
            const Vec3f& p = points[drawn[i][0]].position;
            const Vec3f& q = points[drawn[i][1]].position;
            const Vec3f& r = points[drawn[i][2]].position;
            triangles.px[i] = p.x();
            triangles.py[i] = p.y();
            triangles.pz[i] = p.z();
            triangles.qx[i] = q.x();
            triangles.qy[i] = q.y();
            triangles.qz[i] = q.z();
            triangles.rx[i] = r.x();
            triangles.ry[i] = r.y();
            triangles.rz[i] = r.z();
        }
        measure_block(triangles);
        for (std::size_t i = 0; i < kBlock && samples.areas.size() < wanted; ++i) {
            if (triangles.wide[i] == 0) continue;
            keep(points[drawn[i][0]], points[drawn[i][1]], points[drawn[i][2]], triangles, i,
                 samples);
        }
    }
    return samples;
}

using Histograms = std::array<std::array<std::uint32_t, kBins>, 10>;

std::size_t round_bin(float value) {
    return static_cast<std::size_t>(value * kTopBin + 0.5F);
}

// A line lies on the surface, off it, or partly on it.
void vote_line(float length, std::int32_t inside, std::int32_t visited, Histograms& votes) {
    if (inside >= visited - 1) {
        ++votes[line_in][round_bin(length)];
    } else if (inside <= 7) {
        ++votes[line_out][round_bin(length)];
    } else {
        ++votes[line_mixed][round_bin(length)];
        ++votes[line_ratio][round_bin(static_cast<float>(inside) / static_cast<float>(visited))];
    }
}

Histograms vote(const Samples& samples, std::span<const std::int32_t> inside) {
    float longest = 0.0F;
    float widest = 0.0F;
    for (const float length : samples.lengths) longest = std::max(longest, length);
    for (const float area : samples.areas) widest = std::max(widest, area);
    Histograms votes{};
    for (std::size_t i = 0; i < samples.areas.size(); ++i) {
        std::int32_t all_inside = 0;
        std::int32_t all_visited = 0;
        for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
            all_inside += inside[k];
            all_visited += samples.lines[k].length;
            vote_line(samples.lengths[k] / longest, inside[k], samples.lines[k].length, votes);
        }
        const std::size_t kind = all_inside <= 21 ? 1 : (all_visited - all_inside < 4 ? 0 : 2);
        ++votes[area_in + kind][round_bin(samples.areas[i] / widest)];
        for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
            votes[angle_in + kind][static_cast<std::size_t>(samples.angle_bins[k])] +=
                static_cast<std::uint32_t>(samples.lines[k].length);
        }
    }
    return votes;
}

}  // namespace

std::vector<float> describe_esf(const PointCloud& cloud, const EsfSettings& settings) {
    require_points(cloud, "esf");
    if (settings.samples < 1) {
        throw InvalidInput(fmt::format("esf: {} samples, at least 1 is needed", settings.samples));
    }
    std::vector<float> row(kEsfLength, 0.0F);
    const std::vector<GridPoint> points = into_grid(cloud);
    if (points.size() < 3) return row;
    VoxelGrid grid;
    for (const GridPoint& point : points) {
        grid.add_dilated(point.voxel[0], point.voxel[1], point.voxel[2]);
    }
    const Samples samples = draw_samples(points, settings);
    std::vector<std::int32_t> inside(samples.lines.size());
    trace_lines(grid, samples.lines, inside);
    const Histograms votes = vote(samples, inside);
    double sum = 0.0;
    for (std::size_t h = 0; h < votes.size(); ++h) {
        for (const std::uint32_t count : votes[h]) sum += double{kWeights[h]} * count;
    }
    if (!(sum > 0.0)) return row;
    for (std::size_t i = 0; i < kEsfLength; ++i) {
        row[i] =
            static_cast<float>(double{kWeights[i / kBins]} * votes[i / kBins][i % kBins] / sum);
    }
    return row;
}

}  // namespace ostraka
