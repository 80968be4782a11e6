// SPDX-License-Identifier: Apache-2.0
// Private to mesh: what simplify.cpp computes with.
#pragma once

#include <cstdint>
#include <tuple>

#include "ostraka/base/types.hpp"

namespace ostraka {

// Sum over planes n.p + d = 0 of weight * (squared distance).
struct Quadric {
    Mat3d a = Mat3d::Zero();
    Vec3d b = Vec3d::Zero();
    double c = 0.0;
    double weight = 0.0;

    void add_plane(const Vec3d& n, double d, double w) {
        a += w * n * n.transpose();
        b += w * d * n;
        c += w * d * d;
        weight += w;
    }
    Quadric& operator+=(const Quadric& other) {
        a += other.a;
        b += other.b;
        c += other.c;
        weight += other.weight;
        return *this;
    }
    double at(const Vec3d& p) const { return p.dot(a * p) + 2.0 * b.dot(p) + c; }
};

// Squared distance from a point to a triangle.
// Ericson. Real-Time Collision Detection, 5.1.5. 2005.
inline double squared_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d ab = b - a;
    const Vec3d ac = c - a;
    const Vec3d ap = p - a;
    const double d1 = ab.dot(ap);
    const double d2 = ac.dot(ap);
    if (d1 <= 0.0 && d2 <= 0.0) return ap.squaredNorm();
    const Vec3d bp = p - b;
    const double d3 = ab.dot(bp);
    const double d4 = ac.dot(bp);
    if (d3 >= 0.0 && d4 <= d3) return bp.squaredNorm();
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return (ap - ab * (d1 / (d1 - d3))).squaredNorm();
    const Vec3d cp = p - c;
    const double d5 = ab.dot(cp);
    const double d6 = ac.dot(cp);
    if (d6 >= 0.0 && d5 <= d6) return cp.squaredNorm();
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return (ap - ac * (d2 / (d2 - d6))).squaredNorm();
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
        return (bp - (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)))).squaredNorm();
    }
    const double scale = 1.0 / (va + vb + vc);
    return (ap - ab * (vb * scale) - ac * (vc * scale)).squaredNorm();
}

inline constexpr double kFoldCosine = -0.8;  // between neighbors' normals: the surface turns back

// Whether the surface turns back on itself between triangles with these normals (any length).
inline bool turns_back(const Vec3d& a, const Vec3d& b) {
    return a.dot(b) < kFoldCosine * a.norm() * b.norm();
}

// An edge that may be collapsed; void once an end has changed since.
struct Candidate {
    double order;
    std::uint32_t u;
    std::uint32_t v;
    std::uint32_t u_stamp;
    std::uint32_t v_stamp;
    bool operator>(const Candidate& other) const {
        return std::tie(order, u, v) > std::tie(other.order, other.u, other.v);
    }
};

}  // namespace ostraka
