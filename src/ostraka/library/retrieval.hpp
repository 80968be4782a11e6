// SPDX-License-Identifier: Apache-2.0
// Finds the library entries nearest to a described piece, and lets them vote (method, 3.3).
//
// Distance: Hellinger's (L2 between square roots of rows of sum 1), which weighs a bin's relative
// error rather than its size. Fused distance: the sum over descriptors, each divided by its own
// scale, the median distance between an entry and the nearest entry of another model.
#pragma once

#include <string>
#include <vector>

#include "ostraka/library/model_library.hpp"

namespace ostraka {

struct EntryMatch {
    std::uint32_t entry = kNoIndex;  ///< index into ModelLibrary::entries
    float distance = 0.0F;           ///< Hellinger, or fused
};

/// One model's place in a ranking.
struct RankedModel {
    std::uint32_t model = kNoIndex;  ///< index into ModelLibrary::models
    double score = 0.0;              ///< votes / k
    int votes = 0;                   ///< entries of this model among the k nearest
    EntryMatch best;                 ///< its nearest entry
};

/// All rows of a library, ready to be searched. Exact; const and safe from many threads.
/// The library must outlive it.
class EntryIndex {
  public:
    explicit EntryIndex(const ModelLibrary& library);

    const ModelLibrary& library() const { return *library_; }
    /// Distance of a described piece from every entry.
    /// @param table  number of the descriptor among ModelLibrary::tables.
    /// @param row    as describe() gives it.
    std::vector<float> distances(std::size_t table, std::span<const float> row) const;
    /// Fused distance of a piece from every entry, over all tables. @param cloud  with normals.
    std::vector<float> fused_distances(const PointCloud& cloud) const;

  private:
    const ModelLibrary* library_;
    std::vector<std::vector<float>> rows_;  // per table: entries x length, normalized and rooted
    std::vector<float> scales_;             // per table
};

/// The k nearest entries, nearest first; ties by index.
std::vector<EntryMatch> nearest_entries(std::span<const float> distances, std::size_t k);

/// Every model with an entry, by votes among the k nearest entries, then by its nearest entry.
std::vector<RankedModel> rank_models(const ModelLibrary& library, std::span<const float> distances,
                                     std::size_t k);

/// Makes a segment comparable with the entries: at their sampling distance, with normals; and,
/// unless the library holds whole views only, reduced to its largest cluster, as the subparts were.
/// @param segment  in the library's unit; may hold NaN points; viewpoint set.
/// @return fewer than 3 points if nothing usable is left.
PointCloud prepare_segment(const PointCloud& segment, const LibrarySettings& settings);

/// Ranks the models for a segment. @param segment  with normals, at the library's sampling
/// distance.
/// @param descriptor  a name in the library, or "fused".
/// @throws InvalidInput if the library has no such descriptor, or the segment has under 3 points.
std::vector<RankedModel> classify(const EntryIndex& index, const PointCloud& segment,
                                  std::string_view descriptor = "fused", std::size_t k = 1);

}  // namespace ostraka
