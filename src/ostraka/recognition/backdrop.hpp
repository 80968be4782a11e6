// SPDX-License-Identifier: Apache-2.0
// Tables, walls and floors: flat surface that is too large to be an object's. Found first, on a
// thinned scan, as nothing else needs to be done with the many points on them.
#pragma once

#include <optional>
#include <vector>

#include "ostraka/cloud/range_smoothing.hpp"
#include "ostraka/recognition/surface_extents.hpp"
#include "ostraka/segmentation/plane_pieces.hpp"

namespace ostraka {

/// A connected flat piece of the scan.
struct FlatPiece {
    PlanePiece plane;
    Pose T_piece_cloud = Pose::Identity();  ///< inverse of the plane's own
    double extent = 0.0;  ///< of the surface it is part of, scan's unit: coplanar pieces are one
                          ///< surface, seen between the objects before it, where hardly anything of
                          ///< the scan lies behind them (the tops of two equal boxes are not)
    std::optional<SurfaceExtents> extents;  ///< around each place, no more than `extent`; none: the
                                            ///< same everywhere
    bool last = false;                      ///< hardly anything of the scan lies behind it
    double share = 0.0;  ///< of the scan's surface, that of coplanar pieces included
};

struct Backdrop {
    std::vector<FlatPiece> pieces;  ///< of at least the least extent asked for; largest first
    double slack = 0.0;  ///< distance from a piece that counts as on it: what sampling and noise
                         ///< make of a flat surface; scan's unit

    /// How far the flat surface extends that a point is on; 0: on none.
    double extent_at(const Vec3f& point) const;
    /// The table: the largest of the surfaces that have nothing behind, if it extends at least
    /// `extent`; nullptr if there is none.
    const FlatPiece* table(double extent) const;
};

struct BackdropSettings {
    double sampling = 0.0;  ///< distance that details have; pieces are found at several times that
    RangeNoise noise;       ///< of the scan; zeros where it is merged
    double least = 0.0;     ///< extent of the smallest surface of interest
    double wall = 0.0;      ///< extent beyond which a surface is nobody's face. From afar the tops
                            ///< of boxes side by side look as large: what extends so far, and has
                            ///< something behind, is looked at more closely
    bool merged = false;    ///< of several views, or nobody knows from where: then most of the scan
                            ///< lies in front of a table, and nothing is looked at closely
};

/// @param scan  finite points of any density; viewpoint set, unless it is merged.
Backdrop find_backdrop(const PointCloud& scan, const BackdropSettings& settings);

}  // namespace ostraka
