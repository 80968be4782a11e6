// SPDX-License-Identifier: Apache-2.0
// Parts that hold others: brackets, blocks, plates.
#include <cmath>
#include <vector>

#include "ostraka/simulation/part_builders.hpp"

namespace ostraka {

// Angle bracket: base, wall, a rib off the middle, two unequal holes and a slot. No symmetry.
Solid build_l_bracket(Variation& vary) {
    const double length = vary.length(80.0, 66.0, 92.0);
    const double width = vary.length(52.0, 44.0, 60.0);
    const double height = vary.length(62.0, 50.0, 74.0);
    const double base = vary.length(9.0, 7.0, 11.0);
    const double wall = vary.length(8.0, 6.5, 10.0);
    const double rib = vary.length(7.0, 6.0, 9.0);
    const double shift = vary.length(9.0, 5.0, 12.0);
    const double hole = vary.length(5.5, 4.5, 6.5);
    const double slot = vary.length(16.0, 10.0, 20.0);
    const double h = width / 2.0;
    Solid body = smooth_unite(block(0.0, length, -h, h, 0.0, base),
                              block(0.0, wall, -h, h, 0.0, height), 5.0);
    body = intersect(body, block(0.0, length, -h, h, 0.0, height));
    const std::vector<Vec2d> profile{{wall - 1.0, -base + 1.0},
                                     {0.62 * length, -base + 1.0},
                                     {0.62 * length, -base - 2.0},
                                     {wall + 3.0, -0.82 * height},
                                     {wall - 1.0, -0.82 * height}};
    // Drawn in (x, -z), then stood up: along_y turns the drawing's y into -z.
    body = unite({body, at(along_y(extruded(profile, rib)), 0.0, shift, 0.0)});
    const double low_y = 0.5 * (-h + shift - rib / 2.0);
    const double high_y = 0.5 * (h + shift + rib / 2.0);
    body = subtract(body, at(cylinder(hole, 100.0), 0.72 * length, low_y, 0.0));
    body = subtract(body, at(cylinder(0.65 * hole + 0.5, 100.0), 0.5 * length, high_y, 0.0));
    const Solid groove = rotated(along_x(link(3.6, 3.6, slot, 100.0)), Vec3d::UnitX(), 0.0);
    body = subtract(body, at(groove, 0.0, low_y, height - 9.0));
    // One upper corner is cut.
    const Solid corner =
        at(rotated(box({100.0, 20.0, 20.0}), Vec3d::UnitX(), kPi / 4.0), 0.0, h, height);
    return subtract(body, corner);
}

// Pillow block: foot with slots, housing with a bore, a collar on one face, a grease boss beside
// the top. No symmetry.
Solid build_bearing_block(Variation& vary) {
    const double length = vary.length(112.0, 98.0, 124.0);
    const double depth = vary.length(34.0, 28.0, 40.0);
    const double foot = vary.length(13.0, 10.0, 16.0);
    const double axis = vary.length(36.0, 33.0, 40.0);
    const double housing = vary.length(28.0, 25.0, 31.0);
    const double bore = vary.length(16.0, 13.0, 18.0);
    const double slot = vary.length(7.0, 4.0, 10.0);
    const double boss_angle = vary.length(0.55, 0.4, 0.9);  // from the top, radians
    const double h = length / 2.0;
    const Solid base = block(-h, h, -depth / 2.0, depth / 2.0, 0.0, foot);
    Solid body =
        smooth_unite(base, at(along_y(cylinder(housing, depth - 6.0)), 0.0, 0.0, axis), 7.0);
    body = unite({body, block(-housing + 2.0, housing - 2.0, -depth / 2.0 + 3.0, depth / 2.0 - 3.0,
                              1.0, axis)});
    body = unite({body, at(along_y(cylinder(bore + 6.0, 10.0)), 0.0, depth / 2.0 - 1.0, axis)});
    const Solid boss = rotated(post(5.5, 0.0, housing + 6.0), Vec3d::UnitY(), boss_angle);
    body = unite({body, at(boss, 0.0, 0.0, axis)});
    const Solid nipple = rotated(post(2.6, 0.0, 2.0 * housing), Vec3d::UnitY(), boss_angle);
    body = subtract(body, at(nipple, 0.0, 0.0, axis));
    body = intersect(body, half_space(-Vec3d::UnitZ(), 0.0));
    body = subtract(body, at(along_y(cylinder(bore, 300.0)), 0.0, 0.0, axis));
    body = subtract(body, at(along_y(post(bore + 3.0, depth / 2.0, 200.0)), 0.0, 0.0, axis));
    const Solid hole = at(link(5.0, 5.0, slot, 100.0), h - 11.0 - slot, 0.0, 0.0);
    body = subtract(body, with_mirror(hole, 0));
    return subtract(body, block(-18.0, 18.0, -100.0, 100.0, -1.0, 3.5));
}

// Heat sink: plate with fins, some of them cut away for a transistor, ears with holes. No symmetry.
Solid build_heat_sink(Variation& vary) {
    const int fins = vary.count(8, 6, 9);
    const double pitch = vary.length(9.0, 8.0, 10.0);
    const double thickness = vary.length(3.4, 3.0, 4.0);
    const double depth = vary.length(58.0, 48.0, 70.0);
    const double height = vary.length(34.0, 24.0, 42.0);
    const double plate = vary.length(6.0, 5.0, 8.0);
    const double cut = vary.length(0.45, 0.3, 0.6);
    const double width = pitch * (fins - 1) + thickness;
    std::vector<Solid> parts{block(-9.0, width + 9.0, 0.0, depth, 0.0, plate)};
    for (int i = 0; i < fins; ++i) {
        // Fins get lower toward the far side.
        const double top = height * (1.0 - 0.035 * i);
        parts.push_back(block(pitch * i, pitch * i + thickness, 0.0, depth, 0.5 * plate, top));
    }
    Solid body = unite(parts);
    const double left = pitch * 2.0 - 0.5 * (pitch - thickness);
    const double right = pitch * 4.0 + 0.5 * (pitch + thickness);
    body = subtract(body, block(left, right, depth * (1.0 - cut), 200.0, plate, 200.0));
    body = subtract(body,
                    at(cylinder(2.8, 100.0), 0.5 * (left + right), depth * (1.0 - 0.4 * cut), 0.0));
    body = subtract(body, at(cylinder(2.6, 100.0), -4.6, 9.0, 0.0));
    body = subtract(body, at(cylinder(2.6, 100.0), width + 4.6, depth - 9.0, 0.0));
    return subtract(body, block(-20.0, -1.0, depth - 18.0, 200.0, -1.0, 100.0));
}

}  // namespace ostraka
