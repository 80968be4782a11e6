// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/gasd.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/exact_sum.hpp"
#include "ostraka/descriptors/gasd_aligned.hpp"

namespace ostraka {
namespace {

constexpr int kHalfGrid = 4;
constexpr int kGrid = 2 * kHalfGrid;
constexpr int kPadded = kGrid + 2;  // a border of one cell takes what interpolation spills
constexpr std::size_t kBlock = 256;

// The sign that PCL's eigen33 gives an eigenvector: it is the longest cross product of two rows of
// A - lambda I, that is plus or minus a row of the adjugate, which is c * v * v^T.
double pcl_sign(const Vec3d& v, bool middle_eigenvalue) {
    int largest = 2;
    if (std::abs(v[1]) > std::abs(v[largest])) largest = 1;
    if (std::abs(v[0]) > std::abs(v[largest])) largest = 0;
    const bool negative = (largest == 1) != middle_eigenvalue;
    return (v[largest] < 0.0) != negative ? -1.0 : 1.0;
}

// PCL's x axis: the eigenvector whose cross product was shortest takes its sign from the other two.
Vec3d pcl_x_axis(const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>& solver) {
    const Vec3d values = solver.eigenvalues();
    std::array<Vec3d, 3> axes;
    std::array<double, 3> lengths{};
    for (int i = 0; i < 3; ++i) {
        const Vec3d v = solver.eigenvectors().col(i);
        const auto k = static_cast<std::size_t>(i);
        axes[k] = v * pcl_sign(v, i == 1);
        lengths[k] =
            std::abs((values[i] - values[(i + 1) % 3]) * (values[i] - values[(i + 2) % 3])) *
            v.cwiseAbs().maxCoeff();
    }
    const bool x_is_shortest = lengths[2] < lengths[0] && lengths[2] < lengths[1];
    if (x_is_shortest) return axes[0].cross(axes[1]);
    return axes[2];
}

// Columns of a block of points in the aligned frame, and what each adds to its eight cells.
struct Columns {
    std::array<float, kBlock> x, y, z;
    std::array<float, kBlock> fx, fy, fz;     // fractions within the cell
    std::array<std::int32_t, kBlock> cell;    // the lowest of the eight cells
    std::array<std::int32_t, kBlock> counts;  // whether the point lies in an outer half-shell
};

struct Scale {
    float farthest;  // largest distance to the centroid
    float largest;   // largest coordinate along any axis
    bool outer_half_only;
};

OSTRAKA_VECTOR_CLONES
void place_block(const Scale& scale, Columns& c, std::size_t count) {
    const float shell = scale.farthest / static_cast<float>(kHalfGrid);
    const bool all = !scale.outer_half_only;
    for (std::size_t i = 0; i < count; ++i) {
        const float x = c.x[i];
        const float y = c.y[i];
        const float z = c.z[i];
        const float shells = std::sqrt((x * x + z * z) + y * y) / shell;
        const float within = shells - static_cast<float>(static_cast<std::int32_t>(shells));
        c.counts[i] = static_cast<std::int32_t>(all | (within >= 0.5F));
        // From -0.5 to 7.5; one is added so that truncation is the floor.
        const float gx = x / scale.largest * kHalfGrid + (kHalfGrid + 0.5F);
        const float gy = y / scale.largest * kHalfGrid + (kHalfGrid + 0.5F);
        const float gz = z / scale.largest * kHalfGrid + (kHalfGrid + 0.5F);
        const auto bx = static_cast<std::int32_t>(gx);
        const auto by = static_cast<std::int32_t>(gy);
        const auto bz = static_cast<std::int32_t>(gz);
        c.fx[i] = gx - static_cast<float>(bx);
        c.fy[i] = gy - static_cast<float>(by);
        c.fz[i] = gz - static_cast<float>(bz);
        c.cell[i] = (bx * kPadded + by) * kPadded + bz;
    }
}

using Cells = std::array<double, kPadded * kPadded * kPadded>;

void scatter_block(const Columns& c, std::size_t count, const TermRounder& rounded, Cells& cells) {
    for (std::size_t i = 0; i < count; ++i) {
        if (c.counts[i] == 0) continue;
        double* corner = cells.data() + c.cell[i];
        const double x1 = c.fx[i];
        const double y1 = c.fy[i];
        const double z1 = c.fz[i];
        const double x0 = 1.0 - x1;
        const double y0 = 1.0 - y1;
        const double z0 = 1.0 - z1;
        const auto add_pair = [&](int offset, double weight) {
            corner[offset] += rounded(weight * z0);
            corner[offset + 1] += rounded(weight * z1);
        };
        add_pair(0, x0 * y0);
        add_pair(kPadded, x0 * y1);
        add_pair(kPadded * kPadded, x1 * y0);
        add_pair(kPadded * kPadded + kPadded, x1 * y1);
    }
}

// Sum of x^3 and of |x|^3 along an axis, the same for any order of the points.
std::pair<double, double> third_moment(const PointCloud& cloud, const Vec3d& centroid,
                                       const Vec3d& axis) {
    const double radius = largest_distance(cloud.points, centroid);
    const TermRounder rounded(cloud.size(), radius * radius * radius);
    double sum = 0.0;
    double magnitude = 0.0;
    for (const Vec3f& point : cloud.points) {
        const double along = (point.x() - centroid.x()) * axis.x() +
                             (point.y() - centroid.y()) * axis.y() +
                             (point.z() - centroid.z()) * axis.z();
        const double cube = rounded(along * along * along);
        sum += cube;
        magnitude += std::abs(cube);
    }
    return {sum, magnitude};
}

}  // namespace

GasdFrame gasd_frame(const PointCloud& cloud, const GasdSettings& settings) {
    require_points(cloud, "gasd");
    GasdFrame frame;
    frame.centroid = exact_centroid(cloud.points);
    const Mat3d scatter = exact_scatter(cloud.points, frame.centroid);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
    Vec3d z = solver.eigenvectors().col(0);
    if (z.dot(cloud.viewpoint.cast<double>() - frame.centroid) < 0.0) z = -z;
    Vec3d x = solver.eigenvectors().col(2);
    if (settings.x_sign == GasdSettings::AxisSign::pcl) x = pcl_x_axis(solver);
    const auto [sum, magnitude] = third_moment(cloud, frame.centroid, x);
    frame.x_skewness = magnitude > 0.0 ? sum / magnitude : 0.0;
    if (settings.x_sign == GasdSettings::AxisSign::third_moment && sum < 0.0) {
        x = -x;
        frame.x_skewness = -frame.x_skewness;
    }
    frame.R_aligned_cloud.row(0) = x;
    frame.R_aligned_cloud.row(1) = z.cross(x);
    frame.R_aligned_cloud.row(2) = z;
    return frame;
}

Pose gasd_pose(const GasdFrame& frame) {
    Pose T_aligned_cloud = Pose::Identity();
    T_aligned_cloud.linear() = frame.R_aligned_cloud;
    T_aligned_cloud.translation() = -(frame.R_aligned_cloud * frame.centroid);
    return T_aligned_cloud;
}

std::vector<float> describe_gasd(const PointCloud& cloud, const GasdSettings& settings) {
    return describe_gasd(cloud, gasd_frame(cloud, settings), settings);
}

std::vector<float> describe_gasd(const PointCloud& cloud, const GasdFrame& frame,
                                 const GasdSettings& settings) {
    require_points(cloud, "gasd");
    std::vector<float> row(kGasdLength, 0.0F);
    const AlignedPoints aligned = align(cloud, frame);
    const Scale scale{aligned.farthest, aligned.largest, settings.outer_half_only};
    if (!(scale.farthest > 0.0F) || cloud.size() < 2) return row;
    const TermRounder rounded(cloud.size(), 1.0);
    Cells cells{};
    Columns columns;
    for (std::size_t first = 0; first < cloud.size(); first += kBlock) {
        const std::size_t count = std::min(kBlock, cloud.size() - first);
        for (std::size_t i = 0; i < count; ++i) {
            columns.x[i] = aligned.points[first + i].x();
            columns.y[i] = aligned.points[first + i].y();
            columns.z[i] = aligned.points[first + i].z();
        }
        place_block(scale, columns, count);
        scatter_block(columns, count, rounded, cells);
    }
    const double share = 100.0 / static_cast<double>(cloud.size() - 1);
    std::size_t out = 0;
    for (int x = 1; x <= kGrid; ++x) {
        for (int y = 1; y <= kGrid; ++y) {
            for (int z = 1; z <= kGrid; ++z) {
                const auto cell = static_cast<std::size_t>((x * kPadded + y) * kPadded + z);
                row[out++] = static_cast<float>(cells[cell] * share);
            }
        }
    }
    return row;
}

}  // namespace ostraka
