// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/svg_canvas.hpp"

#include <fmt/format.h>

#include <iterator>

#include "ostraka/report/markup.hpp"

namespace ostraka {
namespace {

std::string stroke_attributes(const Stroke& stroke) {
    std::string text =
        fmt::format(R"(class="s-{}" stroke="{}" stroke-width="{}")", stroke.paint->name,
                    css_color(stroke.paint->light), pixels(stroke.width));
    if (*stroke.dash != '\0') text += fmt::format(R"( stroke-dasharray="{}")", stroke.dash);
    return text;
}

std::string fill_attributes(const Paint& paint, double opacity, double edge) {
    const bool edged = edge > 0.0;
    std::string text = fmt::format(R"(class="f-{}{}{}" fill="{}")", paint.name, edged ? " s-" : "",
                                   edged ? kPaper.name : "", css_color(paint.light));
    if (opacity < 1.0) text += fmt::format(R"( fill-opacity="{}")", pixels(opacity));
    if (edged) {
        text +=
            fmt::format(R"( stroke="{}" stroke-width="{}")", css_color(kPaper.light), pixels(edge));
    }
    return text;
}

// The element's end, with a hint inside if there is one.
std::string element_end(std::string_view tag, std::string_view hint) {
    if (hint.empty()) return "/>\n";
    return fmt::format("><title>{}</title></{}>\n", escape_html(hint), tag);
}

}  // namespace

std::string pixels(double value) {
    std::string text = fmt::format("{:.2f}", value);
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text == "-0" ? "0" : text;
}

void SvgCanvas::line(Dot a, Dot b, const Stroke& stroke) {
    body_ += fmt::format(R"(<line x1="{}" y1="{}" x2="{}" y2="{}" {}/>)", pixels(a.x), pixels(a.y),
                         pixels(b.x), pixels(b.y), stroke_attributes(stroke));
    body_ += '\n';
}

void SvgCanvas::outline(std::string_view path, const Stroke& stroke) {
    body_ += fmt::format(R"(<path d="{}" fill="none" stroke-linejoin="round" {}/>)", path,
                         stroke_attributes(stroke));
    body_ += '\n';
}

void SvgCanvas::shape(std::string_view path, const Paint& fill, double opacity, double edge,
                      std::string_view hint) {
    body_ += fmt::format(R"(<path d="{}" {})", path, fill_attributes(fill, opacity, edge));
    body_ += element_end("path", hint);
}

void SvgCanvas::rectangle(Dot corner, double width, double height, const Paint& fill,
                          double opacity, std::string_view hint) {
    body_ += fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}" {})", pixels(corner.x),
                         pixels(corner.y), pixels(width), pixels(height),
                         fill_attributes(fill, opacity, 0.0));
    body_ += element_end("rect", hint);
}

void SvgCanvas::text(Dot at, std::string_view text, const TextStyle& style) {
    constexpr double kMiddleOfLetters = 0.35;  // above the baseline, of the size
    constexpr const char* kAnchors[] = {"", R"( text-anchor="middle")", R"( text-anchor="end")"};
    // Turned text turns about the place itself, so the shift to the baseline comes after.
    const double x = style.turn == 0.0 ? at.x : 0.0;
    const double y = (style.turn == 0.0 ? at.y : 0.0) + kMiddleOfLetters * style.size;
    std::string turn;
    if (style.turn != 0.0) {
        turn = fmt::format(R"_( transform="translate({} {}) rotate({})")_", pixels(at.x),
                           pixels(at.y), pixels(style.turn));
    }
    body_ += fmt::format(
        R"(<text x="{}" y="{}" font-size="{}"{}{}{} class="f-{}{}{}" fill="{}">{}{}</text>)",
        pixels(x), pixels(y), pixels(style.size), kAnchors[static_cast<int>(style.anchor)],
        style.bold ? R"( font-weight="600")" : "", turn, style.paint->name,
        *style.classes != '\0' ? " " : "", style.classes, css_color(style.paint->light),
        style.hint.empty() ? "" : fmt::format("<title>{}</title>", escape_html(style.hint)),
        escape_html(text));
    body_ += '\n';
}

void SvgCanvas::begin_clip(Dot corner, double width, double height) {
    // A nested drawing clips what leaves it and, unlike a clip path, needs no name in the page.
    body_ += fmt::format(R"(<svg x="{0}" y="{1}" width="{2}" height="{3}" )"
                         R"(viewBox="{0} {1} {2} {3}" overflow="hidden">)",
                         pixels(corner.x), pixels(corner.y), pixels(width), pixels(height));
    body_ += '\n';
}

void SvgCanvas::end_clip() {
    body_ += "</svg>\n";
}

std::string SvgCanvas::svg(double width, double height, std::string_view name) const {
    return fmt::format(
        R"(<svg xmlns="http://www.w3.org/2000/svg" class="plot" role="img" aria-label="{2}" )"
        R"(width="{0}" height="{1}" viewBox="0 0 {0} {1}" )"
        R"(font-family="system-ui,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif">)"
        "\n{3}</svg>\n",
        pixels(width), pixels(height), escape_html(name), body_);
}

std::string marker_path(std::size_t shape, Dot at, double radius) {
    const auto polygon = [&](std::initializer_list<Dot> corners) {
        std::string path;
        for (const Dot& c : corners) {
            fmt::format_to(std::back_inserter(path), "{}{} {}", path.empty() ? "M" : "L",
                           pixels(at.x + radius * c.x), pixels(at.y + radius * c.y));
        }
        return path + "Z";
    };
    switch (shape % 7) {
        case 1:
            return polygon({{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0.9}, {-0.9, 0.9}});
        case 2:
            return polygon({{0.0, -1.2}, {1.1, 0.8}, {-1.1, 0.8}});
        case 3:
            return polygon({{0.0, -1.25}, {1.25, 0.0}, {0.0, 1.25}, {-1.25, 0.0}});
        case 4:
            return polygon({{0.0, 1.2}, {1.1, -0.8}, {-1.1, -0.8}});
        case 5:
            return polygon({{-1.2, -0.4},
                            {-0.4, -0.4},
                            {-0.4, -1.2},
                            {0.4, -1.2},
                            {0.4, -0.4},
                            {1.2, -0.4},
                            {1.2, 0.4},
                            {0.4, 0.4},
                            {0.4, 1.2},
                            {-0.4, 1.2},
                            {-0.4, 0.4},
                            {-1.2, 0.4}});
        case 6:
            return polygon({{-1.1, -0.55}, {1.1, -0.55}, {1.1, 0.55}, {-1.1, 0.55}});
        default:
            return fmt::format("M{0} {2}a{1} {1} 0 1 0 {3} 0a{1} {1} 0 1 0 {4} 0Z",
                               pixels(at.x - radius), pixels(radius), pixels(at.y),
                               pixels(2.0 * radius), pixels(-2.0 * radius));
    }
}

}  // namespace ostraka
