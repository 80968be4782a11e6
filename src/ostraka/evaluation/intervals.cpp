// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/intervals.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

// `value` of the items as they are, and of `draws` samples of as many items with repetition; NaN
// where it isn't defined.
Interval resample(std::size_t count, std::uint64_t seed, int draws,
                  const std::function<double(std::span<const std::uint32_t>)>& value) {
    std::vector<std::uint32_t> items(count);
    for (std::uint32_t i = 0; i < count; ++i) items[i] = i;
    Interval interval{.value = value(items)};
    if (std::isnan(interval.value)) return {};
    std::vector<double> values;
    for (int draw = 0; draw < std::max(1, draws); ++draw) {
        Random random(seed, static_cast<std::uint64_t>(draw));
        for (std::uint32_t& item : items) item = random.below(static_cast<std::uint32_t>(count));
        // A draw in which nothing was to be found says nothing.
        if (const double drawn = value(items); !std::isnan(drawn)) values.push_back(drawn);
    }
    if (values.empty()) values.push_back(interval.value);
    std::sort(values.begin(), values.end());
    const std::size_t tail = values.size() / 40;  // 2.5 %
    interval.low = values[tail];
    interval.high = values[values.size() - 1 - tail];
    return interval;
}

}  // namespace

Interval bootstrap_ratio(std::span<const double> parts, std::span<const double> wholes,
                         std::uint64_t seed, int draws) {
    const auto ratio = [&](std::span<const std::uint32_t> items) {
        double part = 0.0;
        double whole = 0.0;
        for (const std::uint32_t i : items) {
            part += parts[i];
            whole += wholes[i];
        }
        return whole > 0.0 ? part / whole : std::numeric_limits<double>::quiet_NaN();
    };
    if (parts.empty()) return {};
    return resample(parts.size(), seed, draws, ratio);
}

double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

Interval bootstrap_median(std::span<const double> values, std::uint64_t seed, int draws) {
    if (values.empty()) return {};
    return resample(values.size(), seed, draws, [&](std::span<const std::uint32_t> items) {
        std::vector<double> drawn;
        drawn.reserve(items.size());
        for (const std::uint32_t i : items) drawn.push_back(values[i]);
        return median(std::move(drawn));
    });
}

}  // namespace ostraka
