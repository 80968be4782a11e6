// SPDX-License-Identifier: Apache-2.0
// What the scan says of a piece of a placed model's surface: the one rule by which poses are scored
// and verified.
#pragma once

#include <algorithm>
#include <cmath>

#include "ostraka/recognition/scan.hpp"

namespace ostraka {

enum class CellVerdict : std::uint8_t {
    outside,    ///< the model isn't there
    support,    ///< the scan agrees, in distance and normal
    hidden,     ///< something is in front
    violation,  ///< the scan saw through, or the surface faces elsewhere
    backdrop,   ///< the scan agrees, but its surface is a plane too large to be the model's
    taken,      ///< the scan agrees, but another object explains it
    missing,    ///< nothing was measured
    unsure,  ///< at an edge of the scan, where a ray may miss by a cell; or seen at a slant, where
             ///< sensors fail
};

/// A piece of a placed model's surface, scene frame.
struct SurfacePiece {
    Vec3f point;
    Vec3f normal;        ///< outward
    float range = 0.0F;  ///< from the viewpoint
    float slope = 1.0F;  ///< cosine of incidence
};

struct CellCheck {
    CellVerdict verdict = CellVerdict::missing;
    float off = 0.0F;        ///< of support: from the model to the scan, along the model's normal
    float agreement = 1.0F;  ///< of support: cosine between the normals
    bool through = false;    ///< something farther is seen, on a face that isn't at a slant: in
                             ///< violation, or unsure beside an edge
};

inline constexpr float kMinAgreement = 0.7F;  ///< cosine between the normals of model and scan
inline constexpr float kMinSlope = 0.3F;      ///< cosine below which tolerance along a ray grows no
                                              ///< further
inline constexpr float kFading = 0.5F;        ///< cosine below which sensors begin to lose returns
                                              ///< (docs/sensors.md): none means nothing

inline constexpr float kEdgeOn = 0.15F;  ///< cosine below which a face is hardly a cell wide: what
                                         ///< its cell shows may as well be beside it

inline constexpr float kTooLarge = 1.1F;  ///< model diameters that a flat surface of it can't have

/// @param cell       of the scan's range map that shows the piece, or kNoIndex.
/// @param tolerance  along the normal, scan's unit. @param largest  diameter of the model.
inline CellCheck check_cell(const Scan& scan, std::uint32_t cell, const SurfacePiece& piece,
                            float tolerance, float largest) {
    const bool slanted = piece.slope < kFading;
    const CellCheck nothing{slanted ? CellVerdict::unsure : CellVerdict::missing};
    if (cell == kNoIndex) return nothing;
    if (!scan.ranges[cell].measured()) {
        const bool in_shadow = piece.range > scan.ranges[cell].shadow;
        return in_shadow ? CellCheck{CellVerdict::unsure} : nothing;
    }
    const RangeCell& seen = scan.ranges[cell];
    const float slack = tolerance / std::max(kMinSlope, piece.slope);
    if (piece.range < seen.near - slack) {
        const bool clear = piece.range < seen.nearest_around - slack;
        return {.verdict = clear ? CellVerdict::violation : CellVerdict::unsure,
                .through = !slanted};
    }
    if (piece.range > seen.far + slack) return {CellVerdict::hidden};
    const bool edge_on = piece.slope < kEdgeOn;
    if (seen.point == kNoIndex) {
        const bool wall = seen.wall > kTooLarge * largest;
        return {wall && !edge_on ? CellVerdict::backdrop : CellVerdict::unsure};
    }
    const float agreement = piece.normal.dot(scan.cloud.normals[seen.point]);
    if (agreement < kMinAgreement) {
        return {seen.steady && !edge_on ? CellVerdict::violation : CellVerdict::unsure};
    }
    const float off = piece.normal.dot(scan.cloud.points[seen.point] - piece.point);
    if (std::abs(off) > tolerance) return {CellVerdict::unsure};
    if (scan.plane_extents[seen.point] > kTooLarge * largest) return {CellVerdict::backdrop};
    return {CellVerdict::support, off, agreement};
}

}  // namespace ostraka
