// SPDX-License-Identifier: Apache-2.0
// Chooses the entries of a model among its candidates (method, 2.5).
//
// First, candidates that show the same surface as an earlier one are dropped; the earlier one then
// stands for them too. Then up to `budget` are chosen so that a random candidate, taken as a likely
// observation, overlaps its best entry most: maximize F(S) = sum over kept candidates o of
// weight(o) * max over e in S of overlap(e, o), where the weight counts the candidates that o
// stands for. A facility-location function, monotone and submodular, for which the greedy choice
// reaches at least 1 - 1/e of the best. Nemhauser, Wolsey, Fisher. An Analysis of Approximations
// for Maximizing Submodular Set Functions. Math. Programming 14, 1978. Lazy evaluation: Minoux
// 1978. On a symmetric model two pieces overlap as much as the one does with the best image of the
// other: they look the same, though they lie elsewhere.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "ostraka/library/surface_elements.hpp"

namespace ostraka {

enum class Redundancy {
    surface,  ///< dropped: what shows the same surface as an earlier candidate; then the best are
              ///< chosen
    icp,   ///< the study's: dropped is what ICP lays onto an earlier candidate (icp_redundancy.hpp)
    none,  ///< nothing is dropped
};
std::string_view redundancy_name(Redundancy redundancy);
std::optional<Redundancy> parse_redundancy(std::string_view name);

inline constexpr int kMostSpreadDirections = 64;

struct SelectionSettings {
    Redundancy redundancy = Redundancy::surface;
    int budget = 48;  ///< entries a model, at most; the same for all, so that votes are fair. 0:
                      ///< any number, for `icp` and `none`; there, others are thinned out evenly
    double max_overlap = 0.9;  ///< overlap (intersection over union) with an earlier candidate that
                               ///< makes one redundant; above 1 nothing is
    int spread = 16;  ///< principal directions in which the candidates that an entry stands for
                      ///< vary (spread.hpp), 0 to 64; 0: none are kept; with `surface` only
};

/// Overlaps at which coverage is reported.
inline constexpr std::array<double, 5> kCoveredOverlaps = {0.5, 0.6, 0.7, 0.8, 0.9};

struct SelectionResult {
    std::vector<std::uint32_t> chosen;   ///< indices of candidates, ascending
    std::vector<std::uint32_t> nearest;  ///< for each candidate the position in `chosen` of the one
                                         ///< that overlaps it most; kNoIndex if it is redundant
    std::size_t redundant = 0;           ///< dropped as redundant
    std::size_t beyond_budget = 0;       ///< neither redundant nor chosen
    double coverage = 0.0;               ///< F(chosen) / number of candidates, 0 to 1
    std::array<double, kCoveredOverlaps.size()>
        covered{};  ///< share of candidates that some
                    ///< chosen one overlaps by at least so much
};

/// @param candidates  what each shows; earlier ones are preferred as representatives.
/// @param images      for each symmetry but the identity, where it takes each element; may be
/// empty.
SelectionResult select_entries(std::span<const ElementSet> candidates,
                               const SelectionSettings& settings,
                               std::span<const ElementMap> images = {});

/// `count` of `total` indices, evenly spread, ascending; all if `count` is 0 or not below `total`.
std::vector<std::uint32_t> thin_out(std::size_t total, std::size_t count);

}  // namespace ostraka
