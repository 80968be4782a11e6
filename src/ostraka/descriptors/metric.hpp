// SPDX-License-Identifier: Apache-2.0
// Distances between descriptor rows, and which one suits which descriptor.
// Cha. Comprehensive Survey on Distance/Similarity Measures between Probability Density Functions.
// Int. J. Math. Models and Methods in Applied Sciences 1(4), 2007.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "ostraka/descriptors/descriptor.hpp"

namespace ostraka {

/// Of rows scaled to an absolute sum of 1.
enum class Metric {
    l1,          ///< sum of |a - b|
    l2,          ///< root of the sum of (a - b)^2
    chi_square,  ///< sum of (a - b)^2 / (|a| + |b|)
    hellinger,   ///< L2 between signed square roots: weighs a bin's relative error, not its size
};

/// "l1", "l2", "chi_square", "hellinger".
std::string_view metric_name(Metric metric);
std::optional<Metric> parse_metric(std::string_view name);

/// The metric that recognized most segments with this descriptor in our measurements (protocol S,
/// BENCHMARK.md).
Metric best_metric(const AnyDescriptor& descriptor);

/// A row made ready for distance(): scaled to an absolute sum of 1 and, for Hellinger, rooted.
/// A row of zeros stays one.
std::vector<float> comparable_row(std::span<const float> row, Metric metric);

/// @param a,b  comparable_row()s of equal length.
/// @return the same bits on every machine.
float distance(std::span<const float> a, std::span<const float> b, Metric metric);

}  // namespace ostraka
