// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/keypoint_detectors.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <tuple>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/local_checks.hpp"
#include "ostraka/descriptors/surfel_grid.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kCellChunk = 16;  // cells that share scratch memory
// A third eigenvalue below this share of the first is rounding of float coordinates.
constexpr double kFlat = 1e-10;

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Double4 = double __attribute__((vector_size(32)));
constexpr std::size_t kLanes = 4;

struct Scatter {
    std::array<double, 6> sums;  // xx, xy, xz, yy, yz, zz
    std::int64_t neighbors = 0;  // the point itself included
};

// The scatter about `center` of the points closer than the radius. The order of the points is
// fixed, so the sums are repeatable.
OSTRAKA_VECTOR_CLONES
void add_scatter(const SurfelColumns& around, const float* weights, const float* center,
                 float squared_radius, Scatter& scatter) {
    Double4 xx = {};
    Double4 xy = {};
    Double4 xz = {};
    Double4 yy = {};
    Double4 yz = {};
    Double4 zz = {};
    Int4 inside_count = {};
    for (std::size_t i = 0; i < around.count; i += kLanes) {
        Float4 x;
        Float4 y;
        Float4 z;
        Float4 w;
        std::memcpy(&x, around.x.data() + i, sizeof(x));
        std::memcpy(&y, around.y.data() + i, sizeof(y));
        std::memcpy(&z, around.z.data() + i, sizeof(z));
        std::memcpy(&w, weights + i, sizeof(w));
        const Float4 fx = x - center[0];
        const Float4 fy = y - center[1];
        const Float4 fz = z - center[2];
        const Int4 inside = fx * fx + fy * fy + fz * fz < squared_radius;
        inside_count -= inside;
        // What is outside weighs nothing. Differences are exact.
        const Double4 weight = __builtin_convertvector(inside ? w : Float4{}, Double4);
        const Double4 dx = __builtin_convertvector(x, Double4) - double{center[0]};
        const Double4 dy = __builtin_convertvector(y, Double4) - double{center[1]};
        const Double4 dz = __builtin_convertvector(z, Double4) - double{center[2]};
        const Double4 wx = weight * dx;
        const Double4 wy = weight * dy;
        xx += wx * dx;
        xy += wx * dy;
        xz += wx * dz;
        yy += wy * dy;
        yz += wy * dz;
        zz += weight * dz * dz;
    }
    scatter.sums.fill(0.0);
    scatter.neighbors = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::array<double, 6> part = {xx[lane], xy[lane], xz[lane],
                                            yy[lane], yz[lane], zz[lane]};
        for (std::size_t k = 0; k < part.size(); ++k) scatter.sums[k] += part[k];
        scatter.neighbors += inside_count[lane];
    }
}

// Calls body(slot, around) for each point of the grid; `around` holds all points within the radius
// and some more. Points of a cell share it.
void for_each_surfel(const SurfelGrid& grid,
                     const std::function<void(std::size_t, const SurfelColumns&)>& body) {
    parallel_for((grid.cell_count() + kCellChunk - 1) / kCellChunk, [&](std::size_t chunk) {
        SurfelColumns around;
        const std::size_t end = std::min(grid.cell_count(), (chunk + 1) * kCellChunk);
        for (std::size_t cell = chunk * kCellChunk; cell < end; ++cell) {
            const std::size_t last = grid.cell_begin(cell + 1);
            grid.gather(grid.cell_begin(cell), last, around);
            for (std::size_t s = grid.cell_begin(cell); s < last; ++s) body(s, around);
        }
    });
}

std::array<float, 3> position(const SurfelGrid& grid, std::size_t slot) {
    const SurfelColumns& columns = grid.columns();
    return {columns.x[slot], columns.y[slot], columns.z[slot]};
}

float squared_distance(const SurfelColumns& points, std::size_t i, const std::array<float, 3>& p) {
    const float dx = points.x[i] - p[0];
    const float dy = points.y[i] - p[1];
    const float dz = points.z[i] - p[2];
    return dx * dx + dy * dy + dz * dz;
}

// 1 / number of points within the radius of each point, in the grid's order.
std::vector<float> density_weights(const SurfelGrid& grid, float radius) {
    std::vector<float> weights(grid.size());
    for_each_surfel(grid, [&](std::size_t slot, const SurfelColumns& around) {
        const std::array<float, 3> center = position(grid, slot);
        int neighbors = 0;
        for (std::size_t i = 0; i < around.count; ++i) {
            if (squared_distance(around, i, center) < radius * radius) ++neighbors;
        }
        weights[slot] = 1.0F / static_cast<float>(std::max(neighbors, 1));
    });
    return weights;
}

// The third eigenvalue where the surface is distinctive, else 0.
double saliency_of(const Scatter& scatter, const IssSettings& settings) {
    if (scatter.neighbors < settings.min_neighbors) return 0.0;
    const auto& s = scatter.sums;
    Eigen::Matrix3d matrix;
    matrix << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix, Eigen::EigenvaluesOnly);
    const double first = solver.eigenvalues()[2];
    const double second = solver.eigenvalues()[1];
    const double third = solver.eigenvalues()[0];
    const bool distinctive = third > kFlat * first && second < settings.gamma_21 * first &&
                             third < settings.gamma_32 * second;
    return distinctive && std::isfinite(first) ? third : 0.0;
}

// In the order of the points as given.
std::vector<double> saliencies(std::span<const Vec3f> points, const IssSettings& settings) {
    const float radius = settings.salient_radius;
    const SurfelGrid grid(points, {}, radius);
    std::vector<float> density(grid.size(), 1.0F);
    if (settings.paper_weights) density = density_weights(grid, radius);
    std::vector<double> result(points.size(), 0.0);
    for_each_surfel(grid, [&](std::size_t slot, const SurfelColumns& around) {
        thread_local std::vector<float> weights;
        weights.resize(around.count + kVectorLanes);
        double total = 0.0;
        const std::array<float, 3> center = position(grid, slot);
        for (std::size_t i = 0; i < around.count; ++i) {
            weights[i] = density[around.slot[i]];
            if (settings.paper_weights && squared_distance(around, i, center) < radius * radius) {
                total += weights[i];
            }
        }
        Scatter scatter;
        add_scatter(around, weights.data(), center.data(), radius * radius, scatter);
        if (settings.paper_weights) {
            for (double& sum : scatter.sums) sum /= total;
        }
        result[grid.original()[slot]] = saliency_of(scatter, settings);
    });
    return result;
}

void require_finite(std::span<const Vec3f> points, std::string_view detector) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (usable(points[i])) continue;
        throw InvalidInput(fmt::format("{}: point {} is not finite or too far", detector, i));
    }
}

}  // namespace

std::vector<std::uint32_t> detect_iss(std::span<const Vec3f> points, const IssSettings& settings) {
    require_finite(points, "iss");
    require_radius(settings.salient_radius, "iss");
    require_radius(settings.non_max_radius, "iss");
    if (!(settings.gamma_21 > 0.0) || !(settings.gamma_32 > 0.0) || settings.min_neighbors < 1) {
        throw InvalidInput("iss: gamma_21, gamma_32 and min_neighbors must be positive");
    }
    const std::vector<double> saliency = saliencies(points, settings);
    const float radius = settings.non_max_radius;
    const SurfelGrid grid(points, {}, radius);
    std::vector<char> kept(points.size(), 0);
    for_each_surfel(grid, [&](std::size_t slot, const SurfelColumns& around) {
        const std::uint32_t index = grid.original()[slot];
        if (!(saliency[index] > 0.0)) return;
        const std::array<float, 3> center = position(grid, slot);
        int neighbors = 0;
        bool largest = true;
        for (std::size_t i = 0; i < around.count && largest; ++i) {
            if (!(squared_distance(around, i, center) < radius * radius)) continue;
            ++neighbors;
            largest = saliency[grid.original()[around.slot[i]]] <= saliency[index];
        }
        kept[index] = largest && neighbors >= settings.min_neighbors ? 1 : 0;
    });
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (kept[i] != 0) result.push_back(i);
    }
    return result;
}

std::vector<std::uint32_t> detect_uniform(std::span<const Vec3f> points,
                                          const UniformSettings& settings) {
    require_finite(points, "uniform");
    require_radius(settings.spacing, "uniform");
    constexpr float kMostCells = 1073741824.0F;
    struct Candidate {
        std::array<float, 3> cell;
        float squared_distance;  // to the cell's center
        std::uint32_t index;
    };
    std::vector<Candidate> candidates(points.size());
    const float inverse = 1.0F / settings.spacing;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const Vec3f cell = (points[i] * inverse).array().floor();
        if (!(cell.cwiseAbs().maxCoeff() <= kMostCells)) {
            throw InvalidInput(
                fmt::format("uniform: spacing {:g} is too small for a point at {:g} {:g} {:g}",
                            settings.spacing, points[i].x(), points[i].y(), points[i].z()));
        }
        const Vec3f center = (cell + Vec3f::Constant(0.5F)) * settings.spacing;
        candidates[i] = {{cell.x(), cell.y(), cell.z()}, (points[i] - center).squaredNorm(), i};
    }
    const auto key = [&](const Candidate& c) {
        const Vec3f& p = points[c.index];
        return std::tuple(c.cell, c.squared_distance, p.x(), p.y(), p.z(), c.index);
    };
    std::sort(candidates.begin(), candidates.end(),
              [&](const Candidate& a, const Candidate& b) { return key(a) < key(b); });
    std::vector<std::uint32_t> result;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (i > 0 && candidates[i].cell == candidates[i - 1].cell) continue;
        result.push_back(candidates[i].index);
    }
    std::sort(result.begin(), result.end());
    return result;
}

}  // namespace ostraka
