// SPDX-License-Identifier: Apache-2.0
// Clouds with exact normals for the tests of descriptors: what one viewpoint sees of a closed
// shape.
#pragma once

#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "ostraka/base/random.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka::shapes {

struct Surfel {
    Vec3d point, normal;
};

/// Keeps what faces the viewpoint, until there are `count` points.
template <class Sample>
PointCloud view_of(std::size_t count, const Vec3d& viewpoint, const Sample& sample) {
    PointCloud cloud;
    cloud.viewpoint = viewpoint.cast<float>();
    while (cloud.size() < count) {
        const Surfel surfel = sample();
        if (surfel.normal.dot(viewpoint - surfel.point) <= 0.0) continue;
        cloud.points.push_back(surfel.point.cast<float>());
        cloud.normals.push_back(surfel.normal.normalized().cast<float>());
    }
    return cloud;
}

/// An ellipsoid with half axes 50, 35 and 25 and bumps of 4 on it. The radius along a direction d
/// is r(d) = 1 / |d / axes| * (1 + bumps(d)), so the normal is the gradient of |p| - r(p / |p|).
inline PointCloud bumpy_ellipsoid(std::size_t count, std::uint64_t seed = 1) {
    const Vec3d axes(50.0, 35.0, 25.0);
    const auto level = [&](const Vec3d& p) {
        const Vec3d d = p.normalized();
        const double bumps = 0.05 * std::sin(7.0 * d.x() + 1.0) * std::cos(5.0 * d.y()) +
                             0.06 * std::sin(4.0 * d.z() + 2.0 * d.x() + 0.3);
        return p.cwiseQuotient(axes).norm() / (1.0 + bumps) - 1.0;
    };
    Random random(seed);
    return view_of(count, Vec3d(120.0, 200.0, 400.0), [&] {
        const Vec3d d = random.direction();
        const Vec3d p = d / (level(d) + 1.0);  // level + 1 is homogeneous of degree 1
        const double h = 1e-4;
        const Vec3d gradient(level(p + Vec3d(h, 0, 0)) - level(p - Vec3d(h, 0, 0)),
                             level(p + Vec3d(0, h, 0)) - level(p - Vec3d(0, h, 0)),
                             level(p + Vec3d(0, 0, h)) - level(p - Vec3d(0, 0, h)));
        return Surfel{p, gradient.normalized()};
    });
}

/// A torus with radii 40 and 15, of which the part beyond a slanted plane is cut off.
inline PointCloud cut_torus(std::size_t count, std::uint64_t seed = 2) {
    Random random(seed);
    return view_of(count, Vec3d(-100.0, 150.0, 300.0), [&] {
        for (;;) {
            const double u = random.uniform(0.0, 2.0 * kPi);
            const double v = random.uniform(0.0, 2.0 * kPi);
            const double r = 40.0 + 15.0 * std::cos(v);
            const Vec3d p(r * std::cos(u), r * std::sin(u), 15.0 * std::sin(v));
            if (0.8 * p.x() + 0.3 * p.y() + 0.2 * p.z() > 22.0) continue;
            return Surfel{p,
                          Vec3d(std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v))};
        }
    });
}

/// A box of 80 x 50 x 30 with a corner missing, turned so that no face is parallel to an axis.
inline PointCloud notched_box(std::size_t count, std::uint64_t seed = 3) {
    const Vec3d half(40.0, 25.0, 15.0);
    Random random(seed);
    const Mat3d turn = Random(17).rotation();
    return view_of(count, Vec3d(250.0, -180.0, 260.0), [&] {
        for (;;) {
            const auto face = static_cast<Eigen::Index>(random.below(3));
            const double side = random.below(2) == 0 ? -1.0 : 1.0;
            Vec3d p(random.uniform(-40.0, 40.0), random.uniform(-25.0, 25.0),
                    random.uniform(-15.0, 15.0));
            p[face] = side * half[face];
            if (p.x() > 11.0 && p.y() < 7.0 && p.z() > -20.0 && p.x() - p.y() > 30.0) continue;
            Vec3d normal = Vec3d::Zero();
            normal[face] = side;
            return Surfel{turn * p, turn * normal};
        }
    });
}

/// All three at a size.
inline std::vector<PointCloud> all(std::size_t count) {
    return {bumpy_ellipsoid(count), cut_torus(count), notched_box(count)};
}

/// Every `step`-th vertex of a PLY file with float x y z first, that faces the viewpoint; empty if
/// the file can't be read.
inline PointCloud ply_view(const std::string& path, std::size_t step) {
    std::ifstream file(path, std::ios::binary);
    std::string line;
    std::size_t vertices = 0;
    bool big = false;
    std::size_t properties = 0;
    bool in_vertices = false;
    while (std::getline(file, line) && line.rfind("end_header", 0) != 0) {
        std::istringstream words(line);
        std::string key;
        std::string name;
        words >> key >> name;
        if (key == "format") big = name == "binary_big_endian";
        if (key == "element") in_vertices = name == "vertex";
        if (key == "element" && in_vertices) words >> vertices;
        if (key == "property" && in_vertices) ++properties;
    }
    PointCloud all;
    std::vector<unsigned char> bytes(4 * properties);
    for (std::size_t i = 0; i < vertices; ++i) {
        file.read(reinterpret_cast<char*>(bytes.data()),
                  static_cast<std::streamsize>(bytes.size()));
        if (!file || i % step != 0) continue;
        Vec3f p;
        for (std::size_t k = 0; k < 3; ++k) {
            std::uint32_t bits = 0;
            for (std::size_t b = 0; b < 4; ++b) {
                bits |= std::uint32_t{bytes[4 * k + b]} << (big ? 24U - 8U * b : 8U * b);
            }
            p[static_cast<Eigen::Index>(k)] = std::bit_cast<float>(bits);
        }
        all.points.push_back(p);
    }
    if (all.empty()) return {};
    const Vec3d center = centroid(all.points);
    all.viewpoint = center.cast<float>();
    all.normals = estimate_normals(all);  // toward the center
    PointCloud view;
    double reach = 0.0;
    for (const Vec3f& p : all.points) reach = std::max(reach, (p.cast<double>() - center).norm());
    view.viewpoint = (center + Vec3d(0.3, 0.4, 0.9) * 4.0 * reach).cast<float>();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Vec3f normal = -all.normals[i];
        if (!(normal.dot(view.viewpoint - all.points[i]) > 0.0F)) continue;
        view.points.push_back(all.points[i]);
        view.normals.push_back(normal);
    }
    return view;
}

inline double relative_l1(std::span<const float> a, std::span<const float> b) {
    double difference = 0.0;
    double size = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference += std::abs(double{a[i]} - b[i]);
        size += std::abs(b[i]);
    }
    return difference / size;
}

}  // namespace ostraka::shapes
