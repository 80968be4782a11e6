// SPDX-License-Identifier: Apache-2.0
// Why an object was reported and a near miss was not, in words and numbers.
#pragma once

#include "ostraka/recognition/recognize.hpp"
#include "ostraka/recognition/verification.hpp"

namespace ostraka {

/// What became of a hypothesis.
enum class Outcome {
    reported,
    too_small,  ///< too little of it is seen to say anything
    doubtful,   ///< its confidence is below RecognitionSettings::min_confidence
    lost,       ///< other objects explain the same piece of the scan better
};

/// One kind of evidence, and what it does to the confidence.
struct Reason {
    std::string topic;          ///< "agreement", "fit", ...
    std::string words;          ///< a clause: "12 % of what should be seen is contradicted"
    double contribution = 0.0;  ///< to the logit of the confidence, against a typical right report:
                                ///< sum of weight x (feature - typical feature)
};

struct Explanation {
    RecognizedObject object;
    Outcome outcome = Outcome::reported;
    std::uint32_t number = kNoIndex;  ///< of a reported one: index into Recognition::objects
    std::uint32_t rival = kNoIndex;   ///< the reported object that explains the same, as an index
                                      ///< into Recognition::objects; kNoIndex: none
    Verified verified;                ///< counts of cells
    CellVerdicts cells;               ///< which they are; empty if the scan has no range map
    std::vector<Reason> reasons;      ///< what counts most first, for or against
    std::string verdict;              ///< one or a few sentences
};

struct ExplanationSettings {
    std::size_t near_misses = 12;  ///< at most; of each (model, place) the most confident one
    std::string unit;              ///< of lengths in words ("mm"); empty: none is named
};

/// The reported objects in their order, then the near misses, most confident first.
/// @param recognition  with its candidates (RecognitionSettings::keep_candidates).
/// @param scan         prepare_scan() of the same scene with the same settings.
/// @param settings     given to recognize().
/// @throws InvalidInput if an object names no model of the library.
std::vector<Explanation> explain(const ModelLibrary& library, const Recognition& recognition,
                                 const Scan& scan, const RecognitionSettings& settings,
                                 const ExplanationSettings& wish = {});

/// What a right report's feature is about like: the median of the reports that the general weights
/// were learned from. 0 for a feature that nothing is known of.
double typical_value(Feature feature);

}  // namespace ostraka
