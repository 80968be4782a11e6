// SPDX-License-Identifier: Apache-2.0
// Draws on an image: rectangles, lines and text, blended over what is there.
// A pixel (x, y) is a unit square centered at integer coordinates. Whatever lies outside the image
// is left out. `alpha` is the opacity, 0 to 1.
#pragma once

#include <string>
#include <string_view>

#include "ostraka/io/png_file.hpp"

namespace ostraka {

/// The pixels [x, x + width) x [y, y + height).
struct Rectangle {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;

    int right() const { return x + width; }
    int bottom() const { return y + height; }
    bool contains(int column, int row) const {
        return column >= x && column < right() && row >= y && row < bottom();
    }
};

/// Whether two rectangles share a pixel.
bool overlap(const Rectangle& a, const Rectangle& b);

/// The common pixels; of width or height 0 if there are none.
Rectangle intersection(const Rectangle& a, const Rectangle& b);

/// `share` of `to` over `from`, each channel rounded to nearest. @param share  0 to 1.
Color mix(Color from, Color to, double share);

/// @throws InvalidInput if a side isn't positive.
Image blank_image(int width, int height, Color color);

/// One pixel.
void blend(Image& image, int x, int y, Color color, double alpha = 1.0);

/// All pixels of a rectangle.
void fill(Image& image, const Rectangle& area, Color color, double alpha = 1.0);

/// The same with round corners, smooth at the edge. @param radius  of the corners, pixels.
void fill_rounded(Image& image, const Rectangle& area, double radius, Color color,
                  double alpha = 1.0);

/// The outermost `thickness` pixels inside a rectangle.
void frame(Image& image, const Rectangle& area, int thickness, Color color, double alpha = 1.0);

/// A line with round ends, smooth at the edge; equal ends give a disk. @param width  pixels.
void draw_line(Image& image, const Vec2d& from, const Vec2d& to, double width, Color color,
               double alpha = 1.0);

/// One line of text; every character outside ASCII 32 to 126 shows as one '?'.
/// @param left_top    of the first capital letter, pixels.
/// @param cap_height  of capital letters, pixels; lines are best 1.7 times that apart.
void draw_text(Image& image, const Vec2d& left_top, std::string_view text, double cap_height,
               Color color, double alpha = 1.0);

/// Width of that line of text, pixels.
double text_width(std::string_view text, double cap_height);

/// The text with its end replaced by ".." where it is wider than `width`.
std::string shortened(std::string_view text, double cap_height, double width);

/// Colors for objects that people with any color vision can tell apart, bright on dark ground.
/// Okabe, Ito. Color Universal Design. 2008. Departs from it: no black, blue is lighter; after
/// seven, the colors come again paler.
Color object_color(std::size_t index);

}  // namespace ostraka
