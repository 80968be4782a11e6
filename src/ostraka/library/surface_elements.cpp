// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/surface_elements.hpp"

#include <bit>

#include "ostraka/cloud/farthest_points.hpp"

namespace ostraka {

double overlap(const ElementSet& a, const ElementSet& b) {
    int common = 0;
    int either = 0;
    for (std::size_t w = 0; w < a.size(); ++w) {
        common += std::popcount(a[w] & b[w]);
        either += std::popcount(a[w] | b[w]);
    }
    return either > 0 ? static_cast<double>(common) / either : 0.0;
}

int count_elements(const ElementSet& set) {
    int count = 0;
    for (const std::uint64_t word : set) count += std::popcount(word);
    return count;
}

SurfaceElements::SurfaceElements(const PointCloud& surface) : tree_({}) {
    const Vec3f center = centroid(surface.points).cast<float>();
    const std::uint32_t first = farthest_from(surface.points, center);
    for (const std::uint32_t i : farthest_points(surface.points, kSurfaceElements, first)) {
        centers_.push_back(surface.points[i]);
        normals_.push_back(surface.normals[i]);
    }
    tree_ = KdTree(centers_);
}

std::vector<std::uint32_t> SurfaceElements::label(const PointCloud& cloud) const {
    constexpr std::size_t kTried = 6;
    std::vector<std::uint32_t> labels(cloud.size(), kNoIndex);
    std::vector<Neighbor> nearest;
    const auto faces = [&](std::uint32_t element, std::size_t i) {
        return normals_[element].dot(cloud.normals[i]) > 0.0F;
    };
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const std::uint32_t first = tree_.nearest(cloud.points[i]).index;
        if (faces(first, i)) {  // nearly always, and found at a third of the cost of several
            labels[i] = first;
            continue;
        }
        tree_.nearest(cloud.points[i], kTried, nearest);
        for (const Neighbor& neighbor : nearest) {
            if (faces(neighbor.index, i)) {
                labels[i] = neighbor.index;
                break;
            }
        }
    }
    return labels;
}

ElementMap SurfaceElements::map(const Pose& T_surface_surface) const {
    const Mat3f R = T_surface_surface.linear().cast<float>();
    PointCloud moved;
    for (std::size_t i = 0; i < centers_.size(); ++i) {
        moved.points.push_back((T_surface_surface * centers_[i].cast<double>()).cast<float>());
        moved.normals.push_back(R * normals_[i]);
    }
    return label(moved);
}

ElementSet mapped(const ElementSet& set, const ElementMap& map) {
    ElementSet result{};
    for (std::size_t word = 0; word < set.size(); ++word) {
        for (std::uint64_t bits = set[word]; bits != 0; bits &= bits - 1) {
            const std::size_t element =
                64 * word + static_cast<std::size_t>(std::countr_zero(bits));
            const std::uint32_t to = element < map.size() ? map[element] : kNoIndex;
            if (to != kNoIndex) result[to / 64] |= std::uint64_t{1} << (to % 64);
        }
    }
    return result;
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
