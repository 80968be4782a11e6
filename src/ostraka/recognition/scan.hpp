// SPDX-License-Identifier: Apache-2.0
// A scan made ready: at the library's density, with normals, its table found (method, 3.1).
#pragma once

#include <optional>

#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/planes.hpp"
#include "ostraka/recognition/range_map.hpp"
#include "ostraka/recognition/settings.hpp"

namespace ostraka {

struct Scan {
    PointCloud cloud;            ///< finite, about `sampling` apart, normals toward the viewpoint
    KdTree tree;                 ///< over cloud.points
    RangeMap ranges;             ///< of the scan at full density
    std::optional<Plane> table;  ///< the dominant plane, if there is one
    std::vector<std::uint32_t> foreground;  ///< indices of points that aren't on the table
    double sampling = 0.0;
};

/// @param raw        at any density; NaN points are "no return"; viewpoint set.
/// @param sampling   the library's.
/// @param model_diameter  of the library's largest model: a table is larger than that.
/// @throws InvalidInput if fewer than 10 finite points remain, all points coincide, the scan's
/// extent
///         makes its unit implausible, or the viewpoint lies on the scan.
Scan prepare_scan(const PointCloud& raw, double sampling, double model_diameter,
                  const RecognitionSettings& settings);

}  // namespace ostraka
