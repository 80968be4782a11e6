// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/distance_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace ostraka {
namespace {

constexpr int kAxisBits = 21;

// Neighbors of a block have keys too: numbers start at 1.
std::uint64_t key_of(const Eigen::Vector3i& block) {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
        key = key << kAxisBits | static_cast<std::uint64_t>(block[axis] + 1);
    }
    return key;
}

Eigen::Vector3i block_of(std::uint64_t key) {
    constexpr std::uint64_t kMask = (std::uint64_t{1} << kAxisBits) - 1;
    return {static_cast<int>(key >> (2 * kAxisBits)) - 1,
            static_cast<int>(key >> kAxisBits & kMask) - 1, static_cast<int>(key & kMask) - 1};
}

Eigen::Vector3i block_around(const Vec3f& point) {
    return (point / static_cast<float>(kBlockSide)).array().floor().cast<int>();
}

template <class Visit>
void for_neighbors(const Eigen::Vector3i& block, const Visit& visit) {
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) visit(Eigen::Vector3i(block + Eigen::Vector3i(x, y, z)));
        }
    }
}

// A point of a sparse part stands for more surface: the same weight for the same area.
float area_weight(const Splat& splat) {
    return splat.radius * splat.radius;
}

}  // namespace

FieldValue field_at(const Vec3f& place, std::span<const Splat> splats, const Vec3f& facing) {
    constexpr float kBack = -0.2F;  // cosine
    FieldValue value;
    for (const Splat& splat : splats) {
        const Vec3f off = place - splat.point;
        const float ratio = off.squaredNorm() / (splat.radius * splat.radius);
        if (!(ratio < kReach * kReach) || splat.normal.dot(facing) < kBack) continue;
        const float weight = area_weight(splat) * std::exp(-ratio);
        value.weight += weight;
        value.distance += weight * off.dot(splat.normal);
        value.radius += weight * splat.radius;
        value.normal += weight * splat.normal;
        value.aside -= weight * off;
    }
    if (value.weight > 0.0F) {
        value.distance /= value.weight;
        value.radius /= value.weight;
        value.normal /= value.weight;
        value.aside /= value.weight;
    }
    return value;
}

DistanceBlocks::DistanceBlocks(std::span<const Splat> splats) : splats_(splats) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(splats.size());
    for (std::uint32_t i = 0; i < splats.size(); ++i) {
        keyed[i] = {key_of(block_around(splats[i].point)), i};
    }
    std::sort(keyed.begin(), keyed.end());
    for (std::uint32_t i = 0; i < keyed.size(); ++i) {
        if (held_.empty() || held_.back() != keyed[i].first) {
            held_.push_back(keyed[i].first);
            start_.push_back(i);
        }
        order_.push_back(keyed[i].second);
    }
    start_.push_back(static_cast<std::uint32_t>(keyed.size()));
    for (const std::uint64_t key : held_) {
        for_neighbors(block_of(key),
                      [&](const Eigen::Vector3i& near) { keys_.push_back(key_of(near)); });
    }
    std::sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
}

Eigen::Vector3i DistanceBlocks::origin(std::size_t block) const {
    return kBlockSide * block_of(keys_[block]);
}

std::uint32_t DistanceBlocks::find(const Eigen::Vector3i& cell) const {
    const std::uint64_t key = key_of(block_around(cell.cast<float>()));
    const auto found = std::lower_bound(keys_.begin(), keys_.end(), key);
    if (found == keys_.end() || *found != key) return kNoIndex;
    return static_cast<std::uint32_t>(found - keys_.begin());
}

void DistanceBlocks::gather(std::size_t block, std::vector<Splat>& near) const {
    near.clear();
    const Vec3f low = origin(block).cast<float>();
    const Vec3f high = low + Vec3f::Constant(static_cast<float>(kBlockSide));
    for_neighbors(block_of(keys_[block]), [&](const Eigen::Vector3i& other) {
        const std::uint64_t key = key_of(other);
        const auto found = std::lower_bound(held_.begin(), held_.end(), key);
        if (found == held_.end() || *found != key) return;
        const auto at = static_cast<std::size_t>(found - held_.begin());
        for (std::uint32_t i = start_[at]; i < start_[at + 1]; ++i) {
            const Splat& splat = splats_[order_[i]];
            const Vec3f nearest = splat.point.cwiseMax(low).cwiseMin(high);
            const float reach = kReach * splat.radius;
            if ((nearest - splat.point).squaredNorm() < reach * reach) near.push_back(splat);
        }
    });
}

void fill_distances(const Eigen::Vector3i& origin, std::span<const Splat> near,
                    std::vector<float>& distances) {
    constexpr std::size_t kCount = std::size_t{kCorners} * kCorners * kCorners;
    std::array<float, kCount> weights{};
    distances.assign(kCount, 0.0F);
    for (const Splat& splat : near) {
        const float reach = kReach * splat.radius;
        const float shrink = 1.0F / (splat.radius * splat.radius);
        const Eigen::Vector3i low =
            (splat.point.array() - reach).ceil().cast<int>().matrix() - origin;
        const Eigen::Vector3i high =
            (splat.point.array() + reach).floor().cast<int>().matrix() - origin;
        const Eigen::Vector3i first = low.cwiseMax(0);
        const Eigen::Vector3i last = high.cwiseMin(kBlockSide);
        for (int z = first.z(); z <= last.z(); ++z) {
            for (int y = first.y(); y <= last.y(); ++y) {
                for (int x = first.x(); x <= last.x(); ++x) {
                    const Vec3f place = (origin + Eigen::Vector3i(x, y, z)).cast<float>();
                    const Vec3f off = place - splat.point;
                    const float ratio = off.squaredNorm() * shrink;
                    if (!(ratio < kReach * kReach)) continue;
                    const float weight = area_weight(splat) * std::exp(-ratio);
                    const auto at = static_cast<std::size_t>((z * kCorners + y) * kCorners + x);
                    weights[at] += weight;
                    distances[at] += weight * off.dot(splat.normal);
                }
            }
        }
    }
    for (std::size_t i = 0; i < kCount; ++i) {
        distances[i] =
            weights[i] > 0.0F ? distances[i] / weights[i] : std::numeric_limits<float>::quiet_NaN();
    }
}

}  // namespace ostraka
