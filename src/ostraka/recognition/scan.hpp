// SPDX-License-Identifier: Apache-2.0
// A scan made ready: at the library's density, with normals, tables and walls cut away
// (method, 3.1).
#pragma once

#include <optional>

#include "ostraka/cloud/point_blocks.hpp"
#include "ostraka/recognition/range_map.hpp"
#include "ostraka/recognition/settings.hpp"
#include "ostraka/registration/surface_field.hpp"

namespace ostraka {

/// The plane that objects stand on.
struct TablePlane {
    Vec3d normal = Vec3d::UnitZ();  ///< unit, toward the viewpoint
    double offset = 0.0;            ///< normal . x = offset for points x on it
};

struct Scan {
    PointCloud cloud;  ///< what may be objects: finite, about `sampling` apart, normals toward the
                       ///< viewpoint; without what is on a table or wall, or below the table
    PointBlocks blocks;                  ///< of the cloud
    std::vector<float> plane_extents;    ///< of each point: how far the flat surface it is part of
                                         ///< extends; 0: it isn't part of a large one
    RangeMap ranges;                     ///< of the whole scan at full density; empty if merged
    std::optional<SurfaceField> merged;  ///< of a merged scan: what is nearest to any place
    std::vector<RangeMap> views;         ///< of a merged scan: one of each known viewpoint
    std::optional<TablePlane> table;     ///< if there is one
    std::vector<char> explained;  ///< of each point: whether an object that was found already shows
                                  ///< there; empty: none was
    double sampling = 0.0;
    double cell = 0.0;       ///< side of a cell of the range map at the scan's median distance
    double deviation = 0.0;  ///< expected of the cloud's points along the line of sight, from the
                             ///< noise that was measured; scan's unit; if merged, their
                             ///< surface_roughness()
    double thickness = 0.0;  ///< of a merged scan: surface_thickness() of what is given
};

/// @param raw        at any density; NaN points are "no return"; viewpoint set.
/// @param sampling   the library's.
/// A merged scan (RecognitionSettings::viewpoint_known, viewpoints) has its normals turned outward
/// (normal_orientation.hpp); neither its noise nor its tables are removed.
/// @param model_diameter  of the library's largest model: tables and walls are larger than that.
/// @throws InvalidInput if fewer than 10 finite points remain, all points coincide, the scan's
///         extent makes its unit implausible, or the viewpoint lies on the scan.
Scan prepare_scan(const PointCloud& raw, double sampling, double model_diameter,
                  const RecognitionSettings& settings);

}  // namespace ostraka
