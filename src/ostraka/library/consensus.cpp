// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/consensus.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

// The distance of each keypoint to its nearest match of any model, and their median.
struct Nearest {
    std::vector<std::int32_t> distance;
    double median = 0.0;
};

Nearest nearest_of(std::span<const std::vector<Correspondence>> matches) {
    std::size_t count = 0;
    for (const auto& of_model : matches) count = std::max(count, of_model.size());
    Nearest nearest;
    nearest.distance.assign(count, std::numeric_limits<std::int32_t>::max());
    for (const auto& of_model : matches) {
        for (std::size_t k = 0; k < of_model.size(); ++k) {
            if (!of_model[k].matched()) continue;
            nearest.distance[k] = std::min(nearest.distance[k], of_model[k].distance);
        }
    }
    std::vector<std::int32_t> sorted = nearest.distance;
    if (sorted.empty()) return nearest;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    nearest.median = std::max(1.0, static_cast<double>(*middle));
    return nearest;
}

// The pose that one match claims, in the parts that agreement is tested with.
struct Claim {
    Mat3f R_scene_model;
    Vec3f t_scene_model;
    Vec3f scene_point;
    Vec3f model_point;
    double weight = 0.0;
};

struct Limits {
    float tolerance;
    float lever;
    float min_trace;  // of R_a R_b^T
};

// Cheapest test first: most pairs fail it.
bool agree(const Claim& seed, const Claim& other, const Limits& limits) {
    const float apart = (other.scene_point - seed.scene_point).norm();
    const float in_model = (other.model_point - seed.model_point).norm();
    if (std::abs(apart - in_model) >= limits.tolerance) return false;
    if (seed.R_scene_model.cwiseProduct(other.R_scene_model).sum() <= limits.min_trace) {
        return false;
    }
    const Vec3f predicted = seed.R_scene_model * other.model_point + seed.t_scene_model;
    return (predicted - other.scene_point).norm() < limits.tolerance + limits.lever * apart;
}

double best_agreement(const std::vector<Claim>& claims, const Limits& limits) {
    double best = 0.0;
    for (const Claim& seed : claims) {
        double sum = 0.0;
        for (const Claim& other : claims) {
            if (agree(seed, other, limits)) sum += other.weight;
        }
        best = std::max(best, sum);
    }
    return best;
}

}  // namespace

std::vector<double> keypoint_consensus(std::span<const std::vector<Correspondence>> matches,
                                       double sampling, const ConsensusSettings& settings) {
    const Nearest nearest = nearest_of(matches);
    std::vector<double> consensus(matches.size(), 0.0);
    const auto count = static_cast<double>(nearest.distance.size());
    if (nearest.distance.empty()) return consensus;
    const Limits limits{static_cast<float>(settings.tolerance * sampling),
                        static_cast<float>(settings.lever),
                        static_cast<float>(1.0 + 2.0 * std::cos(settings.max_angle))};
    parallel_for(matches.size(), [&](std::size_t m) {
        std::vector<Claim> claims;
        claims.reserve(matches[m].size());
        for (std::size_t k = 0; k < matches[m].size(); ++k) {
            const Correspondence& match = matches[m][k];
            if (!match.matched()) continue;
            const double excess = static_cast<double>(match.distance - nearest.distance[k]);
            claims.push_back({match.R_scene_model,
                              match.scene_point - match.R_scene_model * match.model_point,
                              match.scene_point, match.model_point,
                              std::exp(-excess / (settings.rivalry * nearest.median))});
        }
        consensus[m] = best_agreement(claims, limits) / count;
    });
    return consensus;
}

}  // namespace ostraka
