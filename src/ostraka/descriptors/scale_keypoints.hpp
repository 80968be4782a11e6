// SPDX-License-Identifier: Apache-2.0
// Keypoints that bring their own scale: bumps, dents and corners, each with its size.
// Darom, Keller. Scale-Invariant Features for 3-D Mesh Models. IEEE Transactions on Image
// Processing 21(5), 2012: the detector "MeshScaleDoG". The surface is smoothed again and again,
// each vertex moving to the mean of itself and its ring of neighbors; where and when a vertex moves
// more than all around it, in place and scale, there is a feature of that scale. Details as in the
// toolbox that the authors published. Departs from it: (1) only the motion along the normal counts,
// as the motion within the surface comes from uneven sampling and from borders; so planes have no
// keypoints. (2) The motion is multiplied by the level and divided by the vertex' mean edge,
// instead of dividing each level by its sum over the mesh, which makes a piece's keypoints depend
// on all the rest. (3) An extremum in scale needs a finer and a coarser level. (4) Weak extrema are
// dropped.
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/triangulation.hpp"

namespace ostraka {

struct ScaleKeypoint {
    std::uint32_t index = kNoIndex;  ///< of the point
    int level = 0;                   ///< smoothing step, from 2
    float scale = 0.0F;     ///< mean edge length at the point x sqrt(level), in the points' unit
    float response = 0.0F;  ///< motion along the normal x level / mean edge length; positive
};

struct ScaleKeypointSettings {
    int levels = 20;  ///< smoothing steps; scales reach to sqrt(levels) edge lengths; 3 to 1000
    float contrast = 0.05F;     ///< least response; that of a round bump is a quarter of
                                ///< its height in mean edge lengths
    bool keep_borders = false;  ///< also keypoints whose ring reaches the surface's border, where
                                ///< occlusion made them
};

/// @param cloud  finite points with unit normals (a NaN normal's point is no keypoint).
/// @param triangles  of the surface, indices into cloud.points, as from triangulate() or a mesh.
/// @return ascending by index, then level. Scaling the cloud scales them; a rigid motion changes
///         nothing; up to rounding. The same bits for any number of threads.
/// @throws InvalidInput if normals are missing, a point is not finite, a triangle's index is out of
///         range, or a setting is out of range.
std::vector<ScaleKeypoint> detect_scale_keypoints(const PointCloud& cloud,
                                                  std::span<const IndexTriangle> triangles,
                                                  const ScaleKeypointSettings& settings = {});

}  // namespace ostraka
