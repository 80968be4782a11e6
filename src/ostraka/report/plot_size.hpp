// SPDX-License-Identifier: Apache-2.0
// How large plots are drawn: two of half width fit side by side on a page.
#pragma once

namespace ostraka {

inline constexpr int kHalfPlot = 540;    ///< pixels: half of a page's width
inline constexpr int kWholePlot = 1120;  ///< pixels: a page's width

struct PlotSize {
    int width = kHalfPlot;  ///< pixels of the whole drawing, 240 to 4000
    int height = 250;       ///< pixels of the area that holds data, 60 to 4000; labels come on top
};

}  // namespace ostraka
