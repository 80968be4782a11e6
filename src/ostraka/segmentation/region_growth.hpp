// SPDX-License-Identifier: Apache-2.0
// Private to this module: regions that grow through connected points, cheapest point first.
// Adams, Bischof. Seeded Region Growing. PAMI 16(6), 1994.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "ostraka/cloud/clusters.hpp"

namespace ostraka {

inline constexpr float kNever = std::numeric_limits<float>::infinity();

/// Bids of regions for points, cheapest first. Costs are rounded down to 1/64, those of 4 and more
/// are equal: far cheaper than exact order, and patches don't notice. Equal ones come latest first.
class BidQueue {
  public:
    struct Bid {
        std::uint32_t point;
        std::uint32_t region;
    };
    void push(float cost, Bid bid) {
        const auto level = static_cast<std::size_t>(std::min(kTop, cost * kPerUnit));
        levels_.at(level).push_back(bid);
        lowest_ = std::min(lowest_, level);
    }
    /// False if there is none.
    bool pop(Bid& bid) {
        while (lowest_ < levels_.size() && levels_.at(lowest_).empty()) ++lowest_;
        if (lowest_ == levels_.size()) return false;
        bid = levels_.at(lowest_).back();
        levels_.at(lowest_).pop_back();
        return true;
    }

  private:
    static constexpr float kPerUnit = 64.0F;
    static constexpr float kTop = 255.0F;
    std::array<std::vector<Bid>, 256> levels_;
    std::size_t lowest_ = 0;
};

/// Grows regions from the points they own already. @param cost  (point, region) -> float, 0 or
/// more; kNever: not there. A point goes to the region that bids least among those that reach it.
/// @param owner  in and out: the region of each point, or kNoIndex.
template <class Cost>
void grow_regions(const ProximityGraph& graph, std::vector<std::uint32_t>& owner,
                  const Cost& cost) {
    std::vector<float> lowest(owner.size(), kNever);
    BidQueue bids;
    const auto bid_around = [&](std::uint32_t point, std::uint32_t region) {
        for (std::uint32_t n = graph.starts[point]; n < graph.starts[point + 1]; ++n) {
            const std::uint32_t next = graph.neighbors[n];
            if (owner[next] != kNoIndex) continue;
            const float price = std::max(0.0F, cost(next, region));
            if (!(price < lowest[next])) continue;  // also where it is kNever
            lowest[next] = price;
            bids.push(price, {next, region});
        }
    };
    for (std::uint32_t i = 0; i < owner.size(); ++i) {
        if (owner[i] != kNoIndex) bid_around(i, owner[i]);
    }
    for (BidQueue::Bid bid{}; bids.pop(bid);) {
        if (owner[bid.point] != kNoIndex) continue;
        owner[bid.point] = bid.region;
        bid_around(bid.point, bid.region);
    }
}

}  // namespace ostraka
