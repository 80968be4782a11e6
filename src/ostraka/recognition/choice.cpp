// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/choice.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace ostraka {
namespace {

constexpr double kMaxShared = 0.35;    // of the smaller support of two that may stand together
constexpr double kSamePlace = 0.7;     // of the smaller support of two poses at the same place
constexpr double kSamePiece = 0.5;     // of the smaller support of rivals
constexpr double kUnexplained = 20.0;  // logits that a rival loses with what it leaves unexplained:
                                       // log loss is flat from 10 to 50 (boxy parts in bins)
constexpr double kSurest = 1.0 - 1e-9;  // a confidence whose odds are finite
constexpr double kAsMuch = 0.9;         // of the explained value of another pose of the model
constexpr double kLeastDoubt = 1e-3;    // what is surer is as sure
constexpr int kMaxSteps = 200'000;      // of branch and bound, a group of conflicting hypotheses

std::size_t shared_cells(const Verified& a, const Verified& b) {
    if (a.cells.empty() || b.cells.empty()) return 0;
    if (a.cells.back() < b.cells.front() || b.cells.back() < a.cells.front()) return 0;
    std::size_t shared = 0;
    for (auto i = a.cells.begin(), j = b.cells.begin(); i != a.cells.end() && j != b.cells.end();) {
        if (*i < *j) {
            ++i;
        } else if (*j < *i) {
            ++j;
        } else {
            ++shared, ++i, ++j;
        }
    }
    return shared;
}

// Finds the set of greatest value without conflicts in one group. Members are in descending value.
class Search {
  public:
    Search(std::vector<double> values, std::vector<std::vector<bool>> conflicts)
        : values_(std::move(values)), conflicts_(std::move(conflicts)) {}

    std::vector<std::size_t> best() {
        std::vector<bool> free(values_.size(), true);
        branch(0, 0.0, free);
        return best_;
    }

  private:
    // No more can be had of what is free from `next` on.
    double bound(std::size_t next, const std::vector<bool>& free) const {
        double sum = 0.0;
        for (std::size_t i = next; i < values_.size(); ++i) {
            if (free[i]) sum += values_[i];
        }
        return sum;
    }

    void branch(std::size_t next, double value, const std::vector<bool>& free) {
        while (next < values_.size() && !free[next]) ++next;
        if (value > best_value_) {
            best_value_ = value;
            best_ = taken_;
        }
        if (next == values_.size() || ++steps_ > kMaxSteps) return;
        if (value + bound(next, free) <= best_value_) return;
        std::vector<bool> left = free;
        for (std::size_t i = next; i < left.size(); ++i) {
            if (conflicts_[next][i]) left[i] = false;
        }
        taken_.push_back(next);
        branch(next + 1, value + values_[next], left);
        taken_.pop_back();
        branch(next + 1, value, free);
    }

    std::vector<double> values_;
    std::vector<std::vector<bool>> conflicts_;
    std::vector<std::size_t> taken_;
    std::vector<std::size_t> best_;
    double best_value_ = 0.0;
    int steps_ = 0;
};

std::vector<std::vector<bool>> conflicts_of(std::span<const Verified* const> candidates,
                                            const std::vector<std::size_t>& able) {
    const std::size_t n = able.size();
    std::vector<std::vector<bool>> conflicts(n, std::vector<bool>(n, false));
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            conflicts[i][j] = conflicts[j][i] =
                in_conflict(*candidates[able[i]], *candidates[able[j]]);
        }
    }
    return conflicts;
}

bool same_place(const Verified& a, const Verified& b) {
    return a.hypothesis.model == b.hypothesis.model && shared_support(a, b) > kSamePlace;
}

// Items that conflict, directly or through others, are in one group. Ascending indices.
std::vector<std::vector<std::size_t>> groups_of(const std::vector<std::vector<bool>>& conflicts) {
    std::vector<bool> seen(conflicts.size(), false);
    std::vector<std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < conflicts.size(); ++i) {
        if (seen[i]) continue;
        std::vector<std::size_t> group = {i};
        seen[i] = true;
        for (std::size_t k = 0; k < group.size(); ++k) {
            for (std::size_t j = 0; j < conflicts.size(); ++j) {
                if (!conflicts[group[k]][j] || seen[j]) continue;
                seen[j] = true;
                group.push_back(j);
            }
        }
        std::sort(group.begin(), group.end());
        groups.push_back(std::move(group));
    }
    return groups;
}

// @param support  cells of the piece that it may explain.
double rival_odds(const Verified& v, std::size_t support) {
    const double share =
        std::min(1.0, static_cast<double>(v.support) / static_cast<double>(support));
    const double confidence = std::min(v.confidence, kSurest);
    return confidence / (1.0 - confidence) * std::exp(-kUnexplained * (1.0 - share));
}

// The best choice within a group of conflicting candidates.
std::vector<std::size_t> best_of_group(const std::vector<std::size_t>& group,
                                       const std::vector<double>& all_values,
                                       const std::vector<std::vector<bool>>& conflicts) {
    std::vector<double> values;
    std::vector<std::vector<bool>> inner(group.size(), std::vector<bool>(group.size(), false));
    for (std::size_t i = 0; i < group.size(); ++i) {
        values.push_back(all_values[group[i]]);
        for (std::size_t j = 0; j < group.size(); ++j) inner[i][j] = conflicts[group[i]][group[j]];
    }
    std::vector<std::size_t> chosen = Search(std::move(values), std::move(inner)).best();
    for (std::size_t& index : chosen) index = group[index];
    return chosen;
}

}  // namespace

double explained_value(const Verified& v) {
    const double doubt = std::max(1.0 - v.confidence, kLeastDoubt);
    return -std::log(doubt) * static_cast<double>(v.support);
}

bool fits_better(const Verified& v, const Verified& other) {
    return v.depth_fit > other.depth_fit && explained_value(v) > kAsMuch * explained_value(other);
}

double shared_support(const Verified& a, const Verified& b) {
    const std::size_t smaller = std::min(a.support, b.support);
    if (smaller == 0) return 0.0;
    return static_cast<double>(shared_cells(a, b)) / static_cast<double>(smaller);
}

bool in_conflict(const Verified& a, const Verified& b) {
    return shared_support(a, b) > kMaxShared;
}

Rivals rivals_of(const Verified& v, std::span<const Verified* const> candidates) {
    std::map<std::uint32_t, double> odds_of_model;
    Rivals rivals;
    double most = 0.0;
    for (std::size_t i = 0; i < candidates.size() && v.support > 0; ++i) {
        const Verified& other = *candidates[i];
        if (other.hypothesis.model == v.hypothesis.model) continue;
        const double odds = rival_odds(other, v.support);
        double& of_model = odds_of_model[other.hypothesis.model];
        if (odds <= of_model || shared_support(v, other) <= kSamePiece) continue;
        of_model = odds;
        if (odds > most) rivals.likeliest = i;
        most = std::max(most, odds);
    }
    for (const auto& [model, odds] : odds_of_model) rivals.odds += odds;
    return rivals;
}

std::vector<std::size_t> choose(std::span<const Verified* const> candidates,
                                double min_confidence) {
    std::vector<std::size_t> able;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const Verified& v = *candidates[i];
        if (v.confidence >= min_confidence && v.support > 0) able.push_back(i);
    }
    const auto outdone = [&, all = able](std::size_t i) {
        const Verified& v = *candidates[i];
        return std::any_of(all.begin(), all.end(), [&](std::size_t other) {
            return fits_better(*candidates[other], v) && same_place(*candidates[other], v);
        });
    };
    able.erase(std::remove_if(able.begin(), able.end(), outdone), able.end());
    std::stable_sort(able.begin(), able.end(), [&](std::size_t a, std::size_t b) {
        return explained_value(*candidates[a]) > explained_value(*candidates[b]);
    });
    const auto conflicts = conflicts_of(candidates, able);
    std::vector<double> values;
    for (const std::size_t i : able) values.push_back(explained_value(*candidates[i]));
    std::vector<std::size_t> chosen;
    for (const auto& group : groups_of(conflicts)) {
        for (const std::size_t i : best_of_group(group, values, conflicts)) {
            chosen.push_back(able[i]);
        }
    }
    std::stable_sort(chosen.begin(), chosen.end(), [&](std::size_t a, std::size_t b) {
        const Verified& v = *candidates[a];
        const Verified& w = *candidates[b];
        return v.confidence != w.confidence ? v.confidence > w.confidence : v.support > w.support;
    });
    return chosen;
}

}  // namespace ostraka
