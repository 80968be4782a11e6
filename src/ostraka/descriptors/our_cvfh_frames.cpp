// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/our_cvfh_frames.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/exact_sum.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kBlock = 256;
constexpr double kDefaultWidth = 0.1;  // of the largest distance

// Axes of a region by spread, the greatest first: columns. Points near its middle weigh most.
Mat3d region_axes(const PointCloud& cloud, const SmoothRegion& region) {
    const Vec3d center = region.centroid.cast<double>();
    double reach = 0.0;
    for (const std::uint32_t i : region.points) {
        reach = std::max(reach, (cloud.points[i].cast<double>() - center).squaredNorm());
    }
    reach = std::sqrt(reach);
    Mat3d scatter = Mat3d::Zero();
    double size = 0.0;
    for (const std::uint32_t i : region.points) {
        const Vec3d offset = cloud.points[i].cast<double>() - center;
        scatter += (reach - offset.norm()) * offset * offset.transpose();
        size += reach * offset.squaredNorm();
    }
    if (size > 0.0) scatter /= size;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
    Mat3d axes;
    for (int k = 0; k < 3; ++k) axes.col(k) = solver.eigenvectors().col(2 - k);
    return axes;
}

// How the whole piece lies along an axis: turned toward the heavier side; 1 if both weigh the same.
struct Side {
    Vec3d axis;
    double ambiguity;
};

// Along the first two columns of `axes`.
std::array<Side, 2> heavier_sides(const PointCloud& cloud, const Vec3d& center, const Mat3d& axes) {
    const Vec3d a = axes.col(0);
    const Vec3d b = axes.col(1);
    // Of each axis the signed and the absolute lengths.
    double sum_a = 0.0;
    double sum_b = 0.0;
    double all_a = 0.0;
    double all_b = 0.0;
    for (const Vec3f& point : cloud.points) {
        const double x = point.x() - center.x();
        const double y = point.y() - center.y();
        const double z = point.z() - center.z();
        const double along_a = x * a.x() + y * a.y() + z * a.z();
        const double along_b = x * b.x() + y * b.y() + z * b.z();
        sum_a += along_a;
        sum_b += along_b;
        all_a += std::abs(along_a);
        all_b += std::abs(along_b);
    }
    const auto side = [](const Vec3d& axis, double sum, double all) {
        const double larger = all + std::abs(sum);  // both twice the sums of the sides
        const double ambiguity = larger > 0.0 ? (all - std::abs(sum)) / larger : 1.0;
        return Side{sum < 0.0 ? Vec3d(-axis) : axis, ambiguity};
    };
    return {side(a, sum_a, all_a), side(b, sum_b, all_b)};
}

Mat3d frame_of(const Vec3d& x, const Vec3d& z) {
    Mat3d R_frame_cloud;
    R_frame_cloud.row(0) = x;
    R_frame_cloud.row(1) = z.cross(x);
    R_frame_cloud.row(2) = z;
    return R_frame_cloud;
}

// exp(-x) for x >= 0, relative error below 1e-6, up to 80; beyond as there. Polynomial: Moshier.
// Cephes Mathematical Library, expf. 1989.
inline float decay(float x) {
    const float limited = x < 80.0F ? x : 80.0F;
    const float steps = limited * 1.44269504F + 0.5F;
    const auto whole = static_cast<std::int32_t>(steps);
    const float r = static_cast<float>(whole) * 0.693147181F - limited;
    const float series = ((((1.9875691500e-4F * r + 1.3981999507e-3F) * r + 8.3334519073e-3F) * r +
                           4.1665795894e-2F) *
                              r +
                          1.6666665459e-1F) *
                             r +
                         5.0000001201e-1F;
    const float power = std::bit_cast<float>((127 - whole) << 23);
    return (series * r * r + r + 1.0F) * power;
}

// A block of points in the frame: share on the positive side of each axis, and the distance's bin.
struct Placed {
    std::array<float, kBlock> x, y, z;
    std::array<std::int32_t, kBlock> bin;
};

struct Scale {
    float inverse_width;  // 1 / (2 width^2)
    float shells;         // bins over the largest distance
};

// Far from the plane between two sides all of a point is on its own, on the plane half of it.
inline float share(float along, float inverse_width) {
    const float half = 0.5F - 0.5F * decay(along * along * inverse_width);
    return along >= 0.0F ? 0.5F + half : 0.5F - half;
}

OSTRAKA_VECTOR_CLONES
void place_block(const Scale& scale, std::size_t count, Placed& p) {
    const Scale s = scale;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) {
        const float x = p.x[i];
        const float y = p.y[i];
        const float z = p.z[i];
        const float shell = std::sqrt(x * x + y * y + z * z) * s.shells;
        // The shells are open at the bottom and closed at the top: ceil(shell) - 1.
        const auto whole = static_cast<std::int32_t>(shell);
        const std::int32_t above = static_cast<float>(whole) < shell ? whole : whole - 1;
        const std::int32_t low = above > 0 ? above : 0;
        constexpr auto kTop = static_cast<std::int32_t>(kOctantBins) - 1;
        p.bin[i] = low < kTop ? low : kTop;
        p.x[i] = share(x, s.inverse_width);
        p.y[i] = share(y, s.inverse_width);
        p.z[i] = share(z, s.inverse_width);
    }
}

// Weights are integers, so that their sums don't depend on the order of the points. A block's fit
// into 32 bits.
constexpr float kUnit = 4194304.0F;  // 2^22
template <class Integer>
using Shells = std::array<std::array<Integer, kOctants>, kOctantBins>;

// Octants count as in PCL, whose y axis points the other way: +x 4, -y 2, +z 1.
OSTRAKA_VECTOR_CLONES
void add_block(const Placed& p, std::size_t count, Shells<std::int32_t>& shells) {
    static_assert(kOctants == kVectorLanes);
    const Float8 x0 = {1, 1, 1, 1, 0, 0, 0, 0};  // a side's share is the other's complement
    const Float8 x1 = {-1, -1, -1, -1, 1, 1, 1, 1};
    const Float8 y0 = {0, 0, 1, 1, 0, 0, 1, 1};
    const Float8 y1 = {1, 1, -1, -1, 1, 1, -1, -1};
    const Float8 z0 = {1, 0, 1, 0, 1, 0, 1, 0};
    const Float8 z1 = {-1, 1, -1, 1, -1, 1, -1, 1};
    for (std::size_t i = 0; i < count; ++i) {
        const Float8 weight = (x0 + x1 * p.x[i]) * (y0 + y1 * p.y[i]) * (z0 + z1 * p.z[i]);
        std::array<std::int32_t, kOctants>& shell = shells[static_cast<std::size_t>(p.bin[i])];
        Int8 sum;
        std::memcpy(&sum, shell.data(), sizeof(sum));
        sum += __builtin_convertvector(weight * kUnit + 0.5F, Int8);
        std::memcpy(shell.data(), &sum, sizeof(sum));
    }
}

}  // namespace

std::vector<Mat3d> region_frames(const PointCloud& cloud, const SmoothRegion& region,
                                 const OurCvfhSettings& settings) {
    const Vec3d center = region.centroid.cast<double>();
    const Mat3d axes = region_axes(cloud, region);
    const auto [first, second] = heavier_sides(cloud, center, axes);
    Vec3d z = axes.col(2);
    if (region.normal.cast<double>().dot(z) < 0.0) z = -z;
    const double lower = std::min(first.ambiguity, second.ambiguity);
    const double upper = std::max(first.ambiguity, second.ambiguity);
    if (!(lower > double{settings.axis_ratio} * upper)) {
        return {frame_of(second.ambiguity < first.ambiguity ? second.axis : first.axis, z)};
    }
    if (!(lower > double{settings.min_axis_value})) {
        return {frame_of(first.axis, z), frame_of(second.axis, z)};
    }
    return {frame_of(first.axis, z), frame_of(-first.axis, z), frame_of(second.axis, z),
            frame_of(-second.axis, z)};
}

void octant_distances(const PointCloud& cloud, const Pose& T_frame_cloud, float octant_width,
                      bool normalize, std::span<float> bins) {
    const Mat3f R = T_frame_cloud.linear().cast<float>();
    const Vec3d center = T_frame_cloud.inverse().translation();
    const double reach = largest_distance(cloud.points, center);
    const double width = octant_width > 0.0F ? octant_width : kDefaultWidth * reach;
    const Scale scale{static_cast<float>(width > 0.0 ? 0.5 / (width * width) : 0.0),
                      static_cast<float>(reach > 0.0 ? kOctantBins / reach : 0.0)};
    const Vec3f origin = center.cast<float>();
    Shells<std::int64_t> shells{};
    Placed placed;
    for (std::size_t first = 0; first < cloud.size(); first += kBlock) {
        const std::size_t count = std::min(kBlock, cloud.size() - first);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3f offset = cloud.points[first + i] - origin;
            placed.x[i] = R(0, 0) * offset.x() + R(0, 1) * offset.y() + R(0, 2) * offset.z();
            placed.y[i] = R(1, 0) * offset.x() + R(1, 1) * offset.y() + R(1, 2) * offset.z();
            placed.z[i] = R(2, 0) * offset.x() + R(2, 1) * offset.y() + R(2, 2) * offset.z();
        }
        place_block(scale, count, placed);
        Shells<std::int32_t> block{};
        add_block(placed, count, block);
        for (std::size_t b = 0; b < kOctantBins; ++b) {
            for (std::size_t o = 0; o < kOctants; ++o) shells[b][o] += block[b][o];
        }
    }
    const auto points = static_cast<double>(cloud.size());
    const double share = !normalize ? 1.0 : points > 1.0 ? 100.0 / (points - 1.0) : 0.0;
    for (std::size_t o = 0; o < kOctants; ++o) {
        for (std::size_t b = 0; b < kOctantBins; ++b) {
            bins[o * kOctantBins + b] =
                static_cast<float>(static_cast<double>(shells[b][o]) * (share / double{kUnit}));
        }
    }
}

}  // namespace ostraka
