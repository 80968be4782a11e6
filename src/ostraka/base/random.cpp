// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/random.hpp"

#include <cmath>

namespace ostraka {
namespace {

std::uint64_t split_mix(std::uint64_t value) {
    value += 0x9e3779b97f4a7c15ULL;
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
    return value ^ (value >> 31);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t item)
    : state_(split_mix(seed ^ split_mix(item))), increment_(split_mix(item + seed) | 1U) {
    bits();
}

std::uint32_t Random::bits() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + increment_;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto rotation = static_cast<std::uint32_t>(old >> 59U);
    return (shifted >> rotation) | (shifted << ((32U - rotation) & 31U));
}

double Random::uniform() {
    const std::uint64_t high = bits() >> 5U;
    const std::uint64_t low = bits() >> 6U;
    return static_cast<double>(high * 67108864U + low) / 9007199254740992.0;
}

std::uint32_t Random::below(std::uint32_t count) {
    const std::uint32_t threshold = (0U - count) % count;
    for (;;) {
        const std::uint32_t value = bits();
        if (value >= threshold) return value % count;
    }
}

double Random::normal() {
    for (;;) {
        const double u = uniform(-1.0, 1.0);
        const double v = uniform(-1.0, 1.0);
        const double s = u * u + v * v;
        if (s > 0.0 && s < 1.0) return u * std::sqrt(-2.0 * std::log(s) / s);
    }
}

Vec3d Random::direction() {
    const double z = uniform(-1.0, 1.0);
    const double angle = uniform(0.0, 2.0 * kPi);
    const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

Mat3d Random::rotation() {
    const double u = uniform();
    const double a = uniform(0.0, 2.0 * kPi);
    const double b = uniform(0.0, 2.0 * kPi);
    const double p = std::sqrt(1.0 - u);
    const double q = std::sqrt(u);
    const Eigen::Quaterniond rotation(q * std::cos(b), p * std::sin(a), p * std::cos(a),
                                      q * std::sin(b));
    return rotation.normalized().toRotationMatrix();
}

}  // namespace ostraka
