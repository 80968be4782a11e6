// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/spread.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>

#include "ostraka/base/lane_sums.hpp"
#include "ostraka/base/vector_clones.hpp"

#if OSTRAKA_HAS_AVX2_CLONES
#include <immintrin.h>
#endif

namespace ostraka {
namespace {

constexpr double kReach = 2.0;    // of a patch, in standard deviations of what it was made of
constexpr float kSteps = 127.0F;  // of a direction's largest coordinate

OSTRAKA_VECTOR_CLONES float dot(const float* a, const float* b, std::size_t length) {
    return sum_in_lanes<16>(a, b, length, [](float x, float y) { return x * y; });
}

OSTRAKA_DEFAULT_CLONE
float dot_bytes(const float* a, const std::int8_t* b, std::size_t length) {
    return sum_in_lanes<16>(a, b, length,
                            [](float x, std::int8_t y) { return x * static_cast<float>(y); });
}

#if OSTRAKA_HAS_AVX2_CLONES
// The same to the bit. Compilers widen bytes by half a vector at a time.
OSTRAKA_AVX2_CLONE
float dot_bytes(const float* a, const std::int8_t* b, std::size_t length) {
    __m256 low = _mm256_setzero_ps();
    __m256 high = low;
    std::size_t i = 0;
    for (; i + 16 <= length; i += 16) {
        __m128i bytes;
        std::memcpy(&bytes, b + i, sizeof(bytes));
        const __m256 first = _mm256_cvtepi32_ps(_mm256_cvtepi8_epi32(bytes));
        const __m256 second = _mm256_cvtepi32_ps(_mm256_cvtepi8_epi32(_mm_srli_si128(bytes, 8)));
        low = _mm256_add_ps(low, _mm256_mul_ps(_mm256_loadu_ps(a + i), first));
        high = _mm256_add_ps(high, _mm256_mul_ps(_mm256_loadu_ps(a + i + 8), second));
    }
    std::array<float, 16> lanes;
    _mm256_storeu_ps(lanes.data(), low);
    _mm256_storeu_ps(lanes.data() + 8, high);
    for (; i < length; ++i) lanes[i % lanes.size()] += a[i] * static_cast<float>(b[i]);
    return sum_of_lanes(lanes);
}
#endif

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
    const Eigen::Map<const RowMajor> matrix(rows.data(), row_count,
                                            static_cast<Eigen::Index>(length));
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
    : length_(length), count_(spread.count(length)), spread_(&spread) {
    const std::size_t entries = spread.means.size() / length;
    for (std::size_t e = 0; e < entries; ++e) {
        const float* mean = spread_->means.data() + e * length;
        mean_squares_.push_back(dot(mean, mean, length));
        for (std::size_t d = 0; d < count_; ++d) {
            const std::int8_t* bytes = spread_->directions.data() + (e * count_ + d) * length;
            const float scale = spread_->scales[e * count_ + d];
            const int square = std::inner_product(bytes, bytes + length, bytes, 0);
            squares_.push_back(scale * scale * static_cast<float>(square));
            offsets_.push_back(scale * dot_bytes(mean, bytes, length));
        }
    }
}

std::vector<float> SpreadIndex::distances(std::span<const float> row) const {
    std::vector<float> result(mean_squares_.size());
    const float row_square = dot(row.data(), row.data(), length_);
    for (std::size_t e = 0; e < result.size(); ++e) {
        const float* mean = spread_->means.data() + e * length_;
        float square = row_square + mean_squares_[e] - 2.0F * dot(row.data(), mean, length_);
        for (std::size_t k = e * count_; k < (e + 1) * count_; ++k) {
            if (!(squares_[k] > 0.0F)) continue;
            const std::int8_t* direction = spread_->directions.data() + k * length_;
            const float along =
                spread_->scales[k] * dot_bytes(row.data(), direction, length_) - offsets_[k];
            const float share = std::clamp(along / squares_[k], -1.0F, 1.0F);
            square -= share * (2.0F * along - share * squares_[k]);
        }
        result[e] = std::sqrt(std::max(0.0F, square));
    }
    return result;
}

}  // namespace ostraka
