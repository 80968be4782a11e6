// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/unit.hpp"

#include <gtest/gtest.h>

#include <array>

namespace ostraka {
namespace {

constexpr std::array kUnits = {Unit::millimeter, Unit::centimeter, Unit::meter, Unit::inch};

TEST(Unit, NamesAndParsingAreInverse) {
    for (const Unit unit : kUnits) {
        EXPECT_FALSE(unit_name(unit).empty());
        EXPECT_EQ(parse_unit(unit_name(unit)), unit);
    }
}

TEST(Unit, OtherTextIsNoUnit) {
    for (const char* text : {"", "MM", "mm ", "meter", "km", "\""}) {
        EXPECT_FALSE(parse_unit(text).has_value()) << text;
    }
}

TEST(Unit, FactorsAreTheDefinitions) {
    EXPECT_DOUBLE_EQ(unit_factor(Unit::meter, Unit::millimeter), 1000.0);
    EXPECT_DOUBLE_EQ(unit_factor(Unit::millimeter, Unit::meter), 0.001);
    EXPECT_DOUBLE_EQ(unit_factor(Unit::inch, Unit::millimeter), 25.4);
    EXPECT_DOUBLE_EQ(unit_factor(Unit::inch, Unit::centimeter), 2.54);
    EXPECT_DOUBLE_EQ(meters_per(Unit::centimeter), 0.01);
}

TEST(Unit, ThereAndBackIsOne) {
    for (const Unit from : kUnits) {
        EXPECT_EQ(unit_factor(from, from), 1.0);
        for (const Unit to : kUnits) {
            EXPECT_DOUBLE_EQ(unit_factor(from, to) * unit_factor(to, from), 1.0);
        }
    }
}

}  // namespace
}  // namespace ostraka
