// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/stroke_font.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace ostraka {
namespace {

// Strokes separated by blanks: a kind and the control points, one digit (base 16) a coordinate.
// l: straight lines. s: quadratic B-spline from the first to the last point. c: closed B-spline.
// d: dot. Small letters reach from 3 to 9.
constexpr std::array<std::string_view, 95> kStrokes = {
    "",
    "l0006 d09",
    "l0002 l2022",
    "l2019 l5049 l0363 l0666",
    "s5240000455591907 l303A",
    "c00303404 c45757949 l6019",
    "s691310404305094965",
    "l0002",
    "s2003082B",
    "s0023280B",
    "l2025 l0144 l4104",
    "l3339 l0666",
    "l190B",
    "l0646",
    "d09",
    "l400A",
    "c00505909",
    "l022029",
    "s0200505409 l0959",
    "s0110505424 s2454591908",
    "l49400656",
    "l500004 s041353591908",
    "c04545909 s400107",
    "l005029",
    "c00505404 c04545909",
    "c00505505 s525819",
    "d04 d09",
    "d14 l190B",
    "l530659",
    "l0555 l0858",
    "l035609",
    "s020050532426 d29",
    "c23535727 s53588880000969",
    "l093069 l1656",
    "l0009 s002050542404 s042464692909",
    "s625000095967",
    "l0009 s002060692909",
    "l50000959 l0444",
    "l500009 l0444",
    "s625000096965 l6535",
    "l0009 l6069 l0464",
    "l0009",
    "s4046490907",
    "l0009 l5005 l2359",
    "l000949",
    "l0900356069",
    "l09006960",
    "c00707909",
    "l0009 s002050552505",
    "c00707909 l4679",
    "l0009 s002050552505 l2559",
    "s5240000455591907",
    "l0060 l3039",
    "s000609696660",
    "l003960",
    "l0029426980",
    "l0059 l5009",
    "l003560 l3539",
    "l00500959",
    "l20000B2B",
    "l004A",
    "l00202B0B",
    "l032043",
    "l0A5A",
    "l0012",
    "c03535909 l5359",
    "l0009 c03535909",
    "s544303094958",
    "l5059 c03535909",
    "l0656 s565303094958",
    "s40202329 l0343",
    "c03535909 s53585B1B0A",
    "l0009 s0603535659",
    "l0309 d00",
    "s23292B0B d20",
    "l0009 l4307 l1649",
    "s00070929",
    "l0309 s0603434649 s4643838689",
    "l0309 s0603535659",
    "c03535909",
    "l030B c03535909",
    "l535B c03535909",
    "l0309 s060333",
    "s4433030646491908",
    "s11161939 l0333",
    "s0306095956 l5359",
    "l032943",
    "l0329436983",
    "l0349 l4309",
    "l0329 l431B",
    "l03430949",
    "s30101505 s05151B3B",
    "l000B",
    "s00202535 s35252B0B",
    "s07144855",
};
constexpr double kSpacing = 2.7;
constexpr double kBlank = 4.0;
constexpr int kPieceSteps = 6;  // segments that a piece of a spline becomes

double coordinate(char digit) {
    return digit >= 'A' ? 10.0 + (digit - 'A') : static_cast<double>(digit - '0');
}

void add_line(Glyph& letter, const std::vector<Vec2d>& points) {
    for (std::size_t i = 1; i < points.size(); ++i) {
        letter.segments.emplace_back(points[i - 1], points[i]);
    }
}

// One quadratic piece, appended to a line that ends where it starts.
void add_piece(std::vector<Vec2d>& line, const Vec2d& control, const Vec2d& end) {
    const Vec2d start = line.back();  // a copy: the line grows
    for (int i = 1; i <= kPieceSteps; ++i) {
        const double t = static_cast<double>(i) / kPieceSteps;
        line.emplace_back((1.0 - t) * (1.0 - t) * start + 2.0 * t * (1.0 - t) * control +
                          t * t * end);
    }
}

void add_spline(Glyph& letter, const std::vector<Vec2d>& points, bool closed) {
    const std::size_t count = points.size();
    const auto middle = [&](std::size_t i) -> Vec2d {
        return 0.5 * (points[i % count] + points[(i + 1) % count]);
    };
    std::vector<Vec2d> line = {closed ? middle(count - 1) : points.front()};
    const std::size_t first = closed ? 0 : 1;
    const std::size_t last = closed ? count : count - 1;
    for (std::size_t i = first; i < last; ++i) {
        const bool ends = !closed && i + 2 == count;
        add_piece(line, points[i], ends ? points.back() : middle(i));
    }
    add_line(letter, line);
}

void add_stroke(Glyph& letter, std::string_view stroke) {
    std::vector<Vec2d> points;
    for (std::size_t i = 1; i + 1 < stroke.size(); i += 2) {
        points.emplace_back(coordinate(stroke[i]), coordinate(stroke[i + 1]));
        letter.advance = std::max(letter.advance, points.back().x());
    }
    if (stroke[0] == 'd') letter.segments.emplace_back(points[0], points[0]);
    if (stroke[0] == 'l') add_line(letter, points);
    if (stroke[0] == 's' || stroke[0] == 'c') add_spline(letter, points, stroke[0] == 'c');
}

std::vector<Glyph> make_font() {
    std::vector<Glyph> font(kStrokes.size());
    for (std::size_t i = 0; i < kStrokes.size(); ++i) {
        std::string_view strokes = kStrokes[i];
        while (!strokes.empty()) {
            const std::size_t end = std::min(strokes.find(' '), strokes.size());
            add_stroke(font[i], strokes.substr(0, end));
            strokes.remove_prefix(std::min(end + 1, strokes.size()));
        }
        font[i].advance = kStrokes[i].empty() ? kBlank : font[i].advance + kSpacing;
    }
    return font;
}

}  // namespace

const Glyph& glyph(char character) {
    static const std::vector<Glyph> font = make_font();
    const bool known = character >= 32 && character <= 126;
    return font[static_cast<std::size_t>((known ? character : '?') - 32)];
}

}  // namespace ostraka
