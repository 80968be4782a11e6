// SPDX-License-Identifier: Apache-2.0
// The work hardly depends on the number of points. For 20,000 triples the floor is about 0.45 ms at
// 3 GHz: a million voxels (voxel_lines.cpp), 240,000 scattered loads of corners and 200,000 votes
// at one a cycle, 80,000 vectorized roots. Measured: three times that.
#include "ostraka/descriptors/esf.hpp"

#include <algorithm>
#include <array>

#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/esf_samples.hpp"

namespace ostraka {
namespace {

constexpr std::uint32_t kBins = 64;
constexpr float kTopBin = 63.0F;
constexpr std::size_t kBlock = 256;

// Ten histograms, in the row's order, and one for votes that don't count.
enum Histogram : std::uint32_t {
    angle_in,
    angle_out,
    angle_mixed,
    area_in,
    area_out,
    area_mixed,
    line_in,
    line_out,
    line_mixed,
    line_ratio,
    nowhere
};
// PCL's weights of a vote; angles vote with traced lengths in units of 32 voxels.
constexpr std::array<float, 10> kWeights = {0.5F / 32, 0.5F / 32, 0.5F / 32, 0.5F, 0.5F,
                                            1.0F,      0.5F,      2.0F,      2.0F, 1.0F};

// Where the votes of a block of triangles go: histogram * 64 + bin.
using Slots = std::array<std::uint32_t, kBlock>;
struct Votes {
    std::array<Slots, 3> line, ratio, angle;
    Slots area;
};
using Counts = std::array<std::uint32_t, 11 * kBins>;

inline std::uint32_t round_bin(float position) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(position + 0.5F));
}

// A line lies on the surface, off it, or partly on it: only then its share on it counts.
OSTRAKA_VECTOR_CLONES
void vote_lines(const float* length, const std::uint8_t* inside, const std::uint8_t* visited,
                std::size_t count, float bins_per_length, std::uint32_t* line,
                std::uint32_t* ratio) {
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t in = inside[i];
        const std::int32_t all = visited[i];
        const std::uint32_t off = in <= 7 ? line_out : line_mixed;
        const std::uint32_t kind = in >= all - 1 ? line_in : off;
        line[i] = kind * kBins + round_bin(length[i] * bins_per_length);
        const float share = static_cast<float>(in) / static_cast<float>(all);
        ratio[i] = (kind == line_mixed ? line_ratio : nowhere) * kBins + round_bin(share * kTopBin);
    }
}

OSTRAKA_VECTOR_CLONES
void vote_triangles(const EsfSamples& s, std::size_t first, std::size_t count, float bins_per_area,
                    Votes& votes) {
    const float* area = s.area.data() + first;
    const std::uint8_t* inside0 = s.inside[0].data() + first;
    const std::uint8_t* inside1 = s.inside[1].data() + first;
    const std::uint8_t* inside2 = s.inside[2].data() + first;
    const std::uint8_t* visited0 = s.visited[0].data() + first;
    const std::uint8_t* visited1 = s.visited[1].data() + first;
    const std::uint8_t* visited2 = s.visited[2].data() + first;
    const std::uint8_t* angle0 = s.angle[0].data() + first;
    const std::uint8_t* angle1 = s.angle[1].data() + first;
    const std::uint8_t* angle2 = s.angle[2].data() + first;
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t in = std::int32_t{inside0[i]} + inside1[i] + inside2[i];
        const std::int32_t all = std::int32_t{visited0[i]} + visited1[i] + visited2[i];
        const std::uint32_t off = all - in < 4 ? 0 : 2;
        const std::uint32_t kind = in <= 21 ? 1 : off;
        votes.area[i] = (area_in + kind) * kBins + round_bin(area[i] * bins_per_area);
        votes.angle[0][i] = (angle_in + kind) * kBins + angle0[i];
        votes.angle[1][i] = (angle_in + kind) * kBins + angle1[i];
        votes.angle[2][i] = (angle_in + kind) * kBins + angle2[i];
    }
}

Counts count_votes(const EsfSamples& samples) {
    const float bins_per_length = kTopBin / samples.longest;
    const float bins_per_area = kTopBin / samples.widest;
    Counts counts{};
    Votes votes;
    for (std::size_t first = 0; first < samples.count; first += kBlock) {
        const std::size_t count = std::min(kBlock, samples.count - first);
        vote_triangles(samples, first, count, bins_per_area, votes);
        for (std::size_t side = 0; side < 3; ++side) {
            const std::uint8_t* visited = samples.visited[side].data() + first;
            vote_lines(samples.length[side].data() + first, samples.inside[side].data() + first,
                       visited, count, bins_per_length, votes.line[side].data(),
                       votes.ratio[side].data());
            for (std::size_t i = 0; i < count; ++i) {
                ++counts[votes.line[side][i]];
                ++counts[votes.ratio[side][i]];
                counts[votes.angle[side][i]] += visited[i];
            }
        }
        for (std::size_t i = 0; i < count; ++i) ++counts[votes.area[i]];
    }
    return counts;
}

}  // namespace

std::vector<float> describe_esf(const PointCloud& cloud, const EsfSettings& settings) {
    require_points(cloud, "esf");
    if (settings.samples < 1) {
        throw InvalidInput(fmt::format("esf: {} samples, at least 1 is needed", settings.samples));
    }
    std::vector<float> row(kEsfLength, 0.0F);
    const std::vector<EsfPoint> points = into_esf_grid(cloud);
    if (points.size() < 3) return row;
    // Kept, because half a MiB of fresh memory costs as much as a tenth of the work.
    thread_local EsfSamples samples;
    draw_esf_samples(points, settings, samples);
    if (samples.count == 0) return row;
    const Counts counts = count_votes(samples);
    double sum = 0.0;
    for (std::size_t i = 0; i < kEsfLength; ++i) sum += double{kWeights[i / kBins]} * counts[i];
    for (std::size_t i = 0; i < kEsfLength; ++i) {
        row[i] = static_cast<float>(double{kWeights[i / kBins]} * counts[i] / sum);
    }
    return row;
}

}  // namespace ostraka
