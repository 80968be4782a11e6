// SPDX-License-Identifier: Apache-2.0
// Parts of a scan that are bounded by concave creases: objects that touch, mostly.
// Stein, Schoeler, Papon, Woergoetter. Object Partitioning using Local Convexity. CVPR 2014 (LCCP).
// Departs from the paper:
// - Patches merge smoothest first, and two groups merge only if their common border is convex for
// the
//   most part: one wrong edge in a row of concave ones can't join two objects.
// - A step between parallel surfaces (a plate on a table) separates them.
// - A common neighbor confirms two convex patches (extended convexity) if it is convex with one and
// not
//   concave with the other: beside a sharp edge, most pairs are "singular" and say nothing. Where
//   there is no common neighbor none is asked for: a bar one patch wide stays whole.
#pragma once

#include <vector>

#include "ostraka/segmentation/patches.hpp"

namespace ostraka {

struct ConvexSettings {
    double max_concavity = 0.17;  ///< radians by which a surface may turn inward and still go on
    double sanity_angle = 1.05;   ///< radians; largest angle between the crease of two patches and
                                  ///< the line between them that marks a contact in a corner only
    double max_step = 0.8;        ///< sampling distances between parallel surfaces that still go on
    double max_share = 0.5;  ///< of a common border: concave; with more, two groups don't merge
    std::size_t min_points = 60;  ///< smaller parts join the neighbor they have most contact with,
                                  ///< or are left out if they have none
};

/// How the surface goes on from one patch to a touching one.
enum class Bend : std::uint8_t {
    convex,    ///< outward, straight on, or inward by less than max_concavity
    concave,   ///< inward: a crease between two objects, or between parts of one
    singular,  ///< they touch in a corner only: says nothing
    step,      ///< parallel, one behind the other
};

/// The convexity and sanity criteria of the paper (sections 3.2 and 3.3), and the step criterion.
/// @param sampling  distance between neighboring points, in the patches' unit.
Bend bend_between(const SurfacePatch& a, const SurfacePatch& b, const PatchContact& contact,
                  double sampling, const ConvexSettings& settings);

/// Two parts that touch.
struct PartContact {
    std::uint32_t a = 0;  ///< part, less than b
    std::uint32_t b = 0;
    std::uint32_t pairs = 0;    ///< connected pairs of points, one of each part
    std::uint32_t concave = 0;  ///< of these: across a concave crease or a step
};

struct ConvexParts {
    Clusters parts;  ///< point indices, each ascending; largest first, ties by smallest index
    std::vector<PartContact> contacts;  ///< longest first, ties by a, then b
};

/// Every part is connected; two share no point.
/// Deterministic; the same parts whatever the order of the points.
/// @param cloud    at an even density, with normals toward the viewpoint; NaN points are left out.
/// @param patches  how to cut the cloud; patches.sampling is the cloud's and must be set.
/// @throws InvalidInput if normals are missing or patches.sampling isn't positive.
ConvexParts convex_parts(const PointCloud& cloud, const PatchSettings& patches,
                         const ConvexSettings& settings = {});

/// The same on a cloud that is cut already (see surface_patches()).
/// @param sampling  the distance between neighboring points.
ConvexParts convex_parts(const SurfacePatches& patches, double sampling,
                         const ConvexSettings& settings = {});

}  // namespace ostraka
