// SPDX-License-Identifier: Apache-2.0
#include "ostraka/registration/plane_pairs.hpp"

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kLanes = 4;
constexpr std::size_t kColumns = 7;
static_assert(PlanePairs::kMost % kLanes == 0);

// Products of column A with itself and all after it: one column at a time, as the sums of all are
// more than there are registers.
template <std::size_t A>
__attribute__((always_inline)) inline void sum_column(const double* columns, std::size_t count,
                                                      double*& out) {
    std::array<Double4, kColumns - A> total{};
    for (std::size_t i = 0; i < count; i += kLanes) {
        Double4 own;
        load4(columns + A * PlanePairs::kMost + i, own);
        for (std::size_t b = 0; b < kColumns - A; ++b) {
            Double4 other;
            load4(columns + (A + b) * PlanePairs::kMost + i, other);
            total[b] += own * other;
        }
    }
    for (const Double4& lanes : total) *out++ = (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

// @param columns  kColumns of PlanePairs::kMost each. @param count  a multiple of kLanes.
OSTRAKA_VECTOR_CLONES
void sum_products(const double* columns, std::size_t count, double* out) {
    sum_column<0>(columns, count, out);
    sum_column<1>(columns, count, out);
    sum_column<2>(columns, count, out);
    sum_column<3>(columns, count, out);
    sum_column<4>(columns, count, out);
    sum_column<5>(columns, count, out);
    sum_column<6>(columns, count, out);
}

}  // namespace

Mat6d PlaneSums::left() const {
    Mat6d left;
    std::size_t s = 0;
    for (Eigen::Index a = 0; a < 6; ++a) {
        for (Eigen::Index b = a; b < 6; ++b) left(a, b) = left(b, a) = sums_[s++];
        ++s;  // the right side's
    }
    return left;
}

Vec6d PlaneSums::right() const {
    Vec6d right;
    std::size_t s = 0;
    for (Eigen::Index a = 0; a < 6; ++a) {
        s += static_cast<std::size_t>(6 - a);
        right[a] = -sums_[s++];
    }
    return right;
}

PlaneSums& PlaneSums::operator+=(const PlaneSums& other) {
    for (std::size_t s = 0; s < kSums; ++s) sums_[s] += other.sums_[s];
    pairs_ += other.pairs_;
    return *this;
}

Pose step_about(const Vec3d& pivot, const Vec3d& turn, const Vec3d& shift) {
    const double angle = turn.norm();
    Pose T_step = Pose::Identity();
    T_step.translate(Vec3d(pivot + shift));
    if (angle > 0.0) T_step.rotate(Eigen::AngleAxisd(angle, turn / angle));
    T_step.translate(Vec3d(-pivot));
    return T_step;
}

PlaneSums PlanePairs::take() {
    PlaneSums result;
    result.pairs_ = count_;
    std::size_t padded = count_;
    for (; padded % kLanes != 0; ++padded) {
        for (auto& column : columns_) column[padded] = 0.0;
    }
    sum_products(columns_[0].data(), padded, result.sums_.data());
    count_ = 0;
    return result;
}

}  // namespace ostraka
