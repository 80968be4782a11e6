// SPDX-License-Identifier: Apache-2.0
// Looks at a model from all sides (method, 2.1): what a depth sensor at each viewpoint sees of it.
#pragma once

#include "ostraka/mesh/shape.hpp"
#include "ostraka/views/render.hpp"

namespace ostraka {

struct ViewSettings {
    int count = 42;                ///< viewpoints: 12, 20, 42, 80, 162, 320, 642, 1280 or 2562
    double sampling = 0.0;         ///< distance between the points of a view, in the model's unit
    double distance = 3.0;         ///< from the model's center to the sensor, in model diameters
    double rays_per_sample = 2.0;  ///< rays cast along each sampling distance, before resampling
    SensorSettings sensor;         ///< what the virtual sensor adds; ideal by default
};

/// A view: its camera and its cloud.
struct ModelView {
    int index = 0;  ///< number of the viewpoint
    Pose T_camera_model = Pose::Identity();
    PointCloud cloud;  ///< model frame, about `sampling` apart, with normals; viewpoint set
};

/// Camera number `index` of the settings. The icosahedron stands in the model's canonical axes
/// (MeshShape::axes), so that turning the model in its file turns the views with it.
Pose view_camera(const MeshShape& shape, const ViewSettings& settings, int index);

/// The organized cloud that the sensor sees, in the camera frame, before resampling.
RenderedView render_view(const RayScene& model, const MeshShape& shape,
                         const ViewSettings& settings, int index);

/// The same view from what render_view() gave.
ModelView make_view(const RenderedView& rendered, const ViewSettings& settings, int index);

/// One view. @param model  the scene that holds the one mesh in its own frame.
/// @param shape  measure() of that mesh.
/// @throws InvalidInput if the count isn't an icosahedron's, `index` isn't below it, or sampling,
///         distance or rays_per_sample is out of range.
ModelView make_view(const RayScene& model, const MeshShape& shape, const ViewSettings& settings,
                    int index);

}  // namespace ostraka
