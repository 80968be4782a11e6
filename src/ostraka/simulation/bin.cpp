// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/bin.hpp"

#include <cmath>

#include "ostraka/base/error.hpp"

namespace ostraka {

BinSettings usual_bin(double diameter) {
    return {2.6 * diameter, 1.8 * diameter, 0.9 * diameter, 0.05 * diameter};
}

void check(const BinSettings& bin) {
    for (const double measure : {bin.length, bin.width, bin.height, bin.wall}) {
        if (!(measure > 0.0) || !std::isfinite(measure)) {
            throw InvalidInput("bin: length, width, height and wall must be above 0 and finite");
        }
    }
}

TriangleMesh bin_mesh(const BinSettings& bin) {
    check(bin);
    TriangleMesh mesh;
    // Four corners, counter-clockwise from above.
    const auto add_ring = [&](double margin, double z) {
        const double x = bin.length / 2.0 + margin;
        const double y = bin.width / 2.0 + margin;
        for (const auto& [sx, sy] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
            mesh.vertices.push_back(Vec3d(sx * x, sy * y, z).cast<float>());
        }
    };
    add_ring(bin.wall, -bin.wall);
    add_ring(bin.wall, bin.height);
    add_ring(0.0, bin.height);
    add_ring(0.0, 0.0);
    // From ring to ring: outer walls, rim, inner walls; the surface is to the left of a ring.
    for (std::uint32_t ring = 0; ring < 3; ++ring) {
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t a = 4 * ring + k;
            const std::uint32_t b = 4 * ring + (k + 1) % 4;
            mesh.triangles.push_back({a, b, b + 4});
            mesh.triangles.push_back({a, b + 4, a + 4});
        }
    }
    mesh.triangles.push_back({0, 2, 1});
    mesh.triangles.push_back({0, 3, 2});
    mesh.triangles.push_back({12, 13, 14});
    mesh.triangles.push_back({12, 14, 15});
    return mesh;
}

}  // namespace ostraka
