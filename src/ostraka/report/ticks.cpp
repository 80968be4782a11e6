// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr double kSlack = 1e-9;  // of a step, so that 0.3 / 0.1 counts as 3

PlotAxis widened(PlotAxis axis) {
    const double size = std::max(std::abs(axis.low), std::abs(axis.high));
    if (axis.high - axis.low > std::max(1e-9 * size, 1e-100)) return axis;
    const double margin = size > 1e-90 ? 0.1 * size : 0.5;
    axis.low -= margin;
    axis.high += margin;
    return axis;
}

bool is_range(const std::optional<std::pair<double, double>>& range) {
    return range && is_plottable(range->first) && is_plottable(range->second) &&
           range->first < range->second;
}

std::string fixed_point(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", value, decimals);
    if (text.find_first_not_of("-0.") == std::string::npos && text.front() == '-') text.erase(0, 1);
    return text;
}

}  // namespace

bool is_plottable(double value) {
    return std::abs(value) < 1e100;  // false for NaN, too
}

void PlotRange::include(double value) {
    if (!is_plottable(value)) return;
    low = empty ? value : std::min(low, value);
    high = empty ? value : std::max(high, value);
    empty = false;
}

double nice_step(double span, int count) {
    const double rough = span / count;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0}) {
        // The nearest of the steps on a logarithmic scale.
        if (rough <= factor * power * std::sqrt(factor == 2.0 ? 2.5 : 2.0)) return factor * power;
    }
    return 10.0 * power;
}

PlotAxis make_axis(const PlotRange& data, const std::optional<std::pair<double, double>>& fixed,
                   bool percent, int count) {
    PlotAxis axis;
    axis.percent = percent;
    const bool exact = is_range(fixed);
    if (exact) {
        axis.low = fixed->first;
        axis.high = fixed->second;
    } else if (!data.empty) {
        axis.low = data.low;
        axis.high = data.high;
    }
    axis = widened(axis);
    axis.step = nice_step(axis.high - axis.low, count);
    const double first = axis.low / axis.step;
    const double last = axis.high / axis.step;
    const double begin = exact ? std::ceil(first - kSlack) : std::floor(first + kSlack);
    const double end = exact ? std::floor(last + kSlack) : std::ceil(last - kSlack);
    // Steps below one are divided by their inverse: 3 / 10 is 0.3, 3 * 0.1 isn't.
    const double inverse = std::round(1.0 / axis.step);
    const auto multiple = [&](double k) { return axis.step < 1.0 ? k / inverse : k * axis.step; };
    const int ticks = static_cast<int>(end - begin) + 1;
    for (int k = 0; k < ticks; ++k) axis.ticks.push_back(multiple(begin + k));
    if (!exact) {
        axis.low = axis.ticks.front();
        axis.high = axis.ticks.back();
    }
    return axis;
}

std::string PlotAxis::label(double tick) const {
    return tick_label(tick, step, percent);
}

std::string tick_label(double value, double step, bool percent) {
    const double shown = percent ? 100.0 * value : value;
    const double shown_step = percent ? 100.0 * step : step;
    const double size = std::max(std::abs(shown), shown_step);
    const char* unit = percent ? " %" : "";
    if (size >= 1e7 || shown_step < 1e-5) {
        return fmt::format("{:.6g}{}", std::abs(shown) < 1e-6 * shown_step ? 0.0 : shown, unit);
    }
    const double digits = -std::floor(std::log10(shown_step) + kSlack);
    return fixed_point(shown, std::clamp(static_cast<int>(digits), 0, 6)) + unit;
}

std::string value_label(double value, bool percent) {
    if (!is_plottable(value)) return "none";
    if (percent) return fixed_point(100.0 * value, 1) + " %";
    const double size = std::abs(value);
    if (size >= 1e7 || (size > 0.0 && size < 1e-4)) return fmt::format("{:.3g}", value);
    const int decimals = size >= 100.0 ? 0 : size >= 10.0 ? 1 : size >= 1.0 ? 2 : 3;
    return value == std::round(value) ? fixed_point(value, 0) : fixed_point(value, decimals);
}

}  // namespace ostraka
