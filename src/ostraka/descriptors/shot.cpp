// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/shot.hpp"

#include <array>
#include <limits>

#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/fast_math.hpp"
#include "ostraka/descriptors/shot_frame.hpp"
#include "ostraka/descriptors/support.hpp"
#include "ostraka/descriptors/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr std::int32_t kVolumes = 32;  // 8 sectors x 2 radii x 2 halves
constexpr std::int32_t kCosineBins = 11;
constexpr std::size_t kBlock = 256;
constexpr std::size_t kChunk = 8;  // keypoints that share scratch memory
// Weights are integers, so that their sums don't depend on the order of the points.
constexpr float kUnit = 268435456.0F;  // 2^28; a weight is at most 4

// What each point of a block adds to its own bin and to its four neighbors.
struct Votes {
    std::array<std::int32_t, kBlock> own, cosine, radial, vertical, sideways;  // bins
    std::array<std::int32_t, kBlock> own_weight, cosine_weight, radial_weight, vertical_weight,
        sideways_weight;
};

struct Axes {
    std::array<float, 3> x, y, z;
};

inline std::int32_t fixed_point(float weight) {
    return static_cast<std::int32_t>(weight * kUnit);
}

// Quadrilinear interpolation: over the cosine, the radius, the inclination and the azimuth.
OSTRAKA_VECTOR_CLONES
void vote_block(const Support& s, std::size_t first, std::size_t count, const Axes& axes,
                float radius, Votes& votes) {
    constexpr float kQuarterTurn = 1.57079632679F;
    const float* sx = s.x.data() + first;
    const float* sy = s.y.data() + first;
    const float* sz = s.z.data() + first;
    const float* sd = s.distance.data() + first;
    const float* snx = s.nx.data() + first;
    const float* sny = s.ny.data() + first;
    const float* snz = s.nz.data() + first;
    const float half = radius * 0.5F;
    const float inverse_half = 1.0F / half;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) {
        const float x = sx[i] * axes.x[0] + sy[i] * axes.x[1] + sz[i] * axes.x[2];
        const float y = sx[i] * axes.y[0] + sy[i] * axes.y[1] + sz[i] * axes.y[2];
        const float z = sx[i] * axes.z[0] + sy[i] * axes.z[1] + sz[i] * axes.z[2];
        const float distance = sd[i];
        const float normal_z = snx[i] * axes.z[0] + sny[i] * axes.z[1] + snz[i] * axes.z[2];
        const bool valid = (distance > 0.0F) & (normal_z == normal_z);

        // The volume: azimuth sector x 4 + outer half x 2 + upper half.
        const float ax = std::fabs(x);
        const float ay = std::fabs(y);
        const std::int32_t left = ((y > 0.0F) | ((y == 0.0F) & (x < 0.0F))) ? 1 : 0;
        const bool right = (x > 0.0F) | ((x == 0.0F) & (y > 0.0F));
        const std::int32_t side = right ? 1 - left : left;
        const bool same_sign = ((x > 0.0F) & (y > 0.0F)) | ((x < 0.0F) & (y < 0.0F)) | (x == 0.0F);
        const std::int32_t octant = same_sign ? (ax >= ay ? 0 : 1) : (ax > ay ? 1 : 0);
        const std::int32_t sector = 4 * left + 2 * side + octant;
        const std::int32_t outer = distance > half ? 1 : 0;
        const std::int32_t upper = z > 0.0F ? 1 : 0;
        const std::int32_t volume = 4 * sector + 2 * outer + upper;

        // The cosine; its neighbor wraps over 10 of the 11 bins, as in PCL.
        float cosine = normal_z < 1.0F ? normal_z : 1.0F;
        cosine = cosine > -1.0F ? cosine : -1.0F;
        const float position = (1.0F + cosine) * 5.0F;
        const auto step = static_cast<std::int32_t>(valid ? position + 0.5F : 0.0F);
        const float past = position - static_cast<float>(step);
        const std::int32_t above = step >= 9 ? step - 9 : step + 1;
        const std::int32_t below = step == 0 ? 9 : step - 1;
        const float cosine_share = std::fabs(past);
        const std::int32_t bin = volume * kCosineBins + step;

        // The radius: distance to the middle of the own shell, in shells.
        const float radial = (distance - (outer != 0 ? 1.5F : 0.5F) * half) * inverse_half;
        const bool radial_votes = outer != 0 ? radial <= 0.0F : radial >= 0.0F;
        const float radial_share = std::fabs(radial);

        // The inclination from the z axis: distance to the middle of the own half.
        const float inclination = fast_atan2(std::sqrt(x * x + y * y), z);
        const float vertical =
            (inclination - (upper != 0 ? 0.5F : 1.5F) * kQuarterTurn) / kQuarterTurn;
        const bool vertical_votes = upper != 0 ? vertical >= 0.0F : vertical <= 0.0F;
        const float vertical_share = std::fabs(vertical);

        // The azimuth: distance to the middle of the own sector.
        const bool has_azimuth = (x != 0.0F) | (y != 0.0F);
        const float turns = fast_atan2(y, x) * (2.0F / kQuarterTurn);
        float azimuth = turns - (static_cast<float>(sector) - 3.5F);
        azimuth = azimuth < 0.5F ? azimuth : 0.5F;
        azimuth = azimuth > -0.5F ? azimuth : -0.5F;
        const float azimuth_share = has_azimuth ? std::fabs(azimuth) : 1.0F;
        const std::int32_t turned = (volume + (azimuth > 0.0F ? 4 : kVolumes - 4)) & (kVolumes - 1);

        const float own = (1.0F - cosine_share) + (1.0F - radial_share) + (1.0F - vertical_share) +
                          (1.0F - azimuth_share);
        votes.own[i] = bin;
        votes.cosine[i] = volume * kCosineBins + (past > 0.0F ? above : below);
        votes.radial[i] = radial_votes ? bin + (outer != 0 ? -2 : 2) * kCosineBins : bin;
        votes.vertical[i] = vertical_votes ? bin + (upper != 0 ? -1 : 1) * kCosineBins : bin;
        votes.sideways[i] = turned * kCosineBins + step;
        votes.own_weight[i] = fixed_point(valid ? own : 0.0F);
        votes.cosine_weight[i] = fixed_point(valid ? cosine_share : 0.0F);
        votes.radial_weight[i] = fixed_point(valid & radial_votes ? radial_share : 0.0F);
        votes.vertical_weight[i] = fixed_point(valid & vertical_votes ? vertical_share : 0.0F);
        votes.sideways_weight[i] = fixed_point(valid & has_azimuth ? azimuth_share : 0.0F);
    }
}

using Bins = std::array<std::int64_t, kShotLength>;

void count_block(const Votes& votes, std::size_t count, Bins& bins) {
    const auto add = [&bins](std::int32_t bin, std::int32_t weight) {
        bins[static_cast<std::size_t>(bin)] += weight;
    };
    for (std::size_t i = 0; i < count; ++i) {
        add(votes.own[i], votes.own_weight[i]);
        add(votes.cosine[i], votes.cosine_weight[i]);
        add(votes.radial[i], votes.radial_weight[i]);
        add(votes.vertical[i], votes.vertical_weight[i]);
        add(votes.sideways[i], votes.sideways_weight[i]);
    }
}

void normalize(const Bins& bins, std::span<float> row) {
    double squares = 0.0;
    for (const std::int64_t bin : bins) {
        squares += static_cast<double>(bin) * static_cast<double>(bin);
    }
    const double scale = squares > 0.0 ? 1.0 / std::sqrt(squares) : 0.0;
    for (std::size_t b = 0; b < kShotLength; ++b) {
        row[b] = static_cast<float>(static_cast<double>(bins[b]) * scale);
    }
}

// The frame and row of a support that is filled already.
Mat3f describe_support(const Support& support, float radius, std::span<float> row) {
    const Mat3f frame = shot_frame(support, radius);
    if (!frame.allFinite()) return frame;
    const Axes axes{{frame(0, 0), frame(0, 1), frame(0, 2)},
                    {frame(1, 0), frame(1, 1), frame(1, 2)},
                    {frame(2, 0), frame(2, 1), frame(2, 2)}};
    Bins bins{};
    Votes votes;
    for (std::size_t first = 0; first < support.count; first += kBlock) {
        const std::size_t count = std::min(kBlock, support.count - first);
        vote_block(support, first, count, axes, radius, votes);
        count_block(votes, count, bins);
    }
    normalize(bins, row);
    return frame;
}

}  // namespace

LocalDescriptors describe_shot(const PointCloud& cloud, const KdTree& tree,
                               std::span<const Vec3f> keypoints, const ShotSettings& settings) {
    check(cloud);
    require_support(cloud, tree, keypoints, settings.radius, "shot");
    if (!cloud.empty()) require_normals(cloud, "shot");
    LocalDescriptors result;
    result.rows.assign(keypoints.size() * kShotLength, 0.0F);
    result.frames.resize(keypoints.size());
    const std::size_t chunks = (keypoints.size() + kChunk - 1) / kChunk;
    parallel_for(chunks, [&](std::size_t chunk) {
        Support support;
        std::vector<Neighbor> neighbors;
        const std::size_t end = std::min(keypoints.size(), (chunk + 1) * kChunk);
        for (std::size_t k = chunk * kChunk; k < end; ++k) {
            tree.within(keypoints[k], settings.radius, neighbors);
            gather(
                cloud, keypoints[k], neighbors.size(), true,
                [&](std::size_t i) { return neighbors[i].index; }, support);
            const std::span<float> row(result.rows.data() + k * kShotLength, kShotLength);
            result.frames[k] = describe_support(support, settings.radius, row);
        }
    });
    return result;
}

std::vector<float> describe_global_shot(const PointCloud& cloud,
                                        const GlobalShotSettings& /*settings*/) {
    require_points(cloud, "shot");
    require_normals(cloud, "shot");
    const WholeSupport whole = whole_support(cloud.points);
    std::vector<float> row(kShotLength, 0.0F);
    if (!(whole.radius > 0.0F)) return row;
    Support support;
    gather(
        cloud, whole.center, cloud.size(), true, [](std::size_t i) { return i; }, support);
    describe_support(support, whole.radius, row);
    return row;
}

}  // namespace ostraka
