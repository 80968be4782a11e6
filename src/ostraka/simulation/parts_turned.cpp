// SPDX-License-Identifier: Apache-2.0
// Parts made on a lathe, or at least around an axis (z).
#include <cmath>
#include <vector>

#include "ostraka/simulation/part_builders.hpp"

namespace ostraka {
namespace {

// A slot for a key in the wall of a bore along z, at +x; cut along all of z.
Solid keyway(double bore_radius, double width, double depth) {
    return block(0.0, bore_radius + depth, -width / 2.0, width / 2.0, -200.0, 200.0);
}

}  // namespace

// Disk, filleted hub, bore, bolt circle. A notch in the rim breaks the rotational symmetry; one
// mirror plane may stay, where the notch is opposite to or over a hole.
Solid build_flange(Variation& vary) {
    const double rim = vary.length(45.0, 38.0, 52.0);
    const double thickness = vary.length(11.0, 8.0, 15.0);
    const double hub = vary.length(21.0, 17.0, 24.0);
    const double height = vary.length(30.0, 22.0, 40.0);
    const double bore = vary.length(12.0, 8.0, 13.5);
    const int holes = vary.count(6, 4, 8);
    const double hole = vary.length(4.2, 3.2, 4.6);
    const double notch = vary.length(5.0, 4.0, 6.5);
    Solid body = smooth_unite(post(rim, 0.0, thickness), post(hub, 0.0, height), 8.0);
    // The blend swells past the flat faces; cut it back.
    body = intersect(body, post(2.0 * rim, 0.0, height));
    body = subtract(body, post(bore, -1.0, height + 1.0));
    body = subtract(body, post(bore + 3.5, height - 4.0, height + 1.0));
    body = subtract(body, bolt_circle(holes, 0.5 * (rim + hub) + 2.0, hole, 100.0, kPi / holes));
    return subtract(body, at(cylinder(notch, 100.0), rim + 1.0, 0.0, 0.0));
}

// Spur gear with a hub on one side, lightening holes and a keyway. The keyway leaves one mirror
// plane at most.
Solid build_gear(Variation& vary) {
    const int teeth = vary.count(20, 14, 24);
    const double rim = vary.length(42.0, 36.0, 48.0);
    const double width = vary.length(16.0, 11.0, 22.0);
    const double hub = vary.length(16.0, 14.0, 18.0);
    const double hub_height = vary.length(12.0, 8.0, 18.0);
    const double bore = vary.length(8.0, 6.5, 9.0);
    const int holes = vary.count(5, 3, 6);
    const double pitch = 2.0 * kPi * rim / teeth;
    const double depth = 0.62 * pitch;
    // A tooth with slightly curved flanks, from within the rim to the tip.
    std::vector<Vec2d> tooth;
    constexpr std::array<std::array<double, 2>, 5> kHalf = {
        {{-0.3, 0.33}, {0.0, 0.30}, {0.40, 0.26}, {0.75, 0.19}, {1.0, 0.12}}};
    for (const auto& [out, half] : kHalf) tooth.emplace_back(rim + out * depth, -half * pitch);
    for (auto row = kHalf.rbegin(); row != kHalf.rend(); ++row) {
        tooth.emplace_back(rim + (*row)[0] * depth, (*row)[1] * pitch);
    }
    const Solid wheel = unite({cylinder(rim, width), circular(extruded(tooth, width), teeth)});
    const double middle = 0.5 * (rim + hub);
    const double recess = 0.5 * (rim - 6.0 - hub);
    Solid body = wheel;
    if (recess > 3.0) {
        const Solid ring = subtract(cylinder(rim - 6.0, 8.0), cylinder(hub, 20.0));
        body = subtract(body, at(ring, 0.0, 0.0, -width / 2.0));
    }
    const double hole = std::min(0.6 * recess, 0.35 * 2.0 * kPi * middle / holes);
    body = subtract(body, bolt_circle(holes, middle - 2.0, hole, 100.0, kPi / holes));
    body = unite({body, post(hub, -width / 2.0, width / 2.0 + hub_height)});
    body = subtract(body, cylinder(bore, 200.0));
    return subtract(body, keyway(bore, 5.0, 3.0));
}

// Hexagon bolt: chamfered head, washer face, shank, thread as rings without a helix. Sixfold
// symmetric, as bolts are.
Solid build_bolt(Variation& vary) {
    const double radius = vary.length(8.0, 7.0, 11.0);
    const double shank = vary.length(62.0, 45.0, 80.0);
    const double head = vary.length(11.0, 9.0, 14.0);
    const double thread_share = vary.length(0.55, 0.4, 0.8);
    const double flats = radius * vary.length(3.1, 2.8, 3.4);
    Solid top = at(hexagonal_prism(flats, head), 0.0, 0.0, head / 2.0);
    const double corner = flats / std::sqrt(3.0);
    // The 30 degree chamfer of the head.
    const double rise = head + 0.577 * 0.55 * flats;
    top = intersect(
        top, revolved(std::vector<Vec2d>{{0.0, -1.0},
                                         {corner + 2.0, -1.0},
                                         {corner + 2.0, rise - 0.577 * (corner + 2.0)},
                                         {0.53 * flats - 4.0, rise - 0.577 * (0.53 * flats - 4.0)},
                                         {0.0, rise - 0.577 * (0.53 * flats - 4.0)}}));
    top = intersect(top, half_space(Vec3d::UnitZ(), head));
    const Solid washer = post(0.47 * flats, -1.6, 1.0);
    // Outline of shank and thread, from the top down.
    std::vector<Vec2d> outline{{0.0, 1.0}, {radius, 1.0}};
    constexpr double kPitch = 4.0;
    constexpr double kDepth = 1.6;
    const int turns = std::max(3, static_cast<int>(shank * thread_share / kPitch));
    const double start = -shank + kPitch * turns;
    outline.emplace_back(radius, start);
    for (int i = 0; i < turns; ++i) {
        const double z = start - kPitch * i;
        outline.emplace_back(radius - kDepth, z - 1.6);
        outline.emplace_back(radius - kDepth, z - 2.0);
        if (i + 1 < turns) {
            outline.emplace_back(radius, z - 3.5);
            outline.emplace_back(radius, z - 4.0);
        }
    }
    outline.emplace_back(radius - kDepth - 1.0, -shank);
    outline.emplace_back(0.0, -shank);
    return unite({top, washer, revolved(outline)});
}

// V-belt pulley: grooved rim, spokes, hub on one side with a boss for a set screw. The boss leaves
// one mirror plane at most.
Solid build_pulley(Variation& vary) {
    const double rim = vary.length(48.0, 42.0, 58.0);
    const double width = vary.length(20.0, 17.0, 26.0);
    const double groove = vary.length(8.0, 6.5, 9.0);
    const int spokes = vary.count(5, 3, 6);
    const double spoke = vary.length(8.0, 6.5, 10.0);
    const double hub = vary.length(14.0, 12.5, 16.0);
    const double bore = vary.length(7.0, 5.5, 8.0);
    const double inner = rim - groove - 5.0;
    const double h = width / 2.0;
    const std::vector<Vec2d> outline{
        {inner, -h},         {rim, -h},      {rim, -h + 3.0}, {rim - groove, -2.0},
        {rim - groove, 2.0}, {rim, h - 3.0}, {rim, h},        {inner, h}};
    const Solid ring = revolved(outline);
    Solid arm = link(0.5 * spoke + 1.5, 0.5 * spoke, inner + 1.0, 0.45 * width);
    Solid body = unite({ring, intersect(circular(arm, spokes), cylinder(inner + 2.0, width))});
    body = smooth_unite(body, post(hub, -h, h + 8.0), 4.0);
    body = intersect(body, cylinder(rim, 2.0 * width + 16.0));
    const Solid boss = turned_z(at(along_x(cylinder(5.5, 10.0)), hub + 1.0, 0.0, h + 2.0), 0.6);
    body = unite({body, boss});
    const Solid screw = turned_z(at(along_x(cylinder(2.6, 30.0)), 15.0, 0.0, h + 2.0), 0.6);
    body = subtract(body, screw);
    return subtract(body, cylinder(bore, 200.0));
}

// Star knob: lobes around a domed head, stem, blind hole. A pointer on one lobe breaks the
// symmetry to one mirror plane.
Solid build_knob(Variation& vary) {
    const int lobes = vary.count(5, 3, 7);
    const double reach = vary.length(24.0, 20.0, 28.0);
    const double lobe = vary.length(9.0, 7.0, 10.0);
    const double thickness = vary.length(18.0, 14.0, 22.0);
    const double stem = vary.length(11.0, 9.5, 14.0);
    const double stem_length = vary.length(20.0, 14.0, 28.0);
    const double round = 3.0;
    const Solid disk = cylinder(reach - 2.0, thickness - 2.0 * round);
    const Solid arms =
        circular(at(cylinder(lobe - round, thickness - 2.0 * round), reach, 0.0, 0.0), lobes);
    Solid head = grown(smooth_unite(disk, arms, 6.0), round);
    head = intersect(head, cylinder(2.0 * reach, thickness));
    // Domed on top.
    const double dome = 3.2 * reach;
    head = intersect(head, at(sphere(dome), 0.0, 0.0, thickness / 2.0 - dome + 1.0));
    const double under = -thickness / 2.0;
    Solid body = smooth_unite(head, post(stem, under - stem_length, 0.0), 5.0);
    body = subtract(body, post(0.52 * stem, under - stem_length - 1.0, under + 4.0));
    const Solid pointer =
        at(rounded_box({0.7 * reach, 5.0, 8.0}, 1.5), 0.75 * reach, 0.0, thickness / 2.0 - 3.0);
    return unite({body, pointer});
}

// Shaft with shoulders, a keyway on one journal and flats on the other. No symmetry but, where the
// keyway faces a flat, one mirror plane.
Solid build_stepped_shaft(Variation& vary) {
    const double r1 = vary.length(9.0, 8.0, 11.0);
    const double r2 = vary.length(14.0, 12.5, 16.0);
    const double r3 = vary.length(19.0, 17.5, 23.0);
    const double r4 = vary.length(11.0, 9.0, 12.0);
    const double l1 = vary.length(32.0, 24.0, 38.0);
    const double l2 = vary.length(26.0, 16.0, 30.0);
    const double l3 = vary.length(10.0, 7.0, 16.0);
    const double l4 = vary.length(38.0, 26.0, 44.0);
    const double turn = vary.length(0.7, 0.3, 1.3);
    const double z1 = l1;
    const double z2 = z1 + l2;
    const double z3 = z2 + l3;
    const double z4 = z3 + l4;
    const std::vector<Vec2d> outline{{0.0, 0.0}, {r1 - 1.5, 0.0}, {r1, 1.5},      {r1, z1},
                                     {r2, z1},   {r2, z2},        {r3, z2},       {r3, z3},
                                     {r4, z3},   {r4, z4 - 2.0},  {r4 - 2.0, z4}, {0.0, z4}};
    Solid body = revolved(outline);
    const Solid key = at(link(3.0, 3.0, l2 - 12.0, 6.0), 0.0, 0.0, 0.0);
    body = subtract(body, at(along_x(key), r2, 0.0, z2 - 5.0));
    const Solid flat = block(r1 - 2.5, 60.0, -30.0, 30.0, -1.0, 0.45 * l1);
    body = subtract(body, turned_z(flat, turn));
    const Solid hole = turned_z(along_x(cylinder(2.8, 100.0)), turn + 0.9);
    return subtract(body, at(hole, 0.0, 0.0, z4 - 10.0));
}

// Open centrifugal impeller: back plate, curved blades, hub, bore with a keyway. Chiral; the
// keyway breaks the rotational symmetry.
Solid build_impeller(Variation& vary) {
    const double rim = vary.length(45.0, 38.0, 52.0);
    const int blades = vary.count(6, 4, 8);
    const double height = vary.length(20.0, 14.0, 26.0);
    const double sweep = vary.length(1.0, 0.6, 1.3);  // radians from root to tip
    const double plate = vary.length(5.0, 4.0, 6.5);
    const double hub = vary.length(14.0, 12.0, 15.0);
    const double bore = vary.length(6.5, 5.5, 7.5);
    constexpr int kSteps = 8;
    std::vector<Vec2d> blade;
    const double half = 1.9;  // half of the blade's thickness
    for (int side = 0; side < 2; ++side) {
        for (int i = 0; i <= kSteps; ++i) {
            const double t = static_cast<double>(side == 0 ? i : kSteps - i) / kSteps;
            const double r = hub - 4.0 + t * (rim - hub + 4.0);
            const double angle = sweep * t * (2.0 - t) + (side == 0 ? -half : half) / r;
            blade.emplace_back(r * std::cos(angle), r * std::sin(angle));
        }
    }
    const Solid wing = at(extruded(blade, height), 0.0, 0.0, height / 2.0);
    // The blades get lower toward the rim.
    const Solid cover = revolved(std::vector<Vec2d>{
        {0.0, 0.0}, {rim, 0.0}, {rim, 0.55 * height}, {hub, height}, {0.0, height}});
    Solid body = unite({post(rim, -plate, 0.001), intersect(circular(wing, blades), cover)});
    body = smooth_unite(body, post(hub, -plate, height + 4.0), 3.0);
    body = intersect(body, post(2.0 * rim, -plate, height + 10.0));
    body = subtract(body, cylinder(bore, 200.0));
    return subtract(body, keyway(bore, 5.0, 3.0));
}

}  // namespace ostraka
