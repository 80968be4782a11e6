// SPDX-License-Identifier: Apache-2.0
// Scans with known objects in them, as published or simulated. What a folder must look like is in
// docs/data_sets.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ostraka/base/types.hpp"
#include "ostraka/base/unit.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/io/bop_scene.hpp"
#include "ostraka/io/depth_camera.hpp"

namespace ostraka {

enum class DataSetKind {
    ostraka,  ///< what `ostraka simulate` writes
    bop,      ///< BOP: Benchmark for 6D Object Pose Estimation
    bologna,  ///< 3D Keypoint Detection Benchmark, University of Bologna
    uwa       ///< 3D Object Recognition Data Set, University of Western Australia
};

/// "ostraka", "bop", "bologna" or "uwa".
std::string_view data_set_kind_name(DataSetKind kind);

struct RecordedModel {
    std::string name;
    std::filesystem::path file;  ///< a mesh; empty: none was found, though truth may name the model
    int number = 0;              ///< BOP's object identifier; elsewhere 0
};

struct RecordedObject {
    std::uint32_t model = 0;                ///< index into DataSet::models
    Pose T_scene_model = Pose::Identity();  ///< in the data set's unit
    double visible_fraction = -1.0;         ///< 0 to 1, as each data set defines it; -1: not stated
};

struct RecordedScene {
    std::string name;  ///< unique in the set: "rs1", "Scene3_0.5", "000001/000012", "scene_0003"
    int scene = 0;     ///< BOP's number; elsewhere 0
    int image = 0;     ///< BOP's number; elsewhere the position in DataSet::scenes
    std::filesystem::path scan;        ///< cloud or depth image; empty: it isn't there, only truth
    std::optional<DepthCamera> depth;  ///< set: `scan` is a depth image, lengths in the set's unit
    std::optional<Vec3f> viewpoint;    ///< sensor in the scan's frame, where the format defines it
    bool truth_known = true;           ///< false: `objects` is empty, as nobody says what is there
    std::vector<RecordedObject> objects;
};

struct DataSet {
    DataSetKind kind = DataSetKind::ostraka;
    std::optional<Unit> unit;            ///< of scans, models and poses; nothing: not stated
    std::vector<RecordedModel> models;   ///< in the order of their numbers or names
    std::vector<RecordedScene> scenes;   ///< in natural order of their names: rs2 before rs10
    std::vector<BopTarget> bop_targets;  ///< test_targets_bop19.json where it is there
};

/// Reads what a folder says of its scans; recognizes the kind by its content. Scans themselves are
/// read by read_scan().
/// @throws InvalidInput if it is of no known kind (the message says what was looked for),
/// FileError,
///         FormatError.
DataSet open_data_set(const std::filesystem::path& folder);

/// Reads a scene's scan: a depth image as depth_cloud() does; a cloud as stored, with the scene's
/// viewpoint unless the file states its own.
/// @return in the data set's unit and the scene's frame.
/// @throws InvalidInput if the scene has no scan or one of a kind that can't be read, FileError,
///         FormatError.
PointCloud read_scan(const RecordedScene& scene);

}  // namespace ostraka
