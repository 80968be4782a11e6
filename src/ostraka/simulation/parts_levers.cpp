// SPDX-License-Identifier: Apache-2.0
// Parts that move or carry: hooks, levers, cams, forks, rods.
#include <array>
#include <cmath>
#include <vector>

#include "ostraka/simulation/part_builders.hpp"

namespace ostraka {

// Crane hook with a threaded-looking shank and a flat on one cheek. One mirror plane, save for the
// flat.
Solid build_hook(Variation& vary) {
    const double bend = vary.length(24.0, 21.0, 28.0);
    const double body = vary.length(10.5, 9.0, 12.0);
    const double tip = vary.length(5.5, 4.5, 6.5);
    const double neck = vary.length(7.5, 6.5, 8.5);
    const double shank = vary.length(34.0, 26.0, 42.0);
    const double opening = vary.length(0.75, 0.55, 0.95);  // radians left open before the tip
    // The bend's center is the origin; the shank stands on its axis, along +y. From the neck the
    // bar swings out to the left, around and up to the tip on the right.
    std::vector<SweepBall> balls;
    const double start = bend + 14.0;
    balls.push_back({Vec3d(0.0, start + 6.0, 0.0), neck + 1.5});
    constexpr int kSteps = 40;
    const double first = kPi * 0.5 + 0.35;
    const double last = 2.0 * kPi + 0.35 * kPi - opening;
    for (int i = 0; i <= kSteps; ++i) {
        const double t = static_cast<double>(i) / kSteps;
        const double angle = first + (last - first) * t;
        const double thick =
            neck + 1.5 + (body - neck - 1.5) * std::sin(std::min(1.0, 1.6 * t) * kPi / 2.0);
        const double taper = t < 0.55 ? 0.0 : (t - 0.55) / 0.45;
        const double radius = thick + (tip - thick) * std::pow(taper, 1.4);
        balls.push_back({Vec3d(bend * std::cos(angle), bend * std::sin(angle), 0.0), radius});
    }
    // The tip bends outward a little.
    const Vec3d end = balls.back().center;
    balls.push_back({end + Vec3d(3.5, 6.0, 0.0), tip * 0.85});
    Solid hook = swept(balls);
    // Cheeks are flattened, one more than the other.
    hook = intersect(hook, half_space(Vec3d::UnitZ(), 0.82 * body));
    hook = intersect(hook, half_space(-Vec3d::UnitZ(), 0.95 * body));
    // Shank with grooves instead of a thread.
    std::vector<Vec2d> outline{{0.0, start}, {neck, start}};
    const double top = start + shank;
    for (double z = start + 12.0; z + 6.0 < top; z += 5.0) {
        outline.emplace_back(neck, z);
        outline.emplace_back(neck - 1.4, z + 1.2);
        outline.emplace_back(neck - 1.4, z + 2.2);
        outline.emplace_back(neck, z + 3.4);
    }
    outline.emplace_back(neck, top - 1.5);
    outline.emplace_back(neck - 1.5, top);
    outline.emplace_back(0.0, top);
    const Solid collar = at(along_y(cylinder(neck + 4.0, 6.0)), 0.0, start + 3.0, 0.0);
    return unite({hook, along_y(revolved(outline)), collar});
}

// Clevis: two ears with a pin hole, a round shank with a hole along it. A boss on one ear and a
// shorter other ear leave one mirror plane.
Solid build_clevis(Variation& vary) {
    const double ear = vary.length(15.0, 13.0, 18.0);
    const double gap = vary.length(18.0, 14.0, 22.0);
    const double wall = vary.length(8.0, 6.5, 9.5);
    const double reach = vary.length(40.0, 32.0, 48.0);
    const double shank = vary.length(11.0, 9.5, 13.0);
    const double length = vary.length(38.0, 28.0, 48.0);
    const double pin = vary.length(6.0, 5.0, 7.5);
    const double boss = vary.length(5.0, 3.5, 7.0);
    const double width = gap + 2.0 * wall;
    // Ears run along +x, pin along z.
    Solid body = at(rotated(link(ear, ear, reach, width), Vec3d::UnitX(), 0.0), 0.0, 0.0, 0.0);
    body = intersect(body, half_space(-Vec3d::UnitX(), 4.0));
    body = subtract(body, block(10.0, 200.0, -100.0, 100.0, -gap / 2.0, gap / 2.0));
    body = smooth_unite(body, along_x(post(shank, -length, 4.0)), 5.0);
    body = intersect(body, block(-length, 200.0, -ear, ear, -width / 2.0, width / 2.0));
    body = unite({body, at(post(pin + 4.5, 0.0, boss + 1.0), reach, 0.0, width / 2.0 - 1.0)});
    body = subtract(body, at(cylinder(pin, 300.0), reach, 0.0, 0.0));
    body = subtract(body, along_x(post(0.5 * shank, -length - 1.0, -0.3 * length)));
    // The ear without boss is cut short.
    return subtract(body, block(reach + 0.68 * ear, 300.0, -100.0, 100.0, -100.0, 0.0));
}

// Crank: a large and a small boss of different height on a tapered web, keyway, pin. One mirror
// plane is broken by the keyway, which is turned.
Solid build_crank(Variation& vary) {
    const double reach = vary.length(70.0, 58.0, 84.0);
    const double big = vary.length(20.0, 18.0, 23.0);
    const double small = vary.length(13.0, 11.5, 15.0);
    const double web = vary.length(9.0, 7.5, 12.0);
    const double big_height = vary.length(32.0, 24.0, 38.0);
    const double small_height = vary.length(20.0, 16.0, 26.0);
    const double pin = vary.length(7.0, 6.0, 8.0);
    const double pin_length = vary.length(24.0, 14.0, 30.0);
    const double key_angle = vary.length(0.9, 0.3, 2.4);
    Solid body = link(big - 3.0, small - 2.0, reach, web);
    body = subtract(body, at(link(big - 9.0, small - 6.0, reach, web), 0.0, 0.0, web - 2.5));
    body = unite({body, post(big, -web / 2.0, big_height - web / 2.0),
                  at(post(small, -small_height + web, web / 2.0 + 2.0), reach, 0.0, 0.0),
                  at(post(pin, 0.0, pin_length), reach, 0.0, 0.0)});
    body = subtract(body, cylinder(0.52 * big, 300.0));
    const double bore = 0.52 * big;
    const Solid key = block(0.0, bore + 3.5, -3.0, 3.0, -200.0, 200.0);
    body = subtract(body, turned_z(key, key_angle));
    // An oil hole through the large boss.
    return subtract(body, turned_z(at(along_x(post(2.6, 0.0, 60.0)), 0.0, 0.0, big_height * 0.6),
                                   key_angle + 1.9));
}

// Disk cam: an eccentric lobe, a hub, a keyed bore off the middle, a timing hole. One mirror plane
// at most.
Solid build_cam(Variation& vary) {
    const double base = vary.length(26.0, 23.0, 30.0);
    const double nose = vary.length(10.0, 8.0, 13.0);
    const double lift = vary.length(38.0, 30.0, 44.0);
    const double width = vary.length(16.0, 12.0, 22.0);
    const double hub = vary.length(16.0, 14.0, 17.0);
    const double hub_height = vary.length(14.0, 9.0, 20.0);
    const double bore = vary.length(9.0, 7.5, 10.0);
    const double key_angle = vary.length(2.2, 1.2, 2.8);
    Solid body = link(base, nose, lift, width);
    body = unite({body, post(hub, 0.0, width / 2.0 + hub_height)});
    body = subtract(body, cylinder(bore, 300.0));
    const Solid key = block(0.0, bore + 3.0, -2.8, 2.8, -200.0, 200.0);
    body = subtract(body, turned_z(key, key_angle));
    // A pocket in the nose saves weight; a small hole marks the timing.
    body = subtract(body, at(post(0.5 * nose, 0.0, 100.0), lift - 1.0, 0.0, -width / 2.0 + 4.0));
    const double ring = 0.5 * (hub + base) + 0.5;
    return subtract(body, turned_z(at(cylinder(2.6, 300.0), ring, 0.0, 0.0), -1.3));
}

// Wing nut: conical hub with a bore and two wings. Twofold symmetric, as wing nuts are.
Solid build_wing_nut(Variation& vary) {
    const double low = vary.length(13.0, 11.0, 15.0);
    const double high = vary.length(10.0, 9.0, 10.8);
    const double height = vary.length(16.0, 13.0, 20.0);
    const double span = vary.length(32.0, 26.0, 38.0);
    const double rise = vary.length(20.0, 14.0, 26.0);
    const double wing = vary.length(8.5, 7.5, 10.5);
    const double bore = vary.length(5.5, 4.5, 6.0);
    const double angle = std::atan2(rise, span - 6.0);
    const double reach = std::hypot(rise, span - 6.0);
    // The wing is a link in the xz plane, 5 mm thick.
    Solid blade = link(0.62 * wing, wing, reach, 2.0);
    blade = grown(rotated(blade, Vec3d::UnitX(), kPi / 2.0), 1.6);
    blade = rotated(blade, Vec3d::UnitY(), -angle);
    blade = at(blade, 5.0, 0.0, 0.45 * height);
    // Wings are bent the same way around: turned by half a turn, not mirrored.
    const Solid wings = circular(at(blade, 0.0, 2.0, 0.0), 2);
    const Solid cone = at(capped_cone(low, high, height), 0.0, 0.0, height / 2.0);
    Solid body = smooth_unite(cone, wings, 4.0);
    body = intersect(body, half_space(-Vec3d::UnitZ(), 0.0));
    return subtract(body, cylinder(bore, 300.0));
}

// Shift fork: a half ring with pads, an arm bent out of its plane, a bored boss with a lug. No
// symmetry.
Solid build_fork(Variation& vary) {
    const double ring = vary.length(30.0, 26.0, 34.0);
    const double wall = vary.length(8.0, 7.0, 10.0);
    const double width = vary.length(10.0, 8.0, 12.0);
    const double reach = vary.length(56.0, 50.0, 66.0);
    const double boss = vary.length(13.0, 11.5, 15.0);
    const double boss_height = vary.length(36.0, 28.0, 44.0);
    const double offset = vary.length(10.0, 4.0, 14.0);
    const double lug = vary.length(24.0, 20.0, 30.0);
    Solid half = subtract(cylinder(ring + wall, width), cylinder(ring, 100.0));
    half = intersect(half, half_space(-Vec3d::UnitX(), 8.0));
    half = subtract(half, block(-100.0, 200.0, -100.0, 0.0, -0.1, 0.0));
    // Opening to -x: keep the arc of x above -8; pads at both ends.
    const double end = ring + wall / 2.0;
    const Solid pad =
        block(-16.0, -2.0, end - wall / 2.0 - 2.0, end + wall / 2.0, -0.7 * width, 0.7 * width);
    half = unite({half, with_mirror(pad, 1)});
    const std::array<SweepBall, 2> bar = {SweepBall{Vec3d(ring + 3.0, 0.0, 0.0), 6.0},
                                          SweepBall{Vec3d(reach, 0.0, offset), 8.0}};
    Solid body = smooth_unite(half, swept(bar), 6.0);
    body = smooth_unite(
        body,
        at(post(boss, offset - boss_height * 0.35, offset + boss_height * 0.65), reach, 0.0, 0.0),
        5.0);
    body = subtract(body, at(cylinder(ring, 100.0), 0.0, 0.0, 0.0));
    const Solid tab =
        at(turned_z(link(7.0, 5.5, lug, 7.0), 0.9), reach, 0.0, offset + boss_height * 0.5);
    body = unite({body, tab});
    const Vec3d eye(reach + lug * std::cos(0.9), lug * std::sin(0.9), 0.0);
    body = subtract(body, moved(cylinder(2.6, 200.0), eye));
    return subtract(body, at(cylinder(0.6 * boss, 300.0), reach, 0.0, 0.0));
}

// Connecting rod: large eye with bolt bosses, small eye, I-section. One mirror plane is broken by
// the oil boss on one side.
Solid build_connecting_rod(Variation& vary) {
    const double reach = vary.length(84.0, 72.0, 96.0);
    const double big = vary.length(21.0, 19.0, 24.0);
    const double small = vary.length(12.0, 11.0, 14.0);
    const double thick = vary.length(18.0, 15.0, 22.0);
    const double web = vary.length(5.0, 4.0, 7.0);
    const double bore = vary.length(0.66, 0.58, 0.7);  // of the eye's radius
    Solid beam = link(0.62 * big, 0.75 * small, reach, 0.75 * thick);
    const double depth = (0.75 * thick - web) / 2.0;
    Solid pocket = at(link(0.62 * big - 5.0, 0.75 * small - 3.6, reach, depth), 0.0, 0.0,
                      0.375 * thick - depth / 2.0 + 0.01);
    // Only between the eyes.
    const double margin = 4.0;
    pocket =
        intersect(pocket, block(big + margin, reach - small - margin, -99.0, 99.0, -99.0, 99.0));
    beam = subtract(beam, with_mirror(pocket, 2));
    Solid body = smooth_unite(beam, cylinder(big, thick), 4.0);
    body = smooth_unite(body, at(cylinder(small, thick + 4.0), reach, 0.0, 0.0), 4.0);
    // Cap bolts along x beside the large eye.
    const Solid lug = at(along_x(cylinder(6.5, 26.0)), 0.0, big + 1.0, 0.0);
    body = unite({body, with_mirror(lug, 1)});
    const Solid bolt = at(along_x(cylinder(2.7, 100.0)), 0.0, big + 2.0, 0.0);
    body =
        subtract(body, with_mirror(intersect(bolt, block(-60.0, 60.0, 0.0, 99.0, -9.0, 9.0)), 1));
    const Solid oil = rotated(along_x(post(4.5, 0.0, small + 7.0)), Vec3d::UnitZ(), 0.8);
    body = unite({body, at(oil, reach, 0.0, 0.0)});
    const Solid drill = rotated(along_x(post(2.0, 0.0, 60.0)), Vec3d::UnitZ(), 0.8);
    body = subtract(body, at(drill, reach, 0.0, 0.0));
    body = subtract(body, cylinder(bore * big, 200.0));
    return subtract(body, at(cylinder(bore * small, 200.0), reach, 0.0, 0.0));
}

}  // namespace ostraka
