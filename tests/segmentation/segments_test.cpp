// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/segments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"
#include "segmentation/depth_scans.hpp"
#include "segmentation/partitions.hpp"

namespace ostraka {
namespace {

using test_scans::box;
using test_scans::scan;

const SegmentationSettings kUnit{.patches = {.sampling = 1.0}};

// A box on a box, a ball on a third box, apart from each other.
const test_scans::Scan& heap() {
    static const test_scans::Scan seen =
        scan({box({15, 12, 8}, {-25, 0, 8}, 0.3), box({8, 8, 8}, {-24, 0, 24}, 0.8),
              box({12, 12, 8}, {20, 0, 8}, 0.2), test_scans::ball(9, {22, 2, 24})},
             {120, 140, 180}, 0.2);
    return seen;
}

std::vector<Segment> all_segments(const SegmentationSettings& settings = kUnit) {
    return segment_hierarchy(heap().cloud, test_scans::all_of(heap().cloud.size()), settings);
}

std::vector<std::uint32_t> common(const Segment& a, const Segment& b) {
    std::vector<std::uint32_t> both;
    std::set_intersection(a.indices.begin(), a.indices.end(), b.indices.begin(), b.indices.end(),
                          std::back_inserter(both));
    return both;
}

TEST(SegmentHierarchy, HoldsEveryObjectAndEveryPile) {
    const std::vector<Segment> segments = all_segments();
    std::vector<std::vector<std::uint32_t>> sets;
    for (const Segment& segment : segments) sets.push_back(segment.indices);
    for (std::uint32_t s = 0; s < 4; ++s) {
        EXPECT_GT(test_scans::best_agreement(heap(), s, sets), 0.9) << s;
    }
    const Segment& pile = segments.front();
    EXPECT_EQ(pile.kind, SegmentKind::cluster);
    EXPECT_TRUE(std::all_of(pile.indices.begin(), pile.indices.end(),
                            [](std::uint32_t i) { return heap().solid[i] < 2; }));
}

TEST(SegmentHierarchy, IsAForestFromCoarseToFine) {
    const std::vector<Segment> segments = all_segments();
    std::array<int, 5> of_kind{};
    for (std::size_t s = 0; s < segments.size(); ++s) {
        const Segment& segment = segments[s];
        ++of_kind.at(static_cast<std::size_t>(segment.kind));
        EXPECT_TRUE(std::is_sorted(segment.indices.begin(), segment.indices.end()));
        EXPECT_GE(segment.indices.size(), kUnit.min_points);
        if (s > 0) {
            EXPECT_GE(segment.kind, segments[s - 1].kind);
            if (segment.kind == segments[s - 1].kind) {
                EXPECT_LE(segment.indices.size(), segments[s - 1].indices.size());
            }
        }
        if (segment.kind == SegmentKind::cluster) {
            EXPECT_EQ(segment.parent, kNoIndex);
            continue;
        }
        ASSERT_LT(segment.parent, s);
        const Segment& parent = segments[segment.parent];
        EXPECT_LT(parent.kind, segment.kind);
        EXPECT_NE(parent.kind, SegmentKind::joined);
        const std::size_t held = common(parent, segment).size();
        if (segment.kind == SegmentKind::plane) {
            EXPECT_GE(held, segment.indices.size() * 9 / 10);
        } else {
            EXPECT_EQ(held, segment.indices.size());
        }
    }
    EXPECT_EQ(of_kind[0], 2) << "two piles";
    EXPECT_GE(of_kind[1], 3);
    EXPECT_GE(of_kind[3], 5) << "faces of boxes";
}

TEST(SegmentHierarchy, HoldsNothingTwice) {
    const std::vector<Segment> segments = all_segments();
    for (std::size_t s = 0; s < segments.size(); ++s) {
        for (std::size_t t = 0; t < s; ++t) {
            const std::size_t both = common(segments[s], segments[t]).size();
            const std::size_t either =
                segments[s].indices.size() + segments[t].indices.size() - both;
            EXPECT_LE(static_cast<double>(both), 0.95 * static_cast<double>(either))
                << s << " " << t;
        }
    }
    SegmentationSettings lenient = kUnit;
    lenient.same = 1.0;
    EXPECT_GT(all_segments(lenient).size(), segments.size()) << "there is something to drop";
}

TEST(SegmentHierarchy, JoinsTouchingParts) {
    // Three boxes in a row, each higher than the last: the middle one touches both.
    const test_scans::Scan row = scan(
        {box({9, 12, 6}, {-18, 0, 6}), box({9, 14, 12}, {0, 0, 12}), box({9, 12, 18}, {18, 0, 18})},
        {-120, 140, 180}, 0.1);
    const auto segments = segment_hierarchy(row.cloud, test_scans::all_of(row.cloud.size()), kUnit);
    std::size_t pairs = 0;
    for (const Segment& segment : segments) {
        if (segment.kind != SegmentKind::joined) continue;
        ++pairs;
        std::size_t parts = 0;
        for (const Segment& part : segments) {
            if (part.kind != SegmentKind::convex) continue;
            const std::size_t held = common(part, segment).size();
            EXPECT_TRUE(held == 0 || held == part.indices.size());
            parts += held > 0 ? 1 : 0;
        }
        EXPECT_EQ(parts, 2U);
    }
    EXPECT_EQ(pairs, 2U) << "first and last don't touch";
}

TEST(SegmentHierarchy, CutsOnlyTheForeground) {
    std::vector<std::uint32_t> foreground;
    for (std::uint32_t i = 0; i < heap().cloud.size(); ++i) {
        if (heap().solid[i] != 0) foreground.push_back(i);
    }
    const auto segments = segment_hierarchy(heap().cloud, foreground, kUnit);
    ASSERT_FALSE(segments.empty());
    for (const Segment& segment : segments) {
        for (const std::uint32_t i : segment.indices) EXPECT_NE(heap().solid[i], 0U);
    }
}

TEST(SegmentHierarchy, IsBounded) {
    SegmentationSettings few = kUnit;
    few.max_of_kind = 1;
    const auto segments = all_segments(few);
    EXPECT_EQ(std::count_if(segments.begin(), segments.end(),
                            [](const Segment& s) { return s.kind == SegmentKind::cluster; }),
              1);
    EXPECT_LE(segments.size(), 5U);
    EXPECT_EQ(segments[0].indices, all_segments()[0].indices) << "the largest stays";
}

TEST(SegmentHierarchy, DoesNotDependOnTheOrderOfPoints) {
    const std::vector<std::uint32_t> order = test_scans::shuffled(heap().cloud.size(), 2);
    const auto others =
        segment_hierarchy(select(heap().cloud, order), test_scans::all_of(order.size()), kUnit);
    for (int kind = 0; kind < 5; ++kind) {
        std::vector<std::vector<std::uint32_t>> expected;
        std::vector<std::vector<std::uint32_t>> found;
        for (const Segment& s : all_segments()) {
            if (static_cast<int>(s.kind) == kind) expected.push_back(s.indices);
        }
        for (const Segment& s : others) {
            if (static_cast<int>(s.kind) == kind) found.push_back(s.indices);
        }
        std::sort(expected.begin(), expected.end());
        EXPECT_EQ(test_scans::in_original(found, order), expected) << kind;
    }
}

TEST(SegmentHierarchy, TakesEmptyInvalidAndSinglePoints) {
    EXPECT_TRUE(segment_hierarchy({}, {}, kUnit).empty());
    PointCloud cloud;
    cloud.points = {{1, 2, 3}, test_clouds::nowhere()};
    cloud.normals = {{0, 0, 1}, {0, 0, 1}};
    const std::vector<std::uint32_t> both = {0, 1};
    EXPECT_TRUE(segment_hierarchy(cloud, both, kUnit).empty());
    SegmentationSettings tiny = kUnit;
    tiny.min_points = 1;
    const auto segments = segment_hierarchy(cloud, both, tiny);
    ASSERT_EQ(segments.size(), 1U);
    EXPECT_EQ(segments[0].indices, (std::vector<std::uint32_t>{0}));
    EXPECT_EQ(name_of(segments[0].kind), "cluster");
    const std::vector<std::uint32_t> beyond = {2};
    EXPECT_THROW(segment_hierarchy(cloud, beyond, kUnit), InvalidInput);
    EXPECT_THROW(segment_hierarchy(cloud, both, {}), InvalidInput) << "no sampling";
    SegmentationSettings narrow = kUnit;
    narrow.gap = 1.0;
    EXPECT_THROW(segment_hierarchy(cloud, both, narrow), InvalidInput);
}

}  // namespace
}  // namespace ostraka
