// SPDX-License-Identifier: Apache-2.0
// Hypotheses from segments and their global descriptors (method, 3.2, 3.3 and 3.5).
#pragma once

#include "ostraka/library/retrieval.hpp"
#include "ostraka/recognition/hypothesis.hpp"

namespace ostraka {

/// Pieces of the scan that may belong to one object: Euclidean clusters of what isn't on the table,
/// and their smooth parts. Indices into scan.cloud, largest first within each kind.
std::vector<std::vector<std::uint32_t>> segment_scan(const Scan& scan, std::size_t min_points);

/// Retrieves the nearest entries of each segment and aligns their frames with the segment's.
std::vector<Hypothesis> hypotheses_from_segments(const Scan& scan, const EntryIndex& index,
                                                 const RecognitionSettings& settings);

}  // namespace ostraka
