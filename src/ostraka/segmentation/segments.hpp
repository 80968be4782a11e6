// SPDX-License-Identifier: Apache-2.0
// Pieces of a scan that may belong to one object, from coarse to fine. Every way to cut a scan
// fails on some scene: distance alone where objects touch, convexity on an object with a concave
// crease. So all of them propose, and what is wrong is found out later.
#pragma once

#include <span>
#include <string_view>

#include "ostraka/segmentation/convex_parts.hpp"
#include "ostraka/segmentation/plane_pieces.hpp"

namespace ostraka {

/// How a segment was cut; the order in which segments are listed.
enum class SegmentKind : std::uint8_t {
    cluster,  ///< apart from everything else by a gap
    convex,   ///< bounded by concave creases
    joined,   ///< two touching convex parts together
    smooth,   ///< without any crease
    plane,    ///< flat
};
std::string_view name_of(SegmentKind kind);

struct Segment {
    std::vector<std::uint32_t> indices;  ///< into the cloud, ascending
    std::uint32_t parent = kNoIndex;  ///< an earlier segment that holds this one (a plane: at least
                                      ///< 90 % of it); kNoIndex: none
    SegmentKind kind = SegmentKind::cluster;
};

struct SegmentationSettings {
    PatchSettings patches;      ///< patches.sampling must be set
    ConvexSettings convex;      ///< its min_points is replaced by the one below
    PlanePieceSettings planes;  ///< as above
    double gap = 2.5;  ///< sampling distances that separate clusters; at least patches.reach
    double smooth_angle = 0.2;       ///< radians between neighboring normals of a smooth region
    double smooth_curvature = 0.04;  ///< as SmoothnessSettings::max_curvature
    std::size_t min_points = 60;     ///< smaller segments are left out
    std::size_t max_of_kind = 60;    ///< segments of each kind; the largest stay
    std::size_t min_contact = 6;     ///< connected pairs of points between two parts to be joined
    double same =
        0.95;  ///< intersection over union above which the later of two segments is dropped
};

/// A forest of segments: clusters, in them convex parts, in these smooth regions, in these planes.
/// Kind after kind, largest first in each (ties: smallest index), so parents come before children.
/// Deterministic; the same segments whatever the order of the points.
/// @param cloud       at an even density, with normals toward the viewpoint; NaN points are left
/// out.
/// @param foreground  indices of the points to cut, each once.
/// @throws InvalidInput if normals are missing, an index is out of range, the sampling isn't
/// positive,
///         or the gap is less than the reach.
std::vector<Segment> segment_hierarchy(const PointCloud& cloud,
                                       std::span<const std::uint32_t> foreground,
                                       const SegmentationSettings& settings);

}  // namespace ostraka
