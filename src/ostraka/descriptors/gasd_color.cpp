// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/gasd_color.hpp"

#include <array>

#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/gasd_aligned.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kShapeGrid = 6;  // cells along an axis
constexpr std::size_t kColorGrid = 4;
constexpr std::size_t kHues = 12;
constexpr std::size_t kShapeCells = kShapeGrid * kShapeGrid * kShapeGrid;
constexpr std::size_t kColorCells = kColorGrid * kColorGrid * kColorGrid;
constexpr std::size_t kOutside = ~std::size_t{0};
static_assert(kShapeCells + kColorCells * kHues == kGasdColorLength);

// The cell of a grid over [-largest, largest]^3; kOutside on the upper border.
std::size_t cell_of(const Vec3f& point, float largest, std::size_t grid) {
    const auto half = static_cast<float>(grid / 2);
    std::size_t cell = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float along = point[axis] / largest * half + half;
        const auto k = static_cast<std::size_t>(along > 0.0F ? along : 0.0F);
        if (k >= grid) return kOutside;
        cell = cell * grid + k;
    }
    return cell;
}

}  // namespace

float hue_of(const Color& color) {
    const int r = color[0];
    const int g = color[1];
    const int b = color[2];
    const int high = std::max({r, g, b});
    const int low = std::min({r, g, b});
    if (high == low) return 0.0F;
    const float inverse = 1.0F / static_cast<float>(high - low);
    float hue = 0.0F;
    if (high == r) {
        hue = 60.0F * (static_cast<float>(g - b) * inverse);
    } else if (high == g) {
        hue = 60.0F * (2.0F + static_cast<float>(b - r) * inverse);
    } else {
        hue = 60.0F * (4.0F + static_cast<float>(r - g) * inverse);
    }
    return hue < 0.0F ? hue + 360.0F : hue;
}

std::vector<float> describe_gasd_color(const PointCloud& cloud, const GasdColorSettings& settings) {
    require_points(cloud, "gasd_color");
    if (cloud.colors.empty()) throw InvalidInput("gasd_color: the cloud has no colors");
    std::vector<float> row(kGasdColorLength, 0.0F);
    const AlignedPoints aligned = align(cloud, gasd_frame(cloud, {.x_sign = settings.x_sign}));
    if (!(aligned.largest > 0.0F) || cloud.size() < 2) return row;
    std::array<std::uint32_t, kGasdColorLength> counts{};
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const std::size_t shape = cell_of(aligned.points[i], aligned.largest, kShapeGrid);
        const std::size_t color = cell_of(aligned.points[i], aligned.largest, kColorGrid);
        if (shape != kOutside) ++counts[shape];
        if (color == kOutside) continue;
        const float hue = hue_of(cloud.colors[i]) / 360.0F * static_cast<float>(kHues);
        ++counts[kShapeCells + color * kHues + std::min(static_cast<std::size_t>(hue), kHues - 1)];
    }
    const float share = 100.0F / static_cast<float>(cloud.size() - 1);
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = static_cast<float>(counts[k]) * share;
    return row;
}

}  // namespace ostraka
