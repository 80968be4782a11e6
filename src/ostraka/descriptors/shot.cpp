// SPDX-License-Identifier: Apache-2.0
// A point of a support costs 28 bytes and about 180 operations, of which 160 are vectorized by
// eight and 10 are scattered additions: a floor of about 20 cycles. Measured, with the search and
// the frame: three to four times that.
#include "ostraka/descriptors/shot.hpp"

#include <array>
#include <limits>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/fast_math.hpp"
#include "ostraka/descriptors/neighborhoods.hpp"
#include "ostraka/descriptors/shot_frame.hpp"
#include "ostraka/descriptors/support.hpp"

namespace ostraka {
namespace {

constexpr std::int32_t kVolumes = 32;  // 8 sectors x 2 radii x 2 halves
constexpr std::int32_t kCosineBins = 11;
constexpr std::size_t kBlock = 256;
constexpr std::size_t kChunk = 8;  // keypoints that share scratch memory
// Weights are integers, so that their sums don't depend on the order of the points.
constexpr float kUnit = 268435456.0F;  // 2^28; a weight is at most 4

// What each point of a block adds to its own bin and to the next ones over the cosine, the radius,
// the inclination and the azimuth.
struct Votes {
    std::array<std::array<std::int32_t, kBlock>, 5> bin, weight;
};

struct Axes {
    float xx, xy, xz, yx, yy, yz, zx, zy, zz;  // the frame's rows
};

// A cosine as a position among the bins: [0, 10].
inline float cosine_position(float value) {
    const float low = value < 1.0F ? value : 1.0F;
    return (1.0F + (low > -1.0F ? low : -1.0F)) * 5.0F;
}

// The bin that shares a vote with `step`; wraps over 10 of the 11 bins, as in PCL.
inline std::int32_t cosine_neighbor(std::int32_t step, float past) {
    const std::int32_t above = step >= 9 ? step - 9 : step + 1;
    const std::int32_t below = step == 0 ? 9 : step - 1;
    return past > 0.0F ? above : below;
}

// 1 where true. Integers instead of bool, because compilers vectorize them.
inline std::int32_t is(bool condition) {
    return condition ? 1 : 0;
}

// The eighth of a turn about z that (x, y) lies in, counted from -x; on its border as PCL decides.
inline std::int32_t sector_of(float x, float y) {
    const float ax = std::fabs(x);
    const float ay = std::fabs(y);
    const std::int32_t left = is(y > 0.0F) | (is(y == 0.0F) & is(x < 0.0F));
    const std::int32_t right = is(x > 0.0F) | (is(x == 0.0F) & is(y > 0.0F));
    const std::int32_t same_sign =
        (is(x > 0.0F) & is(y > 0.0F)) | (is(x < 0.0F) & is(y < 0.0F)) | is(x == 0.0F);
    const std::int32_t octant = (same_sign & is(ax < ay)) | ((1 - same_sign) & is(ax > ay));
    return 4 * left + 2 * (left ^ right) + octant;
}

// How far the azimuth is past the middle of its sector, in sectors: [-0.5, 0.5].
inline float past_sector(float x, float y, std::int32_t sector) {
    const float eighths = fast_atan2(y, x) * (4.0F / 3.14159265359F);
    float past = eighths - (static_cast<float>(sector) - 3.5F);
    past = past < 0.5F ? past : 0.5F;
    return past > -0.5F ? past : -0.5F;
}

// How far the inclination from the z axis is past the middle of its half, in halves.
inline float past_half(float x, float y, float z) {
    constexpr float kQuarterTurn = 1.57079632679F;
    const float inclination = fast_atan2(std::sqrt(x * x + y * y), z);
    return (inclination - (z > 0.0F ? 0.5F : 1.5F) * kQuarterTurn) / kQuarterTurn;
}

// Quadrilinear interpolation: over the cosine, the radius, the inclination and the azimuth.
OSTRAKA_VECTOR_CLONES
void vote_block(const Support& s, std::size_t first, std::size_t count, const Axes& axes,
                float radius, Votes& v) {
    const float* sx = s.x.data() + first;
    const float* sy = s.y.data() + first;
    const float* sz = s.z.data() + first;
    const float* sd = s.distance.data() + first;
    const float* snx = s.nx.data() + first;
    const float* sny = s.ny.data() + first;
    const float* snz = s.nz.data() + first;
    const float half = radius * 0.5F;
    const float inverse_half = 1.0F / half;
    const Axes a = axes;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) {
        const float x = sx[i] * a.xx + sy[i] * a.xy + sz[i] * a.xz;
        const float y = sx[i] * a.yx + sy[i] * a.yy + sz[i] * a.yz;
        const float z = sx[i] * a.zx + sy[i] * a.zy + sz[i] * a.zz;
        const float distance = sd[i];
        const float normal_z = snx[i] * a.zx + sny[i] * a.zy + snz[i] * a.zz;
        const float valid = distance > 0.0F ? (normal_z == normal_z ? kUnit : 0.0F) : 0.0F;

        // The volume: azimuth sector x 4 + outer half x 2 + upper half.
        const std::int32_t sector = sector_of(x, y);
        const std::int32_t volume = 4 * sector + 2 * is(distance > half) + is(z > 0.0F);
        const float position = cosine_position(normal_z);
        const auto step = static_cast<std::int32_t>(position + 0.5F);

        // How far the point is past the middle of its bin, along each of the four dimensions.
        const float cosine = position - static_cast<float>(step);
        const float radial = (distance - (distance > half ? 1.5F : 0.5F) * half) * inverse_half;
        const float vertical = past_half(x, y, z);
        const float azimuth = past_sector(x, y, sector);
        // Away from the border of the sphere and from the poles the next bin gets that share.
        const float inward = distance > half ? -radial : radial;
        const float sideways = z > 0.0F ? vertical : -vertical;
        const float azimuth_share = x != 0.0F || y != 0.0F ? std::fabs(azimuth) : 1.0F;
        const float own = (1.0F - std::fabs(cosine)) + (1.0F - std::fabs(radial)) +
                          (1.0F - std::fabs(vertical)) + (1.0F - azimuth_share);
        const std::int32_t turned = (volume + (azimuth > 0.0F ? 4 : kVolumes - 4)) & (kVolumes - 1);
        v.bin[0][i] = volume * kCosineBins + step;
        v.bin[1][i] = volume * kCosineBins + cosine_neighbor(step, cosine);
        v.bin[2][i] = (volume ^ 2) * kCosineBins + step;
        v.bin[3][i] = (volume ^ 1) * kCosineBins + step;
        v.bin[4][i] = turned * kCosineBins + step;
        v.weight[0][i] = static_cast<std::int32_t>(own * valid);
        v.weight[1][i] = static_cast<std::int32_t>(std::fabs(cosine) * valid);
        v.weight[2][i] = static_cast<std::int32_t>((inward > 0.0F ? inward : 0.0F) * valid);
        v.weight[3][i] = static_cast<std::int32_t>((sideways > 0.0F ? sideways : 0.0F) * valid);
        v.weight[4][i] =
            static_cast<std::int32_t>((azimuth_share < 1.0F ? azimuth_share : 0.0F) * valid);
    }
}

using Bins = std::array<std::int64_t, kShotLength>;

void count_block(const Votes& votes, std::size_t count, Bins& bins) {
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < votes.bin.size(); ++k) {
            bins[static_cast<std::size_t>(votes.bin[k][i])] += votes.weight[k][i];
        }
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
    const Axes axes{frame(0, 0), frame(0, 1), frame(0, 2), frame(1, 0), frame(1, 1),
                    frame(1, 2), frame(2, 0), frame(2, 1), frame(2, 2)};
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

LocalDescriptors describe_shot(const PointCloud& cloud, std::span<const Vec3f> keypoints,
                               const ShotSettings& settings) {
    require_search(cloud, keypoints, settings.radius, "shot");
    if (!cloud.empty()) require_normals(cloud, "shot");
    LocalDescriptors result;
    result.rows.assign(keypoints.size() * kShotLength, 0.0F);
    result.frames.assign(keypoints.size(), no_frame());
    if (cloud.empty() || keypoints.empty()) return result;
    const Neighborhoods neighborhoods(cloud, settings.radius, true);
    const std::size_t chunks = (keypoints.size() + kChunk - 1) / kChunk;
    parallel_for(chunks, [&](std::size_t chunk) {
        Support support;
        const std::size_t end = std::min(keypoints.size(), (chunk + 1) * kChunk);
        for (std::size_t k = chunk * kChunk; k < end; ++k) {
            neighborhoods.find(keypoints[k], support);
            const std::span<float> row(result.rows.data() + k * kShotLength, kShotLength);
            result.frames[k] = describe_support(support, settings.radius, row);
        }
    });
    return result;
}

LocalDescriptors describe_shot(const PointCloud& cloud, const KdTree& tree,
                               std::span<const Vec3f> keypoints, const ShotSettings& settings) {
    require_support(cloud, tree, keypoints, settings.radius, "shot");
    return describe_shot(cloud, keypoints, settings);
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
