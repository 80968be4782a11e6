// SPDX-License-Identifier: Apache-2.0
// Gift wrapping: from the nearest neighbor around the point, each time to the neighbor whose circle
// through the point and the last neighbor is empty.
#include "ostraka/descriptors/delaunay_star.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "ostraka/descriptors/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr float kLargestWeight = 1e-3F;
constexpr float kFar = std::numeric_limits<float>::max();
constexpr std::size_t kNone = ~std::size_t{0};

struct Plane {
    Vec3f origin, normal, u, v;  // u and v are divided by the radius
    float scale;                 // 1 / radius
    float weight;                // of the origin
};

// Projects the candidates along the normal and marks those near enough that face the same way.
OSTRAKA_VECTOR_CLONES
void project(const Nearby& nearby, const Plane& plane, StarScratch& s) {
    const std::size_t count = nearby.size();
    const float* px = nearby.x.data();
    const float* py = nearby.y.data();
    const float* pz = nearby.z.data();
    const float* nx = nearby.nx.data();
    const float* ny = nearby.ny.data();
    const float* nz = nearby.nz.data();
    const float* weight = nearby.weight.data();
    float* su = s.u.data();
    float* sv = s.v.data();
    float* squared = s.squared.data();
    std::int32_t* usable = s.usable.data();
    const Plane p = plane;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) {
        const float x = (px[i] - p.origin.x()) * p.scale;
        const float y = (py[i] - p.origin.y()) * p.scale;
        const float z = (pz[i] - p.origin.z()) * p.scale;
        const float length = x * x + y * y + z * z;
        const float u = x * p.u.x() + y * p.u.y() + z * p.u.z();
        const float v = x * p.v.x() + y * p.v.y() + z * p.v.z();
        const float planar = u * u + v * v;
        const float facing = nx[i] * p.normal.x() + ny[i] * p.normal.y() + nz[i] * p.normal.z();
        su[i] = u;
        sv[i] = v;
        squared[i] = planar + p.weight - weight[i];
        // Neighbors steeper than 60 degrees belong to another sheet.
        const bool use =
            (length < 1.0F) & (length > 0.0F) & (facing > 0.0F) & (planar > 0.25F * length);
        usable[i] = use ? 1 : 0;
    }
}

// Keeps the marked candidates and fills up with ones at the origin, which are never chosen.
void compact(const Nearby& nearby, StarScratch& s) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < nearby.size(); ++i) {
        s.flat_u[count] = s.u[i];
        s.flat_v[count] = s.v[i];
        s.flat_squared[count] = s.squared[i];
        s.flat_index[count] = nearby.index[i];
        count += static_cast<std::size_t>(s.usable[i]);
    }
    s.count = count;
    for (std::size_t i = count; i < count + kVectorLanes; ++i) {
        s.flat_u[i] = 0.0F;
        s.flat_v[i] = 0.0F;
        s.flat_squared[i] = 0.0F;
    }
}

// The next neighbor after `a`, leftwards (side 1) or rightwards (-1): the one whose circle's center
// is lowest over the edge from the origin to a.
OSTRAKA_VECTOR_CLONES
std::size_t next_around(const StarScratch& s, std::size_t a, float side) {
    const float ax = s.flat_u[a];
    const float ay = s.flat_v[a] * side;
    const float length = ax * ax + ay * ay;
    const float height = s.flat_squared[a];
    const float* su = s.flat_u.data();
    const float* sv = s.flat_v.data();
    const float* squared = s.flat_squared.data();
    const Int8 numbers = {0, 1, 2, 3, 4, 5, 6, 7};
    Float8 best = Float8{} + kFar;
    Int8 where = Int8{} - 1;
    for (std::size_t i = 0; i < s.count; i += kVectorLanes) {
        Float8 x;
        Float8 y;
        Float8 square;
        load8(su + i, x);
        load8(sv + i, y);
        load8(squared + i, square);
        y *= side;
        const Float8 cross = ax * y - ay * x;
        const Float8 center = (square * length - height * (ax * x + ay * y)) / cross;
        // Comparisons with the NaN of the filling are false.
        const Int8 better = (cross > 1e-6F) & (center < best);
        best = better ? center : best;
        where = better ? numbers + static_cast<std::int32_t>(i) : where;
    }
    float lowest = kFar;
    std::int32_t found = -1;
    for (std::size_t lane = 0; lane < kVectorLanes; ++lane) {
        const bool tie = best[lane] == lowest && where[lane] < found;
        if (where[lane] < 0 || !(best[lane] < lowest || tie)) continue;
        lowest = best[lane];
        found = where[lane];
    }
    return found < 0 ? kNone : static_cast<std::size_t>(found);
}

// The neighbor with the nearest bisector: it is always in the star.
std::size_t first_neighbor(const StarScratch& s, float& nearest) {
    float best = kFar;
    std::size_t first = 0;
    float shortest = kFar;
    for (std::size_t i = 0; i < s.count; ++i) {
        const float square = s.flat_u[i] * s.flat_u[i] + s.flat_v[i] * s.flat_v[i];
        shortest = square < shortest ? square : shortest;
        const float bisector = s.flat_squared[i] * s.flat_squared[i] / square;
        if (bisector < best) {
            best = bisector;
            first = i;
        }
    }
    nearest = std::sqrt(shortest);
    return first;
}

// Leftwards from the first neighbor and, if the star is open, rightwards.
void wrap(const StarScratch& s, Star& star) {
    const std::size_t first = first_neighbor(s, star.nearest);
    std::array<std::size_t, Star::kLargest> around{};
    std::size_t count = 0;
    around[count++] = first;
    while (count < Star::kLargest) {
        const std::size_t next = next_around(s, around[count - 1], 1.0F);
        if (next == kNone) break;
        if (next == first) {
            star.closed = true;
            break;
        }
        around[count++] = next;
    }
    std::size_t last = first;
    while (!star.closed && count < Star::kLargest) {
        last = next_around(s, last, -1.0F);
        const auto end = around.begin() + static_cast<std::ptrdiff_t>(count);
        if (last == kNone || std::find(around.begin(), end, last) != end) break;
        std::rotate(around.begin(), end, end + 1);
        around[0] = last;
        ++count;
    }
    star.count = static_cast<std::uint8_t>(count);
    for (std::size_t i = 0; i < count; ++i) star.neighbors[i] = s.flat_index[around[i]];
}

}  // namespace

bool Star::holds(std::uint32_t a, std::uint32_t b) const {
    for (std::size_t i = 0; i < count; ++i) {
        if (neighbors[i] != a) continue;
        if (i + 1 < count) return neighbors[i + 1] == b;
        return closed && neighbors[0] == b;
    }
    return false;
}

void Nearby::clear() {
    for (auto* column : {&x, &y, &z, &nx, &ny, &nz, &weight}) column->clear();
    index.clear();
}

void Nearby::add(const Vec3f& point, const Vec3f& normal, float point_weight, std::uint32_t i) {
    x.push_back(point.x());
    y.push_back(point.y());
    z.push_back(point.z());
    nx.push_back(normal.x());
    ny.push_back(normal.y());
    nz.push_back(normal.z());
    weight.push_back(point_weight);
    index.push_back(i);
}

float star_weight(const Vec3f& point) {
    std::uint32_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
        hash = (hash ^ std::bit_cast<std::uint32_t>(point[axis])) * 0x9e3779b1U;
        hash ^= hash >> 15U;
    }
    return static_cast<float>(hash >> 8U) * (kLargestWeight / 16777216.0F);
}

Star delaunay_star(const Vec3f& point, const Vec3f& normal, float radius, const Nearby& nearby,
                   StarScratch& scratch) {
    Star star;
    if (!(normal.squaredNorm() > 0.25F) || !(normal.squaredNorm() < 4.0F)) return star;
    const std::size_t room = nearby.size() + kVectorLanes;
    if (scratch.u.size() < room) {
        for (auto* column : {&scratch.u, &scratch.v, &scratch.squared, &scratch.flat_u,
                             &scratch.flat_v, &scratch.flat_squared}) {
            column->resize(room);
        }
        scratch.usable.resize(room);
        scratch.flat_index.resize(room);
    }
    const Vec3f helper = std::abs(normal.x()) < 0.6F ? Vec3f(1, 0, 0) : Vec3f(0, 1, 0);
    const Vec3f u = normal.cross(helper).normalized();
    const Vec3f v = normal.cross(u);
    project(nearby, {point, normal, u, v, 1.0F / radius, star_weight(point)}, scratch);
    compact(nearby, scratch);
    if (scratch.count >= 2) wrap(scratch, star);
    return star;
}

}  // namespace ostraka
