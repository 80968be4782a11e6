// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ostraka/library/confidence_model.hpp"
#include "ostraka/recognition/verification.hpp"

namespace ostraka {

/// Share of an outline up to which something before it says nothing: in a heap that is usual.
inline constexpr double kOftenFenced = 0.5;

/// Too little support to say anything: such hypotheses are never reported.
bool too_small(const Verified& verified);

/// All but Feature::rival, which is 0: only the whole search tells of rivals.
Features features_of(const Verified& verified);

}  // namespace ostraka
