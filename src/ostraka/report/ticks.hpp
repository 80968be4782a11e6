// SPDX-License-Identifier: Apache-2.0
// Internal to report: an axis' range, its ticks at steps of 1, 2 or 5 times a power of ten, and
// their labels.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ostraka {

/// False for values that no plot shows: not finite, or beyond 1e100.
bool is_plottable(double value);

/// The range of values seen so far.
struct PlotRange {
    double low = 0.0;
    double high = 0.0;
    bool empty = true;

    /// Values that aren't plottable change nothing.
    void include(double value);
};

struct PlotAxis {
    double low = 0.0;
    double high = 1.0;
    double step = 0.2;
    std::vector<double> ticks;  ///< ascending multiples of the step from low to high
    bool percent = false;       ///< labels show hundredths: 0.5 is "50 %"

    /// A place within the range: 0 at low, 1 at high.
    double share(double value) const { return (value - low) / (high - low); }
    std::string label(double tick) const;
};

/// The step for about `count` ticks over a span: 1, 2 or 5 times a power of ten.
double nice_step(double span, int count);

/// @param fixed  the axis' exact range; none, or one that can't be: the data's, rounded outward to
///               whole steps and, if it is a single value, widened.
PlotAxis make_axis(const PlotRange& data, const std::optional<std::pair<double, double>>& fixed,
                   bool percent, int count = 5);

/// A number with as many decimals as the step between its neighbors asks for.
std::string tick_label(double value, double step, bool percent);

/// A value as a hint or a bar's label shows it: "0.942", "94.2 %", "1250".
std::string value_label(double value, bool percent);

}  // namespace ostraka
