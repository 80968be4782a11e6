// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/cell_order.hpp"

#include <algorithm>

namespace ostraka {
namespace {

constexpr double kCellsPerPoint = 16.0;
constexpr double kAlwaysAllowed = 4096.0;  // cells

struct Box {
    Vec3f low, high;
};

Box box_of(std::span<const Vec3f> points) {
    if (points.empty()) return {Vec3f::Zero(), Vec3f::Zero()};
    Box box{points.front(), points.front()};
    for (const Vec3f& point : points) {
        box.low = box.low.cwiseMin(point);
        box.high = box.high.cwiseMax(point);
    }
    return box;
}

// Seven eighths of the points, by a sample, and half as much around them.
Box box_of_most(std::span<const Vec3f> points, const Box& all) {
    constexpr std::size_t kSamples = 256;
    const std::size_t step = std::max<std::size_t>(1, points.size() / kSamples);
    Box box = all;
    std::vector<float> values;
    for (int axis = 0; axis < 3; ++axis) {
        values.clear();
        for (std::size_t i = 0; i < points.size(); i += step) values.push_back(points[i][axis]);
        std::sort(values.begin(), values.end());
        const float low = values[values.size() / 16];
        const float high = values[values.size() - 1 - values.size() / 16];
        const float border = 0.5F * (high - low);
        box.low[axis] = std::max(box.low[axis], low - border);
        box.high[axis] = std::min(box.high[axis], high + border);
    }
    return box;
}

// As a double, because the number may be huge.
double cells_in(const Box& box, double cell) {
    double cells = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        cells *= std::floor((double{box.high[axis]} - double{box.low[axis]}) / cell) + 1.0;
    }
    return cells;
}

}  // namespace

CellOrder::CellOrder(std::span<const Vec3f> points, float cell) {
    const double most = kCellsPerPoint * static_cast<double>(points.size()) + kAlwaysAllowed;
    Box box = box_of(points);
    if (cells_in(box, cell) > most) box = box_of_most(points, box);
    double side = cell;
    while (cells_in(box, side) > most) side *= 1.25;
    low_ = box.low;
    cells_per_length_ = static_cast<float>(1.0 / side);
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double length = double{box.high[axis]} - double{box.low[axis]};
        cells_[a] = static_cast<std::size_t>(length / side) + 1;
        last_[a] = static_cast<float>(cells_[a] - 1);
    }
    // A counting sort. starts_[c + 1] is where the next point of cell c goes.
    const std::size_t count = cells_[0] * cells_[1] * cells_[2];
    starts_.assign(count + 2, 0);
    order_.resize(points.size());
    std::vector<std::uint32_t> cell_of(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        cell_of[i] = static_cast<std::uint32_t>(cell_at(points[i]));
        ++starts_[cell_of[i] + 2];
    }
    for (std::size_t c = 2; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
    for (std::uint32_t i = 0; i < points.size(); ++i) order_[starts_[cell_of[i] + 1]++] = i;
    starts_.pop_back();
}

}  // namespace ostraka
