// SPDX-License-Identifier: Apache-2.0
// Scans with known objects to evaluate on: simulated, or recorded in published data sets.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ostraka/io/data_set.hpp"
#include "ostraka/library/model_library.hpp"
#include "ostraka/simulation/recipes.hpp"

namespace ostraka {

/// A scan and its truth, in a library's unit; models are counted as the library's.
struct TestScene {
    std::string name;
    int scene = 0;  ///< BOP's number; elsewhere 0
    int image = 0;  ///< BOP's number; elsewhere the position in the set
    PointCloud cloud;
    std::vector<TrueObject> objects;
    std::vector<std::uint32_t> labels;    ///< per point: index into objects, or kNoIndex
    bool viewpoint_known = true;          ///< false: merged, or nobody says where the sensor was
    std::optional<PinholeCamera> camera;  ///< set: the cloud is organized, a pixel of it a point
};

/// Scenes that are made or read one at a time, when they are needed.
struct TestSet {
    std::string description;  ///< one line for people, and to tell one set from another
    std::size_t count = 0;
    std::function<TestScene(std::size_t)> load;  ///< safe from many threads at once
    std::vector<std::string> notes;  ///< what of the set can't be used, a line each; may be empty
};

/// Scenes simulated from the library's own models.
/// @param count  scenes; fewer if the recipe has a limit.
TestSet simulated_set(const ModelLibrary& library, const SceneRecipe& recipe, std::size_t count);

/// Of all models. @param library  has at least one.
double mean_diameter(const ModelLibrary& library);

/// The same scenes for another library. Objects whose model it lacks (by name) stay in the scans
/// but not in the truth: whatever is reported there is wrong.
/// @param from  the library that the set's models are counted by. @param to  must outlive the set.
TestSet for_library(TestSet set, const ModelLibrary& from, const ModelLibrary& to);

/// A data set's scans. Objects whose model is not in the library (by its name) are left out, and
/// noted. Labels: the object whose placed surface is nearest, within one sampling distance. Where
/// the set doesn't state how much of an object is visible, 1 is assumed.
/// @param library  must outlive the set.
/// @param unit  of the set where it states none.
/// @throws InvalidInput if no scene has a scan and an object of the library.
TestSet recorded_set(const DataSet& data, const ModelLibrary& library, std::optional<Unit> unit);

/// The data set's poses in its scenes: a layout to simulate scans of. Scenes without any of the
/// models are left out.
/// @param names  of the models; their order is that of PlacedModel::model.
/// @param factor  models' units in one of the data set's.
/// @param notes  what is left out, a line each; may be null.
/// @throws InvalidInput if the set places none of the models.
std::vector<std::vector<PlacedModel>> layout_of(const DataSet& data,
                                                std::span<const std::string> names, double factor,
                                                std::vector<std::string>* notes);

/// Where the sensor of a data set's scenes stands: T_camera_scene.
Pose layout_camera(const DataSet& data);

/// The library's models, ready to be placed.
SceneModels scene_models_of(const ModelLibrary& library);

}  // namespace ostraka
