// SPDX-License-Identifier: Apache-2.0
// Heaps: objects dropped one after another on a table or into a bin, each until it touches what
// lies there. No object is inside another, a wall or the table.
// Contact is found on height maps: each object becomes a column from its lowest to its highest
// point in each cell of a grid. So no two meshes overlap, whatever their shape, and the price is:
// - an object is moved sideways by whole cells, and may stop short of another by a cell sideways
//   (the distance between two that support each other is at most the diagonal of a cell);
// - what is under an overhang counts as filled: nothing slips under a handle;
// - an object rolls on the bare table only. On others it keeps its rotation, and slides downhill to
//   the next hollow; it may lean where a real one would topple.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ostraka/simulation/bin.hpp"
#include "ostraka/simulation/height_map.hpp"
#include "ostraka/simulation/rolling_shape.hpp"
#include "ostraka/simulation/scene.hpp"

namespace ostraka {

/// What drop() needs of models, worked out once; indices as in SceneModels.
struct DropModels {
    std::vector<RasterMesh> meshes;
    std::vector<RollingShape> shapes;
    std::vector<double> diameters;
};
/// Takes about 0.1 s for a model of 100,000 triangles.
DropModels drop_models(const SceneModels& models);

struct DropSettings {
    std::optional<BinSettings> bin;  ///< none: an open table
    double area = 2.0;  ///< table: side of the square in which the objects' centers of mass fall,
                        ///< in mean diameters; at least 0
    double settled = 0.7;    ///< share of objects that first roll to rest on the table, 0 to 1; the
                             ///< others come down in random rotation
    int positions = 16;      ///< places tried for each object; it takes the one where its center of
                             ///< mass is lowest. 1: a loose heap; 100: a dense pile. At least 1
    int rotations = 1;       ///< rotations tried for each object, each at all places; at least 1
    int cells = 200;         ///< of the grid along a mean diameter, 10 to 2000
    std::uint64_t seed = 0;  ///< heap number i uses (seed, i)
};

struct DropResult {
    std::vector<PlacedModel> placed;      ///< in the order they fell; world z up, table top at 0
    std::vector<std::uint32_t> left_out;  ///< indices into `chosen` that found no place in the bin
    double cell = 0.0;                    ///< side of a cell of the grid, in the models' unit
};

/// Drops models, repeats allowed. In a bin each object is within its walls as seen from above; it
/// is left out if it is too large for that in all rotations tried, or if its center of mass would
/// stay above the rim. On a table none is left out.
/// @param chosen  indices of the models to drop, in this order; at least 1.
/// @param number  which heap of the seed.
/// @throws InvalidInput if a setting or an index is out of range.
DropResult drop(const DropModels& models, std::span<const std::uint32_t> chosen,
                std::uint64_t number, const DropSettings& settings = {});

}  // namespace ostraka
