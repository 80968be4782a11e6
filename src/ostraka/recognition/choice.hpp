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

/// The hypothesis of another model that explains best what `v` explains.
struct Rival {
    std::size_t number = 0;  ///< of the candidates
    double value = 0.0;  ///< its explained_value(), as a share of that of `v`, at most 1; 0: none
};

/// A model that isn't in the scan often explains a piece of it no better than others do: what is
/// told apart clearly is much more often right (the ratio test of D. G. Lowe, IJCV 2004, for
/// objects).
/// @param candidates  `v` may be among them.
Rival best_rival(const Verified& v, std::span<const Verified* const> candidates);

/// Of the hypotheses at or above `min_confidence` the set with the greatest sum of
/// explained_value(), no two of which explain more than a third of the same cells. Of
/// poses of one model at the same place only those take part that none fits_better() than.
/// Up to some hundred thousand steps are spent on finding it; what is best by then is returned.
/// @return indices of the chosen ones, most confident first.
std::vector<std::size_t> choose(std::span<const Verified* const> candidates, double min_confidence);

}  // namespace ostraka
