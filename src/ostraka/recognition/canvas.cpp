// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/canvas.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/recognition/stroke_font.hpp"

namespace ostraka {
namespace {

constexpr double kStrokeWidth = 1.25;  // of letters, font units

Rectangle bounds(const Image& image) {
    return {0, 0, image.width, image.height};
}

// The pixels that a disk of `radius` around a point of the box may touch.
Rectangle around(const Vec2d& low, const Vec2d& high, double radius) {
    const Rectangle area{static_cast<int>(std::floor(low.x() - radius)),
                         static_cast<int>(std::floor(low.y() - radius)), 0, 0};
    return {area.x, area.y, static_cast<int>(std::ceil(high.x() + radius)) - area.x + 1,
            static_cast<int>(std::ceil(high.y() + radius)) - area.y + 1};
}

double segment_distance(const Vec2d& point, const Vec2d& from, const Vec2d& to) {
    const Vec2d along = to - from;
    const double length2 = along.squaredNorm();
    const double t =
        length2 > 0.0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0.0;
    return (point - from - t * along).norm();
}

void draw_glyph(Image& image, const Glyph& letter, const Vec2d& left_top, double unit, Color color,
                double alpha) {
    const double half = 0.5 * kStrokeWidth * unit;
    const Vec2d size((letter.advance + 1.0) * unit, (kFontCapHeight + kFontDescent) * unit);
    const Rectangle area =
        intersection(around(left_top, left_top + size, half + 1.0), bounds(image));
    for (int y = area.y; y < area.bottom(); ++y) {
        for (int x = area.x; x < area.right(); ++x) {
            const Vec2d point = (Vec2d(x, y) - left_top) / unit;
            double nearest = 1e9;
            for (const auto& [from, to] : letter.segments) {
                const double dot = from == to ? 0.25 : 0.0;  // dots are bolder than strokes
                nearest = std::min(nearest, segment_distance(point, from, to) - dot);
            }
            const double coverage = std::clamp(half + 0.5 - nearest * unit, 0.0, 1.0);
            if (coverage > 0.0) blend(image, x, y, color, alpha * coverage);
        }
    }
}

// Bytes that continue a UTF-8 character.
bool continues(char byte) {
    return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

}  // namespace

bool overlap(const Rectangle& a, const Rectangle& b) {
    return a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
}

Rectangle intersection(const Rectangle& a, const Rectangle& b) {
    const int x = std::max(a.x, b.x);
    const int y = std::max(a.y, b.y);
    return {x, y, std::max(0, std::min(a.right(), b.right()) - x),
            std::max(0, std::min(a.bottom(), b.bottom()) - y)};
}

Color mix(Color from, Color to, double share) {
    Color mixed;
    for (std::size_t c = 0; c < 3; ++c) {
        const double value = (1.0 - share) * from[c] + share * to[c];
        mixed[c] = static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
    }
    return mixed;
}

Image blank_image(int width, int height, Color color) {
    if (width <= 0 || height <= 0) throw InvalidInput("an image needs at least one pixel");
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    return {width, height, std::vector<Color>(count, color)};
}

void blend(Image& image, int x, int y, Color color, double alpha) {
    if (!bounds(image).contains(x, y)) return;
    Color& pixel =
        image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                     static_cast<std::size_t>(x)];
    pixel = mix(pixel, color, alpha);
}

void fill(Image& image, const Rectangle& area, Color color, double alpha) {
    const Rectangle inside = intersection(area, bounds(image));
    for (int y = inside.y; y < inside.bottom(); ++y) {
        for (int x = inside.x; x < inside.right(); ++x) blend(image, x, y, color, alpha);
    }
}

void fill_rounded(Image& image, const Rectangle& area, double radius, Color color, double alpha) {
    const Rectangle inside = intersection(area, bounds(image));
    const Vec2d half(0.5 * area.width, 0.5 * area.height);
    const Vec2d center = Vec2d(area.x, area.y) + half - Vec2d(0.5, 0.5);
    for (int y = inside.y; y < inside.bottom(); ++y) {
        for (int x = inside.x; x < inside.right(); ++x) {
            const Vec2d offset = (Vec2d(x, y) - center).cwiseAbs() - half + Vec2d(radius, radius);
            const double outside = offset.cwiseMax(0.0).norm() - radius;
            const double coverage = std::clamp(0.5 - outside, 0.0, 1.0);
            const bool straight = offset.x() <= 0.0 || offset.y() <= 0.0;
            if (coverage > 0.0) blend(image, x, y, color, alpha * (straight ? 1.0 : coverage));
        }
    }
}

void frame(Image& image, const Rectangle& area, int thickness, Color color, double alpha) {
    const int side = std::min(thickness, (std::min(area.width, area.height) + 1) / 2);
    const int rest = std::max(0, area.height - 2 * side);
    const int bottom = std::min(side, area.height - side);
    const int right = std::min(side, area.width - side);
    fill(image, {area.x, area.y, area.width, side}, color, alpha);
    fill(image, {area.x, area.bottom() - bottom, area.width, bottom}, color, alpha);
    fill(image, {area.x, area.y + side, side, rest}, color, alpha);
    fill(image, {area.right() - right, area.y + side, right, rest}, color, alpha);
}

void draw_line(Image& image, const Vec2d& from, const Vec2d& to, double width, Color color,
               double alpha) {
    const double half = 0.5 * width;
    const Rectangle area =
        intersection(around(from.cwiseMin(to), from.cwiseMax(to), half + 1.0), bounds(image));
    for (int y = area.y; y < area.bottom(); ++y) {
        for (int x = area.x; x < area.right(); ++x) {
            const double distance = segment_distance(Vec2d(x, y), from, to);
            const double coverage = std::clamp(half + 0.5 - distance, 0.0, 1.0);
            if (coverage > 0.0) blend(image, x, y, color, alpha * std::min(coverage, width));
        }
    }
}

void draw_text(Image& image, const Vec2d& left_top, std::string_view text, double cap_height,
               Color color, double alpha) {
    const double unit = cap_height / kFontCapHeight;
    Vec2d position = left_top;
    for (const char character : text) {
        if (continues(character)) continue;
        const Glyph& letter = glyph(character);
        draw_glyph(image, letter, position, unit, color, alpha);
        position.x() += letter.advance * unit;
    }
}

double text_width(std::string_view text, double cap_height) {
    double width = 0.0;
    for (const char character : text) {
        if (!continues(character)) width += glyph(character).advance;
    }
    return width * cap_height / kFontCapHeight;
}

std::string shortened(std::string_view text, double cap_height, double width) {
    if (text_width(text, cap_height) <= width) return std::string(text);
    std::string start(text);
    while (!start.empty() && text_width(start + "..", cap_height) > width) {
        while (start.size() > 1 && continues(start.back())) start.pop_back();
        start.pop_back();
    }
    return start + "..";
}

Color object_color(std::size_t index) {
    constexpr std::array<Color, 7> kColors = {{{245, 158, 11},
                                               {72, 176, 240},
                                               {16, 185, 129},
                                               {226, 120, 186},
                                               {240, 228, 66},
                                               {232, 88, 36},
                                               {110, 120, 250}}};
    const Color pale{255, 255, 255};
    const double paleness = 0.4 * static_cast<double>(index / kColors.size() % 2);
    return mix(kColors[index % kColors.size()], pale, paleness);
}

}  // namespace ostraka
