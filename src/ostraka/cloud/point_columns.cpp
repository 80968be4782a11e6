// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/point_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kPadding = 8;
constexpr double kColumnsPerPoint = 4.0;
constexpr double kLeastColumns = 1024.0;
// Boxes are a little wider than their balls, beyond what rounding may do to a squared distance.
constexpr float kWiden = 1.00001F;

// Writes the slots in the runs that lie in the ball, branch-free, and how many.
// `slots` and `squared` have room for all slots in the runs.
OSTRAKA_VECTOR_CLONES
std::size_t filter(const SlotRun* runs, std::size_t count, const float* x, const float* y,
                   const float* z, const float* query, float squared_radius, std::uint32_t* slots,
                   float* squared) {
    const float qx = query[0];
    const float qy = query[1];
    const float qz = query[2];
    std::size_t found = 0;
    for (std::size_t r = 0; r < count; ++r) {
        for (std::uint32_t i = runs[r].begin; i < runs[r].end; ++i) {
            const float dx = qx - x[i];
            const float dy = qy - y[i];
            const float dz = qz - z[i];
            const float distance = dx * dx + dy * dy + dz * dz;
            slots[found] = i;
            squared[found] = distance;
            found += distance < squared_radius ? 1U : 0U;
        }
    }
    return found;
}

struct Bounds {
    std::array<double, 3> low{};
    std::array<double, 3> extent{};
};

Bounds bounds_of(std::span<const Vec3f> points) {
    Bounds bounds;
    if (points.empty()) return bounds;
    Vec3f low = points.front();
    Vec3f high = points.front();
    for (const Vec3f& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        bounds.low[axis] = double{low[a]};
        bounds.extent[axis] = double{high[a]} - double{low[a]};
    }
    return bounds;
}

}  // namespace

PointColumns::PointColumns(std::span<const Vec3f> points, double side) {
    if (!(side > 0.0))
        throw InvalidInput(fmt::format("columns: side {:g}, must be positive", side));
    const Bounds bounds = bounds_of(points);
    std::stable_sort(axes_.begin(), axes_.end(), [&](std::size_t a, std::size_t b) {
        return bounds.extent[a] > bounds.extent[b];
    });
    const double most =
        std::max(kLeastColumns, kColumnsPerPoint * static_cast<double>(points.size()));
    const double u = bounds.extent[axes_[0]];
    const double v = bounds.extent[axes_[1]];
    while ((std::floor(u / side) + 1.0) * (std::floor(v / side) + 1.0) > most) side *= 1.25;
    inverse_side_ = 1.0 / side;
    for (std::size_t k = 0; k < 2; ++k) {
        low_[k] = bounds.low[axes_[k]];
        counts_[k] = static_cast<std::size_t>(bounds.extent[axes_[k]] * inverse_side_) + 1;
    }
    // Counting sort by column, then each column by height.
    std::vector<std::uint32_t> column_of(points.size());
    starts_.assign(counts_[0] * counts_[1] + 1, 0);
    const auto a0 = static_cast<Eigen::Index>(axes_[0]);
    const auto a1 = static_cast<Eigen::Index>(axes_[1]);
    const auto a2 = static_cast<Eigen::Index>(axes_[2]);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t c =
            cell(0, double{points[i][a0]}) * counts_[1] + cell(1, double{points[i][a1]});
        column_of[i] = static_cast<std::uint32_t>(c);
        ++starts_[c + 1];
    }
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    struct Keyed {
        float height;
        std::uint32_t index;
    };
    std::vector<Keyed> keyed(points.size());
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        keyed[next[column_of[i]]++] = {points[i][a2], i};
    }
    const auto before = [&](const Keyed& a, const Keyed& b) {
        if (a.height != b.height) return a.height < b.height;
        const Vec3f& p = points[a.index];
        const Vec3f& q = points[b.index];
        if (p[a1] != q[a1]) return p[a1] < q[a1];
        if (p[a0] != q[a0]) return p[a0] < q[a0];
        return a.index < b.index;
    };
    for (std::size_t c = 0; c + 1 < starts_.size(); ++c) {
        if (starts_[c + 1] - starts_[c] < 2) continue;
        std::sort(keyed.begin() + starts_[c], keyed.begin() + starts_[c + 1], before);
    }
    order_.resize(points.size());
    for (std::size_t slot = 0; slot < points.size(); ++slot) order_[slot] = keyed[slot].index;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::vector<float>& column = coordinates_[axis];
        column.assign(points.size() + kPadding, std::numeric_limits<float>::infinity());
        for (std::size_t slot = 0; slot < points.size(); ++slot) {
            column[slot] = points[order_[slot]][static_cast<Eigen::Index>(axis)];
        }
    }
}

std::size_t PointColumns::cell(std::size_t side_axis, double coordinate) const {
    const double at = (coordinate - low_[side_axis]) * inverse_side_;
    const std::size_t last = counts_[side_axis] - 1;
    // Compared as doubles: an infinite or NaN coordinate doesn't fit an integer.
    if (!(at > 0.0)) return 0;
    return at < static_cast<double>(last) ? static_cast<std::size_t>(at) : last;
}

void PointColumns::runs_in_box(const Vec3f& low, const Vec3f& high,
                               std::vector<SlotRun>& runs) const {
    runs.clear();
    if (order_.empty()) return;
    const auto bound = [&](const Vec3f& corner, std::size_t k) {
        return double{corner[static_cast<Eigen::Index>(axes_[k])]};
    };
    const float bottom = low[static_cast<Eigen::Index>(axes_[2])];
    const float top = high[static_cast<Eigen::Index>(axes_[2])];
    const float* height = coordinates_[axes_[2]].data();
    const std::size_t first = cell(1, bound(low, 1));
    const std::size_t last = cell(1, bound(high, 1));
    for (std::size_t u = cell(0, bound(low, 0)); u <= cell(0, bound(high, 0)); ++u) {
        for (std::size_t c = u * counts_[1] + first; c <= u * counts_[1] + last; ++c) {
            const float* begin = height + starts_[c];
            const float* end = height + starts_[c + 1];
            if (begin == end) continue;
            // Often the whole column is inside.
            if (*begin < bottom) begin = std::lower_bound(begin, end, bottom);
            if (begin == end) continue;
            if (*(end - 1) > top) end = std::upper_bound(begin, end, top);
            if (begin == end) continue;
            const auto from = static_cast<std::uint32_t>(begin - height);
            const auto to = static_cast<std::uint32_t>(end - height);
            if (!runs.empty() && runs.back().end == from) {
                runs.back().end = to;
            } else {
                runs.push_back({from, to});
            }
        }
    }
}

void PointColumns::slots_within(const Vec3f& query, float radius, std::vector<std::uint32_t>& slots,
                                std::vector<float>& squared_distances) const {
    thread_local std::vector<SlotRun> runs;
    // One step outward for the rounding of the corners.
    const Vec3f half = Vec3f::Constant(radius * kWiden);
    constexpr float kFar = std::numeric_limits<float>::infinity();
    const auto down = [](float value) { return std::nextafter(value, -kFar); };
    const auto up = [](float value) { return std::nextafter(value, kFar); };
    runs_in_box((query - half).unaryExpr(down), (query + half).unaryExpr(up), runs);
    std::size_t room = 1;  // a rejected candidate is written, too, before the next one
    for (const SlotRun& run : runs) room += run.end - run.begin;
    slots.resize(room);
    squared_distances.resize(room);
    const std::size_t found = filter(runs.data(), runs.size(), coordinates_[0].data(),
                                     coordinates_[1].data(), coordinates_[2].data(), query.data(),
                                     radius * radius, slots.data(), squared_distances.data());
    slots.resize(found);
    squared_distances.resize(found);
}

void PointColumns::within(const Vec3f& query, float radius,
                          std::vector<Neighbor>& neighbors) const {
    thread_local std::vector<std::uint32_t> slots;
    thread_local std::vector<float> squared;
    slots_within(query, radius, slots, squared);
    neighbors.resize(slots.size());
    for (std::size_t i = 0; i < slots.size(); ++i) neighbors[i] = {order_[slots[i]], squared[i]};
}

void PointColumns::nearest_in_column(std::size_t c, const Vec3f& query, std::uint32_t& slot,
                                     float& squared_distance) const {
    const float* height = coordinates_[axes_[2]].data();
    const float at = query[static_cast<Eigen::Index>(axes_[2])];
    const std::uint32_t begin = starts_[c];
    const std::uint32_t end = starts_[c + 1];
    const auto middle = static_cast<std::uint32_t>(
        end - begin > 8 ? std::lower_bound(height + begin, height + end, at) - height : begin);
    const auto look = [&](std::uint32_t s) {
        const float dx = query.x() - coordinates_[0][s];
        const float dy = query.y() - coordinates_[1][s];
        const float dz = query.z() - coordinates_[2][s];
        const float squared = dx * dx + dy * dy + dz * dz;
        if (squared < squared_distance) {
            squared_distance = squared;
            slot = s;
        }
    };
    const auto beyond = [&](std::uint32_t s) {
        return (height[s] - at) * (height[s] - at) >= squared_distance;
    };
    for (std::uint32_t s = middle; s < end && !(height[s] > at && beyond(s)); ++s) look(s);
    for (std::uint32_t s = middle; s > begin && !beyond(s - 1); --s) look(s - 1);
}

void PointColumns::nearest_seed(const Vec3f& query, std::uint32_t& slot,
                                float& squared_distance) const {
    const auto own_u =
        static_cast<std::ptrdiff_t>(cell(0, double{query[static_cast<Eigen::Index>(axes_[0])]}));
    const auto own_v =
        static_cast<std::ptrdiff_t>(cell(1, double{query[static_cast<Eigen::Index>(axes_[1])]}));
    const auto rows = static_cast<std::ptrdiff_t>(counts_[0]);
    const auto width = static_cast<std::ptrdiff_t>(counts_[1]);
    const double limit = std::sqrt(double{squared_distance}) * inverse_side_ + 1.0;
    const std::uint32_t none = slot;
    for (std::ptrdiff_t ring = 0; ring < std::max(rows, width); ++ring) {
        if (static_cast<double>(ring) > limit) return;
        for (std::ptrdiff_t u = std::max<std::ptrdiff_t>(0, own_u - ring);
             u <= std::min(rows - 1, own_u + ring); ++u) {
            // Of the inner rows only the two ends belong to the ring.
            const bool full = u == own_u - ring || u == own_u + ring;
            const std::ptrdiff_t step = full || ring == 0 ? 1 : 2 * ring;
            for (std::ptrdiff_t v = own_v - ring; v <= own_v + ring; v += step) {
                if (v < 0 || v >= width) continue;
                nearest_in_column(static_cast<std::size_t>(u * width + v), query, slot,
                                  squared_distance);
            }
        }
        if (slot != none) return;
    }
}

std::uint32_t PointColumns::nearest_slot(const Vec3f& query, std::uint32_t slot,
                                         float& squared_distance) const {
    if (order_.empty()) return slot;
    if (slot == kNoIndex) nearest_seed(query, slot, squared_distance);
    if (slot == kNoIndex) return slot;
    const double reach = std::sqrt(double{squared_distance}) * double{kWiden};
    const auto at = [&](std::size_t k) {
        return double{query[static_cast<Eigen::Index>(axes_[k])]};
    };
    const std::size_t first = cell(1, at(1) - reach);
    const std::size_t last = cell(1, at(1) + reach);
    const std::size_t last_row = cell(0, at(0) + reach);
    for (std::size_t u = cell(0, at(0) - reach); u <= last_row; ++u) {
        for (std::size_t v = first; v <= last; ++v) {
            nearest_in_column(u * counts_[1] + v, query, slot, squared_distance);
        }
    }
    return slot;
}

}  // namespace ostraka
