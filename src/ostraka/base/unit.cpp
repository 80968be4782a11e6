// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/unit.hpp"

namespace ostraka {

std::string_view unit_name(Unit unit) {
    switch (unit) {
        case Unit::millimeter:
            return "mm";
        case Unit::centimeter:
            return "cm";
        case Unit::meter:
            return "m";
        case Unit::inch:
            return "in";
    }
    return "";
}

std::optional<Unit> parse_unit(std::string_view name) {
    for (const Unit unit : {Unit::millimeter, Unit::centimeter, Unit::meter, Unit::inch}) {
        if (name == unit_name(unit)) return unit;
    }
    return std::nullopt;
}

double meters_per(Unit unit) {
    switch (unit) {
        case Unit::millimeter:
            return 1e-3;
        case Unit::centimeter:
            return 1e-2;
        case Unit::meter:
            return 1.0;
        case Unit::inch:
            return 0.0254;
    }
    return 1.0;
}

double unit_factor(Unit from, Unit to) {
    return from == to ? 1.0 : meters_per(from) / meters_per(to);
}

}  // namespace ostraka
