// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/vfh.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/exact_sum.hpp"
#include "ostraka/descriptors/fast_math.hpp"

namespace ostraka {
namespace {

constexpr int kAngleBins = 45;
constexpr int kViewBins = 128;
constexpr std::size_t kBlock = 256;  // points handled at a time: their columns stay in the L1 cache

// What all points are compared with.
struct Center {
    float px, py, pz;  // centroid
    float nx, ny, nz;  // mean normal, not unit
    float vx, vy, vz;  // toward the viewpoint
};

// Columns of a block of points; bins come out as -1 where undefined.
struct Columns {
    std::array<float, kBlock> px, py, pz, nx, ny, nz;
    std::array<std::int32_t, kBlock> angle, cosine, tilt, view;
};

// Clamps before truncating: the argument may be slightly outside, never NaN where `valid`.
inline std::int32_t bin_of(float value, int bins, bool valid) {
    const float top = static_cast<float>(bins - 1);
    const float low = value > 0.0F ? value : 0.0F;
    const float clamped = low < top ? low : top;
    return valid ? static_cast<std::int32_t>(clamped) : -1;
}

// The pair features of Rusu 2010 between the center and each point, in PCL's order of the pair: the
// one whose normal is closer to the connecting line comes first.
OSTRAKA_VECTOR_CLONES
void bin_block(const Center& center, Columns& c, std::size_t count) {
    constexpr float kHalfTurn = 3.14159265F;
    constexpr float kAngleScale = static_cast<float>(kAngleBins) / (2.0F * kHalfTurn);
    for (std::size_t i = 0; i < count; ++i) {
        const float dx = c.px[i] - center.px;
        const float dy = c.py[i] - center.py;
        const float dz = c.pz[i] - center.pz;
        const float nx = c.nx[i];
        const float ny = c.ny[i];
        const float nz = c.nz[i];
        const float length = std::sqrt(dx * dx + dy * dy + dz * dz);
        const float inverse = 1.0F / (length > 0.0F ? length : 1.0F);
        const float cosine1 = (center.nx * dx + center.ny * dy + center.nz * dz) * inverse;
        const float cosine2 = (nx * dx + ny * dy + nz * dz) * inverse;
        const bool swap = (std::fabs(cosine1) < std::fabs(cosine2)) & (std::fabs(cosine2) <= 1.0F);
        const float tilt = swap ? -cosine2 : cosine1;
        const float sign = swap ? -1.0F : 1.0F;
        const float ux = swap ? nx : center.nx;
        const float uy = swap ? ny : center.ny;
        const float uz = swap ? nz : center.nz;
        const float mx = swap ? center.nx : nx;
        const float my = swap ? center.ny : ny;
        const float mz = swap ? center.nz : nz;
        float vx = sign * (dy * uz - dz * uy);
        float vy = sign * (dz * ux - dx * uz);
        float vz = sign * (dx * uy - dy * ux);
        const float norm = std::sqrt(vx * vx + vy * vy + vz * vz);
        const bool valid = (length > 0.0F) & (norm > 0.0F);  // also false for NaN
        const float scale = 1.0F / (valid ? norm : 1.0F);
        vx *= scale;
        vy *= scale;
        vz *= scale;
        const float wx = uy * vz - uz * vy;
        const float wy = uz * vx - ux * vz;
        const float wz = ux * vy - uy * vx;
        const float cosine = vx * mx + vy * my + vz * mz;
        const float angle = fast_atan2(wx * mx + wy * my + wz * mz, ux * mx + uy * my + uz * mz);
        c.angle[i] = bin_of((angle + kHalfTurn) * kAngleScale, kAngleBins, valid);
        c.cosine[i] = bin_of((cosine + kHalfTurn) * kAngleScale, kAngleBins, valid);
        c.tilt[i] = bin_of((tilt + kHalfTurn) * kAngleScale, kAngleBins, valid);
        const float view = nx * center.vx + ny * center.vy + nz * center.vz;
        c.view[i] = bin_of((view + 1.0F) * (0.5F * kViewBins), kViewBins, view == view);
    }
}

Center center_of(const PointCloud& cloud, const VfhSettings& settings) {
    const Vec3d middle = exact_centroid(cloud.points);
    const TermRounder rounded(cloud.size(), 1.0);
    Vec3d normal = Vec3d::Zero();
    std::size_t count = 0;
    for (const Vec3f& n : cloud.normals) {
        if (!(n.squaredNorm() < 1.5F)) continue;
        normal += Vec3d(rounded(n.x()), rounded(n.y()), rounded(n.z()));
        ++count;
    }
    if (count > 0) normal /= static_cast<double>(count);
    const Vec3d away = cloud.viewpoint.cast<double>() - middle;
    // PCL's difference of homogeneous vectors has a fourth component of -1.
    const double length =
        std::sqrt(away.squaredNorm() + (settings.pcl_viewpoint_length ? 1.0 : 0.0));
    const Vec3d view = length > 0.0 ? Vec3d(away / length) : Vec3d::Zero();
    const Vec3f p = middle.cast<float>();
    const Vec3f n = normal.cast<float>();
    const Vec3f v = view.cast<float>();
    return {p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), v.x(), v.y(), v.z()};
}

void load(const PointCloud& cloud, std::size_t first, std::size_t count, Columns& c) {
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3f& point = cloud.points[first + i];
        const Vec3f& normal = cloud.normals[first + i];
        c.px[i] = point.x();
        c.py[i] = point.y();
        c.pz[i] = point.z();
        c.nx[i] = normal.x();
        c.ny[i] = normal.y();
        c.nz[i] = normal.z();
    }
}

}  // namespace

std::vector<float> describe_vfh(const PointCloud& cloud, const VfhSettings& settings) {
    require_points(cloud, "vfh");
    require_normals(cloud, "vfh");
    const Center center = center_of(cloud, settings);
    // One more bin at the front of each block takes what is undefined (-1).
    std::array<std::uint32_t, kAngleBins + 1> angle{};
    std::array<std::uint32_t, kAngleBins + 1> cosine{};
    std::array<std::uint32_t, kAngleBins + 1> tilt{};
    std::array<std::uint32_t, kViewBins + 1> view{};
    Columns columns;
    for (std::size_t first = 0; first < cloud.size(); first += kBlock) {
        const std::size_t count = std::min(kBlock, cloud.size() - first);
        load(cloud, first, count, columns);
        bin_block(center, columns, count);
        for (std::size_t i = 0; i < count; ++i) {
            ++angle[static_cast<std::size_t>(columns.angle[i] + 1)];
            ++cosine[static_cast<std::size_t>(columns.cosine[i] + 1)];
            ++tilt[static_cast<std::size_t>(columns.tilt[i] + 1)];
            ++view[static_cast<std::size_t>(columns.view[i] + 1)];
        }
    }
    const auto points = static_cast<float>(cloud.size());
    const float share = cloud.size() > 1 ? 100.0F / (points - 1.0F) : 0.0F;
    const float view_share = 100.0F / points;
    std::vector<float> row(kVfhLength, 0.0F);
    for (std::size_t b = 0; b < kAngleBins; ++b) {
        row[b] = static_cast<float>(angle[b + 1]) * share;
        row[kAngleBins + b] = static_cast<float>(cosine[b + 1]) * share;
        row[2 * kAngleBins + b] = static_cast<float>(tilt[b + 1]) * share;
    }
    for (std::size_t b = 0; b < kViewBins; ++b) {
        row[4 * kAngleBins + b] = static_cast<float>(view[b + 1]) * view_share;
    }
    return row;
}

}  // namespace ostraka
