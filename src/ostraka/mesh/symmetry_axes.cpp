// SPDX-License-Identifier: Apache-2.0
// Critical directions of moments: Martinet, Soler, Holzschuch, Sillion. Accurate Detection of
// Symmetries in 3D Shapes. ACM TOG 25(2), 2006, section 4. There, moments up to a high order are
// expanded in spherical harmonics; here, a few are polynomials, and all of them must be critical.
#include "ostraka/mesh/symmetry_axes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr int kMaxDegree = 6;
constexpr int kGrid = 24;                // directions along a side of each face of a half cube
constexpr double kNoise = 0.004;         // moments that vary less say nothing: samples are uneven
constexpr double kNoiseOfRadii = 0.1;    // the same where few samples count
constexpr double kRound = 0.004;         // of the mean radius: what samples of a sphere may be off
constexpr double kDistinct = 0.9986;     // cosine of 3 degrees
constexpr double kNearlyCritical = 0.5;  // slope, of the mean one, that a minimum may have
constexpr std::size_t kMaxCandidates = 50;

using Powers = std::array<std::array<double, kMaxDegree + 1>, 3>;

Powers powers_of(const Vec3d& v) {
    Powers powers{};
    for (int axis = 0; axis < 3; ++axis) {
        powers[axis][0] = 1.0;
        for (int k = 1; k <= kMaxDegree; ++k) powers[axis][k] = powers[axis][k - 1] * v[axis];
    }
    return powers;
}

// The mean of weight * (u . v)^degree over vectors v, as a polynomial of u.
class Moment {
  public:
    Moment(int degree, double noise) : degree_(degree), noise_(noise) {
        for (int a = 0; a <= degree; ++a) {
            for (int b = 0; a + b <= degree; ++b) {
                terms_.push_back({a, b, degree - a - b, 0.0});
            }
        }
    }
    void add(const Powers& powers, double weight, double length) {
        for (Term& term : terms_) {
            term.factor += weight * powers[0][term.a] * powers[1][term.b] * powers[2][term.c];
        }
        total_ += weight * length;
    }
    // From sums to a mean relative to that of length^degree, with multinomial factors.
    void finish() {
        constexpr std::array<double, kMaxDegree + 1> kFactorial = {1, 1, 2, 6, 24, 120, 720};
        for (Term& term : terms_) {
            term.factor *= kFactorial[degree_] /
                           (kFactorial[term.a] * kFactorial[term.b] * kFactorial[term.c]);
            term.factor /= total_ > 0.0 ? total_ : 1.0;
        }
    }
    // The gradient on the unit sphere, over the degree.
    Vec3d slope(const Vec3d& u, const Powers& powers) const {
        Vec3d gradient = Vec3d::Zero();
        for (const Term& t : terms_) {
            const double x = powers[0][t.a];
            const double y = powers[1][t.b];
            const double z = powers[2][t.c];
            if (t.a > 0) gradient.x() += t.factor * t.a * powers[0][t.a - 1] * y * z;
            if (t.b > 0) gradient.y() += t.factor * t.b * x * powers[1][t.b - 1] * z;
            if (t.c > 0) gradient.z() += t.factor * t.c * x * y * powers[2][t.c - 1];
        }
        return (gradient - u.dot(gradient) * u) / degree_;
    }
    void set_scale(double scale) { scale_ = scale; }
    double scale() const { return scale_; }
    double noise() const { return noise_; }

  private:
    struct Term {
        int a, b, c;
        double factor;
    };
    int degree_;
    std::vector<Term> terms_;
    double total_ = 0.0;
    double noise_;
    double scale_ = 0.0;
};

// Every weight depends on what turns about the center leave as it is.
std::vector<Moment> moments_of(std::span<const Vec3f> points, std::span<const Vec3f> normals) {
    constexpr std::array<int, 4> kOfPoints = {2, 3, 4, 6};
    constexpr std::array<int, 3> kOfNormals = {2, 4, 6};
    constexpr std::array<int, 2> kOfRadii = {1, 2};  // where the surface is far from a sphere
    std::vector<Moment> moments;
    for (const int degree : kOfPoints) moments.emplace_back(degree, kNoise);
    for (const int degree : kOfNormals) moments.emplace_back(degree, kNoise);
    for (const int degree : kOfRadii) moments.emplace_back(degree, kNoiseOfRadii);
    double radius = 0.0;
    for (const Vec3f& point : points) radius += point.cast<double>().norm();
    radius /= static_cast<double>(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d point = points[i].cast<double>() / radius;
        const Powers of_point = powers_of(point);
        const Powers of_normal = powers_of(normals[i].cast<double>());
        const double length = point.norm();
        const double deviation = std::pow(std::max(0.0, std::abs(length - 1.0) - kRound), 2);
        std::size_t m = 0;
        for (const int degree : kOfPoints)
            moments[m++].add(of_point, 1.0, std::pow(length, degree));
        for ([[maybe_unused]] const int degree : kOfNormals) moments[m++].add(of_normal, 1.0, 1.0);
        for (const int degree : kOfRadii) {
            moments[m++].add(of_point, deviation, std::pow(length, degree));
        }
    }
    for (Moment& moment : moments) moment.finish();
    return moments;
}

// Sum of squared slopes, each relative to its mean over the sphere.
double unrest(const std::vector<Moment>& moments, const Vec3d& u) {
    const Powers powers = powers_of(u);
    double sum = 0.0;
    for (const Moment& moment : moments) {
        sum += moment.slope(u, powers).squaredNorm() * moment.scale();
    }
    return sum;
}

// The direction through a cell of face 0, 1 or 2 of the cube; cells -1 and kGrid lie beyond it.
Vec3d grid_direction(int face, int i, int j) {
    // Tangents give cells of equal angles.
    const double a = std::tan(kPi / 4.0 * ((2.0 * i + 1.0) / kGrid - 1.0));
    const double b = std::tan(kPi / 4.0 * ((2.0 * j + 1.0) / kGrid - 1.0));
    Vec3d direction = Vec3d::Zero();
    direction[face] = 1.0;
    direction[(face + 1) % 3] = a;
    direction[(face + 2) % 3] = b;
    return direction.normalized();
}

void set_scales(std::vector<Moment>& moments) {
    for (Moment& moment : moments) {
        double sum = 0.0;
        int count = 0;
        for (int face = 0; face < 3; ++face) {
            for (int i = 1; i < kGrid; i += 4) {
                for (int j = 1; j < kGrid; j += 4) {
                    const Vec3d u = grid_direction(face, i, j);
                    sum += moment.slope(u, powers_of(u)).squaredNorm();
                    ++count;
                }
            }
        }
        const double mean = sum / count;
        moment.set_scale(mean > moment.noise() * moment.noise() ? 1.0 / mean : 0.0);
    }
    std::erase_if(moments, [](const Moment& moment) { return moment.scale() == 0.0; });
}

struct Direction {
    Vec3d axis;
    double unrest;
};

// Goes downhill in ever smaller steps.
Direction settled(const std::vector<Moment>& moments, Direction at) {
    for (double step = 0.03; step > 5e-4; step *= 0.5) {
        const Vec3d side = at.axis.unitOrthogonal();
        const Vec3d other = at.axis.cross(side);
        Direction best = at;
        for (int k = 0; k < 6; ++k) {
            const Vec3d move = std::cos(k * kPi / 3.0) * side + std::sin(k * kPi / 3.0) * other;
            const Vec3d axis = (at.axis + step * move).normalized();
            const double value = unrest(moments, axis);
            if (value < best.unrest) best = {axis, value};
        }
        at = best;
    }
    return at;
}

std::vector<Direction> local_minima(const std::vector<Moment>& moments) {
    constexpr int kWide = kGrid + 2;
    std::vector<Direction> minima;
    std::vector<double> values(kWide * kWide);
    for (int face = 0; face < 3; ++face) {
        for (int i = 0; i < kWide; ++i) {
            for (int j = 0; j < kWide; ++j) {
                values[i * kWide + j] = unrest(moments, grid_direction(face, i - 1, j - 1));
            }
        }
        for (int i = 1; i <= kGrid; ++i) {
            for (int j = 1; j <= kGrid; ++j) {
                const double* const here = &values[i * kWide + j];
                const bool least = *here <= here[-1] && *here <= here[1] && *here <= here[-kWide] &&
                                   *here <= here[kWide] && *here <= here[-kWide - 1] &&
                                   *here <= here[-kWide + 1] && *here <= here[kWide - 1] &&
                                   *here <= here[kWide + 1];
                if (least) minima.push_back({grid_direction(face, i - 1, j - 1), *here});
            }
        }
    }
    return minima;
}

Mat3d principal_axes(std::span<const Vec3f> points) {
    Mat3d covariance = Mat3d::Zero();
    for (const Vec3f& point : points) {
        covariance += point.cast<double>() * point.cast<double>().transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    return solver.eigenvectors();
}

}  // namespace

std::vector<Vec3d> candidate_axes(std::span<const Vec3f> points, std::span<const Vec3f> normals) {
    std::vector<Vec3d> axes;
    const Mat3d principal = principal_axes(points);
    for (int k = 0; k < 3; ++k) axes.emplace_back(principal.col(k));
    std::vector<Moment> moments = moments_of(points, normals);
    set_scales(moments);
    if (moments.empty()) return axes;
    std::vector<Direction> minima = local_minima(moments);
    for (Direction& minimum : minima) minimum = settled(moments, minimum);
    std::stable_sort(minima.begin(), minima.end(),
                     [](const Direction& a, const Direction& b) { return a.unrest < b.unrest; });
    const double limit = kNearlyCritical * static_cast<double>(moments.size());
    for (const Direction& minimum : minima) {
        if (axes.size() == kMaxCandidates || minimum.unrest > limit) break;
        const bool known = std::any_of(axes.begin(), axes.end(), [&](const Vec3d& axis) {
            return std::abs(axis.dot(minimum.axis)) > kDistinct;
        });
        if (!known) axes.push_back(minimum.axis);
    }
    return axes;
}

}  // namespace ostraka
