// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/encoding.hpp"

#include <gtest/gtest.h>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

TEST(Encoding, ComesBackToA64000thOfTheRadius) {
    MeshShape shape;
    shape.center = Vec3d(100.0, -20.0, 3.0);
    shape.radius = 50.0;
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const Vec3f point =
            Vec3d(shape.center + 50.0 * random.uniform() * random.direction()).cast<float>();
        const Vec3f back = decode_point(encode_point(point, shape), shape);
        EXPECT_LT((back - point).cwiseAbs().maxCoeff(), 50.0 / 64000.0 + 2e-5);
    }
}

TEST(Encoding, DecodedPointsEncodeToThemselves) {
    MeshShape shape;
    shape.radius = 0.123;
    for (std::int16_t value = -32000; value < 32000;
         value = static_cast<std::int16_t>(value + 777)) {
        const EncodedPoint code = {value, static_cast<std::int16_t>(-value), 5};
        EXPECT_EQ(encode_point(decode_point(code, shape), shape), code);
    }
}

}  // namespace
}  // namespace ostraka
