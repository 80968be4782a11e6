// SPDX-License-Identifier: Apache-2.0
// Smallest enclosing ball: Badoiu, Clarkson. Smaller core-sets for balls. SODA 2003, algorithm 1.
#include "ostraka/mesh/shape.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace ostraka {
namespace {

constexpr int kDirections = 400;       // extreme points are sought along so many directions
constexpr int kBallIterations = 2000;  // the error falls as 1 / sqrt(iterations)

// Vertices that are extreme along one of many directions: enough of the hull for ball and diameter.
std::vector<Vec3d> extreme_vertices(const TriangleMesh& mesh, const Mat3d& axes) {
    std::vector<std::uint32_t> extremes;
    const double golden = kPi * (3.0 - std::sqrt(5.0));
    for (int k = 0; k < kDirections; ++k) {
        const double z = 1.0 - (2.0 * k + 1.0) / kDirections;
        const double r = std::sqrt(1.0 - z * z);
        const Vec3d local(r * std::cos(golden * k), r * std::sin(golden * k), z);
        const Vec3f direction = Vec3d(axes * local).cast<float>();
        std::uint32_t best = 0;
        float best_dot = mesh.vertices[0].dot(direction);
        for (std::uint32_t i = 1; i < mesh.vertices.size(); ++i) {
            const float dot = mesh.vertices[i].dot(direction);
            if (dot > best_dot) {
                best_dot = dot;
                best = i;
            }
        }
        extremes.push_back(best);
    }
    std::sort(extremes.begin(), extremes.end());
    extremes.erase(std::unique(extremes.begin(), extremes.end()), extremes.end());
    std::vector<Vec3d> points;
    for (const std::uint32_t i : extremes) points.push_back(mesh.vertices[i].cast<double>());
    return points;
}

Vec3d ball_center(const std::vector<Vec3d>& points) {
    Vec3d center = Vec3d::Zero();
    for (const Vec3d& point : points) center += point / static_cast<double>(points.size());
    for (int i = 1; i <= kBallIterations; ++i) {
        const Vec3d* farthest = points.data();
        for (const Vec3d& point : points) {
            if ((point - center).squaredNorm() > (*farthest - center).squaredNorm()) {
                farthest = &point;
            }
        }
        center += (*farthest - center) / (i + 1.0);
    }
    return center;
}

// Axes of the surface's own second moments (each triangle integrated exactly), signs by the third
// moment of the triangles' centers, weighted by area.
Mat3d surface_axes(const TriangleMesh& mesh) {
    double area = 0.0;
    Vec3d first = Vec3d::Zero();
    Mat3d second = Mat3d::Zero();
    const Vec3d origin = mesh.vertices[mesh.triangles[0][0]].cast<double>();
    for (const Triangle& triangle : mesh.triangles) {
        const double weight = 0.5 * area_vector(mesh, triangle).norm();
        Vec3d sum = Vec3d::Zero();
        Mat3d squares = Mat3d::Zero();
        for (const std::uint32_t vertex : triangle) {
            const Vec3d point = mesh.vertices[vertex].cast<double>() - origin;
            sum += point;
            squares += point * point.transpose();
        }
        area += weight;
        first += weight / 3.0 * sum;
        second += weight / 12.0 * (squares + sum * sum.transpose());
    }
    const Vec3d mean = first / area;
    const Mat3d covariance = second / area - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    Mat3d axes = solver.eigenvectors().rowwise().reverse();
    Vec3d third = Vec3d::Zero();
    for (const Triangle& triangle : mesh.triangles) {
        Vec3d center = -origin - mean;
        for (const std::uint32_t v : triangle) center += mesh.vertices[v].cast<double>() / 3.0;
        const Vec3d local = axes.transpose() * center;
        third += area_vector(mesh, triangle).norm() * Vec3d(local.array().cube());
    }
    for (int axis = 0; axis < 2; ++axis) {
        if (third[axis] < 0.0) axes.col(axis) = -axes.col(axis);
    }
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return axes;
}

}  // namespace

MeshShape measure(const TriangleMesh& mesh) {
    MeshShape shape;
    shape.axes = surface_axes(mesh);
    const std::vector<Vec3d> extremes = extreme_vertices(mesh, shape.axes);
    shape.center = ball_center(extremes);
    for (const Vec3f& vertex : mesh.vertices) {
        shape.radius = std::max(shape.radius, (vertex.cast<double>() - shape.center).norm());
    }
    for (std::size_t i = 0; i < extremes.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            shape.diameter = std::max(shape.diameter, (extremes[i] - extremes[j]).norm());
        }
    }
    return shape;
}

}  // namespace ostraka
