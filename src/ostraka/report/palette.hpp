// SPDX-License-Identifier: Apache-2.0
// Internal to report: the colors of pages and plots in the light and the dark scheme. Series colors
// are Okabe and Ito's, darkened or lightened until each stands out from its background; the first
// four are apart for every kind of color vision, and beyond color, series differ by marker.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "ostraka/base/types.hpp"

namespace ostraka {

struct Paint {
    const char*
        name;  ///< of the CSS variable, and after "f-" and "s-" of the fill and stroke class
    Color light;
    Color dark;
};

inline constexpr Paint kPaper{"paper", {255, 255, 255}, {19, 22, 27}};
inline constexpr Paint kPlate{"plate", {246, 247, 249}, {28, 32, 39}};
inline constexpr Paint kInk{"ink", {27, 31, 36}, {230, 233, 238}};
inline constexpr Paint kQuiet{"quiet", {89, 97, 109}, {158, 167, 180}};
inline constexpr Paint kAxisLine{"axis", {140, 147, 158}, {108, 117, 131}};
inline constexpr Paint kGrid{"grid", {226, 229, 233}, {46, 52, 61}};
inline constexpr Paint kGood{"good", {0, 118, 86}, {62, 207, 162}};
inline constexpr Paint kBad{"bad", {186, 66, 0}, {255, 148, 84}};
inline constexpr Paint kInverse{"inverse", {255, 255, 255}, {13, 15, 19}};  ///< on strong colors

inline constexpr std::array<Paint, 7> kSeriesPaints = {{{"s0", {0, 114, 178}, {78, 163, 224}},
                                                        {"s1", {213, 94, 0}, {240, 129, 60}},
                                                        {"s2", {0, 158, 115}, {47, 199, 154}},
                                                        {"s3", {204, 111, 165}, {233, 160, 203}},
                                                        {"s4", {191, 140, 0}, {242, 201, 76}},
                                                        {"s5", {75, 46, 131}, {155, 140, 255}},
                                                        {"s6", {107, 114, 128}, {125, 135, 148}}}};

inline const Paint& series_paint(std::size_t series) {
    return kSeriesPaints[series % kSeriesPaints.size()];
}

/// "#0072b2".
std::string css_color(const Color& color);

/// A share of one color on another, as a translucent shape shows it.
Color blend(const Color& under, const Color& over, double share);

/// WCAG 2.1's contrast ratio, 1 to 21.
double contrast(const Color& a, const Color& b);

/// The variables of both schemes, and the classes that give plots their colors from them.
std::string palette_css();

}  // namespace ostraka
