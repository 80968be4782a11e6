// SPDX-License-Identifier: Apache-2.0
// What the numbers of a verified hypothesis say, in words. Private to explanation.cpp.
#pragma once

#include "ostraka/recognition/explanation.hpp"

namespace ostraka {

/// Reasons by topic, what counts most first.
/// @param unit  of lengths; empty: none is named.
std::vector<Reason> reasons_of(const Explanation& explanation, const ConfidenceModel& confidence,
                               const std::string& unit);

/// The verdict. @param objects  that were reported. @param min_confidence  asked for.
std::string verdict_of(const Explanation& explanation, std::span<const RecognizedObject> objects,
                       double min_confidence);

/// "crank #2": the second of the reported objects, counted from 1.
std::string object_label(std::span<const RecognizedObject> objects, std::uint32_t number);

}  // namespace ostraka
