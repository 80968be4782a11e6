// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/metric.hpp"

#include <array>
#include <cmath>

#include "ostraka/base/lane_sums.hpp"
#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr std::array<std::string_view, 4> kNames = {"l1", "l2", "chi_square", "hellinger"};
constexpr float kTiny = 1e-12F;  // where both bins are empty

float magnitude(float value) {
    return value < 0.0F ? -value : value;
}

OSTRAKA_VECTOR_CLONES float l1(const float* a, const float* b, std::size_t length) {
    return sum_in_lanes<8>(a, b, length, [](float x, float y) { return magnitude(x - y); });
}

OSTRAKA_VECTOR_CLONES float squared_l2(const float* a, const float* b, std::size_t length) {
    return sum_in_lanes<8>(a, b, length, [](float x, float y) { return (x - y) * (x - y); });
}

OSTRAKA_VECTOR_CLONES float chi_square(const float* a, const float* b, std::size_t length) {
    return sum_in_lanes<8>(a, b, length, [](float x, float y) {
        return (x - y) * (x - y) / (magnitude(x) + magnitude(y) + kTiny);
    });
}

}  // namespace

std::string_view metric_name(Metric metric) {
    return kNames[static_cast<std::size_t>(metric)];
}

std::optional<Metric> parse_metric(std::string_view name) {
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        if (kNames[i] == name) return static_cast<Metric>(i);
    }
    return std::nullopt;
}

Metric best_metric(const AnyDescriptor& descriptor) {
    const std::string_view name = descriptor_name(descriptor);
    return name == "rops" ? Metric::l2 : Metric::hellinger;
}

std::vector<float> comparable_row(std::span<const float> row, Metric metric) {
    double sum = 0.0;
    for (const float value : row) sum += std::abs(double{value});
    const double scale = sum > 0.0 ? 1.0 / sum : 0.0;
    std::vector<float> result(row.size());
    for (std::size_t i = 0; i < row.size(); ++i) {
        const double value = double{row[i]} * scale;
        const double rooted = std::copysign(std::sqrt(std::abs(value)), value);
        result[i] = static_cast<float>(metric == Metric::hellinger ? rooted : value);
    }
    return result;
}

float distance(std::span<const float> a, std::span<const float> b, Metric metric) {
    switch (metric) {
        case Metric::l1:
            return l1(a.data(), b.data(), a.size());
        case Metric::chi_square:
            return chi_square(a.data(), b.data(), a.size());
        case Metric::l2:
        case Metric::hellinger:
            break;
    }
    return std::sqrt(squared_l2(a.data(), b.data(), a.size()));
}

}  // namespace ostraka
