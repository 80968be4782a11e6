// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/cell_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

constexpr std::uint64_t kAxisBits = 21;
constexpr double kMaxCells = 1048576.0;  // leaves room in 21 bits for the border of neighborhoods

}  // namespace

CellGrid::CellGrid(std::span<const Vec3f> points, double cell) {
    Vec3f low = Vec3f::Zero();
    Vec3f high = Vec3f::Zero();
    if (!points.empty()) low = high = points.front();
    for (const Vec3f& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    const double extent = (high - low).cast<double>().maxCoeff();
    if (!(cell > 0.0) || !(extent / cell < kMaxCells)) {
        throw InvalidInput(
            fmt::format("points span {:.6g} units, too much for cells of {:.6g}: check the unit",
                        extent, cell));
    }
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        std::uint64_t key = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double offset = double{points[i][axis]} - double{low[axis]};
            key = key << kAxisBits | (static_cast<std::uint64_t>(offset / cell) + 1);
        }
        keyed[i] = {key, i};
    }
    std::sort(keyed.begin(), keyed.end());
    order_.resize(points.size());
    cell_of_.resize(points.size());
    for (std::uint32_t i = 0; i < keyed.size(); ++i) {
        if (i == 0 || keyed[i].first != keyed[i - 1].first) {
            keys_.push_back(keyed[i].first);
            starts_.push_back(i);
        }
        order_[i] = keyed[i].second;
        cell_of_[keyed[i].second] = static_cast<std::uint32_t>(keys_.size() - 1);
    }
    starts_.push_back(static_cast<std::uint32_t>(points.size()));
}

void CellGrid::neighborhood(std::size_t c, std::vector<std::uint32_t>& cells) const {
    cells.clear();
    const std::uint64_t key = keys_[c];
    for (std::uint64_t x = 0; x < 3; ++x) {
        for (std::uint64_t y = 0; y < 3; ++y) {
            // The three cells along z are consecutive keys.
            const std::uint64_t first = key + (x << (2 * kAxisBits)) -
                                        (std::uint64_t{1} << (2 * kAxisBits)) + (y << kAxisBits) -
                                        (std::uint64_t{1} << kAxisBits) - 1;
            auto it = std::lower_bound(keys_.begin(), keys_.end(), first);
            for (; it != keys_.end() && *it <= first + 2; ++it) {
                cells.push_back(static_cast<std::uint32_t>(it - keys_.begin()));
            }
        }
    }
}

}  // namespace ostraka
