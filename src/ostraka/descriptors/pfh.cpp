// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/pfh.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/local_checks.hpp"
#include "ostraka/descriptors/pair_features.hpp"
#include "ostraka/descriptors/surfel_grid.hpp"

namespace ostraka {
namespace {

constexpr int kBins = 5;
constexpr std::size_t kFlush = 1024;  // surfels after which the 32-bit counters are emptied

// A histogram for each lane, so that votes for one bin don't wait for each other. The last bin
// takes the votes that don't count.
using LaneCounts = std::array<std::array<std::uint32_t, kPfhLength + 1>, kVectorLanes>;
using Counts = std::array<std::uint64_t, kPfhLength>;

// The pairs of surfel `own` with those before it.
OSTRAKA_VECTOR_CLONES
void count_pairs(const SurfelColumns& c, std::size_t own, LaneCounts& counts) {
    const Float8 zero = {};
    const Surfels8 p{zero + c.x[own],  zero + c.y[own],  zero + c.z[own],
                     zero + c.nx[own], zero + c.ny[own], zero + c.nz[own]};
    const Int8 lane = {0, 1, 2, 3, 4, 5, 6, 7};
    constexpr std::int32_t kMiddle = 2 + 2 * kBins + 2 * kBins * kBins;
    for (std::size_t i = 0; i < own; i += kVectorLanes) {
        Surfels8 q;
        load8(c.x.data() + i, q.x);
        load8(c.y.data() + i, q.y);
        load8(c.z.data() + i, q.z);
        load8(c.nx.data() + i, q.nx);
        load8(c.ny.data() + i, q.ny);
        load8(c.nz.data() + i, q.nz);
        PairBins8 bins;
        pair_bins<kBins>(p, q, bins);
        const Int8 bin =
            kMiddle - (bins.angle + bins.across * kBins + bins.along * (kBins * kBins));
        const Int8 before = lane < static_cast<std::int32_t>(own - i);
        const Int8 vote = before ? bin : Int8{} + static_cast<std::int32_t>(kPfhLength);
        std::array<std::int32_t, kVectorLanes> votes;
        std::memcpy(votes.data(), &vote, sizeof(vote));
        for (std::size_t v = 0; v < kVectorLanes; ++v) {
            ++counts[v][static_cast<std::size_t>(votes[v])];
        }
    }
}

void flush(LaneCounts& lanes, Counts& counts) {
    for (auto& lane : lanes) {
        for (std::size_t b = 0; b < kPfhLength; ++b) counts[b] += lane[b];
        lane.fill(0);
    }
}

struct Scratch {
    SurfelColumns found, sorted;
    std::vector<std::pair<float, std::uint32_t>> order;
};

// Nearest first: where the two surfels of a pair are equally good as the first one, PCL takes the
// farther one.
void sort_by_distance(const Vec3f& keypoint, Scratch& scratch) {
    const SurfelColumns& from = scratch.found;
    SurfelColumns& to = scratch.sorted;
    scratch.order.clear();
    for (std::uint32_t i = 0; i < from.count; ++i) {
        const float dx = from.x[i] - keypoint.x();
        const float dy = from.y[i] - keypoint.y();
        const float dz = from.z[i] - keypoint.z();
        scratch.order.emplace_back(dx * dx + dy * dy + dz * dz, i);
    }
    std::sort(scratch.order.begin(), scratch.order.end());
    to.resize(from.count);
    for (std::size_t i = 0; i < from.count; ++i) {
        const std::uint32_t source = scratch.order[i].second;
        to.x[i] = from.x[source];
        to.y[i] = from.y[source];
        to.z[i] = from.z[source];
        to.nx[i] = from.nx[source];
        to.ny[i] = from.ny[source];
        to.nz[i] = from.nz[source];
    }
    to.pad();
}

void describe_support(const SurfelColumns& support, std::span<float> row) {
    LaneCounts lanes{};
    Counts counts{};
    for (std::size_t i = 1; i < support.count; ++i) {
        count_pairs(support, i, lanes);
        if (i % kFlush == 0) flush(lanes, counts);
    }
    flush(lanes, counts);
    const auto pairs = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    if (pairs == 0) return;
    for (std::size_t b = 0; b < kPfhLength; ++b) {
        row[b] =
            static_cast<float>(100.0 * static_cast<double>(counts[b]) / static_cast<double>(pairs));
    }
}

}  // namespace

LocalDescriptors describe_pfh(const PointCloud& cloud, const KdTree& tree,
                              std::span<const Vec3f> keypoints, const PfhSettings& settings) {
    require_tree(cloud, tree, "pfh");
    return describe_pfh(cloud, keypoints, settings);
}

LocalDescriptors describe_pfh(const PointCloud& cloud, std::span<const Vec3f> keypoints,
                              const PfhSettings& settings) {
    require_surfels(cloud, "pfh");
    require_keypoints(keypoints, "pfh");
    require_radius(settings.radius, "pfh");
    LocalDescriptors result;
    result.rows.assign(keypoints.size() * kPfhLength, 0.0F);
    const SurfelGrid grid(cloud.points, cloud.normals, settings.radius);
    constexpr std::size_t kChunk = 4;  // keypoints that share scratch memory
    parallel_for((keypoints.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        Scratch scratch;
        const std::size_t end = std::min(keypoints.size(), (chunk + 1) * kChunk);
        for (std::size_t k = chunk * kChunk; k < end; ++k) {
            grid.gather(keypoints[k], scratch.found);
            sort_by_distance(keypoints[k], scratch);
            describe_support(scratch.sorted,
                             std::span(result.rows).subspan(k * kPfhLength, kPfhLength));
        }
    });
    return result;
}

}  // namespace ostraka
