// SPDX-License-Identifier: Apache-2.0
// Uses the installed library as somebody else's project would.
#include <cstdio>
#include <ostraka/mesh/shape.hpp>
#include <ostraka/ostraka.hpp>
#include <ostraka/views/ray_scene.hpp>

int main() {
    ostraka::TriangleMesh box;
    for (unsigned i = 0; i < 8; ++i) {
        box.vertices.emplace_back((i & 1U) != 0U ? 1.0F : -1.0F, (i & 2U) != 0U ? 2.0F : -2.0F,
                                  (i & 4U) != 0U ? 3.0F : -3.0F);
    }
    box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    const ostraka::RayScene scene({box});
    const std::vector<ostraka::Vec3d> down = {{0.0, 0.0, -1.0}};
    std::printf("area %.1f, diameter %.2f, %.0f mm above its top\n", ostraka::surface_area(box),
                ostraka::measure(box).diameter, scene.cast({0.1, 0.2, 8.0}, down).front().distance);
    try {
        ostraka::load_library("no/such/file");
        return 1;
    } catch (const ostraka::Error&) {
        return 0;
    }
}
