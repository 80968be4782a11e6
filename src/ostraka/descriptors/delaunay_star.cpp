// SPDX-License-Identifier: Apache-2.0
// Gift wrapping: from the nearest neighbor around the point, each time to the neighbor whose circle
// through the point and the last neighbor is empty. Both ways at once, since each step waits for
// the last one: a star of 6 among 20 neighbors is 3 or 4 sweeps over 3 vectors, each about 40
// cycles of computation but 80 of waiting. With the projection of about 50 nearby points the floor
// is near 300 cycles a point; measured, with agreeing on triangles, four to five times that.
#include "ostraka/descriptors/delaunay_star.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace ostraka {
namespace {

constexpr float kLargestWeight = 1e-3F;
constexpr float kFar = std::numeric_limits<float>::max();
constexpr std::size_t kNone = ~std::size_t{0};
constexpr Int8 kLaneNumbers = {0, 1, 2, 3, 4, 5, 6, 7};

struct Plane {
    Vec3f origin, normal, u, v;  // u and v are divided by the radius
    float scale;                 // 1 / radius
    float weight;                // of the origin
};

// Appends base + lane for each lane that is marked, without branches; writes up to 8 places more.
__attribute__((always_inline)) inline std::size_t append_marked(const Int8& marks,
                                                                std::uint32_t base,
                                                                std::uint32_t* list,
                                                                std::size_t length) {
    std::uint64_t pairs[4];
    std::memcpy(&pairs, &marks, sizeof(pairs));
    if ((pairs[0] | pairs[1] | pairs[2] | pairs[3]) == 0) return length;
    for (std::uint32_t pair = 0; pair < 4; ++pair) {
        list[length] = base + 2 * pair;
        length += pairs[pair] & 1U;
        list[length] = base + 2 * pair + 1;
        length += pairs[pair] >> 63U;
    }
    return length;
}

OSTRAKA_VECTOR_CLONES
std::size_t list_near_box(const StarPoints& points, std::size_t first, std::size_t end,
                          const Vec3f& low, const Vec3f& high, float squared_radius,
                          std::uint32_t* list) {
    std::size_t length = 0;
    for (std::size_t i = first; i < end; i += kVectorLanes) {
        Float8 squared = {};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Float8 position;
            load8(points.columns[axis].data() + i, position);
            const Float8 below = low[static_cast<Eigen::Index>(axis)] - position;
            const Float8 above = position - high[static_cast<Eigen::Index>(axis)];
            Float8 outside = below > above ? below : above;
            outside = outside > 0.0F ? outside : Float8{};
            squared += outside * outside;
        }
        Int8 near = squared < squared_radius;
        if (end - i < kVectorLanes) near &= kLaneNumbers < static_cast<std::int32_t>(end - i);
        length = append_marked(near, static_cast<std::uint32_t>(i), list, length);
    }
    return length;
}

// Projects the nearby points along the normal and lists those within the radius that face the same
// way as the origin.
__attribute__((always_inline)) inline std::size_t project(const StarPoints& nearby, const Plane& p,
                                                          StarScratch& s) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < nearby.count; i += kVectorLanes) {
        Float8 x;
        Float8 y;
        Float8 z;
        load8(nearby.columns[0].data() + i, x);
        load8(nearby.columns[1].data() + i, y);
        load8(nearby.columns[2].data() + i, z);
        x = (x - p.origin.x()) * p.scale;
        y = (y - p.origin.y()) * p.scale;
        z = (z - p.origin.z()) * p.scale;
        const Float8 distance = x * x + y * y + z * z;
        const Float8 u = x * p.u.x() + y * p.u.y() + z * p.u.z();
        const Float8 v = x * p.v.x() + y * p.v.y() + z * p.v.z();
        const Float8 planar = u * u + v * v;
        load8(nearby.columns[3].data() + i, x);
        load8(nearby.columns[4].data() + i, y);
        load8(nearby.columns[5].data() + i, z);
        const Float8 facing = x * p.normal.x() + y * p.normal.y() + z * p.normal.z();
        Float8 weight;
        load8(nearby.columns[6].data() + i, weight);
        const Float8 squared = planar + p.weight - weight;
        std::memcpy(s.all_u.data() + i, &u, sizeof(u));
        std::memcpy(s.all_v.data() + i, &v, sizeof(v));
        std::memcpy(s.all_squared.data() + i, &squared, sizeof(squared));
        // Neighbors steeper than 60 degrees belong to another sheet.
        Int8 use =
            (distance < 1.0F) & (distance > 0.0F) & (facing > 0.0F) & (planar > 0.25F * distance);
        if (nearby.count - i < kVectorLanes) {
            use &= kLaneNumbers < static_cast<std::int32_t>(nearby.count - i);
        }
        length = append_marked(use, static_cast<std::uint32_t>(i), s.list.data(), length);
    }
    return length;
}

// Copies the listed points and fills up with ones at the origin, which are never chosen.
__attribute__((always_inline)) inline void compact(StarScratch& s) {
    for (std::size_t i = 0; i < s.count; ++i) {
        const std::uint32_t at = s.list[i];
        s.u[i] = s.all_u[at];
        s.v[i] = s.all_v[at];
        s.squared[i] = s.all_squared[at];
    }
    for (std::size_t i = s.count; i < s.count + kVectorLanes; ++i) {
        s.u[i] = 0.0F;
        s.v[i] = 0.0F;
        s.squared[i] = 0.0F;
    }
}

// In each lane the lower one of the value there and the one in lane kOther: of equal values the one
// with the smaller number.
template <int... kOther>
__attribute__((always_inline)) inline void keep_lower(Float8& value, Int8& number) {
    const Float8 other_value = __builtin_shufflevector(value, value, kOther...);
    const Int8 other_number = __builtin_shufflevector(number, number, kOther...);
    const Int8 better = (other_value < value) | ((other_value == value) & (other_number < number));
    value = better ? other_value : value;
    number = better ? other_number : number;
}

// The number of the lowest value over all lanes; kNone if no lane has one.
__attribute__((always_inline)) inline std::size_t lowest_lane(Float8& value, Int8& number) {
    keep_lower<4, 5, 6, 7, 0, 1, 2, 3>(value, number);
    keep_lower<2, 3, 0, 1, 6, 7, 4, 5>(value, number);
    keep_lower<1, 0, 3, 2, 5, 4, 7, 6>(value, number);
    const std::int32_t found = number[0];
    return found == std::numeric_limits<std::int32_t>::max() ? kNone
                                                             : static_cast<std::size_t>(found);
}

// The next neighbor after one: the one whose circle's center is lowest over the edge from the
// origin to it.
struct Next {
    float x, y, length, height;  // of the last neighbor
    Float8 best = Float8{} + kFar;
    Int8 where = Int8{} + std::numeric_limits<std::int32_t>::max();

    __attribute__((always_inline)) Next(const StarScratch& s, std::size_t last)
        : x(s.u[last]), y(s.v[last]), length(x * x + y * y), height(s.squared[last]) {}

    // @param side  1 leftwards, -1 rightwards.
    __attribute__((always_inline)) void consider(const Float8& u, const Float8& v,
                                                 const Float8& squared, float side,
                                                 const Int8& numbers) {
        const Float8 cross = side * (x * v - y * u);
        const Float8 center = (squared * length - height * (x * u + y * v)) / cross;
        // Comparisons with the NaN of the filling are false.
        const Int8 better = (cross > 1e-6F) & (center < best);
        best = better ? center : best;
        where = better ? numbers : where;
    }
};

// The next neighbors leftwards from one and rightwards from another, in one sweep: neither waits
// for the other. kNone where there is none.
struct Pair {
    std::size_t left, right;
};
__attribute__((always_inline)) inline Pair next_around(const StarScratch& s, const Pair& last) {
    Next left(s, last.left);
    Next right(s, last.right);
    Int8 numbers = kLaneNumbers;
    for (std::size_t i = 0; i < s.count; i += kVectorLanes, numbers += 8) {
        Float8 u;
        Float8 v;
        Float8 squared;
        load8(s.u.data() + i, u);
        load8(s.v.data() + i, v);
        load8(s.squared.data() + i, squared);
        left.consider(u, v, squared, 1.0F, numbers);
        right.consider(u, v, squared, -1.0F, numbers);
    }
    return {lowest_lane(left.best, left.where), lowest_lane(right.best, right.where)};
}

// The neighbor with the nearest bisector: it is always in the star. kNone if there is none.
__attribute__((always_inline)) inline std::size_t first_neighbor(const StarScratch& s,
                                                                 float& nearest) {
    Float8 best = Float8{} + kFar;
    Float8 shortest = best;
    Int8 where = Int8{} + std::numeric_limits<std::int32_t>::max();
    Int8 numbers = kLaneNumbers;
    for (std::size_t i = 0; i < s.count; i += kVectorLanes, numbers += 8) {
        Float8 u;
        Float8 v;
        Float8 squared;
        load8(s.u.data() + i, u);
        load8(s.v.data() + i, v);
        load8(s.squared.data() + i, squared);
        const Float8 square = u * u + v * v;
        const Int8 shorter = (square > 0.0F) & (square < shortest);
        shortest = shorter ? square : shortest;
        const Float8 bisector = squared * squared / square;  // NaN for the filling
        const Int8 better = bisector < best;
        best = better ? bisector : best;
        where = better ? numbers : where;
    }
    float lowest = kFar;
    for (std::size_t lane = 0; lane < kVectorLanes; ++lane) {
        lowest = std::min<float>(lowest, shortest[lane]);
    }
    nearest = std::sqrt(lowest);
    return lowest_lane(best, where);
}

// Leftwards and rightwards from the first neighbor, until the ends meet or are open.
__attribute__((always_inline)) inline void wrap(const StarScratch& s, const StarPoints& nearby,
                                                Star& star) {
    const std::size_t first = first_neighbor(s, star.nearest);
    if (first == kNone) {
        star.nearest = 0.0F;
        return;
    }
    std::array<std::size_t, 2 * Star::kLargest + 1> around;
    std::size_t low = Star::kLargest;  // the neighbors so far: around[low] to around[high]
    std::size_t high = Star::kLargest;
    around[high] = first;
    bool closed = false;
    bool left_open = false;
    bool right_open = false;
    while (high - low + 1 < Star::kLargest && !(left_open && right_open)) {
        const Pair next = next_around(s, {around[high], around[low]});
        closed =
            (!left_open && next.left == around[low]) || (!right_open && next.right == around[high]);
        if (closed) break;
        left_open = left_open || next.left == kNone;
        right_open = right_open || next.right == kNone;
        if (!left_open) around[++high] = next.left;
        closed = !left_open && !right_open && next.left == next.right;
        if (closed) break;
        if (!right_open && high - low + 1 < Star::kLargest) around[--low] = next.right;
    }
    const std::size_t count = high - low + 1;
    for (std::size_t i = 0; i < count; ++i) {
        star.neighbors[i] = nearby.index[s.list[around[low + i]]];
    }
    if (closed) star.neighbors[count] = star.neighbors[0];
    star.triangles = static_cast<std::uint8_t>(closed ? count : count - 1);
}

// All of a star in one function, so that vectors stay in registers.
OSTRAKA_VECTOR_CLONES
void build_star(const StarPoints& nearby, const Plane& plane, StarScratch& s, Star& star) {
    s.count = project(nearby, plane, s);
    if (s.count < 2) return;
    compact(s);
    wrap(s, nearby, star);
}

OSTRAKA_VECTOR_CLONES
void copy_listed(const StarPoints& points, const std::uint32_t* list, std::size_t count,
                 std::size_t to, StarPoints& found) {
    for (std::size_t column = 0; column < points.columns.size(); ++column) {
        const float* source = points.columns[column].data();
        float* target = found.columns[column].data() + to;
#pragma GCC ivdep
        for (std::size_t i = 0; i < count; ++i) target[i] = source[list[i]];
    }
    const std::uint32_t* source = points.index.data();
    std::uint32_t* target = found.index.data() + to;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) target[i] = source[list[i]];
}

}  // namespace

void StarPoints::resize(std::size_t points) {
    count = points;
    if (index.size() >= points + kVectorLanes) return;
    for (auto& column : columns) column.resize(2 * points + kVectorLanes);
    index.resize(2 * points + kVectorLanes);
}

void StarPoints::set(std::size_t at, const Vec3f& point, const Vec3f& normal, std::uint32_t i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        columns[axis][at] = point[static_cast<Eigen::Index>(axis)];
        columns[axis + 3][at] = normal[static_cast<Eigen::Index>(axis)];
    }
    columns[6][at] = star_weight(point);
    index[at] = i;
}

void append_near_box(const StarPoints& points, std::size_t first, std::size_t end, const Vec3f& low,
                     const Vec3f& high, float radius, std::vector<std::uint32_t>& list,
                     StarPoints& found) {
    if (list.size() < end - first + kVectorLanes) list.resize(2 * (end - first) + kVectorLanes);
    const std::size_t near =
        list_near_box(points, first, end, low, high, radius * radius * 1.0001F, list.data());
    const std::size_t before = found.count;
    found.resize(before + near);
    copy_listed(points, list.data(), near, before, found);
}

float star_weight(const Vec3f& point) {
    std::uint32_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
        hash = (hash ^ std::bit_cast<std::uint32_t>(point[axis])) * 0x9e3779b1U;
        hash ^= hash >> 15U;
    }
    return static_cast<float>(hash >> 8U) * (kLargestWeight / 16777216.0F);
}

Star delaunay_star(const StarPoints& nearby, const Vec3f& point, const Vec3f& normal, float radius,
                   StarScratch& scratch) {
    Star star;
    if (!(normal.squaredNorm() > 0.25F) || !(normal.squaredNorm() < 4.0F)) return star;
    const std::size_t room = nearby.count + 2 * kVectorLanes;
    if (scratch.list.size() < room) {
        scratch.list.resize(2 * room);
        for (auto* column : {&scratch.all_u, &scratch.all_v, &scratch.all_squared, &scratch.u,
                             &scratch.v, &scratch.squared}) {
            column->resize(2 * room);
        }
    }
    const Vec3f helper = std::abs(normal.x()) < 0.6F ? Vec3f(1, 0, 0) : Vec3f(0, 1, 0);
    const Vec3f u = normal.cross(helper).normalized();
    const Vec3f v = normal.cross(u);
    const Plane plane{point, normal, u, v, 1.0F / radius, star_weight(point)};
    build_star(nearby, plane, scratch, star);
    return star;
}

}  // namespace ostraka
