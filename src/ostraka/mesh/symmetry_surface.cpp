// SPDX-License-Identifier: Apache-2.0
// Samples are thinned by dart throwing: Cook. Stochastic Sampling in Computer Graphics. 1986.
// Distances are measured along the mean of both normals, which is exact on planes and spheres
// however far apart the samples are: Rusinkiewicz. A Symmetric Objective Function for ICP. 2019.
#include "ostraka/mesh/symmetry_surface.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {
namespace {

constexpr float kSameSide = 0.5F;      // cosine between normals that face the same way
constexpr double kMinSpacing = 0.004;  // of the diameter; bounds the number of cells
constexpr double kPacking = 0.7;       // samples times spacing squared, over the area
constexpr int kRefinements = 12;       // iterations at most
constexpr double kHeld = 1e-4;         // of the largest eigenvalue: less holds nothing
constexpr double kConverged = 1e-5;    // diameters, radians

// Cells of a box; lists of the points in each.
class CellLists {
  public:
    CellLists(const Vec3f& low, const Vec3f& high, float cell) : low_(low), cell_(cell) {
        for (int axis = 0; axis < 3; ++axis) {
            cells_[axis] = static_cast<int>((high[axis] - low[axis]) / cell) + 3;
        }
        first_.assign(static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2], kNoIndex);
    }
    std::array<int, 3> cell_of(const Vec3f& point) const {
        std::array<int, 3> at{};
        for (int axis = 0; axis < 3; ++axis) {
            at[axis] = static_cast<int>((point[axis] - low_[axis]) / cell_) + 1;
        }
        return at;
    }
    std::uint32_t& first(int x, int y, int z) {
        return first_[(static_cast<std::size_t>(z) * cells_[1] + y) * cells_[0] + x];
    }

  private:
    Vec3f low_;
    float cell_;
    std::array<int, 3> cells_{};
    std::vector<std::uint32_t> first_;
};

void bounds(std::span<const Vec3f> points, Vec3f& low, Vec3f& high) {
    low = high = points[0];
    for (const Vec3f& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
}

// Indices of points of which no two that face the same way are closer than `spacing`.
std::vector<std::uint32_t> throw_darts(std::span<const Vec3f> points,
                                       std::span<const Vec3f> normals, float spacing) {
    Vec3f low;
    Vec3f high;
    bounds(points, low, high);
    CellLists lists(low, high, spacing);
    std::vector<std::uint32_t> kept;
    std::vector<std::uint32_t> next;
    const auto is_free = [&](std::uint32_t i, const std::array<int, 3>& at) {
        for (int dz = -1; dz <= 1; ++dz) {
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    std::uint32_t k = lists.first(at[0] + dx, at[1] + dy, at[2] + dz);
                    for (; k != kNoIndex; k = next[k]) {
                        if ((points[kept[k]] - points[i]).squaredNorm() < spacing * spacing &&
                            normals[kept[k]].dot(normals[i]) > kSameSide) {
                            return false;
                        }
                    }
                }
            }
        }
        return true;
    };
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const std::array<int, 3> at = lists.cell_of(points[i]);
        if (!is_free(i, at)) continue;
        std::uint32_t& first = lists.first(at[0], at[1], at[2]);
        next.push_back(first);
        first = static_cast<std::uint32_t>(kept.size());
        kept.push_back(i);
    }
    return kept;
}

}  // namespace

SymmetrySurface::SymmetrySurface(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                                 double diameter, double tolerance, int samples, double spacing)
    : spacing_(std::max(spacing, kMinSpacing)), tolerance_(tolerance) {
    thin(points, normals, 1.0 / diameter, samples);
    origin_ = centroid(points_);
    for (Vec3f& point : points_) {
        point = Vec3d((point.cast<double>() - origin_) / diameter).cast<float>();
    }
    sort_into_cells();
}

// Sets points_ (not yet in the surface's own frame), normals_, spacing_ and covering_.
void SymmetrySurface::thin(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                           double scale, int samples) {
    // A quarter of the points given, so that hardly a gap between samples is left that a point
    // would have filled.
    const double wanted = std::min(double(samples), 0.25 * double(points.size()));
    std::vector<std::uint32_t> kept;
    for (int attempt = 0; attempt < 3; ++attempt) {
        kept = throw_darts(points, normals, static_cast<float>(spacing_ / scale));
        const double excess = static_cast<double>(kept.size()) / wanted;
        if (excess < 1.3 && (excess > 0.75 || spacing_ <= kMinSpacing)) break;
        if (attempt < 2) spacing_ = std::max(kMinSpacing, spacing_ * std::sqrt(excess));
    }
    const double share = static_cast<double>(kept.size()) / static_cast<double>(points.size());
    covering_ = spacing_ * (1.0 + std::sqrt(kPacking * share));
    // Cells, grids and triangles give points an order; samples must have none.
    std::uint64_t state = 1;
    for (std::size_t i = kept.size(); i > 1; --i) {
        state = state * 6364136223846793005ULL + 1442695040888963407ULL;
        std::swap(kept[i - 1], kept[static_cast<std::size_t>((state >> 33U) % i)]);
    }
    for (const std::uint32_t i : kept) {
        points_.push_back(points[i]);
        normals_.push_back(normals[i]);
    }
}

void SymmetrySurface::sort_into_cells() {
    Vec3f high;
    bounds(points_, corner_, high);
    cell_ = static_cast<float>(covering_ + tolerance_ + kLooseness);
    corner_ -= Vec3f::Constant(cell_);
    for (int axis = 0; axis < 3; ++axis) {
        cells_[axis] = static_cast<int>((high[axis] - corner_[axis]) / cell_) + 2;
    }
    const auto key = [&](const Vec3f& point) {
        const auto x = static_cast<std::size_t>((point.x() - corner_.x()) / cell_);
        const auto y = static_cast<std::size_t>((point.y() - corner_.y()) / cell_);
        const auto z = static_cast<std::size_t>((point.z() - corner_.z()) / cell_);
        return (z * cells_[1] + y) * cells_[0] + x;
    };
    starts_.assign(static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2] + 1, 0);
    for (const Vec3f& point : points_) ++starts_[key(point) + 1];
    for (std::size_t c = 1; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
    std::vector<std::uint32_t> at(starts_.begin(), starts_.end() - 1);
    sorted_.resize(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const Vec3f& p = points_[i];
        const Vec3f& n = normals_[i];
        sorted_[at[key(p)]++] = {p.x(), p.y(), p.z(), n.x(), n.y(), n.z()};
    }
}

// Visits all samples closer than the square root of `bound`, which is at most a cell and which
// visit() may lower, and others, until visit() returns true.
template <class Visit>
void SymmetrySurface::for_neighbors(const Vec3f& point, const float& bound,
                                    const Visit& visit) const {
    constexpr std::array<int, 3> kNearFirst = {0, -1, 1};
    std::array<int, 3> at{};
    Vec3f within;  // the cell at `at`, 0 to 1
    for (int axis = 0; axis < 3; ++axis) {
        const float place = (point[axis] - corner_[axis]) / cell_;
        at[axis] = static_cast<int>(std::floor(place));
        within[axis] = place - static_cast<float>(at[axis]);
        if (at[axis] < -1 || at[axis] > cells_[axis]) return;
    }
    // How far the next cell's nearest side is.
    const auto gap = [&](int axis, int step) {
        if (step == 0) return 0.0F;
        return cell_ * (step < 0 ? within[axis] : 1.0F - within[axis]);
    };
    const int low = std::max(at[0] - 1, 0);
    const int high = std::min(at[0] + 1, cells_[0] - 1);
    for (const int dz : kNearFirst) {
        const int z = at[2] + dz;
        const float from_z = gap(2, dz) * gap(2, dz);
        if (z < 0 || z >= cells_[2] || from_z > bound) continue;
        for (const int dy : kNearFirst) {
            const int y = at[1] + dy;
            if (y < 0 || y >= cells_[1] || from_z + gap(1, dy) * gap(1, dy) > bound) continue;
            const std::size_t row = (static_cast<std::size_t>(z) * cells_[1] + y) * cells_[0];
            const std::uint32_t stop = starts_[row + high + 1];
            for (std::uint32_t i = starts_[row + low]; i < stop; ++i) {
                if (visit(sorted_[i])) return;
            }
        }
    }
}

bool SymmetrySurface::fits(const Vec3f& point, const Vec3f& normal, float tolerance) const {
    const float reach = static_cast<float>(covering_) + tolerance;
    const float bound = reach * reach;
    bool found = false;
    for_neighbors(point, bound, [&](const Sample& s) {
        const float dx = point.x() - s.x;
        const float dy = point.y() - s.y;
        const float dz = point.z() - s.z;
        if (dx * dx + dy * dy + dz * dz > bound) return false;
        const float cosine = normal.x() * s.nx + normal.y() * s.ny + normal.z() * s.nz;
        if (cosine < -kSameSide) return false;
        const float from_sample = dx * s.nx + dy * s.ny + dz * s.nz;
        if (cosine < kSameSide) {
            // The wall of a shallow step, say: near the surface, if not like it.
            found = std::abs(from_sample) <= tolerance;
            return found;
        }
        const float along = from_sample + dx * normal.x() + dy * normal.y() + dz * normal.z();
        // The sum of two unit vectors has length sqrt(2 + 2 cosine).
        found = along * along <= tolerance * tolerance * (2.0F + 2.0F * cosine);
        return found;
    });
    return found;
}

const SymmetrySurface::Sample* SymmetrySurface::closest(const Vec3f& point,
                                                        const Vec3f& normal) const {
    const Sample* best = nullptr;
    float least = cell_ * cell_;
    for_neighbors(point, least, [&](const Sample& s) {
        const float dx = point.x() - s.x;
        const float dy = point.y() - s.y;
        const float dz = point.z() - s.z;
        const float squared = dx * dx + dy * dy + dz * dz;
        if (squared < least &&
            normal.x() * s.nx + normal.y() * s.ny + normal.z() * s.nz > kSameSide) {
            least = squared;
            best = &s;
        }
        return false;
    });
    return best;
}

bool SymmetrySurface::lies_on_itself(const Pose& motion, std::size_t count, double tolerance,
                                     double outliers) const {
    count = std::min(count, size());
    const auto allowed = static_cast<std::size_t>(outliers * static_cast<double>(count));
    const Mat3f turn = motion.linear().cast<float>();
    const Vec3f shift = motion.translation().cast<float>();
    std::size_t missed = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (fits(turn * points_[i] + shift, turn * normals_[i], static_cast<float>(tolerance))) {
            continue;
        }
        if (++missed > allowed) return false;
    }
    return true;
}

Pose SymmetrySurface::refined(const Pose& guess, std::size_t count) const {
    using Vector6 = Eigen::Matrix<double, 6, 1>;
    using Matrix6 = Eigen::Matrix<double, 6, 6>;
    Pose motion = guess;
    for (int iteration = 0; iteration < kRefinements; ++iteration) {
        Matrix6 normal_matrix = Matrix6::Zero();
        Vector6 right = Vector6::Zero();
        for (std::size_t i = 0; i < std::min(count, size()); ++i) {
            const Vec3d point = motion * points_[i].cast<double>();
            const Vec3d normal = motion.linear() * normals_[i].cast<double>();
            const Sample* const s = closest(point.cast<float>(), normal.cast<float>());
            if (s == nullptr) continue;
            const Vec3d mean = (normal + Vec3d(s->nx, s->ny, s->nz)).normalized();
            Vector6 row;
            row << point.cross(mean), mean;
            normal_matrix.selfadjointView<Eigen::Lower>().rankUpdate(row);
            right += row * (Vec3d(s->x, s->y, s->z) - point).dot(mean);
        }
        const Eigen::SelfAdjointEigenSolver<Matrix6> solver(normal_matrix);
        Vector6 step = Vector6::Zero();
        for (int k = 0; k < 6; ++k) {
            const double value = solver.eigenvalues()[k];
            if (!(value > kHeld * solver.eigenvalues()[5])) continue;
            const Vector6 direction = solver.eigenvectors().col(k);
            step += direction * (direction.dot(right) / value);
        }
        const Vec3d turn = step.head<3>();
        Pose change = Pose::Identity();
        if (turn.norm() > 0.0) {
            change.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
        }
        change.translation() = step.tail<3>();
        motion = change * motion;
        if (step.norm() < kConverged) break;
    }
    return motion;
}

}  // namespace ostraka
