// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/vfh_histogram.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/exact_sum.hpp"
#include "ostraka/descriptors/fast_math.hpp"

namespace ostraka {
namespace {

constexpr int kAngleBins = 45;
constexpr int kViewBins = 128;
constexpr std::size_t kBlock = 256;

struct Columns {
    const float *px, *py, *pz, *nx, *ny, *nz;
};

struct Reference {
    float px, py, pz;  // center
    float nx, ny, nz;  // its normal
    float vx, vy, vz;  // toward the viewpoint, unit
    float distance_scale;
};

// Bins of a block of points; -1 where undefined.
struct Binned {
    std::array<std::int32_t, kBlock> angle, cosine, tilt, distance, view;
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
void bin_block(const Reference& given, const Columns& columns, std::size_t first, std::size_t count,
               Binned& b) {
    constexpr float kHalfTurn = 3.14159265F;
    constexpr float kAngleScale = static_cast<float>(kAngleBins) / (2.0F * kHalfTurn);
    const Reference c = given;
    const Columns p = columns;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) {
        const float dx = p.px[first + i] - c.px;
        const float dy = p.py[first + i] - c.py;
        const float dz = p.pz[first + i] - c.pz;
        const float nx = p.nx[first + i];
        const float ny = p.ny[first + i];
        const float nz = p.nz[first + i];
        const float length = std::sqrt(dx * dx + dy * dy + dz * dz);
        const float inverse = 1.0F / (length > 0.0F ? length : 1.0F);
        const float cosine1 = (c.nx * dx + c.ny * dy + c.nz * dz) * inverse;
        const float cosine2 = (nx * dx + ny * dy + nz * dz) * inverse;
        const bool swap = (std::fabs(cosine1) < std::fabs(cosine2)) & (std::fabs(cosine2) <= 1.0F);
        const float tilt = swap ? -cosine2 : cosine1;
        const float sign = swap ? -1.0F : 1.0F;
        const float ux = swap ? nx : c.nx;
        const float uy = swap ? ny : c.ny;
        const float uz = swap ? nz : c.nz;
        const float mx = swap ? c.nx : nx;
        const float my = swap ? c.ny : ny;
        const float mz = swap ? c.nz : nz;
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
        b.angle[i] = bin_of((angle + kHalfTurn) * kAngleScale, kAngleBins, valid);
        b.cosine[i] = bin_of((cosine + kHalfTurn) * kAngleScale, kAngleBins, valid);
        b.tilt[i] = bin_of((tilt + kHalfTurn) * kAngleScale, kAngleBins, valid);
        b.distance[i] = bin_of(length * c.distance_scale, kAngleBins, valid);
        const float view = nx * c.vx + ny * c.vy + nz * c.vz;
        b.view[i] = bin_of((view + 1.0F) * (0.5F * kViewBins), kViewBins, view == view);
    }
}

float farthest(const Columns& p, std::size_t count, const Vec3f& center) {
    float largest = 0.0F;
    for (std::size_t i = 0; i < count; ++i) {
        const float dx = p.px[i] - center.x();
        const float dy = p.py[i] - center.y();
        const float dz = p.pz[i] - center.z();
        largest = std::max(largest, dx * dx + dy * dy + dz * dz);
    }
    return std::sqrt(largest);
}

// One more bin at the front takes what is undefined (-1).
template <std::size_t kBins>
using Counts = std::array<std::uint32_t, kBins + 1>;

template <std::size_t kBins>
void write(const Counts<kBins>& counts, float share, std::span<float> row) {
    for (std::size_t b = 0; b < kBins; ++b) row[b] = static_cast<float>(counts[b + 1]) * share;
}

}  // namespace

VfhHistogram::VfhHistogram(const PointCloud& cloud) : viewpoint_(cloud.viewpoint) {
    for (auto* column : {&px_, &py_, &pz_, &nx_, &ny_, &nz_}) column->resize(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        px_[i] = cloud.points[i].x();
        py_[i] = cloud.points[i].y();
        pz_[i] = cloud.points[i].z();
        nx_[i] = cloud.normals[i].x();
        ny_[i] = cloud.normals[i].y();
        nz_[i] = cloud.normals[i].z();
    }
}

void VfhHistogram::describe(const VfhCenter& center, const VfhBins& bins,
                            std::span<float> row) const {
    const std::size_t size = px_.size();
    const Columns columns{px_.data(), py_.data(), pz_.data(), nx_.data(), ny_.data(), nz_.data()};
    const Vec3d away = viewpoint_.cast<double>() - center.point.cast<double>();
    const double length = away.norm();
    const Vec3f view = length > 0.0 ? Vec3f((away / length).cast<float>()) : Vec3f(Vec3f::Zero());
    const float reach = bins.distances ? farthest(columns, size, center.point) : 0.0F;
    const Reference reference{
        center.point.x(),  center.point.y(),
        center.point.z(),  center.normal.x(),
        center.normal.y(), center.normal.z(),
        view.x(),          view.y(),
        view.z(),          reach > 0.0F ? static_cast<float>(kAngleBins) / reach : 0.0F};
    Counts<kAngleBins> angle{};
    Counts<kAngleBins> cosine{};
    Counts<kAngleBins> tilt{};
    Counts<kAngleBins> distance{};
    Counts<kViewBins> views{};
    Binned binned;
    for (std::size_t first = 0; first < size; first += kBlock) {
        const std::size_t count = std::min(kBlock, size - first);
        bin_block(reference, columns, first, count, binned);
        for (std::size_t i = 0; i < count; ++i) {
            ++angle[static_cast<std::size_t>(binned.angle[i] + 1)];
            ++cosine[static_cast<std::size_t>(binned.cosine[i] + 1)];
            ++tilt[static_cast<std::size_t>(binned.tilt[i] + 1)];
            ++views[static_cast<std::size_t>(binned.view[i] + 1)];
        }
        if (!bins.distances) continue;
        for (std::size_t i = 0; i < count; ++i) {
            ++distance[static_cast<std::size_t>(binned.distance[i] + 1)];
        }
    }
    const auto points = static_cast<float>(size);
    const float share = !bins.normalize ? 1.0F : size > 1 ? 100.0F / (points - 1.0F) : 0.0F;
    write<kAngleBins>(angle, share, row);
    write<kAngleBins>(cosine, share, row.subspan(kAngleBins));
    write<kAngleBins>(tilt, share, row.subspan(2 * kAngleBins));
    write<kAngleBins>(distance, share, row.subspan(3 * kAngleBins));
    write<kViewBins>(views, bins.normalize ? 100.0F / points : 1.0F, row.subspan(4 * kAngleBins));
}

VfhCenter whole_center(const PointCloud& cloud) {
    const TermRounder rounded(cloud.size(), 1.0);
    Vec3d normal = Vec3d::Zero();
    std::size_t count = 0;
    for (const Vec3f& n : cloud.normals) {
        if (!(n.squaredNorm() < 1.5F)) continue;
        normal += Vec3d(rounded(n.x()), rounded(n.y()), rounded(n.z()));
        ++count;
    }
    if (count > 0) normal /= static_cast<double>(count);
    return {exact_centroid(cloud.points).cast<float>(), normal.cast<float>()};
}

}  // namespace ostraka
