// SPDX-License-Identifier: Apache-2.0
// Private to simulation: one builder for each kind of part, and what builders share.
// Lengths are in mm. Walls are at least 3 mm and holes 5 mm wide, so that 96 cells resolve them.
#pragma once

#include <algorithm>
#include <cstdint>

#include "ostraka/base/random.hpp"
#include "ostraka/simulation/solid.hpp"

namespace ostraka {

/// Draws the dimensions of a part. Draw into named constants, one after another: the order of draws
/// is part of the result.
class Variation {
  public:
    explicit Variation(std::uint64_t seed) : random_(seed), nominal_(seed == 0) {}
    /// `value` for the nominal part, else uniform in [low, high).
    double length(double value, double low, double high) {
        return nominal_ ? value : random_.uniform(low, high);
    }
    /// `value` for the nominal part, else uniform in {low, ..., high}.
    int count(int value, int low, int high) {
        if (nominal_) return value;
        return low + static_cast<int>(random_.below(static_cast<std::uint32_t>(high - low + 1)));
    }

  private:
    Random random_;
    bool nominal_;
};

inline Solid at(const Solid& solid, double x, double y, double z) {
    return moved(solid, Vec3d(x, y, z));
}
/// Turns the z axis into the x axis (and x into -z).
inline Solid along_x(const Solid& solid) {
    return rotated(solid, Vec3d::UnitY(), kPi / 2.0);
}
/// Turns the z axis into the y axis (and y into -z).
inline Solid along_y(const Solid& solid) {
    return rotated(solid, Vec3d::UnitX(), -kPi / 2.0);
}
inline Solid turned_z(const Solid& solid, double angle) {
    return rotated(solid, Vec3d::UnitZ(), angle);
}
/// A cylinder that stands on z = low and ends at z = high.
inline Solid post(double radius, double low, double high) {
    return at(cylinder(radius, high - low), 0.0, 0.0, 0.5 * (low + high));
}
/// A block between two corners.
inline Solid block(double x0, double x1, double y0, double y1, double z0, double z1) {
    return at(box({x1 - x0, y1 - y0, z1 - z0}), 0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * (z0 + z1));
}
/// Cylinders through z in [-depth / 2, depth / 2], on a circle, the first at `angle`.
inline Solid bolt_circle(int count, double circle_radius, double hole_radius, double depth,
                         double angle = 0.0) {
    return turned_z(circular(at(cylinder(hole_radius, depth), circle_radius, 0.0, 0.0), count),
                    angle);
}

// Turned parts.
Solid build_flange(Variation& vary);
Solid build_gear(Variation& vary);
Solid build_bolt(Variation& vary);
Solid build_pulley(Variation& vary);
Solid build_knob(Variation& vary);
Solid build_stepped_shaft(Variation& vary);
Solid build_impeller(Variation& vary);
// Parts that lead a fluid.
Solid build_elbow(Variation& vary);
Solid build_tee(Variation& vary);
Solid build_valve_body(Variation& vary);
Solid build_manifold_block(Variation& vary);
Solid build_pump_housing(Variation& vary);
// Parts that move.
Solid build_hook(Variation& vary);
Solid build_clevis(Variation& vary);
Solid build_crank(Variation& vary);
Solid build_cam(Variation& vary);
Solid build_wing_nut(Variation& vary);
Solid build_fork(Variation& vary);
Solid build_connecting_rod(Variation& vary);
// Parts that hold.
Solid build_l_bracket(Variation& vary);
Solid build_bearing_block(Variation& vary);
Solid build_heat_sink(Variation& vary);

}  // namespace ostraka
