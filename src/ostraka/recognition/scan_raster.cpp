// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/scan_raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/recognition/scan_grid.hpp"

namespace ostraka {
namespace {

constexpr int kFine = 2;             // samples along each side of a pixel
constexpr int kBand = 32;            // sample rows that one thread fills
constexpr int kBlock = 4;            // pixels along the side of a block of surroundings
constexpr double kDarkest = 0.6;     // light lost far behind everything around
constexpr double kBrightest = 0.12;  // gained far in front of it

struct Samples {
    int width = 0;
    int height = 0;
    std::vector<float> depth;
    std::vector<float> shade;
};

float edge(const GridVertex& a, const GridVertex& b, float u, float v) {
    return (b.u - a.u) * (v - a.v) - (b.v - a.v) * (u - a.u);
}

// Fills the samples of rows [top, bottom) inside a triangle, nearest surface first. Across a jump
// in depth (not `smooth`) each sample is given to the closest corner.
void fill_triangle(Samples& samples, const std::array<GridVertex, 3>& t, bool smooth, int top,
                   int bottom) {
    const float area = edge(t[0], t[1], t[2].u, t[2].v);
    if (!(std::abs(area) > 1e-9F)) return;
    const auto [low_u, high_u] = std::minmax({t[0].u, t[1].u, t[2].u});
    const auto [low_v, high_v] = std::minmax({t[0].v, t[1].v, t[2].v});
    const int left = std::max(0, static_cast<int>(std::ceil(low_u)));
    const int right = std::min(samples.width - 1, static_cast<int>(std::floor(high_u)));
    const int first = std::max(top, static_cast<int>(std::ceil(low_v)));
    const int last = std::min(bottom - 1, static_cast<int>(std::floor(high_v)));
    for (int y = first; y <= last; ++y) {
        for (int x = left; x <= right; ++x) {
            const auto u = static_cast<float>(x);
            const auto v = static_cast<float>(y);
            const float a = edge(t[1], t[2], u, v) / area;
            const float b = edge(t[2], t[0], u, v) / area;
            const float c = 1.0F - a - b;
            if (a < -1e-4F || b < -1e-4F || c < -1e-4F) continue;
            const GridVertex& closest = a >= b && a >= c ? t[0] : (b >= c ? t[1] : t[2]);
            const float depth =
                !smooth ? closest.depth : a * t[0].depth + b * t[1].depth + c * t[2].depth;
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(samples.width) +
                static_cast<std::size_t>(x);
            if (samples.depth[i] > 0.0F && samples.depth[i] <= depth) continue;
            samples.depth[i] = depth;
            samples.shade[i] =
                smooth ? a * t[0].shade + b * t[1].shade + c * t[2].shade : closest.shade;
        }
    }
}

// The two triangles of a cell's corners, split along the smoother diagonal; where a corner is
// missing, that of the other three.
void fill_cell(Samples& samples, const ScanGrid& grid, int column, int row, double focal, int top,
               int bottom) {
    const std::array<GridVertex, 4> corners = {grid.at(column, row), grid.at(column + 1, row),
                                               grid.at(column + 1, row + 1),
                                               grid.at(column, row + 1)};
    const auto closed = [&](std::size_t i, std::size_t j) {
        return corners[i].valid() && corners[j].valid() && joined(corners[i], corners[j], focal);
    };
    const auto beside = [&](std::size_t i, std::size_t j) {
        const float limit = 2.5F * kFine * grid.spacing;
        return std::abs(corners[i].u - corners[j].u) < limit &&
               std::abs(corners[i].v - corners[j].v) < limit;
    };
    const bool split_02 = std::abs(corners[0].depth - corners[2].depth) <=
                          std::abs(corners[1].depth - corners[3].depth);
    const bool full = std::all_of(corners.begin(), corners.end(),
                                  [](const GridVertex& corner) { return corner.valid(); });
    for (std::size_t k = full && !split_02 ? 1 : 0; k < 4; k += full ? 2 : 1) {
        const std::size_t l = (k + 1) % 4;
        const std::size_t m = (k + 2) % 4;
        const bool smooth = closed(k, l) && closed(l, m) && closed(k, m);
        const bool near = full && beside(k, l) && beside(l, m) && beside(k, m);
        if (!smooth && !near) continue;
        fill_triangle(samples, {corners[k], corners[l], corners[m]}, smooth, top, bottom);
    }
}

// Whether a vertex has no neighbors to span a triangle with: it is then drawn as a square.
bool lonely(const ScanGrid& grid, int column, int row, double focal) {
    const GridVertex& center = grid.at(column, row);
    const auto beside = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= grid.columns || y >= grid.rows) return false;
        return grid.at(x, y).valid() && joined(center, grid.at(x, y), focal);
    };
    const bool in_row = beside(column - 1, row) || beside(column + 1, row);
    const bool in_column = beside(column, row - 1) || beside(column, row + 1);
    return center.valid() && !(in_row && in_column);
}

void fill_point(Samples& samples, const GridVertex& center, float half, int top, int bottom) {
    std::array<GridVertex, 4> corners;
    corners.fill(center);
    for (std::size_t k = 0; k < 4; ++k) {
        corners[k].u += k == 1 || k == 2 ? half : -half;
        corners[k].v += k >= 2 ? half : -half;
    }
    fill_triangle(samples, {corners[0], corners[1], corners[2]}, true, top, bottom);
    fill_triangle(samples, {corners[0], corners[2], corners[3]}, true, top, bottom);
}

// Least and greatest sample row of the vertices in each grid row; first > second for none.
std::vector<std::pair<float, float>> row_spans(const ScanGrid& grid) {
    std::vector<std::pair<float, float>> spans(static_cast<std::size_t>(grid.rows), {1e9F, -1e9F});
    for (std::size_t i = 0; i < grid.vertices.size(); ++i) {
        const GridVertex& vertex = grid.vertices[i];
        if (!vertex.valid()) continue;
        auto& [low, high] = spans[i / static_cast<std::size_t>(grid.columns)];
        low = std::min(low, vertex.v);
        high = std::max(high, vertex.v);
    }
    return spans;
}

Samples fill_samples(ScanGrid grid, const PinholeCamera& camera) {
    Samples samples{camera.width * kFine, camera.height * kFine, {}, {}};
    const auto count =
        static_cast<std::size_t>(samples.width) * static_cast<std::size_t>(samples.height);
    samples.depth.assign(count, 0.0F);
    samples.shade.assign(count, 0.0F);
    constexpr float kHalfSample = 0.5F * (kFine - 1);  // pixel centers -> sample centers
    for (GridVertex& vertex : grid.vertices) {
        vertex.u = vertex.u * kFine + kHalfSample;
        vertex.v = vertex.v * kFine + kHalfSample;
    }
    const std::vector<std::pair<float, float>> spans = row_spans(grid);
    const double focal = camera.fx * kFine;
    const float half = std::min(0.4F * grid.spacing, 2.0F) * kFine;
    const auto bands = static_cast<std::size_t>((samples.height + kBand - 1) / kBand);
    parallel_for(bands, [&](std::size_t band) {
        const int top = static_cast<int>(band) * kBand;
        const int bottom = std::min(samples.height, top + kBand);
        for (int row = 0; row < grid.rows; ++row) {
            const auto& a = spans[static_cast<std::size_t>(row)];
            const auto& b = spans[static_cast<std::size_t>(std::min(row + 1, grid.rows - 1))];
            if (std::max(a.second, b.second) < static_cast<float>(top) - half) continue;
            if (std::min(a.first, b.first) > static_cast<float>(bottom) + half) continue;
            for (int column = 0; column < grid.columns; ++column) {
                if (lonely(grid, column, row, focal)) {
                    fill_point(samples, grid.at(column, row), half, top, bottom);
                }
                if (column + 1 == grid.columns || row + 1 == grid.rows) continue;
                fill_cell(samples, grid, column, row, focal, top, bottom);
            }
        }
    });
    return samples;
}

ScanRaster average_samples(const Samples& samples, const PinholeCamera& camera) {
    const auto width = static_cast<std::size_t>(camera.width);
    const auto height = static_cast<std::size_t>(camera.height);
    ScanRaster raster;
    for (auto* values : {&raster.depth, &raster.coverage, &raster.shade}) {
        values->assign(width * height, 0.0F);
    }
    parallel_for(height, [&](std::size_t row) {
        for (std::size_t column = 0; column < width; ++column) {
            const std::size_t pixel = row * width + column;
            int filled = 0;
            float shade = 0.0F;
            for (std::size_t k = 0; k < kFine * kFine; ++k) {
                const std::size_t i =
                    (row * kFine + k / kFine) * width * kFine + column * kFine + k % kFine;
                const float depth = samples.depth[i];
                if (!(depth > 0.0F)) continue;
                ++filled;
                shade += samples.shade[i];
                float& nearest = raster.depth[pixel];
                if (nearest == 0.0F || depth < nearest) nearest = depth;
            }
            if (filled == 0) continue;
            raster.coverage[pixel] = static_cast<float>(filled) / (kFine * kFine);
            raster.shade[pixel] = shade / static_cast<float>(filled);
        }
    });
    return raster;
}

// Sum of the values in a square window, by running sums; windows end at the picture's border.
std::vector<double> box_sums(const std::vector<double>& values, int width, int height, int radius) {
    std::vector<double> across(values.size());
    std::vector<double> result(values.size());
    const auto columns = static_cast<std::size_t>(width);
    const auto pass = [&](const std::vector<double>& from, std::vector<double>& to,
                          std::size_t start, std::size_t step, int count) {
        double sum = 0.0;
        const auto at = [&](int i) { return start + static_cast<std::size_t>(i) * step; };
        for (int i = 0; i < std::min(radius, count); ++i) sum += from[at(i)];
        for (int i = 0; i < count; ++i) {
            if (i + radius < count) sum += from[at(i + radius)];
            if (i - radius - 1 >= 0) sum -= from[at(i - radius - 1)];
            to[at(i)] = sum;
        }
    };
    parallel_for(static_cast<std::size_t>(height),
                 [&](std::size_t row) { pass(values, across, row * columns, 1, width); });
    parallel_for(
        columns, [&](std::size_t column) { pass(across, result, column, columns, height); }, 16);
    return result;
}

// Weight, mean and variance of the depths around each block of kBlock x kBlock pixels.
struct Surroundings {
    int columns = 0;
    int rows = 0;
    double middle = 0.0;                         // of all depths: moments about zero would cancel
    std::array<std::vector<double>, 3> moments;  // sums of 1, d and d * d, d from the middle

    // Between the centers of the blocks around a pixel.
    std::array<double, 3> at(std::size_t column, std::size_t row) const {
        const auto place = [](std::size_t pixel, int count) {
            const double block = (static_cast<double>(pixel) + 0.5) / kBlock - 0.5;
            return std::clamp(block, 0.0, static_cast<double>(count - 1));
        };
        const double x = place(column, columns);
        const double y = place(row, rows);
        const auto left = static_cast<std::size_t>(std::min(static_cast<int>(x), columns - 2));
        const auto top = static_cast<std::size_t>(std::min(static_cast<int>(y), rows - 2));
        const double right_share = x - static_cast<double>(left);
        const double bottom_share = y - static_cast<double>(top);
        const std::size_t i = top * static_cast<std::size_t>(columns) + left;
        const std::size_t below = i + static_cast<std::size_t>(columns);
        std::array<double, 3> result{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::vector<double>& m = moments[k];
            result[k] =
                (1.0 - bottom_share) * ((1.0 - right_share) * m[i] + right_share * m[i + 1]) +
                bottom_share * ((1.0 - right_share) * m[below] + right_share * m[below + 1]);
        }
        return result;
    }
};

Surroundings look_around(const ScanRaster& raster, const PinholeCamera& camera, int radius) {
    Surroundings around;
    around.columns = std::max(2, (camera.width + kBlock - 1) / kBlock);
    around.rows = std::max(2, (camera.height + kBlock - 1) / kBlock);
    double sum = 0.0;
    double filled = 0.0;
    for (const float depth : raster.depth) {
        sum += double{depth};
        filled += depth > 0.0F ? 1.0 : 0.0;
    }
    around.middle = sum / std::max(1.0, filled);
    const auto columns = static_cast<std::size_t>(around.columns);
    for (std::vector<double>& moment : around.moments) {
        moment.assign(columns * static_cast<std::size_t>(around.rows), 0.0);
    }
    const auto width = static_cast<std::size_t>(camera.width);
    for (std::size_t i = 0; i < raster.depth.size(); ++i) {
        if (!(raster.depth[i] > 0.0F)) continue;
        const std::size_t block = i / width / kBlock * columns + i % width / kBlock;
        const double depth = raster.depth[i] - around.middle;
        around.moments[0][block] += 1.0;
        around.moments[1][block] += depth;
        around.moments[2][block] += depth * depth;
    }
    for (std::vector<double>& moment : around.moments) {
        for (int pass = 0; pass < 2; ++pass) {
            moment = box_sums(moment, around.columns, around.rows, radius / kBlock);
        }
    }
    return around;
}

// Darkens what lies behind its surroundings, as if near surfaces kept light from it. The mean and
// variance of the depths around a pixel tell a step's height, and what share of them is across it.
void add_relief(ScanRaster& raster, const PinholeCamera& camera, int radius) {
    const Surroundings around = look_around(raster, camera, radius);
    const auto width = static_cast<std::size_t>(camera.width);
    parallel_for(static_cast<std::size_t>(camera.height), [&](std::size_t row) {
        for (std::size_t column = 0; column < width; ++column) {
            const std::size_t i = row * width + column;
            if (!(raster.depth[i] > 0.0F)) continue;
            const auto [weight, first, second] = around.at(column, row);
            if (!(weight > 0.0)) continue;
            const double mean = first / weight;
            const double variance = std::max(0.0, second / weight - mean * mean);
            const double behind = raster.depth[i] - around.middle - mean;
            const double spread = behind * behind + variance;
            if (!(std::abs(behind) > 1e-9 * raster.depth[i])) continue;
            const double share = behind * std::abs(behind) / spread;
            const double step = spread / std::abs(behind);
            const double reach = raster.depth[i] * 2.0 * radius / camera.fx;
            const double strength = share > 0.0 ? kDarkest : kBrightest;
            const double loss = strength * share * step / (step + reach);
            raster.shade[i] =
                static_cast<float>(std::clamp(raster.shade[i] * (1.0 - loss), 0.0, 1.0));
        }
    });
}

}  // namespace

double shade_of(const Vec3d& normal) {
    const Vec3d key = Vec3d(-0.48, -0.62, -0.62).normalized();
    const double lit = std::max(0.0, normal.dot(key));
    const double facing = std::max(0.0, -normal.z());
    return std::clamp(0.1 + 0.56 * lit + 0.34 * facing * facing, 0.0, 1.0);
}

ScanRaster rasterize_scan(const PointCloud& scene, const PictureCamera& camera) {
    ScanGrid grid = make_grid(scene, camera);
    shade_grid(grid, camera.pinhole);
    ScanRaster raster =
        average_samples(fill_samples(std::move(grid), camera.pinhole), camera.pinhole);
    add_relief(raster, camera.pinhole, std::max(kBlock, camera.pinhole.width / 80));
    return raster;
}

}  // namespace ostraka
