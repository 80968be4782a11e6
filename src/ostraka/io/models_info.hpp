// SPDX-License-Identifier: Apache-2.0
// models_info.json, BOP's file of models' sizes and symmetries.
// Hodan et al. BOP Challenge 2020 on 6D Object Localization. ECCVW 2020; the format is described in
// docs/bop_datasets_format.md of BOP's toolkit.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "ostraka/base/unit.hpp"
#include "ostraka/mesh/symmetry.hpp"

namespace ostraka {

/// What the file holds of one model. All lengths are in mm, in the model's frame.
struct ModelInfo {
    int number = 1;              ///< BOP's object identifier, as in obj_000001.ply; at least 1
    std::string name;            ///< "name", an addition of Ostraka's; may be empty
    double diameter = 0.0;       ///< "diameter": largest distance between two vertices; above 0
    Vec3d low = Vec3d::Zero();   ///< "min_x", "min_y", "min_z": corner of the bounding box
    Vec3d size = Vec3d::Zero();  ///< "size_x", "size_y", "size_z": its sides; at least 0
    Symmetry symmetry;           ///< "symmetries_discrete" and "symmetries_continuous"
};

/// @param mesh, symmetry  in `unit`; the mesh has at least one triangle with area.
ModelInfo model_info(int number, const std::string& name, const TriangleMesh& mesh,
                     const Symmetry& symmetry, Unit unit);

/// Reads the file, models in the order of their numbers. Matrices and axes are made exactly
/// orthonormal; the identity and other keys are ignored; the center is symmetry_center().
/// @throws FileError, FormatError.
std::vector<ModelInfo> read_models_info(const std::filesystem::path& path);

/// Writes the file, atomically. A model without symmetries of a kind has no such key, as in BOP.
/// @throws FileError; InvalidInput if two models have the same number or a number is below 1.
void write_models_info(const std::filesystem::path& path, std::span<const ModelInfo> models);

}  // namespace ostraka
