// SPDX-License-Identifier: Apache-2.0
// Writes simulated scans as a data set in BOP's layout, which BOP's toolkit reads, see
// bop_scene.hpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "ostraka/base/unit.hpp"
#include "ostraka/cloud/pinhole_camera.hpp"
#include "ostraka/io/bop_scene.hpp"
#include "ostraka/mesh/symmetry.hpp"
#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct BopWriterSettings {
    std::string split = "test";        ///< the scenes' folder: test, val, train, test_..., ...
    int images_per_scene = 1000;       ///< at least 1
    double depth_scale = 0.1;          ///< mm in one step of the depth images; 65535 steps at most
    double min_target_visible = 0.10;  ///< objects less visible are no targets, as in BOP 2019
};

/// Model i has the number i + 1.
struct BopModel {
    std::string name;   ///< kept in models_info.json, an addition of Ostraka's
    TriangleMesh mesh;  ///< at least one triangle with area
    Symmetry symmetry;  ///< none: left out
};

/// Silhouettes of an object; width * height values, row-major, 0 outside; empty: not written.
struct BopMasks {
    std::vector<std::uint8_t> all;      ///< as if nothing were in front
    std::vector<std::uint8_t> visible;  ///< where the object itself is seen
};

struct BopImage {
    PinholeCamera camera;
    std::vector<float> depth;        ///< mm, width * height, row-major; 0 or NaN: no return
    std::vector<BopObject> objects;  ///< numbers as in the writer's models
    std::vector<BopMasks> masks;     ///< none, or one for each object
};

/// Sets each object's counts, boxes and visible fraction from its masks (both must be there) and
/// the depth. An object without pixels is 0 visible. Silhouettes end at the image's border here,
/// while BOP's toolkit counts what lies beyond it, too.
/// @throws InvalidInput if sizes don't fit together.
void measure_masks(BopImage& image);

/// Writes images one by one; where each goes follows from its index, not from the order of the
/// calls. Images first, then the JSON that lists them: a set that was broken off has scene folders
/// without JSON, which no reader takes for scenes.
class BopWriter {
  public:
    /// Writes the models, in mm, with models_info.json, as models/ and models_eval/.
    /// @param root   is made; must be empty if it exists.
    /// @param models, unit  the meshes' and symmetries' unit; at least 1 model.
    /// @throws InvalidInput, FileError.
    BopWriter(const std::filesystem::path& root, std::span<const BopModel> models, Unit unit,
              const BopWriterSettings& settings = {});

    /// Writes image `index % images_per_scene` of scene `index / images_per_scene + 1`. May be
    /// called from several threads at once.
    /// @throws InvalidInput if the sizes don't fit together, a depth is beyond 16 bits of
    /// `depth_scale`, an object's number is none of the models' or a number is not finite, or the
    /// index was written before; FileError.
    void write(std::size_t index, const BopImage& image);

    /// Writes what is left: JSON of the last scenes, camera.json (of the image of the smallest
    /// index), test_targets_bop19.json. To be called once, after the last image.
    /// @throws InvalidInput if there is no image, FileError.
    void finish();

  private:
    std::filesystem::path scene_folder(int scene) const;
    void write_files(int scene, int number, const BopImage& image) const;
    void record(std::size_t index, int scene, int number, const BopImage& image);
    void add_targets(int scene, int number, const std::vector<BopObject>& objects);

    std::filesystem::path root_;
    BopWriterSettings settings_;
    int models_ = 0;
    std::mutex mutex_;                ///< of all below
    std::map<int, BopScene> scenes_;  ///< begun; their images' files are there, their JSON isn't
    std::set<int> complete_;          ///< scenes whose JSON is there
    std::vector<BopTarget> targets_;
    std::size_t first_index_ = std::numeric_limits<std::size_t>::max();
    PinholeCamera first_camera_;  ///< of the image of that index
};

}  // namespace ostraka
