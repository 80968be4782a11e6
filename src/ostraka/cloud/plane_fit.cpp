// SPDX-License-Identifier: Apache-2.0
// The least eigenvalue of a 3 x 3 matrix of trace 1, positive semidefinite: its characteristic
// polynomial is concave and rising up to that root, so Newton's steps from 0 reach it from below
// without overshooting. The eigenvector is the longest cross product of two rows. Branch-free, four
// matrices at a time; those where that is inaccurate go to Eigen.
#include "ostraka/cloud/plane_fit.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr double kUnsureRatio = 1e-6;
constexpr int kNewtonSteps = 8;
// Of the two smaller eigenvalues, with trace 1: nearer ones make the steps slow and the rows short.
constexpr double kLeastGap = 1e-3;
constexpr double kLastStep = 1e-12;

const Vec3f kNone = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());

struct Solutions {
    alignas(32) std::array<double, MomentBatch::kCapacity> x, y, z;  // unit
    alignas(32) std::array<double, MomentBatch::kCapacity> sure;     // 1: accurate, 0: not
};

OSTRAKA_VECTOR_CLONES
void solve(const MomentBatch& batch, Solutions& out) {
    const double inverse = 1.0 / batch.neighbors;
    const auto& s = batch.sums;
    const std::size_t lanes = (batch.count + 3) / 4 * 4;
    for (std::size_t i = 0; i < lanes; ++i) {
        const double mx = s[0][i] * inverse;
        const double my = s[1][i] * inverse;
        const double mz = s[2][i] * inverse;
        double xx = s[3][i] * inverse - mx * mx;
        double xy = s[4][i] * inverse - mx * my;
        double xz = s[5][i] * inverse - mx * mz;
        double yy = s[6][i] * inverse - my * my;
        double yz = s[7][i] * inverse - my * mz;
        double zz = s[8][i] * inverse - mz * mz;
        const double trace = xx + yy + zz;
        const double scale = 1.0 / (trace > 0.0 ? trace : 1.0);
        xx *= scale;
        xy *= scale;
        xz *= scale;
        yy *= scale;
        yz *= scale;
        zz *= scale;
        // lambda^3 - lambda^2 + minors lambda - determinant = 0
        const double m_xx = yy * zz - yz * yz;
        const double m_xy = xz * yz - xy * zz;
        const double m_xz = xy * yz - xz * yy;
        const double minors = m_xx + (xx * zz - xz * xz) + (xx * yy - xy * xy);
        const double determinant = xx * m_xx + xy * m_xy + xz * m_xz;
        double root = 0.0;
        double step = 0.0;
        for (int n = 0; n < kNewtonSteps; ++n) {
            const double value = ((root - 1.0) * root + minors) * root - determinant;
            const double slope = (3.0 * root - 2.0) * root + minors;
            step = value / (slope > 1e-9 ? slope : 1.0);
            root -= step;
        }
        const double sum = 1.0 - root;  // of the two others, and their product
        const double product = minors - root * sum;
        const double square = sum * sum - 4.0 * product;
        const double largest = 0.5 * (sum + std::sqrt(square > 0.0 ? square : 0.0));
        const double gap = (sum - largest) - root;
        const double ax = xx - root;
        const double ay = yy - root;
        const double az = zz - root;
        // Cross products of rows 1 and 2, 2 and 0, 0 and 1: the columns of the adjugate.
        const double p = ay * az - yz * yz;
        const double q = xz * yz - xy * az;
        const double r = xy * yz - xz * ay;
        const double t = ax * az - xz * xz;
        const double u = xy * xz - ax * yz;
        const double v = ax * ay - xy * xy;
        // All three are multiples of n n^T: the longest is that of the largest diagonal element.
        const bool first = (p >= t) & (p >= v);
        const bool second = t >= v;
        const double x = first ? p : (second ? q : r);
        const double y = first ? q : (second ? t : u);
        const double z = first ? r : (second ? u : v);
        const double length = x * x + y * y + z * z;
        const double unit = 1.0 / std::sqrt(length > 0.0 ? length : 1.0);
        out.x[i] = x * unit;
        out.y[i] = y * unit;
        out.z[i] = z * unit;
        const bool sure = (trace > 0.0) & (gap > kLeastGap) & (std::fabs(step) < kLastStep);
        out.sure[i] = sure ? 1.0 : 0.0;
    }
}

}  // namespace

Vec3f fit_normal(const Moments& moments, double line_ratio) {
    if (moments.count < 3.0) return kNone;
    const Vec3d mean = moments.first / moments.count;
    const Mat3d scatter = moments.second / moments.count - mean * mean.transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(scatter);
    // The closed form loses half of the digits where two values are nearly equal, as on a line.
    if (solver.eigenvalues()[1] < kUnsureRatio * solver.eigenvalues()[2]) solver.compute(scatter);
    const Eigen::Vector3d values = solver.eigenvalues();
    if (!(values[2] > 0.0) || values[1] < line_ratio * values[2]) return kNone;
    return Vec3d(solver.eigenvectors().col(0)).normalized().cast<float>();
}

void fit_normals(const MomentBatch& batch, std::array<Vec3f, MomentBatch::kCapacity>& normals) {
    Solutions solutions;
    solve(batch, solutions);
    const auto& s = batch.sums;
    for (std::size_t i = 0; i < batch.count; ++i) {
        if (batch.neighbors >= 3.0 && solutions.sure[i] > 0.0) {
            normals[i] = Vec3d(solutions.x[i], solutions.y[i], solutions.z[i]).cast<float>();
            continue;
        }
        Moments moments;
        moments.first = {s[0][i], s[1][i], s[2][i]};
        moments.second << s[3][i], s[4][i], s[5][i], s[4][i], s[6][i], s[7][i], s[5][i], s[7][i],
            s[8][i];
        moments.count = batch.neighbors;
        normals[i] = fit_normal(moments, kLineRatio);
    }
}

}  // namespace ostraka
