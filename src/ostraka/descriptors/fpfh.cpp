// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/fpfh.hpp"

#include <algorithm>
#include <array>
#include <functional>

#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/local_checks.hpp"
#include "ostraka/descriptors/packed_histogram.hpp"
#include "ostraka/descriptors/pair_features.hpp"
#include "ostraka/descriptors/surfel_grid.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kAngles = 3;
constexpr std::size_t kBins = 11;
constexpr std::size_t kStride = 40;  // floats between the histograms of points: full vectors
constexpr std::size_t kVectors = kStride / kVectorLanes;
constexpr std::size_t kCellChunk = 16;     // cells that share scratch memory
constexpr std::size_t kKeypointChunk = 8;  // keypoints that share scratch memory

using Counts = std::array<std::int32_t, kFpfhLength>;
using Row = std::array<float, kStride>;

__attribute__((always_inline)) inline void load_surfels(const SurfelColumns& c, std::size_t i,
                                                        Surfels8& surfels) {
    load8(c.x.data() + i, surfels.x);
    load8(c.y.data() + i, surfels.y);
    load8(c.z.data() + i, surfels.z);
    load8(c.nx.data() + i, surfels.nx);
    load8(c.ny.data() + i, surfels.ny);
    load8(c.nz.data() + i, surfels.nz);
}

__attribute__((always_inline)) inline void vote(PackedHistogram& histogram, const Int8& bins,
                                                const Voters8& voters) {
    vote8(histogram, 5 * PackedHistogram::kField - ((bins << 2) + bins), voters);
}

// The angles between surfel `own` of the grid and all surfels closer than the radius, itself
// included.
OSTRAKA_VECTOR_CLONES
void count_pairs(const SurfelColumns& grid, std::size_t own, const SurfelColumns& around,
                 float squared_radius, Counts& counts) {
    const Float8 zero = {};
    const Surfels8 p{zero + grid.x[own],  zero + grid.y[own],  zero + grid.z[own],
                     zero + grid.nx[own], zero + grid.ny[own], zero + grid.nz[own]};
    counts.fill(0);
    PackedHistogram angle;
    PackedHistogram across;
    PackedHistogram along;
    std::size_t widened = 0;
    constexpr std::size_t kStep = PackedHistogram::kVotes * kVectorLanes;
    for (std::size_t first = 0; first < around.count; first += kStep) {
        const std::size_t last = std::min(around.count, first + kStep);
        for (std::size_t i = first; i < last; i += kVectorLanes) {
            Surfels8 q;
            load_surfels(around, i, q);
            PairBins8 bins;
            pair_bins<kBins>(p, q, bins);
            Voters8 inside;
            select_voters(bins.squared_distance < squared_radius, inside);
            vote(angle, bins.angle, inside);
            vote(across, bins.across, inside);
            vote(along, bins.along, inside);
        }
        widen(angle);
        widen(across);
        widen(along);
        if (++widened < PackedHistogram::kWidened && last < around.count) continue;
        unpack(angle, counts.data());
        unpack(across, counts.data() + kBins);
        unpack(along, counts.data() + 2 * kBins);
        widened = 0;
    }
}

// A point's own histogram (SPFH): its share of each bin. 0 without neighbors.
void to_shares(Counts& counts, float* shares) {
    std::int32_t neighbors = -1;  // the point itself, which counts in the middle bins
    for (std::size_t b = 0; b < kBins; ++b) neighbors += counts[b];
    for (std::size_t a = 0; a < kAngles; ++a) --counts[a * kBins + kBins / 2];
    const float scale = neighbors > 0 ? 1.0F / static_cast<float>(neighbors) : 0.0F;
    for (std::size_t b = 0; b < kFpfhLength; ++b) shares[b] = scale * static_cast<float>(counts[b]);
}

// Histograms of the points that are asked for, in the grid's order.
struct PointHistograms {
    std::vector<std::uint32_t> row_of;  // slot -> row, kNoIndex where not asked for
    std::vector<float> shares;          // rows of kStride, the last 7 floats 0
};

PointHistograms point_histograms(const SurfelGrid& grid, const std::vector<char>& wanted,
                                 float radius) {
    PointHistograms result;
    result.row_of.assign(grid.size(), kNoIndex);
    std::uint32_t rows = 0;
    for (std::size_t s = 0; s < grid.size(); ++s) {
        if (wanted[s] != 0) result.row_of[s] = rows++;
    }
    result.shares.assign(std::size_t{rows} * kStride, 0.0F);
    parallel_for((grid.cell_count() + kCellChunk - 1) / kCellChunk, [&](std::size_t chunk) {
        SurfelColumns around;
        Counts counts;
        const std::size_t end = std::min(grid.cell_count(), (chunk + 1) * kCellChunk);
        for (std::size_t cell = chunk * kCellChunk; cell < end; ++cell) {
            const std::size_t first = grid.cell_begin(cell);
            const std::size_t last = grid.cell_begin(cell + 1);
            const auto begin = result.row_of.begin() + static_cast<std::ptrdiff_t>(first);
            const auto none = [](std::uint32_t row) { return row == kNoIndex; };
            if (std::all_of(begin, begin + static_cast<std::ptrdiff_t>(last - first), none)) {
                continue;
            }
            grid.gather(first, last, around);
            for (std::size_t s = first; s < last; ++s) {
                if (result.row_of[s] == kNoIndex) continue;
                count_pairs(grid.columns(), s, around, radius * radius, counts);
                to_shares(counts, result.shares.data() + result.row_of[s] * kStride);
            }
        }
    });
    return result;
}

// Points around a keypoint that count, and how much.
struct Weights {
    std::size_t count = 0;
    std::vector<float> weight;
    std::vector<std::uint32_t> row;
    std::vector<std::uint32_t> own;  // rows of points at the keypoint
    std::vector<float> square;       // scratch: squared distances in squared radii
};

OSTRAKA_VECTOR_CLONES
void measure(const Vec3f& keypoint, const SurfelColumns& around, float radius, float* squares) {
    const float x = keypoint.x();
    const float y = keypoint.y();
    const float z = keypoint.z();
    const float square = radius * radius;
    for (std::size_t i = 0; i < around.count; ++i) {
        const float dx = around.x[i] - x;
        const float dy = around.y[i] - y;
        const float dz = around.z[i] - z;
        const float distance = dx * dx + dy * dy + dz * dz;
        squares[i] = distance < square ? distance / square : 2.0F;
    }
}

void weigh(const Vec3f& keypoint, const SurfelColumns& around, const PointHistograms& histograms,
           const FpfhSettings& settings, Weights& weights) {
    if (weights.weight.size() <= around.count) {
        weights.weight.resize(around.count + 1);
        weights.row.resize(around.count + 1);
        weights.square.resize(around.count + 1);
    }
    measure(keypoint, around, settings.radius, weights.square.data());
    weights.own.clear();
    std::size_t count = 0;
    for (std::size_t i = 0; i < around.count; ++i) {
        const float square = weights.square[i];
        const std::uint32_t row = histograms.row_of[around.slot[i]];
        weights.weight[count] = square;
        weights.row[count] = row;
        count += ((square <= 1.0F) & (square > 0.0F)) ? 1U : 0U;
        if (square == 0.0F) weights.own.push_back(row);
    }
    weights.count = count;
    for (std::size_t i = 0; i < count; ++i) {
        // Bounded, so that no weight overflows.
        const float weight = 1.0F / std::max(weights.weight[i], 1e-12F);
        weights.weight[i] = settings.paper_weights ? std::sqrt(weight) : weight;
    }
}

// Sum of weight x histogram. The weights are positive and the order is fixed, so float sums are
// repeatable and good to 1e-5.
OSTRAKA_VECTOR_CLONES
void add_weighted(const float* shares, const std::uint32_t* rows, const float* weights,
                  std::size_t count, Row& sums) {
    std::array<Float8, kVectors> total{};
    for (std::size_t i = 0; i < count; ++i) {
        const float* row = shares + rows[i] * kStride;
        for (std::size_t v = 0; v < kVectors; ++v) {
            Float8 share;
            load8(row + v * kVectorLanes, share);
            total[v] += share * weights[i];
        }
    }
    std::memcpy(sums.data(), total.data(), sizeof(total));
}

void describe_keypoint(const Weights& weights, const PointHistograms& histograms,
                       bool paper_weights, std::span<float> row) {
    Row sums{};
    add_weighted(histograms.shares.data(), weights.row.data(), weights.weight.data(), weights.count,
                 sums);
    if (paper_weights) {
        const float mean = 1.0F / static_cast<float>(std::max<std::size_t>(1, weights.count));
        for (float& sum : sums) sum *= mean;
        for (const std::uint32_t own : weights.own) {
            for (std::size_t b = 0; b < kFpfhLength; ++b) {
                sums[b] +=
                    histograms.shares[own * kStride + b] / static_cast<float>(weights.own.size());
            }
        }
    }
    for (std::size_t a = 0; a < kAngles; ++a) {
        double sum = 0.0;
        for (std::size_t b = 0; b < kBins; ++b) sum += sums[a * kBins + b];
        const double scale = sum > 0.0 ? 100.0 / sum : 0.0;
        for (std::size_t b = a * kBins; b < (a + 1) * kBins; ++b) {
            row[b] = static_cast<float>(scale * sums[b]);
        }
    }
}

void describe_keypoints(const SurfelGrid& grid, std::span<const Vec3f> keypoints,
                        const PointHistograms& histograms, const FpfhSettings& settings,
                        const std::function<std::span<float>(std::size_t)>& row_of) {
    const std::size_t chunks = (keypoints.size() + kKeypointChunk - 1) / kKeypointChunk;
    parallel_for(chunks, [&](std::size_t chunk) {
        SurfelColumns around;
        Weights weights;
        const std::size_t end = std::min(keypoints.size(), (chunk + 1) * kKeypointChunk);
        for (std::size_t k = chunk * kKeypointChunk; k < end; ++k) {
            grid.gather(keypoints[k], around);
            weigh(keypoints[k], around, histograms, settings, weights);
            describe_keypoint(weights, histograms, settings.paper_weights, row_of(k));
        }
    });
}

// Fills the rows of all points of the grid: points of a cell share what lies around them.
void describe_grid(const SurfelGrid& grid, const PointHistograms& histograms,
                   const FpfhSettings& settings, std::span<float> rows) {
    const SurfelColumns& columns = grid.columns();
    parallel_for((grid.cell_count() + kCellChunk - 1) / kCellChunk, [&](std::size_t chunk) {
        SurfelColumns around;
        Weights weights;
        const std::size_t end = std::min(grid.cell_count(), (chunk + 1) * kCellChunk);
        for (std::size_t cell = chunk * kCellChunk; cell < end; ++cell) {
            const std::size_t last = grid.cell_begin(cell + 1);
            grid.gather(grid.cell_begin(cell), last, around);
            for (std::size_t s = grid.cell_begin(cell); s < last; ++s) {
                weigh(Vec3f(columns.x[s], columns.y[s], columns.z[s]), around, histograms, settings,
                      weights);
                describe_keypoint(weights, histograms, settings.paper_weights,
                                  rows.subspan(grid.original()[s] * kFpfhLength, kFpfhLength));
            }
        }
    });
}

}  // namespace

LocalDescriptors describe_fpfh(const PointCloud& cloud, std::span<const Vec3f> keypoints,
                               const FpfhSettings& settings) {
    require_surfels(cloud, "fpfh");
    require_keypoints(keypoints, "fpfh");
    require_radius(settings.radius, "fpfh");
    const SurfelGrid grid(cloud.points, cloud.normals, settings.radius);
    std::vector<char> wanted(grid.size(), 0);
    SurfelColumns around;
    for (const Vec3f& keypoint : keypoints) {
        grid.gather(keypoint, around);
        for (std::size_t i = 0; i < around.count; ++i) wanted[around.slot[i]] = 1;
    }
    const PointHistograms histograms = point_histograms(grid, wanted, settings.radius);
    LocalDescriptors result;
    result.rows.assign(keypoints.size() * kFpfhLength, 0.0F);
    describe_keypoints(grid, keypoints, histograms, settings, [&](std::size_t k) {
        return std::span(result.rows).subspan(k * kFpfhLength, kFpfhLength);
    });
    return result;
}

LocalDescriptors describe_fpfh(const PointCloud& cloud, const KdTree& tree,
                               std::span<const Vec3f> keypoints, const FpfhSettings& settings) {
    require_tree(cloud, tree, "fpfh");
    return describe_fpfh(cloud, keypoints, settings);
}

LocalDescriptors describe_fpfh(const PointCloud& cloud, const FpfhSettings& settings) {
    require_surfels(cloud, "fpfh");
    require_radius(settings.radius, "fpfh");
    const SurfelGrid grid(cloud.points, cloud.normals, settings.radius);
    const std::vector<char> all(grid.size(), 1);
    const PointHistograms histograms = point_histograms(grid, all, settings.radius);
    LocalDescriptors result;
    result.rows.assign(cloud.size() * kFpfhLength, 0.0F);
    describe_grid(grid, histograms, settings, result.rows);
    // Points without a normal are not in the grid, but may have neighbors in it.
    std::vector<std::uint32_t> bare;
    std::vector<Vec3f> keypoints;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (cloud.normals[i].allFinite()) continue;
        bare.push_back(i);
        keypoints.push_back(cloud.points[i]);
    }
    describe_keypoints(grid, keypoints, histograms, settings, [&](std::size_t k) {
        return std::span(result.rows).subspan(bare[k] * kFpfhLength, kFpfhLength);
    });
    return result;
}

}  // namespace ostraka
