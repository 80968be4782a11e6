// SPDX-License-Identifier: Apache-2.0
#include "describe_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ostraka/cloud/resample.hpp"
#include "ostraka/recognition/canvas.hpp"

namespace ostraka::app {
namespace {

constexpr Color kBackground{17, 20, 26};
constexpr Color kPlate{27, 31, 39};
constexpr Color kOddPlate{33, 38, 48};
constexpr Color kText{240, 242, 246};
constexpr Color kQuietText{150, 157, 170};
constexpr Color kSurface{196, 201, 211};
constexpr int kWidth = 1240;
constexpr int kMargin = 20;
constexpr int kTitle = 44;
constexpr int kPiece = 250;
constexpr int kChartLeft = kMargin + kPiece + 2 * kMargin;
constexpr int kChartWidth = kWidth - kChartLeft - kMargin;
constexpr int kLabels = 24;  // under the last row
constexpr double kShades = 20.0;

int row_height(std::size_t rows) {
    return rows == 1 ? kPiece : 118;
}

// From the piece's frame to pixels: orthographic, seen from the viewpoint, the sensor's y down.
struct Projection {
    Vec3d center, right, down, toward;
    double scale = 1.0;
    Vec2d middle = Vec2d::Zero();

    Vec2d operator()(const Vec3f& point) const {
        const Vec3d offset = point.cast<double>() - center;
        return middle + scale * Vec2d(right.dot(offset), down.dot(offset));
    }
};

Projection project(const PointCloud& piece, const Rectangle& area) {
    Projection view;
    view.center = centroid(piece.points);
    view.toward = piece.viewpoint.cast<double>() - view.center;
    if (!(view.toward.norm() > 0.0)) view.toward = Vec3d::UnitZ();
    view.toward.normalize();
    Vec3d down = Vec3d::UnitY();
    if (std::abs(down.dot(view.toward)) > 0.99) down = Vec3d::UnitX();
    view.right = down.cross(-view.toward).normalized();
    view.down = (-view.toward).cross(view.right);
    Vec2d low = Vec2d::Constant(1e30);
    Vec2d high = Vec2d::Constant(-1e30);
    for (const Vec3f& point : piece.points) {
        const Vec2d at = view(point);
        low = low.cwiseMin(at);
        high = high.cwiseMax(at);
    }
    const Vec2d size = high - low;
    const double fit = 0.9 * std::min(area.width / std::max(size.x(), 1e-9),
                                      area.height / std::max(size.y(), 1e-9));
    const Vec2d half = 0.5 * (low + high);
    view.middle = Vec2d(area.x + 0.5 * area.width, area.y + 0.5 * area.height) - fit * half;
    view.scale = fit;
    return view;
}

void draw_piece(Image& image, const Rectangle& area, const PointCloud& piece,
                const std::vector<ChartRow>& rows) {
    const Projection view = project(piece, area);
    std::vector<Color> colors = piece.colors;
    if (colors.empty()) colors.assign(piece.size(), kSurface);
    for (std::size_t r = 0; r < rows.size(); ++r) {
        if (rows[r].marked) continue;
        for (const std::uint32_t i : rows[r].points) colors[i] = object_color(r);
    }
    std::vector<std::uint32_t> order(piece.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const double depth_a = view.toward.dot(piece.points[a].cast<double>());
        const double depth_b = view.toward.dot(piece.points[b].cast<double>());
        return depth_a != depth_b ? depth_a < depth_b : a < b;
    });
    // Squares in few shades: they show a surface as well as disks do, in half the bytes.
    const double spacing = view.scale * mesh_resolution(piece.points);
    const int dot = std::clamp(static_cast<int>(std::ceil(1.3 * spacing)), 2, 12);
    for (const std::uint32_t i : order) {
        const double facing = std::abs(piece.normals[i].cast<double>().dot(view.toward));
        const double light = std::isfinite(facing) ? std::min(0.25 + 0.75 * facing, 1.0) : 0.25;
        const Vec2d at = view(piece.points[i]);
        const int x = static_cast<int>(std::lround(at.x())) - dot / 2;
        const int y = static_cast<int>(std::lround(at.y())) - dot / 2;
        fill(image, {x, y, dot, dot},
             mix(Color{0, 0, 0}, colors[i], std::round(light * kShades) / kShades));
    }
    for (std::size_t r = 0; r < rows.size(); ++r) {
        if (!rows[r].marked) continue;
        for (const std::uint32_t i : rows[r].points) {
            const Vec2d at = view(piece.points[i]);
            draw_line(image, at, at, 15.0, kBackground);
            draw_line(image, at, at, 11.0, object_color(r));
        }
    }
}

float height_of(float value) {
    return std::copysign(std::sqrt(std::abs(value)), value);
}

// Columns of pixels [left, right) of a row's number.
std::pair<int, int> columns_of(std::size_t number, std::size_t length) {
    const double step = double(kChartWidth) / static_cast<double>(length);
    const int left = kChartLeft + static_cast<int>(std::lround(step * double(number)));
    const int next = kChartLeft + static_cast<int>(std::lround(step * double(number + 1)));
    return {left, std::max(left + 1, step >= 3.0 ? next - 1 : next)};
}

void draw_plates(Image& image, const std::vector<ChartBlock>& blocks, std::size_t length, int top,
                 int height) {
    std::size_t begin = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const int left = columns_of(begin, length).first;
        begin += blocks[b].length;
        const int right =
            begin < length ? columns_of(begin, length).first : kChartLeft + kChartWidth;
        fill(image, {left, top, right - left, height}, b % 2 == 0 ? kPlate : kOddPlate);
    }
}

void draw_labels(Image& image, const std::vector<ChartBlock>& blocks, std::size_t length, int top) {
    std::size_t begin = 0;
    for (const ChartBlock& block : blocks) {
        const int left = columns_of(begin, length).first;
        begin += block.length;
        const int right =
            begin < length ? columns_of(begin, length).first : kChartLeft + kChartWidth;
        const std::string text = shortened(block.label, 9.0, right - left - 2);
        const double start = 0.5 * (left + right - text_width(text, 9.0));
        draw_text(image, {start, double(top)}, text, 9.0, kQuietText);
    }
}

// Bars from a line that leaves room below it only where there are negative numbers.
struct Scale {
    float low = 0.0F;
    float high = 1e-30F;

    void include(float value) {
        low = std::min(low, height_of(value));
        high = std::max(high, height_of(value));
    }
    int y(float value, int top, int height) const {
        const double share = double((high - height_of(value)) / (high - low));
        return top + static_cast<int>(std::lround(share * height));
    }
};

void draw_bars(Image& image, const ChartRow& row, const std::vector<ChartBlock>& blocks,
               const Scale& scale, int top, int height, const Color* color) {
    std::size_t number = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        for (std::size_t k = 0; k < blocks[b].length; ++k, ++number) {
            const auto [left, right] = columns_of(number, row.values.size());
            const int zero = scale.y(0.0F, top, height);
            const int end = scale.y(row.values[number], top, height);
            const Rectangle bar{left, std::min(zero, end), right - left, std::abs(zero - end)};
            fill(image, bar, color != nullptr ? *color : object_color(b % 2 == 0 ? 0 : 1));
        }
    }
}

}  // namespace

std::vector<ChartBlock> chart_blocks(const AnyDescriptor& descriptor) {
    const std::string name(descriptor_name(descriptor));
    const auto numbered = [](const std::string& label, std::size_t count, std::size_t length) {
        std::vector<ChartBlock> blocks;
        for (std::size_t b = 1; b <= count; ++b)
            blocks.push_back({fmt::format("{} {}", label, b), length});
        return blocks;
    };
    if (name == "vfh") {
        return {{"angle", 45},
                {"cosine", 45},
                {"tilt", 45},
                {"(empty)", 45},
                {"normals toward the viewpoint", 128}};
    }
    if (name == "cvfh") {
        return {{"angle", 45},
                {"cosine", 45},
                {"tilt", 45},
                {"distance", 45},
                {"normals toward the viewpoint", 128}};
    }
    if (name == "our_cvfh") {
        return {{"angle", 45},
                {"cosine", 45},
                {"tilt", 45},
                {"13 distances in 8 octants", 104},
                {"toward the viewpoint", 69}};
    }
    if (name == "esf") {
        return {{"angle on", 64}, {"off", 64},     {"mixed", 64},     {"area on", 64},
                {"off", 64},      {"mixed", 64},   {"length on", 64}, {"off", 64},
                {"mixed", 64},    {"share on", 64}};
    }
    if (name == "gasd") return numbered("slice x", 8, 64);
    if (name == "gasd_color") {
        return {{"points, 6 x 6 x 6 cells", 216}, {"hues, 12 in each of 4 x 4 x 4 cells", 768}};
    }
    if (name == "shot" || name == "shot_local") return numbered("sector", 8, 44);
    if (name == "rops" || name == "rops_local") {
        return {{"turned about x", 45}, {"turned about y", 45}, {"turned about z", 45}};
    }
    if (name == "pfh") return numbered("cosine to the line", 5, 25);
    if (name == "fpfh") return {{"angle", 11}, {"cosine across", 11}, {"cosine to the line", 11}};
    if (name == "spin_image") return numbered("distance", 9, 17);
    return {{name, descriptor_length(descriptor)}};
}

Image draw_chart(const std::string& title, const PointCloud& piece,
                 const std::vector<ChartBlock>& blocks, const std::vector<ChartRow>& rows) {
    const int height = row_height(rows.size());
    const int charts = static_cast<int>(rows.size()) * (height + kMargin) - kMargin;
    const int inner = std::max(kPiece, charts);
    Image image = blank_image(kWidth, kTitle + inner + kLabels + kMargin / 2, kBackground);
    draw_text(image, {double(kMargin), 16.0}, title, 13.0, kText);
    draw_piece(image, {kMargin, kTitle + (inner - kPiece) / 2, kPiece, kPiece}, piece, rows);
    Scale scale;
    for (const ChartRow& row : rows) {
        for (const float value : row.values) scale.include(value);
    }
    int top = kTitle;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const Color color = object_color(r);
        draw_plates(image, blocks, rows[r].values.size(), top, height);
        draw_bars(image, rows[r], blocks, scale, top + 6, height - 6,
                  rows[r].points.empty() ? nullptr : &color);
        draw_text(image, {kChartLeft + kChartWidth - text_width(rows[r].caption, 8.5), top - 14.0},
                  rows[r].caption, 8.5, mix(kText, color, 0.5));
        top += height + kMargin;
    }
    draw_labels(image, blocks, rows.front().values.size(), kTitle + charts + 8);
    return image;
}

}  // namespace ostraka::app
