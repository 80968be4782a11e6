// SPDX-License-Identifier: Apache-2.0
// Finds the library entries nearest to a described piece, and lets them vote (method, 3.3).
//
// Entries vote by global descriptors. Distance: each descriptor's best metric (metric.hpp), to the
// patch of rows that an entry stands for (spread.hpp), or its own row where it has no spread. Fused
// distance: the sum over descriptors, each divided by its own scale, the median distance between
// an entry and the nearest entry of another model.
// Models are ranked best by "fused", which adds what the keypoints say: local descriptors survive
// where most of an object is hidden and its outline means nothing (consensus.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ostraka/descriptors/metric.hpp"
#include "ostraka/library/keypoint_index.hpp"
#include "ostraka/library/model_library.hpp"

namespace ostraka {

struct EntryMatch {
    std::uint32_t entry = kNoIndex;  ///< index into ModelLibrary::entries
    float distance = 0.0F;           ///< of one descriptor, or fused
};

/// One model's place in a ranking.
struct RankedModel {
    std::uint32_t model = kNoIndex;  ///< index into ModelLibrary::models
    double score = 0.0;  ///< votes / k; "keypoints": the consensus; "fused": 5/7 of it, as a share
                         ///< of the highest, and 2/7 likeness by global descriptors. 0 to 1
    int votes = 0;       ///< entries of this model among the k nearest
    EntryMatch best;     ///< its nearest entry
};

/// All rows of a library, ready to be searched. Exact; const and safe from many threads.
/// The library must outlive it.
class EntryIndex {
  public:
    /// @param metric  for all descriptors; by default each one's best_metric().
    explicit EntryIndex(const ModelLibrary& library, std::optional<Metric> metric = std::nullopt);

    const ModelLibrary& library() const { return *library_; }
    const KeypointIndex& keypoints() const { return keypoints_; }
    /// Distance of a described piece from every entry.
    /// @param table  number of the descriptor among ModelLibrary::tables.
    /// @param row    as describe() gives it.
    std::vector<float> distances(std::size_t table, std::span<const float> row) const;
    /// Fused distances from every entry. @param distances  distances() of each table.
    std::vector<float> fused(std::span<const std::vector<float>> distances) const;
    /// The same of a piece. @param cloud  with normals.
    std::vector<float> fused_distances(const PointCloud& cloud) const;
    /// Distance of a piece's bag of words (bags.hpp) from every entry's. @param cloud  with
    /// normals.
    /// @throws InvalidInput if the library has no codebook.
    std::vector<float> bag_distances(const PointCloud& cloud) const;

  private:
    std::vector<float> to_all(std::size_t table, std::span<const float> comparable) const;

    const ModelLibrary* library_;
    std::vector<Metric> metrics_;           // per table
    std::vector<std::vector<float>> rows_;  // per table: entries x length, comparable_row()s
    std::vector<SpreadIndex> spreads_;      // per table; empty where rows are compared
    std::vector<float> scales_;             // per table
    std::vector<float> bags_;               // entries x words, comparable_row()s
    KeypointIndex keypoints_;
};

/// The k nearest entries, nearest first; ties by index.
std::vector<EntryMatch> nearest_entries(std::span<const float> distances, std::size_t k);

/// Every model with an entry, by votes among the k nearest entries, then by its nearest entry.
std::vector<RankedModel> rank_models(const ModelLibrary& library, std::span<const float> distances,
                                     std::size_t k);

/// A segment as the library's entries are: at their sampling distance, with normals.
struct PreparedSegment {
    PointCloud whole;
    PointCloud piece;  ///< its largest cluster, as the subparts are; the whole segment where the
                       ///< library holds whole views only
    bool empty() const { return piece.size() < 3; }
};

/// Makes a segment comparable with the entries; depth noise is smoothed away (range_smoothing.hpp).
/// @param segment  in the library's unit; may hold NaN points; viewpoint set.
PreparedSegment prepare_segment(const PointCloud& segment, const LibrarySettings& settings);

/// All that is found out about a segment, by which it can be ranked in several ways.
struct SegmentEvidence {
    std::vector<std::vector<float>> distances;  ///< per table, from every entry
    std::vector<double> consensus;              ///< of the keypoints, per model (consensus.hpp)
};

/// @throws InvalidInput if the segment is empty().
SegmentEvidence gather_evidence(const EntryIndex& index, const PreparedSegment& segment);

/// Every model with an entry, best first.
/// @param descriptor  as for classify(), but "bag_of_words", which is not gathered.
std::vector<RankedModel> rank_models(const EntryIndex& index, const SegmentEvidence& evidence,
                                     std::string_view descriptor, std::size_t k);

/// Ranks the models for a segment.
/// @param descriptor  a name in the library; "keypoints": local descriptors only; "bag_of_words":
///                    which words they are, wherever they lie; or "fused", without the words.
/// @throws InvalidInput if the library has no such descriptor, or the segment is empty().
std::vector<RankedModel> classify(const EntryIndex& index, const PreparedSegment& segment,
                                  std::string_view descriptor = "fused", std::size_t k = 1);

}  // namespace ostraka
