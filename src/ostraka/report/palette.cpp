// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/palette.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace ostraka {
namespace {

std::vector<Paint> all_paints() {
    std::vector<Paint> paints = {kPaper, kPlate, kInk, kQuiet,  kAxisLine,
                                 kGrid,  kGood,  kBad, kInverse};
    paints.insert(paints.end(), kSeriesPaints.begin(), kSeriesPaints.end());
    return paints;
}

double luminance(const Color& color) {
    const auto linear = [](std::uint8_t channel) {
        const double c = channel / 255.0;
        return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    };
    return 0.2126 * linear(color[0]) + 0.7152 * linear(color[1]) + 0.0722 * linear(color[2]);
}

}  // namespace

std::string css_color(const Color& color) {
    return fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]);
}

Color blend(const Color& under, const Color& over, double share) {
    Color mixed{};
    for (std::size_t k = 0; k < 3; ++k) {
        mixed[k] = static_cast<std::uint8_t>(
            std::lround((1.0 - share) * double(under[k]) + share * double(over[k])));
    }
    return mixed;
}

double contrast(const Color& a, const Color& b) {
    const auto [dark, bright] = std::minmax({luminance(a), luminance(b)});
    return (bright + 0.05) / (dark + 0.05);
}

std::string palette_css() {
    std::string light;
    std::string dark;
    std::string classes;
    for (const Paint& paint : all_paints()) {
        light += fmt::format("--{}:{};", paint.name, css_color(paint.light));
        dark += fmt::format("--{}:{};", paint.name, css_color(paint.dark));
        classes += fmt::format(".plot .f-{0}{{fill:var(--{0})}}.plot .s-{0}{{stroke:var(--{0})}}\n",
                               paint.name);
    }
    return fmt::format(
        ":root{{color-scheme:light;{}}}\n"
        "@media screen and (prefers-color-scheme:dark){{:root{{color-scheme:dark;{}}}}}\n{}",
        light, dark, classes);
}

}  // namespace ostraka
