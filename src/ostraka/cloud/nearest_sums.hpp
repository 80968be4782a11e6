// SPDX-License-Identifier: Apache-2.0
// Private to this module: the k nearest of a list of candidates, summed without being listed.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "ostraka/cloud/neighborhood_moments.hpp"

namespace ostraka {

/// Points near one or more queries, as columns.
struct Candidates {
    static constexpr std::size_t kLanes = 8;  ///< columns are padded to a multiple of it

    std::vector<float> x, y, z;
    std::vector<float> squared;  ///< distance of each to the last query
    std::vector<std::uint32_t> index;
    std::size_t count = 0;
    std::size_t padded = 0;

    void resize(std::size_t points) {
        count = points;
        padded = (points + kLanes - 1) / kLanes * kLanes;
        if (x.size() >= padded) return;
        for (auto* column : {&x, &y, &z, &squared}) column->resize(padded);
        index.resize(padded);
    }
    /// Fills the last group of lanes with what is in no ball.
    void pad() {
        constexpr float kNowhere = std::numeric_limits<float>::infinity();
        for (std::size_t i = count; i < padded; ++i) x[i] = y[i] = z[i] = kNowhere;
    }
};

struct Query {
    float x, y, z;
    float covered;  ///< squared distance below which the candidates hold all points; infinite where
                    ///< they are all points there are
};

/// Sums over the k candidates nearest to the query (of equally distant ones: of the lowest
/// indices), into one lane of a batch.
/// @param guess  of the k-th squared distance, or 0; replaced by a bound just above it.
/// @return false, and nothing changed but the guess, if the k nearest points may not be among the
///         candidates.
bool sum_nearest(Candidates& near, const Query& query, std::size_t k, float& guess,
                 MomentBatch& batch, std::size_t lane);

/// A bound just above the k-th squared distance; the query must be infinitely covered.
float kth_squared_distance(Candidates& near, const Query& query, std::size_t k, float guess);

}  // namespace ostraka
