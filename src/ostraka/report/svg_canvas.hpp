// SPDX-License-Identifier: Apache-2.0
// Internal to report: what plots draw on. Each shape carries its color of the light scheme and a
// class: alone the drawing is readable anywhere; within a page the page's schemes color it.
#pragma once

#include <string>
#include <string_view>

#include "ostraka/report/palette.hpp"

namespace ostraka {

struct Dot {
    double x = 0.0;  ///< pixels from the left
    double y = 0.0;  ///< pixels from the top
};

struct Stroke {
    const Paint* paint = &kInk;
    double width = 1.0;     ///< pixels
    const char* dash = "";  ///< as SVG has it; empty: solid
};

enum class TextAnchor { kStart, kMiddle, kEnd };

struct TextStyle {
    double size = 12.0;  ///< pixels
    const Paint* paint = &kInk;
    TextAnchor anchor = TextAnchor::kStart;
    bool bold = false;
    double turn = 0.0;           ///< degrees clockwise about the anchor
    const char* classes = "";    ///< further classes
    std::string_view hint = {};  ///< shown while the pointer rests there
};

class SvgCanvas {
  public:
    void line(Dot a, Dot b, const Stroke& stroke);
    /// An open outline. @param path  SVG path data.
    void outline(std::string_view path, const Stroke& stroke);
    /// @param path  SVG path data. @param edge  pixels of paper color around it.
    void shape(std::string_view path, const Paint& fill, double opacity = 1.0, double edge = 0.0,
               std::string_view hint = {});
    void rectangle(Dot corner, double width, double height, const Paint& fill, double opacity = 1.0,
                   std::string_view hint = {});
    /// Any text: it is escaped. @param at  on the line through the middle of the letters.
    void text(Dot at, std::string_view text, const TextStyle& style = {});
    /// What follows is drawn within that rectangle only.
    void begin_clip(Dot corner, double width, double height);
    void end_clip();

    /// The whole drawing. @param name  what it shows, for those who can't see it.
    std::string svg(double width, double height, std::string_view name) const;

  private:
    std::string body_;
};

/// Pixels as SVG writes them: at most two decimals, no exponent.
std::string pixels(double value);

/// One of seven shapes about a place, as path data.
std::string marker_path(std::size_t shape, Dot at, double radius);

}  // namespace ostraka
