// SPDX-License-Identifier: Apache-2.0
// Which hypotheses together explain a scan best, each piece of it once.
// Aldoma, Tombari, Di Stefano, Vincze. A Global Hypotheses Verification Method for 3D Object
// Recognition. ECCV 2012. Departs from the paper: hypotheses are weighed by their probability, and
// the choice is solved by branch and bound where simulated annealing was used, so that it is the
// best one and always the same.
#pragma once

#include "ostraka/recognition/verification.hpp"

namespace ostraka {

/// What a hypothesis adds to an explanation: -log(1 - confidence) support, of confidences of at
/// most 0.999. It grows with how sure the hypothesis is, and in proportion to what it explains: a
/// scan that one object explains is not explained better by two that share it. Of two that are all
/// but sure the one that explains more counts more: the whole, not a part of it that is a model,
/// too.
double explained_value(const Verified& v);

/// Of two poses of one model at the same place, whether `v` is the better one: it explains about as
/// much, and its depths fit better.
bool fits_better(const Verified& v, const Verified& other);

/// How much of the smaller support both explain, 0 to 1.
double shared_support(const Verified& a, const Verified& b);

/// Whether they explain too much of the same cells to stand together.
bool in_conflict(const Verified& a, const Verified& b);

/// What of other models explains the same as a hypothesis.
struct Rivals {
    std::size_t likeliest = 0;  ///< of the candidates; of no meaning where `odds` is 0
    double odds = 0.0;  ///< sum over the other models: how much likelier one of them is than none
};

/// Only one model can be what a piece of a scan shows. Where others would be as sure of it, a
/// hypothesis with the odds o has the probability o / (1 + o + odds), not o / (1 + o): two that
/// nobody can tell apart have half each. A rival that leaves some of the piece unexplained counts
/// less, since something else would have to be there besides.
/// @param candidates  `v` may be among them. Of each other model the pose that counts most counts.
Rivals rivals_of(const Verified& v, std::span<const Verified* const> candidates);

/// Of the hypotheses at or above `min_confidence` the set with the greatest sum of
/// explained_value(), no two of which explain more than a third of the same cells. Of
/// poses of one model at the same place only those take part that none fits_better() than.
/// Up to some hundred thousand steps are spent on finding it; what is best by then is returned.
/// @return indices of the chosen ones, most confident first.
std::vector<std::size_t> choose(std::span<const Verified* const> candidates, double min_confidence);

}  // namespace ostraka
