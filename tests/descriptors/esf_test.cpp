// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/esf.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <numeric>

#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/descriptors/esf_samples.hpp"
#include "ostraka/descriptors/voxel_lines.hpp"

namespace ostraka {
namespace {

TEST(Esf, RowSumsToOne) {
    const auto row = describe_esf(shapes::bumpy_ellipsoid(500));
    EXPECT_NEAR(std::accumulate(row.begin(), row.end(), 0.0), 1.0, 1e-5);
}

TEST(Esf, SeedDecidesTheRow) {
    const PointCloud cloud = shapes::cut_torus(800);
    const auto row = describe_esf(cloud, {.seed = 7});
    EXPECT_EQ(describe_esf(cloud, {.seed = 7}), row);
    const auto other = describe_esf(cloud, {.seed = 8});
    EXPECT_NE(other, row);
    EXPECT_LE(shapes::relative_l1(other, row), 0.15);
}

TEST(Esf, MoreSamplesGiveLessNoise) {
    const PointCloud cloud = shapes::notched_box(800);
    const auto noise = [&](int samples) {
        double sum = 0.0;
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            sum += shapes::relative_l1(
                describe_esf(cloud, {.samples = samples, .seed = 2 * seed}),
                describe_esf(cloud, {.samples = samples, .seed = 2 * seed + 1}));
        }
        return sum;
    };
    EXPECT_NEAR(noise(5'000) / noise(80'000), 4.0, 1.0);  // 1 / sqrt(samples)
}

TEST(Esf, EquilateralTriangleVotesForSixtyDegrees) {
    PointCloud cloud;
    cloud.points = {{1.0F, 0.0F, 0.0F}, {-0.5F, 0.8660254F, 0.0F}, {-0.5F, -0.8660254F, 0.0F}};
    const auto row = describe_esf(cloud);
    // 60 of 90 degrees is 42 of 63, in one of the three angle blocks; nothing else is voted for.
    double at_sixty = 0.0;
    double angles = 0.0;
    for (std::size_t i = 0; i < 192; ++i) {
        angles += row[i];
        if (i % 64 == 42) at_sixty += row[i];
    }
    EXPECT_GT(angles, 0.0);
    EXPECT_EQ(at_sixty, angles);
    // All distances are the largest one.
    double distances = 0.0;
    for (std::size_t i = 384; i < 576; ++i) distances += row[i];
    EXPECT_NEAR(row[384 + 63] + row[448 + 63] + row[512 + 63], distances, 1e-6);
}

TEST(Esf, CloudsWithoutTrianglesGiveZeros) {
    PointCloud line;
    for (int i = 0; i < 100; ++i) line.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    EXPECT_EQ(describe_esf(line), std::vector<float>(kEsfLength, 0.0F));
    line.points.resize(2);
    EXPECT_EQ(describe_esf(line), std::vector<float>(kEsfLength, 0.0F));
}

TEST(Esf, SettingsOutOfRangeAreRejected) {
    EXPECT_THROW(describe_esf(shapes::cut_torus(10), {.samples = 0}), InvalidInput);
}

TEST(EsfSamples, TriplesAreOfDifferentPointsAndAllPairsAreEquallyLikely) {
    // Distances 1 to 6 between four points on a line (a Golomb ruler), a little off it.
    std::vector<EsfPoint> points;
    for (const float x : {0.0F, 1.0F, 4.0F, 6.0F}) {
        points.push_back({x, 0.02F * x * (6.0F - x) + 0.01F * x, 0.0F, pack_voxel(0, 0, 0)});
    }
    EsfSamples samples;
    draw_esf_samples(points, {.samples = 40'000, .seed = 3}, samples);
    ASSERT_EQ(samples.count, 40'000U);
    for (const auto& lengths : samples.length) {
        std::array<int, 7> count{};
        for (std::size_t i = 0; i < samples.count; ++i) {
            ++count[static_cast<std::size_t>(lengths[i] + 0.5F)];
        }
        EXPECT_EQ(count[0], 0);  // no point twice
        for (std::size_t d = 1; d < 7; ++d) {
            EXPECT_NEAR(count[d], 40'000.0 / 6.0, 6.0 * std::sqrt(40'000.0 / 6.0)) << d;
        }
    }
}

TEST(EsfSamples, MemoryIsUsedAgainWithoutATrace) {
    const std::vector<EsfPoint> large = into_esf_grid(shapes::cut_torus(900));
    const std::vector<EsfPoint> small = into_esf_grid(shapes::bumpy_ellipsoid(50));
    EsfSamples fresh;
    draw_esf_samples(small, {.samples = 3'000}, fresh);
    EsfSamples used;
    draw_esf_samples(large, {.samples = 5'000}, used);
    draw_esf_samples(small, {.samples = 3'000}, used);
    EXPECT_EQ(used.count, fresh.count);
    EXPECT_EQ(used.longest, fresh.longest);
    EXPECT_EQ(used.widest, fresh.widest);
    for (std::size_t side = 0; side < 3; ++side) {
        EXPECT_TRUE(std::equal(fresh.inside[side].begin(), fresh.inside[side].begin() + 3'000,
                               used.inside[side].begin()));
    }
}

// Bresenham's line as it is usually written, one voxel after another.
std::vector<std::array<int, 3>> plain_line(std::array<int, 3> at, const std::array<int, 3>& to) {
    std::array<int, 3> difference{};
    std::array<int, 3> step{};
    for (std::size_t k = 0; k < 3; ++k) {
        difference[k] = std::abs(to[k] - at[k]);
        step[k] = to[k] < at[k] ? -1 : 1;
    }
    std::size_t main = 2;
    if (difference[1] >= difference[0] && difference[1] >= difference[2]) main = 1;
    if (difference[0] >= difference[1] && difference[0] >= difference[2]) main = 0;
    const int length = difference[main];
    std::array<int, 3> error{};
    for (std::size_t k = 0; k < 3; ++k) error[k] = 2 * difference[k] - length;
    std::vector<std::array<int, 3>> voxels = {at};
    for (int i = 1; i < length; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (k == main) continue;
            if (error[k] > 0) {
                at[k] += step[k];
                error[k] -= 2 * length;
            }
            error[k] += 2 * difference[k];
        }
        at[main] += step[main];
        voxels.push_back(at);
    }
    return voxels;
}

std::uint32_t pack(const std::array<int, 3>& v) {
    return pack_voxel(static_cast<std::uint32_t>(v[0]), static_cast<std::uint32_t>(v[1]),
                      static_cast<std::uint32_t>(v[2]));
}

TEST(VoxelLines, VisitTheVoxelsOfBresenhamsLine) {
    Random random(5);
    VoxelGrid grid;
    std::vector<std::array<int, 3>> centers;
    const auto draw = [&random] { return static_cast<int>(random.below(64)); };
    for (int i = 0; i < 3'000; ++i) {
        centers.push_back({draw(), draw(), draw()});
        grid.set(pack(centers.back()));
    }
    grid.dilate();
    std::vector<bool> set(64 * 64 * 64, false);
    for (const auto& c : centers) {
        for (int x = std::max(c[0] - 1, 0); x <= std::min(c[0] + 1, 63); ++x) {
            for (int y = std::max(c[1] - 1, 0); y <= std::min(c[1] + 1, 63); ++y) {
                for (int z = std::max(c[2] - 1, 0); z <= std::min(c[2] + 1, 63); ++z) {
                    set[static_cast<std::size_t>((x * 64 + y) * 64 + z)] = true;
                }
            }
        }
    }
    std::vector<std::uint32_t> from_voxels;
    std::vector<std::uint32_t> to_voxels;
    std::vector<std::vector<std::array<int, 3>>> expected;
    for (int i = 0; i < 200'000; ++i) {
        const std::array<int, 3> from = {draw(), draw(), draw()};
        std::array<int, 3> to = {draw(), draw(), draw()};
        if (i % 7 == 0) to[1] = from[1];
        if (i % 11 == 0) to[2] = from[2];
        from_voxels.push_back(pack(from));
        to_voxels.push_back(pack(to));
        expected.push_back(plain_line(from, to));
    }
    from_voxels.push_back(pack({5, 6, 7}));
    to_voxels.push_back(pack({5, 6, 7}));
    expected.push_back(plain_line({5, 6, 7}, {5, 6, 7}));
    std::vector<std::uint8_t> visited(expected.size());
    std::vector<std::uint8_t> inside(expected.size());
    trace_lines(grid, from_voxels, to_voxels, visited, inside);
    std::size_t different = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        std::int32_t count = 0;
        for (const auto& v : expected[i]) {
            if (set[static_cast<std::size_t>((v[0] * 64 + v[1]) * 64 + v[2])]) ++count;
        }
        const bool same = inside[i] == count && visited[i] == expected[i].size();
        if (!same) ++different;
    }
    EXPECT_EQ(different, 0U);
}

}  // namespace
}  // namespace ostraka
