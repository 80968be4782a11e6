// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/chart_frame.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ostraka/base/error.hpp"
#include "ostraka/report/label_text.hpp"

namespace ostraka {
namespace {

constexpr double kTitleSize = 14.0;
constexpr double kTitleLine = 18.0;
constexpr double kLabelSize = 12.0;
constexpr double kTickSize = 11.5;
constexpr double kLegendLine = 20.0;
constexpr double kMark = 26.0;  // room for a legend's mark
constexpr double kGap = 18.0;   // between entries
constexpr double kPad = 10.0;

double entry_width(const LegendEntry& entry) {
    return kMark + label_width(entry.name, kLabelSize);
}

// The x of each entry and its row, if they are set in rows below the chart.
struct LegendPlace {
    double x = 0.0;
    int row = 0;
};

std::vector<LegendPlace> rows_below(const std::vector<LegendEntry>& legend, double left,
                                    double right) {
    std::vector<LegendPlace> places;
    LegendPlace next{left, 0};
    for (const LegendEntry& entry : legend) {
        const double width = std::min(entry_width(entry), right - left);
        if (next.x > left && next.x + width > right) next = {left, next.row + 1};
        places.push_back(next);
        next.x += width + kGap;
    }
    return places;
}

double legend_column(const std::vector<LegendEntry>& legend, double most) {
    double width = 0.0;
    for (const LegendEntry& entry : legend) width = std::max(width, entry_width(entry));
    return std::min(width + 2.0, most);
}

double tick_column(const PlotAxis& axis) {
    double width = 0.0;
    for (const double tick : axis.ticks) {
        width = std::max(width, label_width(axis.label(tick), kTickSize));
    }
    return width;
}

void draw_entry(SvgCanvas& canvas, const LegendEntry& entry, Dot at, double room) {
    const double middle = at.x + 9.0;
    switch (entry.kind) {
        case LegendEntry::Kind::kLine:
            canvas.line(at, {at.x + 18.0, at.y}, {entry.paint, 2.0, series_dash(entry.series)});
            canvas.shape(marker_path(entry.series, {middle, at.y}, 3.4), *entry.paint, 1.0, 1.0);
            break;
        case LegendEntry::Kind::kBar:
            canvas.rectangle({at.x + 3.0, at.y - 6.0}, 12.0, 12.0, *entry.paint);
            break;
        case LegendEntry::Kind::kReference:
            canvas.line(at, {at.x + 18.0, at.y}, {entry.paint, 1.5, "5 3"});
            break;
    }
    const std::string shown = shortened_label(entry.name, kLabelSize, room - kMark);
    TextStyle style;
    style.size = kLabelSize;
    if (shown != entry.name) style.hint = entry.name;
    canvas.text({at.x + kMark, at.y}, shown, style);
}

// Returns the height it takes below `top`.
double draw_legend(SvgCanvas& canvas, const ChartFrame& frame, const ChartLayout& layout,
                   double top) {
    if (frame.legend.empty()) return 0.0;
    if (layout.legend_right) {
        const double x = layout.right + kGap;
        for (std::size_t i = 0; i < frame.legend.size(); ++i) {
            const double y = layout.top + kLegendLine * (double(i) + 0.5);
            draw_entry(canvas, frame.legend[i], {x, y}, layout.width - x);
        }
        return 0.0;
    }
    const std::vector<LegendPlace> places = rows_below(frame.legend, layout.left, layout.width);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Dot at{places[i].x, top + kPad + kLegendLine * (places[i].row + 0.5)};
        draw_entry(canvas, frame.legend[i], at, layout.width - at.x);
    }
    return kPad + kLegendLine * (places.back().row + 1);
}

void check_size(const PlotSize& size) {
    if (size.width < 240 || size.width > 4000 || size.height < 60 || size.height > 4000) {
        throw InvalidInput(fmt::format("plot: size {} x {}", size.width, size.height));
    }
}

}  // namespace

const char* series_dash(std::size_t series) {
    constexpr const char* kDashes[] = {"", "7 3", "2 3", "9 3 2 3"};
    return kDashes[series / kSeriesPaints.size() % 4];
}

ChartLayout lay_out(const ChartFrame& frame) {
    check_size(frame.size);
    ChartLayout layout;
    layout.width = frame.size.width;
    layout.left = tick_column(frame.y) + 8.0;
    const double most = 0.4 * layout.width;
    const double column = frame.legend.empty() ? 0.0 : kGap + legend_column(frame.legend, most);
    const std::vector<LegendPlace> places = rows_below(frame.legend, layout.left, layout.width);
    layout.legend_right = frame.square || (!places.empty() && places.back().row > 1);
    // Half of the last tick's label may stand out at the right.
    layout.right = layout.width - (layout.legend_right ? column : 0.0) - 16.0;
    if (frame.square && layout.right - layout.left > frame.size.height) {
        layout.right = layout.left + frame.size.height;
    }
    if (!frame.title.empty()) {
        layout.title = wrapped_label(frame.title, kTitleSize, layout.width, 2);
    }
    layout.top = kPad + kTitleLine * double(layout.title.size());
    if (!frame.y_label.empty()) layout.top += 20.0;
    layout.top += frame.headroom;
    layout.bottom = layout.top + frame.size.height;
    if (frame.square) {
        layout.bottom = layout.top + (layout.right - layout.left);
        layout.width = layout.right + std::max(column, 16.0);
    }
    return layout;
}

void draw_frame(SvgCanvas& canvas, const ChartFrame& frame, const ChartLayout& layout) {
    double y = 0.5 * kTitleLine;
    for (const std::string& line : layout.title) {
        canvas.text({0.0, y}, line, {.size = kTitleSize, .bold = true});
        y += kTitleLine;
    }
    if (!frame.y_label.empty()) {
        const std::string label = shortened_label(frame.y_label, kLabelSize, layout.width);
        canvas.text({0.0, y + 2.0}, label, {.size = kLabelSize, .paint = &kQuiet});
    }
    for (const double tick : frame.y.ticks) {
        const double at = layout.y(frame.y, tick);
        canvas.line({layout.left, at}, {layout.right, at}, {&kGrid});
        canvas.text({layout.left - 8.0, at}, frame.y.label(tick),
                    {.size = kTickSize, .paint = &kQuiet, .anchor = TextAnchor::kEnd});
    }
}

double draw_x_axis(SvgCanvas& canvas, const ChartLayout& layout, const PlotAxis& axis) {
    canvas.line({layout.left, layout.bottom}, {layout.right, layout.bottom}, {&kAxisLine});
    for (const double tick : axis.ticks) {
        const double at = layout.x(axis, tick);
        canvas.line({at, layout.bottom}, {at, layout.bottom + 5.0}, {&kAxisLine});
        canvas.text({at, layout.bottom + 14.0}, axis.label(tick),
                    {.size = kTickSize, .paint = &kQuiet, .anchor = TextAnchor::kMiddle});
    }
    return 22.0;
}

std::string finish_chart(SvgCanvas& canvas, const ChartFrame& frame, const ChartLayout& layout,
                         double labels) {
    double y = layout.bottom + labels;
    if (!frame.x_label.empty()) {
        const double room = layout.legend_right ? layout.right - layout.left : layout.width;
        const std::string label = shortened_label(frame.x_label, kLabelSize, room);
        canvas.text({0.5 * (layout.left + layout.right), y + 9.0}, label,
                    {.size = kLabelSize, .paint = &kQuiet, .anchor = TextAnchor::kMiddle});
        y += 18.0;
    }
    y += draw_legend(canvas, frame, layout, y);
    if (layout.legend_right) {
        y = std::max(y, layout.top + kLegendLine * double(frame.legend.size()));
    }
    return canvas.svg(layout.width, y + 4.0, frame.title);
}

std::string draw_no_data(std::string_view title, const PlotSize& size) {
    check_size(size);
    SvgCanvas canvas;
    const double width = size.width;
    double top = kPad;
    if (!title.empty()) {
        canvas.text({0.0, 0.5 * kTitleLine}, shortened_label(title, kTitleSize, width),
                    {.size = kTitleSize, .bold = true});
        top += kTitleLine;
    }
    canvas.rectangle({0.0, top}, width, size.height, kPlate);
    canvas.text({0.5 * width, top + 0.5 * size.height}, "no data",
                {.size = kLabelSize, .paint = &kQuiet, .anchor = TextAnchor::kMiddle});
    return canvas.svg(width, top + size.height + 4.0, title);
}

}  // namespace ostraka
