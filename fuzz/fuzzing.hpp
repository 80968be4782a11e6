// SPDX-License-Identifier: Apache-2.0
// What every fuzz target does: a reader may reject its input with FormatError, nothing else, and
// what it accepts must be well formed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka::fuzzing {

inline void check_result(const TriangleMesh& mesh) {
    for (const Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t vertex : triangle) {
            if (vertex >= mesh.vertices.size()) {
                std::abort();
            }
        }
    }
}

inline void check_result(const PointCloud& cloud) {
    check(cloud);
}

template <class Parse>
int run(const std::uint8_t* data, std::size_t size, const Parse& parse) {
    try {
        check_result(parse(std::span<const char>(reinterpret_cast<const char*>(data), size)));
    } catch (const FormatError&) {
    }
    return 0;
}

}  // namespace ostraka::fuzzing
