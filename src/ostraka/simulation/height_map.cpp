// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/height_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "ostraka/base/error.hpp"
#include "ostraka/base/vector_clones.hpp"
#include "ostraka/simulation/envelope_painter.hpp"

namespace ostraka {
namespace {

constexpr double kMaxCells = 67'108'864.0;  // 2^26
constexpr std::size_t kLanes = 4;           // of Double4

// One coordinate of the turned vertices i to i + 3; `row` is that of the rotation.
__attribute__((always_inline)) inline void turn4(const RasterMesh& mesh, std::size_t i,
                                                 const double* row, Double4& turned) {
    turned = Double4{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float* v = mesh.vertices[axis].data() + i;
        turned += row[axis] * Double4{v[0], v[1], v[2], v[3]};
    }
}

struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
};

OSTRAKA_VECTOR_CLONES void range_along(const RasterMesh& mesh, const double* row, Range& range) {
    Double4 low = Double4{} + range.low;
    Double4 high = Double4{} + range.high;
    for (std::size_t i = 0; i < mesh.vertices[0].size(); i += kLanes) {
        Double4 turned;
        turn4(mesh, i, row, turned);
        low = turned < low ? turned : low;
        high = turned > high ? turned : high;
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        range.low = std::min(range.low, low[lane]);
        range.high = std::max(range.high, high[lane]);
    }
}

// The turned coordinate times `factor` minus `origin`, at least 0.
OSTRAKA_VECTOR_CLONES void coordinates(const RasterMesh& mesh, const double* row, double factor,
                                       double origin, float* out) {
    for (std::size_t i = 0; i < mesh.vertices[0].size(); i += kLanes) {
        Double4 turned;
        turn4(mesh, i, row, turned);
        turned = turned * factor - origin;
        turned = turned > 0.0 ? turned : Double4{};
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            out[i + lane] = static_cast<float>(turned[lane]);
        }
    }
}

// Sets the map's place and size.
void frame(double cell, HeightMap& map) {
    const Vec3d first = (map.bounds.low / cell).array().floor();
    // One cell more, as a coordinate may be rounded up to the end of its cell.
    const Vec3d cells = (map.bounds.high / cell).array().floor() - first.array() + 2.0;
    if (!((cells.x() + 8.0) * (cells.y() + 1.0) <= kMaxCells) ||
        first.head<2>().cwiseAbs().maxCoeff() > 1e9) {
        throw InvalidInput("height map: cells of " + std::to_string(cell) +
                           " are too small for the mesh");
    }
    map.first_column = static_cast<int>(first.x());
    map.first_row = static_cast<int>(first.y());
    map.columns = static_cast<int>(cells.x());
    map.rows = static_cast<int>(cells.y());
    constexpr int kStep = static_cast<int>(kVectorLanes);
    map.stride = (map.columns + kStep - 1) / kStep * kStep;
}

}  // namespace

HeightMap height_map(const RasterMesh& mesh, const Mat3d& R_world_model, double cell) {
    HeightMap map;
    const Mat3d rows = R_world_model.transpose();  // its columns are contiguous
    for (int axis = 0; axis < 3; ++axis) {
        Range range;
        range_along(mesh, rows.col(axis).data(), range);
        map.bounds.low[axis] = range.low;
        map.bounds.high[axis] = range.high;
    }
    frame(cell, map);
    GridVertices vertices;
    const std::size_t count = mesh.vertices[0].size();
    const Vec3d origin(map.first_column, map.first_row, map.bounds.low.z());
    const Vec3d factor(1.0 / cell, 1.0 / cell, 1.0);
    int axis = 0;
    for (std::vector<float>* column : {&vertices.x, &vertices.y, &vertices.z}) {
        column->resize(count);
        coordinates(mesh, rows.col(axis).data(), factor[axis], origin[axis], column->data());
        ++axis;
    }
    paint(mesh, vertices, map);
    return map;
}

}  // namespace ostraka
