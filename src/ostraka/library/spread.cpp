// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/spread.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr double kReach = 2.0;    // of a patch, in standard deviations of what it was made of
constexpr float kSteps = 127.0F;  // of a direction's largest coordinate

// Eight partial sums in a fixed order: the same bits whatever vectors the machine has.
OSTRAKA_VECTOR_CLONES float dot(const float* a, const float* b, std::size_t length) {
    std::array<float, 8> sums{};
    std::size_t i = 0;
    for (; i + 8 <= length; i += 8) {
        for (std::size_t lane = 0; lane < 8; ++lane) sums[lane] += a[i + lane] * b[i + lane];
    }
    for (; i < length; ++i) sums[i % 8] += a[i] * b[i];
    return ((sums[0] + sums[4]) + (sums[2] + sums[6])) +
           ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

template <class T>
std::vector<T> slice(const std::vector<T>& values, std::size_t first, std::size_t last) {
    return {values.begin() + static_cast<std::ptrdiff_t>(first),
            values.begin() + static_cast<std::ptrdiff_t>(last)};
}

void append_direction(const Eigen::VectorXd& direction, Spread& spread) {
    const double largest = direction.cwiseAbs().maxCoeff();
    const auto scale = static_cast<float>(largest / double{kSteps});
    spread.scales.push_back(scale);
    for (const double value : direction) {
        spread.directions.push_back(
            scale > 0.0F ? static_cast<std::int8_t>(std::lround(value / double{scale})) : 0);
    }
}

}  // namespace

void Spread::append(const Spread& other) {
    means.insert(means.end(), other.means.begin(), other.means.end());
    directions.insert(directions.end(), other.directions.begin(), other.directions.end());
    scales.insert(scales.end(), other.scales.begin(), other.scales.end());
}

Spread Spread::part(std::size_t first, std::size_t last, std::size_t length) const {
    if (empty()) return {};
    const std::size_t each = count(length);
    return {slice(means, first * length, last * length),
            slice(directions, first * each * length, last * each * length),
            slice(scales, first * each, last * each)};
}

void append_spread(std::span<const float> rows, std::size_t length, std::size_t count,
                   Spread& spread) {
    using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto row_count = static_cast<Eigen::Index>(rows.size() / length);
    const Eigen::Map<const RowMajor> matrix(rows.data(), row_count, static_cast<Eigen::Index>(length));
    Eigen::MatrixXd centered = matrix.cast<double>();
    const Eigen::RowVectorXd mean = centered.colwise().mean();
    centered.rowwise() -= mean;
    for (const double value : mean) spread.means.push_back(static_cast<float>(value));
    // The principal directions by way of the small matrix of scalar products between rows.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(centered * centered.transpose());
    for (std::size_t d = 0; d < count; ++d) {
        const Eigen::Index column = row_count - 1 - static_cast<Eigen::Index>(d);
        Eigen::VectorXd direction = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(length));
        // |centered^T u| is the root of the eigenvalue, which is `row_count` variances. Below
        // rounding there is no direction.
        if (column >= 0 && solver.eigenvalues()[column] > 1e-9) {
            direction = centered.transpose() * solver.eigenvectors().col(column) *
                        (kReach / std::sqrt(static_cast<double>(row_count)));
        }
        append_direction(direction, spread);
    }
}

SpreadIndex::SpreadIndex(const Spread& spread, std::size_t length)
    : length_(length), count_(spread.count(length)) {
    const std::size_t entries = spread.means.size() / length;
    vectors_.reserve(entries * (1 + count_) * length);
    for (std::size_t e = 0; e < entries; ++e) {
        const auto mean = spread.means.begin() + static_cast<std::ptrdiff_t>(e * length);
        vectors_.insert(vectors_.end(), mean, mean + static_cast<std::ptrdiff_t>(length));
        for (std::size_t d = 0; d < count_; ++d) {
            const std::size_t row = e * count_ + d;
            for (std::size_t i = 0; i < length; ++i) {
                vectors_.push_back(spread.scales[row] *
                                   static_cast<float>(spread.directions[row * length + i]));
            }
        }
    }
    for (std::size_t e = 0; e < entries; ++e) {
        const float* center = vectors_.data() + e * (1 + count_) * length;
        for (std::size_t v = 0; v <= count_; ++v) {
            const float* vector = center + v * length;
            squares_.push_back(dot(vector, vector, length));
            if (v > 0) offsets_.push_back(dot(center, vector, length));
        }
    }
}

std::vector<float> SpreadIndex::distances(std::span<const float> row) const {
    const std::size_t entries = squares_.size() / (1 + count_);
    const float row_square = dot(row.data(), row.data(), length_);
    std::vector<float> result(entries);
    for (std::size_t e = 0; e < entries; ++e) {
        const float* vectors = vectors_.data() + e * (1 + count_) * length_;
        float square =
            row_square + squares_[e * (1 + count_)] - 2.0F * dot(row.data(), vectors, length_);
        for (std::size_t d = 0; d < count_; ++d) {
            const float length2 = squares_[e * (1 + count_) + 1 + d];
            if (!(length2 > 0.0F)) continue;
            const float along = dot(row.data(), vectors + (1 + d) * length_, length_) -
                                offsets_[e * count_ + d];
            const float share = std::clamp(along / length2, -1.0F, 1.0F);
            square -= share * (2.0F * along - share * length2);
        }
        result[e] = std::sqrt(std::max(0.0F, square));
    }
    return result;
}

}  // namespace ostraka
