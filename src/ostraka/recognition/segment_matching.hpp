// SPDX-License-Identifier: Apache-2.0
// Hypotheses from segments and their global descriptors (method, 3.2, 3.3 and 3.5).
#pragma once

#include "ostraka/library/retrieval.hpp"
#include "ostraka/recognition/hypothesis.hpp"

namespace ostraka {

/// Pieces of what isn't explained yet that may belong to one object (segments.hpp). Indices into
/// scan.cloud.
std::vector<std::vector<std::uint32_t>> segment_scan(const Scan& scan, std::size_t min_points);

/// Retrieves the nearest entries of each segment and aligns their frames with the segment's.
std::vector<Hypothesis> hypotheses_from_segments(const Scan& scan, const EntryIndex& index,
                                                 const RecognitionSettings& settings);

}  // namespace ostraka
