// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

Vec3d area_vector(const TriangleMesh& mesh, const Triangle& triangle) {
    const Vec3d a = mesh.vertices[triangle[0]].cast<double>();
    const Vec3d b = mesh.vertices[triangle[1]].cast<double>();
    const Vec3d c = mesh.vertices[triangle[2]].cast<double>();
    return (b - a).cross(c - a);
}

double surface_area(const TriangleMesh& mesh) {
    double twice = 0.0;
    for (const Triangle& triangle : mesh.triangles) twice += area_vector(mesh, triangle).norm();
    return 0.5 * twice;
}

TriangleMesh scaled(TriangleMesh mesh, double factor) {
    for (Vec3f& vertex : mesh.vertices) vertex *= static_cast<float>(factor);
    return mesh;
}

TriangleMesh transformed(TriangleMesh mesh, const Pose& T_new_old) {
    for (Vec3f& vertex : mesh.vertices) {
        vertex = (T_new_old * vertex.cast<double>()).cast<float>();
    }
    return mesh;
}

}  // namespace ostraka
