// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/label_layout.hpp"

#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr int kStep = 6;               // pixels between the places tried
constexpr int kGap = 6;                // pixels between boxes
constexpr double kHiding = 9.0;        // of a whole box, in box widths of distance
constexpr double kCrossing = 2.0;      // of two leaders, in box widths
constexpr double kLongLeader = 120.0;  // pixels, at which a leader costs twice its length
constexpr double kWantedLeader = 34;   // pixels; shorter ones crowd the anchor

// Sums of the costs above and to the left of each pixel.
class CostSums {
  public:
    explicit CostSums(const LabelSpace& space)
        : stride_(static_cast<std::size_t>(space.width) + 1),
          rows_(space.width > 0 ? space.cost.size() / static_cast<std::size_t>(space.width) : 0),
          sums_(stride_ * (rows_ + 1), 0.0) {
        for (std::size_t y = 0; y < rows_; ++y) {
            double row = 0.0;
            for (std::size_t x = 0; x + 1 < stride_; ++x) {
                row += double{space.cost[y * (stride_ - 1) + x]};
                sums_[(y + 1) * stride_ + x + 1] = sums_[y * stride_ + x + 1] + row;
            }
        }
    }
    double inside(const Rectangle& box) const {
        return at(box.right(), box.bottom()) - at(box.x, box.bottom()) - at(box.right(), box.y) +
               at(box.x, box.y);
    }

  private:
    double at(int x, int y) const {
        const auto column =
            static_cast<std::size_t>(std::clamp(x, 0, static_cast<int>(stride_) - 1));
        const auto row = static_cast<std::size_t>(std::clamp(y, 0, static_cast<int>(rows_)));
        return sums_[row * stride_ + column];
    }
    std::size_t stride_;
    std::size_t rows_;
    std::vector<double> sums_;
};

double side_of(const Vec2d& a, const Vec2d& b, const Vec2d& point) {
    return (b.x() - a.x()) * (point.y() - a.y()) - (b.y() - a.y()) * (point.x() - a.x());
}

bool cross(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d) {
    return side_of(a, b, c) * side_of(a, b, d) < 0.0 && side_of(c, d, a) * side_of(c, d, b) < 0.0;
}

bool cuts_box(const Vec2d& from, const Vec2d& to, const Rectangle& box) {
    if (box.contains(static_cast<int>(to.x()), static_cast<int>(to.y()))) return true;
    const Vec2d left_top(box.x, box.y);
    const Vec2d right_top(box.right(), box.y);
    const Vec2d left_bottom(box.x, box.bottom());
    const Vec2d right_bottom(box.right(), box.bottom());
    return cross(from, to, left_top, right_bottom) || cross(from, to, right_top, left_bottom);
}

Rectangle grown(const Rectangle& box, int by) {
    return {box.x - by, box.y - by, box.width + 2 * by, box.height + 2 * by};
}

struct Placed {
    Rectangle box;
    Vec2d anchor = Vec2d::Zero();
};

// The cost of a place, or a negative number where it isn't free.
double cost_of(const Rectangle& box, const LabelRequest& request, const CostSums& sums,
               const std::vector<Placed>& placed, double limit) {
    const Vec2d start = leader_start(box, request.anchor);
    const double length = (start - request.anchor).norm();
    double cost =
        length * (1.0 + length / kLongLeader) + 1.5 * std::max(0.0, kWantedLeader - length);
    const double covered = sums.inside(grown(box, 3));
    cost += kHiding * covered / std::max(1, box.height);
    if (cost >= limit) return -1.0;
    for (const Placed& other : placed) {
        if (overlap(grown(box, kGap), other.box)) return -1.0;
        if (cuts_box(start, request.anchor, other.box)) return -1.0;
        const Vec2d other_start = leader_start(other.box, other.anchor);
        if (cuts_box(other_start, other.anchor, grown(box, 2))) return -1.0;
        if (cross(start, request.anchor, other_start, other.anchor)) {
            cost += kCrossing * request.width;
        }
    }
    return cost;
}

std::optional<Rectangle> place(const LabelRequest& request, const Rectangle& area,
                               const CostSums& sums, const std::vector<Placed>& placed) {
    std::optional<Rectangle> best;
    double best_cost = 1e9;
    for (int y = area.y; y + request.height <= area.bottom(); y += kStep) {
        for (int x = area.x; x + request.width <= area.right(); x += kStep) {
            const Rectangle box{x, y, request.width, request.height};
            const double cost = cost_of(box, request, sums, placed, best_cost);
            if (cost < 0.0 || cost >= best_cost) continue;
            best_cost = cost;
            best = box;
        }
    }
    return best;
}

}  // namespace

std::vector<std::optional<Rectangle>> place_labels(std::span<const LabelRequest> requests,
                                                   const LabelSpace& space) {
    const CostSums sums(space);
    std::vector<std::optional<Rectangle>> boxes;
    std::vector<Placed> placed;
    for (const LabelRequest& request : requests) {
        boxes.push_back(place(request, space.area, sums, placed));
        if (boxes.back()) placed.push_back({*boxes.back(), request.anchor});
    }
    return boxes;
}

Vec2d leader_start(const Rectangle& box, const Vec2d& anchor) {
    return {std::clamp(anchor.x(), double(box.x), double(box.right() - 1)),
            std::clamp(anchor.y(), double(box.y), double(box.bottom() - 1))};
}

}  // namespace ostraka
