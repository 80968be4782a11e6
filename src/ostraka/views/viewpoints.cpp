// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/viewpoints.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

using Face = std::array<std::size_t, 3>;

struct Sphere {
    std::vector<Vec3d> vertices;
    std::vector<Face> faces;
};

Sphere icosahedron() {
    const double golden = (1.0 + std::sqrt(5.0)) / 2.0;
    Sphere sphere;
    for (const double a : {-1.0, 1.0}) {
        for (const double b : {-golden, golden}) {
            sphere.vertices.emplace_back(0.0, a, b);
            sphere.vertices.emplace_back(a, b, 0.0);
            sphere.vertices.emplace_back(b, 0.0, a);
        }
    }
    // Three vertices at pairwise distance 2 (the edge length) span a face.
    const auto adjacent = [&](std::size_t i, std::size_t j) {
        return (sphere.vertices[i] - sphere.vertices[j]).norm() < 2.1;
    };
    for (std::size_t i = 0; i < 12; ++i) {
        for (std::size_t j = i + 1; j < 12; ++j) {
            for (std::size_t k = j + 1; k < 12; ++k) {
                if (adjacent(i, j) && adjacent(j, k) && adjacent(i, k)) {
                    sphere.faces.push_back({i, j, k});
                }
            }
        }
    }
    for (Vec3d& vertex : sphere.vertices) vertex.normalize();
    return sphere;
}

Sphere subdivided(const Sphere& coarse) {
    Sphere fine;
    fine.vertices = coarse.vertices;
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles;
    const auto middle = [&](std::size_t a, std::size_t b) {
        const auto [it, is_new] = middles.try_emplace(std::minmax(a, b), fine.vertices.size());
        if (is_new) {
            fine.vertices.push_back((coarse.vertices[a] + coarse.vertices[b]).normalized());
        }
        return it->second;
    };
    for (const Face& face : coarse.faces) {
        const std::size_t ab = middle(face[0], face[1]);
        const std::size_t bc = middle(face[1], face[2]);
        const std::size_t ca = middle(face[2], face[0]);
        fine.faces.push_back({face[0], ab, ca});
        fine.faces.push_back({face[1], bc, ab});
        fine.faces.push_back({face[2], ca, bc});
        fine.faces.push_back({ab, bc, ca});
    }
    return fine;
}

}  // namespace

std::vector<Vec3d> viewpoints(int count) {
    Sphere sphere = icosahedron();
    for (int level = 0; level < 5; ++level) {
        if (static_cast<int>(sphere.vertices.size()) == count) return sphere.vertices;
        if (static_cast<int>(sphere.faces.size()) == count) {
            std::vector<Vec3d> centers;
            for (const Face& face : sphere.faces) {
                const Vec3d sum =
                    sphere.vertices[face[0]] + sphere.vertices[face[1]] + sphere.vertices[face[2]];
                centers.push_back(sum.normalized());
            }
            return centers;
        }
        sphere = subdivided(sphere);
    }
    throw InvalidInput(fmt::format(
        "{} views: an icosahedron gives 12, 20, 42, 80, 162, 320, 642, 1280 or 2562", count));
}

}  // namespace ostraka
