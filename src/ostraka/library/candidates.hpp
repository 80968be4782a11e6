// SPDX-License-Identifier: Apache-2.0
// The views and subparts of a model that might become entries, and the choice among them. Private.
#pragma once

#include <span>
#include <vector>

#include "ostraka/descriptors/triangulation.hpp"
#include "ostraka/library/model_library.hpp"
#include "ostraka/views/model_views.hpp"

namespace ostraka {

/// Indices into a piece's points. Views are triangulated once, for all pieces of them: piece by
/// piece it would take most of the time of a build.
using PieceTriangles = std::vector<IndexTriangle>;

/// A piece of a view.
struct Piece {
    PointCloud cloud;  ///< with normals
    PieceTriangles triangles;
};

/// A candidate that was not chosen, and the entry that shows most of what it shows.
struct Companion {
    std::uint32_t entry = 0;             ///< index into Choice::entries
    std::size_t view = 0;                ///< index into the views
    std::vector<std::uint32_t> indices;  ///< of its points in the view
};

struct Choice {
    std::vector<Entry> entries;
    std::vector<PieceTriangles> triangles;       ///< of each entry
    std::vector<Companion> companions;           ///< without redundant ones; none where no spread
                                                 ///< is asked for
    std::vector<PieceTriangles> view_triangles;  ///< of each view; empty ones if no descriptor
                                                 ///< needs any
};

/// The points and triangles of a companion: made when they are needed, as all together would take
/// hundreds of megabytes.
Piece piece_of(const Companion& companion, std::span<const ModelView> views, const Choice& choice);

/// @param views    of the model; clouds with normals, in the frame that it is looked at in.
/// @param surface  merge_surface() of them, in the same frame.
/// @param symmetry of the model, in the same frame.
/// @param counts   filled in.
Choice choose_entries(std::span<const ModelView> views, const PointCloud& surface,
                      const Symmetry& symmetry, const LibrarySettings& settings,
                      BuildCounts& counts);

}  // namespace ostraka
