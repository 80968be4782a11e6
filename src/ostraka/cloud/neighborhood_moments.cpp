// SPDX-License-Identifier: Apache-2.0
// Exact k nearest neighbors of all points at once. Points that lie together share one list of
// candidates: everything in a box around them. Where a point's k-th distance reaches beyond the
// box, it is looked at again in larger boxes, then in a coarser grid.
#include "ostraka/cloud/neighborhood_moments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/nearest_sums.hpp"
#include "ostraka/cloud/point_columns.hpp"

namespace ostraka {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr double kMargin = 1.15;  // columns are wider than what three of four points need
constexpr std::size_t kSampleCost = 70'000;  // distances measured to choose the columns
constexpr double kLastReach = 4.0;  // in column sides, doubled up to it for points that need more
constexpr double kGrowth = 8.0;     // from one grid to the next coarser one
constexpr std::size_t kFewStray = 32;  // points left for which another grid doesn't pay
constexpr float kNarrow = 0.99999F;    // what a box surely covers, in spite of rounding

void gather(const PointColumns& columns, std::span<const SlotRun> runs, Candidates& near) {
    std::size_t count = 0;
    for (const SlotRun& run : runs) count += run.end - run.begin;
    near.resize(count);
    std::size_t at = 0;
    for (const SlotRun& run : runs) {
        const std::size_t length = run.end - run.begin;
        std::copy_n(columns.coordinate(0) + run.begin, length, near.x.data() + at);
        std::copy_n(columns.coordinate(1) + run.begin, length, near.y.data() + at);
        std::copy_n(columns.coordinate(2) + run.begin, length, near.z.data() + at);
        std::copy_n(columns.order().data() + run.begin, length, near.index.data() + at);
        at += length;
    }
    near.pad();
}

// The work on one grid: blocks of points of a column, one above the other.
struct Sweep {
    const PointColumns& columns;
    std::size_t k;
    float reach;                      // how far candidates surely reach beyond a block
    std::vector<std::uint8_t>& done;  // per point; points that are done already are left out
    const std::function<void(const MomentBatch&)>& visit;

    void column(std::size_t c) const {
        const SlotRun run = columns.column(c);
        const float* height = columns.coordinate(columns.height_axis());
        const auto waits = [&](std::uint32_t slot) { return done[columns.order()[slot]] == 0; };
        std::uint32_t first = run.begin;
        while (first < run.end) {
            std::uint32_t last = first;
            while (last < run.end && last - first < MomentBatch::kCapacity &&
                   height[last] - height[first] <= reach && waits(last)) {
                ++last;
            }
            if (first < last) {
                block({first, last});
                first = last;
            } else {
                ++first;
            }
        }
    }

    void block(const SlotRun& queries) const {
        thread_local Candidates near;
        thread_local std::vector<SlotRun> runs;
        Vec3f low;
        Vec3f high;
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            const float* at = columns.coordinate(static_cast<std::size_t>(axis));
            const auto [least, most] = std::minmax_element(at + queries.begin, at + queries.end);
            low[axis] = *least - reach;
            high[axis] = *most + reach;
        }
        columns.runs_in_box(low, high, runs);
        gather(columns, runs, near);
        MomentBatch batch{};
        batch.neighbors = static_cast<double>(k);
        float guess = 0.0F;
        Query previous{};
        for (std::uint32_t slot = queries.begin; slot < queries.end; ++slot) {
            const Vec3f p(columns.coordinate(0)[slot], columns.coordinate(1)[slot],
                          columns.coordinate(2)[slot]);
            const float margin = kNarrow * std::min((p - low).minCoeff(), (high - p).minCoeff());
            const bool all = near.count == columns.size();
            const Query query{p.x(), p.y(), p.z(), all ? kFar : margin * margin};
            const std::size_t lane = batch.count;
            if (lane > 0 && query.x == previous.x && query.y == previous.y &&
                query.z == previous.z) {
                for (auto& column : batch.sums) column[lane] = column[lane - 1];
            } else if (!sum_nearest(near, query, k, guess, batch, lane)) {
                continue;
            }
            previous = query;
            batch.index[lane] = columns.order()[slot];
            done[batch.index[lane]] = 1;
            ++batch.count;
        }
        if (batch.count > 0) visit(batch);
    }
};

// All points as candidates.
Candidates all_of(std::span<const Vec3f> points) {
    Candidates all;
    all.resize(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        all.x[i] = points[i].x();
        all.y[i] = points[i].y();
        all.z[i] = points[i].z();
        all.index[i] = i;
    }
    all.pad();
    return all;
}

// A length that about three of four points' k nearest lie within, from a few points.
double typical_reach(std::span<const Vec3f> points, Candidates& all, std::size_t k) {
    const std::size_t samples = std::clamp<std::size_t>(kSampleCost / points.size(), 4, 32);
    std::vector<float> reaches;
    float guess = 0.0F;
    for (std::size_t s = 0; s < samples; ++s) {
        const Vec3f& p = points[s * points.size() / samples];
        const Query query{p.x(), p.y(), p.z(), kFar};
        guess = kth_squared_distance(all, query, k, guess);
        reaches.push_back(std::sqrt(guess));
    }
    const auto quantile = reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() * 3 / 4);
    std::nth_element(reaches.begin(), quantile, reaches.end());
    return double{*quantile};
}

// The few points that lie apart, against all points.
void visit_stray(std::span<const Vec3f> points, std::span<const std::uint32_t> stray,
                 Candidates& all, std::size_t k,
                 const std::function<void(const MomentBatch&)>& visit) {
    for (const std::uint32_t i : stray) {
        MomentBatch batch{};
        batch.neighbors = static_cast<double>(k);
        const Query query{points[i].x(), points[i].y(), points[i].z(), kFar};
        float guess = 0.0F;
        sum_nearest(all, query, k, guess, batch, 0);
        batch.index[0] = i;
        batch.count = 1;
        visit(batch);
    }
}

std::vector<std::uint32_t> left_of(const std::vector<std::uint8_t>& done) {
    std::vector<std::uint32_t> left;
    for (std::uint32_t i = 0; i < done.size(); ++i) {
        if (done[i] == 0) left.push_back(i);
    }
    return left;
}

}  // namespace

void visit_nearest_moments(std::span<const Vec3f> points, std::size_t k,
                           const std::function<void(const MomentBatch&)>& visit) {
    if (points.empty()) return;
    k = std::min(k, points.size());
    Candidates all = all_of(points);
    double side = kMargin * typical_reach(points, all, k);
    std::vector<std::uint8_t> done(points.size(), 0);
    for (;;) {
        const PointColumns columns(points, side);
        for (double reach = side; reach <= kLastReach * side; reach *= 2.0) {
            const Sweep sweep{columns, k, static_cast<float>(reach), done, visit};
            parallel_for(
                columns.column_count(), [&](std::size_t c) { sweep.column(c); }, 16);
        }
        const std::vector<std::uint32_t> left = left_of(done);
        if (left.size() <= kFewStray) return visit_stray(points, left, all, k, visit);
        side *= kGrowth;
    }
}

}  // namespace ostraka
