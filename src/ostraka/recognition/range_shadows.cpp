// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/range_shadows.hpp"

#include <algorithm>
#include <vector>

#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

constexpr double kLongShadow = 6.0;  // cells that the longest shadow at an edge must have, to tell
constexpr double kUncertain = 2.0;   // cells that edges of a shadow are uncertain by
constexpr std::size_t kMinEdges = 20;  // cells along edges; fewer can't tell
constexpr double kTypical = 0.3;       // quantile

// One row or column of cells, in one direction.
struct Line {
    std::size_t start;
    std::ptrdiff_t step;
    std::uint32_t count;
    std::size_t operator[](std::uint32_t i) const {
        return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(start) +
                                        step * static_cast<std::ptrdiff_t>(i));
    }
};

std::uint32_t lines_of(const CellRows& rows, std::size_t side) {
    return side < 2 ? rows.height : rows.width;
}

Line line(const CellRows& rows, std::size_t side, std::uint32_t number) {
    const auto width = static_cast<std::ptrdiff_t>(rows.width);
    const bool along_row = side < 2;
    const std::uint32_t count = along_row ? rows.width : rows.height;
    const std::ptrdiff_t step = along_row ? 1 : width;
    const std::ptrdiff_t first = along_row ? width * number : static_cast<std::ptrdiff_t>(number);
    const bool back = side % 2 == 1;
    return {static_cast<std::size_t>(back ? first + step * (count - 1) : first),
            back ? -step : step, count};
}

// Cells of the longest shadow that something at range `near` casts on something at range `far`.
double longest_shadow(double near, double far, double angle) {
    return kParallax * (1.0 - near / far) / angle;
}

// Whether what ends at cell `edge` is as wide as the shadow: narrower things let the camera see lit
// surface between them and their shadow.
bool wide(std::span<const RangeCell> cells, const Line& line, std::uint32_t edge, double shadow,
          double halfway) {
    const auto width = static_cast<std::uint32_t>(shadow) + 1;
    if (edge + 1 < width) return false;
    for (std::uint32_t i = 0; i < width; ++i) {
        const RangeCell& cell = cells[line[edge - i]];
        if (!cell.measured() || double{cell.near} > halfway) return false;
    }
    return true;
}

// The baselines that shadows beside the edges along a line tell of.
void measure(std::span<const RangeCell> cells, const Line& line, double angle,
             std::vector<double>& baselines) {
    std::uint32_t edge = kNoIndex;
    for (std::uint32_t i = 0; i < line.count; ++i) {
        if (!cells[line[i]].measured()) continue;
        const std::uint32_t before = edge;
        edge = i;
        if (before == kNoIndex) continue;
        const double near = double{cells[line[before]].near};
        const double far = double{cells[line[i]].near};
        const double longest = longest_shadow(near, far, angle);
        const double empty = static_cast<double>(i - before - 1);
        if (longest < kLongShadow || empty > longest + kUncertain) continue;
        if (!wide(cells, line, before, longest, (near + far) / 2.0)) continue;
        baselines.push_back((empty + kUncertain) * angle / (1.0 / near - 1.0 / far));
    }
}

}  // namespace

Baselines measure_baselines(std::span<const RangeCell> cells, const CellRows& rows) {
    Baselines result;
    for (std::size_t side = 0; side < result.size(); ++side) {
        std::vector<std::vector<double>> of_line(lines_of(rows, side));
        parallel_for(of_line.size(), [&](std::size_t i) {
            measure(cells, line(rows, side, static_cast<std::uint32_t>(i)), rows.angle, of_line[i]);
        });
        std::vector<double> all;
        for (const auto& some : of_line) all.insert(all.end(), some.begin(), some.end());
        result[side] = std::numeric_limits<double>::infinity();
        if (all.size() < kMinEdges) continue;
        const auto typical =
            all.begin() + static_cast<std::ptrdiff_t>(kTypical * static_cast<double>(all.size()));
        std::nth_element(all.begin(), typical, all.end());
        result[side] = *typical;
    }
    return result;
}

void mark_shadows(std::span<RangeCell> cells, const CellRows& rows, const Baselines& baselines) {
    for (std::size_t side = 0; side < baselines.size(); ++side) {
        parallel_for(lines_of(rows, side), [&](std::size_t number) {
            const Line cell_line = line(rows, side, static_cast<std::uint32_t>(number));
            float last = 0.0F;
            int since = 0;
            for (std::uint32_t i = 0; i < cell_line.count; ++i) {
                RangeCell& cell = cells[cell_line[i]];
                if (cell.measured()) {
                    last = cell.near;
                    since = 0;
                    continue;
                }
                ++since;
                if (!(last > 0.0F)) continue;
                const double tangent = std::min(kParallax, baselines[side] / double{last});
                const double left = 1.0 - since * rows.angle / tangent;
                if (left > 0.0) {
                    cell.shadow = std::min(cell.shadow, static_cast<float>(double{last} / left));
                }
            }
        });
    }
}

}  // namespace ostraka
