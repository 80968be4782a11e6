// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/surface_elements.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace ostraka {
namespace {

// Farthest-point subset (Eldar et al. 1997), starting from the point farthest from the centroid.
std::vector<std::uint32_t> spread(const std::vector<Vec3f>& points, std::size_t count) {
    const Vec3f center = centroid(points).cast<float>();
    std::vector<float> squared(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) squared[i] = (points[i] - center).squaredNorm();
    std::vector<std::uint32_t> chosen;
    for (std::size_t k = 0; k < std::min(count, points.size()); ++k) {
        const auto next = static_cast<std::uint32_t>(
            std::max_element(squared.begin(), squared.end()) - squared.begin());
        if (k == 0) std::fill(squared.begin(), squared.end(), std::numeric_limits<float>::max());
        chosen.push_back(next);
        for (std::size_t i = 0; i < points.size(); ++i) {
            squared[i] = std::min(squared[i], (points[i] - points[next]).squaredNorm());
        }
    }
    return chosen;
}

}  // namespace

double overlap(const ElementSet& a, const ElementSet& b) {
    int common = 0;
    count_common(a, {&b, 1}, {&common, 1});
    const int either = count_elements(a) + count_elements(b) - common;
    return either > 0 ? static_cast<double>(common) / either : 0.0;
}

int count_elements(const ElementSet& set) {
    int count = 0;
    for (const std::uint64_t word : set) count += std::popcount(word);
    return count;
}

__attribute__((target_clones("default", "popcnt", "arch=icelake-server"))) void count_common(
    const ElementSet& a, std::span<const ElementSet> others, std::span<int> result) {
    for (std::size_t i = 0; i < others.size(); ++i) {
        int common = 0;
        for (std::size_t w = 0; w < a.size(); ++w) common += std::popcount(a[w] & others[i][w]);
        result[i] = common;
    }
}

SurfaceElements::SurfaceElements(const PointCloud& surface) : tree_({}) {
    for (const std::uint32_t i : spread(surface.points, kSurfaceElements)) {
        centers_.push_back(surface.points[i]);
        normals_.push_back(surface.normals[i]);
    }
    tree_ = KdTree(centers_);
}

std::vector<std::uint32_t> SurfaceElements::label(const PointCloud& cloud) const {
    constexpr std::size_t kTried = 6;
    std::vector<std::uint32_t> labels(cloud.size(), kNoIndex);
    std::vector<Neighbor> nearest;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        tree_.nearest(cloud.points[i], kTried, nearest);
        for (const Neighbor& neighbor : nearest) {
            if (normals_[neighbor.index].dot(cloud.normals[i]) > 0.0F) {
                labels[i] = neighbor.index;
                break;
            }
        }
    }
    return labels;
}

ElementSet element_set(std::span<const std::uint32_t> labels,
                       std::span<const std::uint32_t> indices) {
    ElementSet set{};
    for (const std::uint32_t i : indices) {
        const std::uint32_t label = labels[i];
        if (label != kNoIndex) set[label / 64] |= std::uint64_t{1} << (label % 64);
    }
    return set;
}

}  // namespace ostraka
