// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/farthest_points.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr float kFar = std::numeric_limits<float>::max();

// Columns, padded to whole vectors by points that are never farthest.
struct Columns {
    std::vector<float> x, y, z;
    std::vector<float> squared;  // distance from the nearest chosen point
};

Columns columns_of(std::span<const Vec3f> points) {
    const std::size_t padded = (points.size() + kVectorLanes - 1) / kVectorLanes * kVectorLanes;
    Columns columns;
    for (auto* column : {&columns.x, &columns.y, &columns.z}) column->reserve(padded);
    for (const Vec3f& point : points) {
        columns.x.push_back(point.x());
        columns.y.push_back(point.y());
        columns.z.push_back(point.z());
    }
    for (auto* column : {&columns.x, &columns.y, &columns.z}) column->resize(padded, 0.0F);
    columns.squared.assign(points.size(), kFar);
    columns.squared.resize(padded, -1.0F);
    return columns;
}

// Takes a chosen point into account. Returns the largest distance.
OSTRAKA_VECTOR_CLONES float approach(Columns& columns, const Vec3f& place) {
    const Float8 none = Float8{} - 1.0F;
    Float8 largest = none;
    for (std::size_t i = 0; i < columns.x.size(); i += kVectorLanes) {
        Float8 x;
        Float8 y;
        Float8 z;
        Float8 squared;
        load8(columns.x.data() + i, x);
        load8(columns.y.data() + i, y);
        load8(columns.z.data() + i, z);
        load8(columns.squared.data() + i, squared);
        x -= place.x();
        y -= place.y();
        z -= place.z();
        const Float8 distance = x * x + y * y + z * z;
        squared = distance < squared ? distance : squared;
        largest = squared > largest ? squared : largest;
        std::memcpy(columns.squared.data() + i, &squared, sizeof(squared));
    }
    float most = -1.0F;
    for (std::size_t lane = 0; lane < kVectorLanes; ++lane) most = std::max(most, largest[lane]);
    return most;
}

}  // namespace

std::vector<std::uint32_t> farthest_points(std::span<const Vec3f> points, std::size_t count,
                                           std::uint32_t first) {
    Columns columns = columns_of(points);
    std::vector<std::uint32_t> chosen;
    std::uint32_t next = first;
    for (std::size_t k = 0; k < std::min(count, points.size()); ++k) {
        chosen.push_back(next);
        const float most = approach(columns, points[next]);
        next = static_cast<std::uint32_t>(
            std::find(columns.squared.begin(), columns.squared.end(), most) -
            columns.squared.begin());
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
