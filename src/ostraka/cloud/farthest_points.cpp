// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/farthest_points.hpp"

#include <algorithm>
#include <limits>

namespace ostraka {
namespace {

std::uint32_t first_of_largest(const std::vector<float>& values) {
    return static_cast<std::uint32_t>(std::max_element(values.begin(), values.end()) -
                                      values.begin());
}

}  // namespace

std::vector<std::uint32_t> farthest_points(std::span<const Vec3f> points, std::size_t count,
                                           std::uint32_t first) {
    std::vector<float> squared(points.size(), std::numeric_limits<float>::max());
    std::vector<std::uint32_t> chosen;
    std::uint32_t next = first;
    for (std::size_t k = 0; k < std::min(count, points.size()); ++k) {
        chosen.push_back(next);
        const Vec3f place = points[next];
        for (std::size_t i = 0; i < points.size(); ++i) {
            squared[i] = std::min(squared[i], (points[i] - place).squaredNorm());
        }
        next = first_of_largest(squared);
    }
    return chosen;
}

std::uint32_t farthest_from(std::span<const Vec3f> points, const Vec3f& place) {
    const auto nearer = [&](const Vec3f& a, const Vec3f& b) {
        return (a - place).squaredNorm() < (b - place).squaredNorm();
    };
    return static_cast<std::uint32_t>(std::max_element(points.begin(), points.end(), nearer) -
                                      points.begin());
}

}  // namespace ostraka
