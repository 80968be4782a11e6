// SPDX-License-Identifier: Apache-2.0
// Scans with ground truth: models placed in a world, seen by a virtual depth sensor.
#pragma once

#include <span>
#include <vector>

#include "ostraka/base/random.hpp"
#include "ostraka/mesh/shape.hpp"
#include "ostraka/views/render.hpp"

namespace ostraka {

/// Models to make scenes of, measured once. All in one unit, which becomes the scans'.
struct SceneModels {
    std::vector<TriangleMesh> meshes;
    std::vector<MeshShape> shapes;  ///< measure() of each
    std::vector<RayModel> rays;     ///< each, ready to be seen
};
/// Measures the meshes. @param shapes  where they are known already.
SceneModels scene_models(std::vector<TriangleMesh> meshes, std::vector<MeshShape> shapes = {});

struct PlacedModel {
    std::uint32_t model = 0;  ///< index into SceneModels
    Pose T_world_model = Pose::Identity();
};

struct TrueObject {
    std::uint32_t model = 0;                ///< index into SceneModels
    Pose T_scene_model = Pose::Identity();  ///< the scan's frame is the camera's
    double visible_fraction = 0.0;          ///< pixels seen / pixels if nothing were in front
    std::size_t pixels_visible = 0;         ///< in the image, not hidden; some may give no depth
    std::size_t pixels_total = 0;           ///< of its silhouette, also beyond the image's border
};

struct SimulatedScene {
    PinholeCamera camera;
    Pose T_camera_world = Pose::Identity();
    PointCloud cloud;                 ///< organized, camera frame, sensor at the origin
    std::vector<TrueObject> objects;  ///< in the order of their placement
    std::vector<std::uint32_t>
        labels;  ///< per pixel: index into objects, or kNoIndex (table, nothing)
    std::vector<std::vector<std::uint32_t>>
        silhouettes;  ///< per object: pixels of its outline, hidden or not, ascending
    std::vector<std::uint32_t> visible;  ///< per pixel: as labels, but before the sensor's faults
};

struct SceneView {
    PinholeCamera camera;
    Pose T_camera_world = Pose::Identity();
    SensorModel sensor;               ///< lengths in the meshes' unit
    double table_size = 0.0;          ///< side of a square table at world z = 0, its top; 0: none
    std::vector<RayModel> furniture;  ///< what else stands there, in the world frame: a bin
};

/// Mean diameter of the chosen models. @param chosen  at least 1.
double mean_diameter(const SceneModels& models, std::span<const std::uint32_t> chosen);
/// Mean diameter of all models. There must be one.
double mean_diameter(const SceneModels& models);

/// A sensor above a table.
struct ViewFromAbove {
    double min_elevation = 0.35;  ///< radians above the table
    double max_elevation = 1.35;  ///< radians
    double distance = 1.0;        ///< from sensor to target
};
/// T_camera_world from a random side and elevation, with a slight roll. World z is up.
Pose view_from_above(Random& random, const Vec3d& target, const ViewFromAbove& settings);

/// Renders placed models.
SimulatedScene simulate_scene(const SceneModels& models, std::span<const PlacedModel> placed,
                              const SceneView& view);

struct TabletopSettings {
    int objects = 1;       ///< stand on the table in random rotation, lowest point touching it
    double spacing = 1.0;  ///< between neighboring objects' centers, in mean diameters
    double min_elevation = 0.35;  ///< radians of the sensor above the table
    double max_elevation = 1.35;  ///< radians
    double distance = 4.0;        ///< from sensor to the objects, in mean diameters
    PinholeCamera camera;         ///< 640 x 480, 58 degrees wide
    SensorModel sensor;
    std::uint64_t seed = 0;  ///< scene number i uses (seed, i)
};

/// Objects on a table from a random viewpoint.
/// @param chosen  indices of the models to place, one for each object.
SimulatedScene simulate_tabletop(const SceneModels& models, std::span<const std::uint32_t> chosen,
                                 std::uint64_t number, const TabletopSettings& settings);

struct RandomViewSettings {
    int min_objects = 3;
    int max_objects = 5;
    double spread = 0.35;   ///< how far objects lie beside the line of sight, in mean diameters
    double distance = 5.0;  ///< from sensor to the middle, in mean diameters; farther where the
                            ///< nearest object would be nearer than the sensor can see
    PinholeCamera camera{1280, 960, 1600.0, 1600.0, 639.5, 479.5};
    SensorModel sensor;
    std::uint64_t seed = 0;  ///< scene number i uses (seed, i)
};

/// Bologna's "random views" recipe: some models in random rotation, seen from one viewpoint, hiding
/// each other. They stand one behind the other with their enclosing balls apart, so that none is
/// inside another; no table.
SimulatedScene simulate_random_view(const SceneModels& models, std::uint64_t number,
                                    const RandomViewSettings& settings);

}  // namespace ostraka
