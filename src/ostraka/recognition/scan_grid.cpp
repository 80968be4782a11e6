// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/scan_grid.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/recognition/scan_raster.hpp"

namespace ostraka {
namespace {

constexpr float kSlope = 5.7F;        // tangent of the most oblique surface that stays closed
constexpr double kPointsACell = 1.5;  // fewer leave holes, more lose detail
constexpr float kLargestCell = 48.0F;
constexpr int kHoleReach = 3;   // cells that a hole may measure
constexpr int kFitRadius = 2;   // cells around a vertex that its plane is fitted to
constexpr double kLevel = 1.0;  // pull toward a surface that faces the camera; 50 is the data's
constexpr int kHolePasses = 2;  // a hole's corners need the second

std::vector<GridVertex> project(const PointCloud& scene, const PictureCamera& camera) {
    std::vector<GridVertex> vertices(scene.size());
    parallel_for(
        scene.size(),
        [&](std::size_t i) {
            if (!scene.points[i].allFinite()) return;
            const Vec3d point = camera.T_camera_scene * scene.points[i].cast<double>();
            if (!(point.z() > 0.0)) return;
            const Vec2d pixel = camera.pinhole.project(point);
            vertices[i] = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                           static_cast<float>(point.z()), 0.0F};
        },
        4096);
    return vertices;
}

struct CellSize {
    int columns = 0;
    int rows = 0;
    float cell = 1.0F;

    CellSize(const PinholeCamera& camera, float side) : cell(side) {
        columns = static_cast<int>(static_cast<float>(camera.width) / side) + 1;
        rows = static_cast<int>(static_cast<float>(camera.height) / side) + 1;
    }
    // kNoIndex outside the picture.
    std::size_t cell_of(const GridVertex& vertex) const {
        const float column = vertex.u / cell;
        const float row = vertex.v / cell;
        if (!vertex.valid() || !(column >= 0.0F) || !(row >= 0.0F)) return kNoIndex;
        if (column >= static_cast<float>(columns) || row >= static_cast<float>(rows))
            return kNoIndex;
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(column);
    }
    std::size_t count() const {
        return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    }
};

// The smallest cells that hold kPointsACell points on average.
float choose_cell(const std::vector<GridVertex>& points, const PinholeCamera& camera) {
    for (float cell = 1.0F;; cell *= 1.2F) {
        const CellSize size(camera, cell);
        std::vector<bool> used(size.count());
        std::size_t inside = 0;
        std::size_t occupied = 0;
        for (const GridVertex& point : points) {
            const std::size_t c = size.cell_of(point);
            if (c == kNoIndex) continue;
            ++inside;
            if (!used[c]) ++occupied;
            used[c] = true;
        }
        const double mean = static_cast<double>(inside) / std::max<double>(1.0, double(occupied));
        if (mean >= kPointsACell || cell * 1.2F > kLargestCell) return cell;
    }
}

// The mean of the points in each cell that are on its nearest surface.
ScanGrid average_cells(const std::vector<GridVertex>& points, const PinholeCamera& camera) {
    const CellSize size(camera, choose_cell(points, camera));
    ScanGrid grid{size.columns, size.rows, size.cell, std::vector<GridVertex>(size.count())};
    std::vector<float> nearest(size.count(), 0.0F);
    for (const GridVertex& point : points) {
        const std::size_t c = size.cell_of(point);
        if (c == kNoIndex) continue;
        if (nearest[c] == 0.0F || point.depth < nearest[c]) nearest[c] = point.depth;
    }
    std::vector<std::uint32_t> counts(size.count(), 0);
    const float thickness = kSlope * size.cell / static_cast<float>(camera.fx);
    for (const GridVertex& point : points) {
        const std::size_t c = size.cell_of(point);
        if (c == kNoIndex || point.depth > nearest[c] * (1.0F + thickness)) continue;
        GridVertex& sum = grid.vertices[c];
        sum = {sum.u + point.u, sum.v + point.v, sum.depth + point.depth, 0.0F};
        ++counts[c];
    }
    for (std::size_t c = 0; c < size.count(); ++c) {
        if (counts[c] == 0) continue;
        const float share = 1.0F / static_cast<float>(counts[c]);
        GridVertex& mean = grid.vertices[c];
        mean = {mean.u * share, mean.v * share, mean.depth * share, 0.0F};
    }
    return grid;
}

// Between two vertices on opposite sides of a hole, where one surface spans it or it is small.
GridVertex bridge(const ScanGrid& grid, int column, int row, int dx, int dy, double focal) {
    const auto look = [&](int direction) -> std::pair<GridVertex, int> {
        for (int step = 1; step <= kHoleReach; ++step) {
            const int x = column + direction * step * dx;
            const int y = row + direction * step * dy;
            if (x < 0 || y < 0 || x >= grid.columns || y >= grid.rows) break;
            if (grid.at(x, y).valid()) return {grid.at(x, y), step};
        }
        return {};
    };
    const auto [a, a_steps] = look(-1);
    if (!a.valid()) return {};
    const auto [b, b_steps] = look(1);
    if (!b.valid() || a_steps + b_steps > kHoleReach + 1) return {};
    if (!joined(a, b, focal)) {
        // What is lost on a contour belongs to what lies behind.
        if (a_steps + b_steps > kHoleReach) return {};
        const float behind = std::max(a.depth, b.depth);
        return {0.5F * (a.u + b.u), 0.5F * (a.v + b.v), behind, 0.0F};
    }
    const float t = static_cast<float>(a_steps) / static_cast<float>(a_steps + b_steps);
    return {a.u + t * (b.u - a.u), a.v + t * (b.v - a.v), a.depth + t * (b.depth - a.depth), 0.0F};
}

void fill_holes(ScanGrid& grid, double focal) {
    std::vector<GridVertex> filled = grid.vertices;
    const auto columns = static_cast<std::size_t>(grid.columns);
    parallel_for(static_cast<std::size_t>(grid.rows), [&](std::size_t row) {
        constexpr std::array<std::array<int, 2>, 4> kWays = {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
        for (std::size_t column = 0; column < columns; ++column) {
            GridVertex& vertex = filled[row * columns + column];
            for (std::size_t way = 0; way < kWays.size() && !vertex.valid(); ++way) {
                vertex = bridge(grid, static_cast<int>(column), static_cast<int>(row),
                                kWays[way][0], kWays[way][1], focal);
            }
        }
    });
    grid.vertices = std::move(filled);
}

// Median of the distances between neighbors in a row.
float typical_spacing(const ScanGrid& grid) {
    std::vector<float> steps;
    for (std::size_t i = 1; i < grid.vertices.size(); i += 7) {
        const GridVertex& a = grid.vertices[i - 1];
        const GridVertex& b = grid.vertices[i];
        if (!a.valid() || !b.valid()) continue;
        steps.push_back(std::hypot(b.u - a.u, b.v - a.v));
    }
    if (steps.empty()) return 1.0F;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return std::clamp(*middle, 1.0F, kLargestCell);
}

// The plane 1 = n . x, that is 1/z = n . ray, which the neighbors on the same surface fit best.
Vec3d fitted_normal(const ScanGrid& grid, const PinholeCamera& camera, int column, int row) {
    const GridVertex& center = grid.at(column, row);
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (int y = std::max(0, row - kFitRadius); y <= std::min(grid.rows - 1, row + kFitRadius);
         ++y) {
        for (int x = std::max(0, column - kFitRadius);
             x <= std::min(grid.columns - 1, column + kFitRadius); ++x) {
            const GridVertex& vertex = grid.at(x, y);
            if (!vertex.valid() || !joined(center, vertex, camera.fx)) continue;
            // Relative to the center, so that the system is well scaled.
            const Eigen::Vector3d place((vertex.u - center.u) / grid.spacing,
                                        (vertex.v - center.v) / grid.spacing, 1.0);
            A += place * place.transpose();
            b += place * (double{center.depth} / double{vertex.depth} - 1.0);
        }
    }
    // Few neighbors, as on an edge, say little about the tilt.
    A.diagonal() += Eigen::Vector3d(kLevel, kLevel, 1e-9);
    const Eigen::Vector3d plane = A.ldlt().solve(b);
    const double scale = camera.fx / grid.spacing;
    const Vec3d ray = camera.ray(center.u, center.v);
    // In normalized coordinates: 1/z = p x + q y + (1 + r - p x0 - q y0), times the center's 1/z.
    const double p = plane.x() * scale;
    const double q = plane.y() * scale;
    return -Vec3d(p, q, 1.0 + plane.z() - p * ray.x() - q * ray.y()).normalized();
}

}  // namespace

ScanGrid make_grid(const PointCloud& scene, const PictureCamera& camera) {
    std::vector<GridVertex> points = project(scene, camera);
    if (scene.organized()) {
        ScanGrid grid{scene.width, scene.height, 1.0F, std::move(points)};
        grid.spacing = typical_spacing(grid);
        fill_holes(grid, camera.pinhole.fx);
        return grid;
    }
    ScanGrid grid = average_cells(points, camera.pinhole);
    for (int pass = 0; pass < kHolePasses; ++pass) fill_holes(grid, camera.pinhole.fx);
    return grid;
}

bool joined(const GridVertex& a, const GridVertex& b, double focal) {
    const float apart = std::max(1.0F, std::hypot(b.u - a.u, b.v - a.v));
    const float depth = std::min(a.depth, b.depth);
    return std::abs(b.depth - a.depth) <= kSlope * apart * depth / static_cast<float>(focal);
}

void shade_grid(ScanGrid& grid, const PinholeCamera& camera) {
    parallel_for(static_cast<std::size_t>(grid.rows), [&](std::size_t row) {
        for (int column = 0; column < grid.columns; ++column) {
            GridVertex& vertex = grid.vertices[row * static_cast<std::size_t>(grid.columns) +
                                               static_cast<std::size_t>(column)];
            if (!vertex.valid()) continue;
            const Vec3d normal = fitted_normal(grid, camera, column, static_cast<int>(row));
            vertex.shade = static_cast<float>(shade_of(normal));
        }
    });
}

}  // namespace ostraka
