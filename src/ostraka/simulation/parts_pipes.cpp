// SPDX-License-Identifier: Apache-2.0
// Parts that lead a fluid: pipes, valves, blocks with ports, pump housings.
#include <cmath>
#include <vector>

#include "ostraka/simulation/part_builders.hpp"

namespace ostraka {
namespace {

// A pipe flange around z, from z = 0 to `thickness`, without its bore.
Solid pipe_flange(double radius, double thickness, int holes, double hole, double circle) {
    const Solid drill = bolt_circle(holes, circle, hole, 4.0 * thickness, kPi / holes);
    return subtract(post(radius, 0.0, thickness), drill);
}

}  // namespace

// Pipe elbow of 90 degrees with flanges of different size and a boss outside the bend. One mirror
// plane, that of the bend.
Solid build_elbow(Variation& vary) {
    const double bend = vary.length(42.0, 38.0, 48.0);
    const double pipe = vary.length(15.0, 13.0, 17.0);
    const double wall = vary.length(4.0, 3.5, 5.0);
    const double big = pipe + vary.length(15.0, 14.0, 18.0);
    const double small = pipe + vary.length(11.0, 10.5, 13.0);
    const int holes = vary.count(4, 3, 6);
    const double leg = vary.length(14.0, 8.0, 22.0);
    const double boss_angle = vary.length(0.5, 0.35, 0.75);  // from the large flange, radians
    // The bend's center is the origin; the pipe runs from (bend, 0) to (0, bend) in xy.
    const Solid quarter =
        intersect(half_space(-Vec3d::UnitX(), 0.0), half_space(-Vec3d::UnitY(), 0.0));
    const auto run = [&](double radius, double extra) {
        const Solid first = at(along_y(post(radius, -leg - extra, 0.01)), bend, 0.0, 0.0);
        const Solid second = at(along_x(post(radius, -leg - extra, 0.01)), 0.0, bend, 0.0);
        return unite({intersect(torus(bend, radius), quarter), first, second});
    };
    const double big_thickness = 8.0;
    const double small_thickness = 6.5;
    const Solid one = pipe_flange(big, big_thickness, holes, 3.6, 0.5 * (big + pipe) + 0.5);
    const Solid two = pipe_flange(small, small_thickness, holes, 2.9, 0.5 * (small + pipe) + 0.5);
    const Solid outlet =
        turned_z(at(along_x(post(7.0, -4.0, pipe + 7.0)), bend, 0.0, 0.0), boss_angle);
    Solid body =
        unite({smooth_unite(run(pipe, 0.0), outlet, 4.0), at(along_y(one), bend, -leg - 0.01, 0.0),
               at(along_x(two), -leg - 0.01, bend, 0.0)});
    body = subtract(body, run(pipe - wall, 5.0));
    return subtract(body, turned_z(at(along_x(post(3.2, 0.0, 60.0)), bend, 0.0, 0.0), boss_angle));
}

// Pipe tee: a run with two flanges, a thinner branch with a third one off the middle. One mirror
// plane.
Solid build_tee(Variation& vary) {
    const double length = vary.length(96.0, 84.0, 110.0);
    const double pipe = vary.length(15.0, 13.0, 17.0);
    const double branch = vary.length(11.0, 9.5, 12.5);
    const double reach = vary.length(46.0, 38.0, 55.0);
    const double shift = vary.length(8.0, 3.0, 12.0);
    const double rim = pipe + vary.length(12.0, 11.0, 15.0);
    const int holes = vary.count(4, 4, 6);
    const double wall = 4.0;
    const double h = length / 2.0;
    const Solid flange = pipe_flange(rim, 7.0, holes, 3.2, 0.5 * (rim + pipe) + 0.5);
    const Solid cap = pipe_flange(branch + 11.0, 6.0, 3, 2.8, branch + 6.0);
    Solid body = smooth_unite(along_x(cylinder(pipe, length - 4.0)),
                              at(post(branch, 0.0, reach - 2.0), shift, 0.0, 0.0), 7.0);
    body = unite({body, at(along_x(flange), -h, 0.0, 0.0), at(along_x(flange), h - 7.0, 0.0, 0.0),
                  at(cap, shift, 0.0, reach - 6.0)});
    body = subtract(body, along_x(cylinder(pipe - wall, 2.0 * length)));
    return subtract(body, at(post(branch - wall, 0.0, 2.0 * reach), shift, 0.0, 0.0));
}

// Globe valve body: bulb in a flanged run, bonnet neck with a square flange, drain plug on one
// side. No symmetry.
Solid build_valve_body(Variation& vary) {
    const double length = vary.length(104.0, 92.0, 118.0);
    const double pipe = vary.length(13.0, 11.5, 14.5);
    const double bulb = vary.length(25.0, 22.0, 28.0);
    const double neck = vary.length(14.0, 12.5, 15.5);
    const double height = vary.length(44.0, 38.0, 50.0);
    const double rim = pipe + vary.length(12.0, 11.0, 15.0);
    const double square = vary.length(44.0, 40.0, 48.0);
    const double plug = vary.length(12.0, 8.0, 15.0);
    const double h = length / 2.0;
    const Solid flange = pipe_flange(rim, 7.0, 4, 3.2, 0.5 * (rim + pipe) + 0.5);
    Solid shell = smooth_unite(along_x(cylinder(pipe, length - 4.0)), sphere(bulb), 9.0);
    shell = smooth_unite(shell, post(neck, 0.0, height - 3.0), 7.0);
    shell = smooth_unite(shell, at(along_y(post(6.5, 0.0, bulb + 8.0)), plug, 0.0, -4.0), 3.0);
    Solid bonnet = at(rounded_box({square, square, 9.0}, 2.5), 0.0, 0.0, height - 4.5);
    const double pitch = square / 2.0 - 6.0;
    const Solid bolts = with_mirror(with_mirror(at(cylinder(2.9, 300.0), pitch, pitch, 0.0), 0), 1);
    bonnet = subtract(bonnet, intersect(bolts, half_space(-Vec3d::UnitZ(), -bulb)));
    Solid body = unite(
        {shell, bonnet, at(along_x(flange), -h, 0.0, 0.0), at(along_x(flange), h - 7.0, 0.0, 0.0)});
    body = subtract(body, along_x(cylinder(pipe - 4.0, 2.0 * length)));
    body = subtract(body, sphere(bulb - 5.0));
    body = subtract(body, post(neck - 4.5, 0.0, 2.0 * height));
    return subtract(body, at(along_y(post(2.9, 0.0, 2.0 * bulb)), plug, 0.0, -4.0));
}

// Hydraulic manifold: block with a step, ports with counterbores on four sides, mounting holes.
// No symmetry.
Solid build_manifold_block(Variation& vary) {
    const double x = vary.length(90.0, 76.0, 104.0);
    const double y = vary.length(50.0, 44.0, 58.0);
    const double z = vary.length(44.0, 38.0, 52.0);
    const double step = vary.length(26.0, 18.0, 32.0);
    const double main = vary.length(8.0, 6.5, 9.0);
    const double gap = vary.length(26.0, 22.0, 28.0);
    const int ports = vary.count(2, 1, 2);
    const double side = vary.length(0.22, 0.1, 0.3);
    const double hx = x / 2.0;
    const double hy = y / 2.0;
    const double hz = z / 2.0;
    const auto port = [](double radius, double depth) {  // looks along +z, its mouth at z = 0
        return unite({post(radius, -depth, 1.0), post(radius + 3.0, -5.0, 1.0)});
    };
    Solid body = rounded_box({x, y, z}, 1.5);
    body = subtract(body, block(hx - step, hx + 9.0, -99.0, 99.0, hz - 14.0, 99.0));
    // Main gallery along x, open on the left only.
    body = subtract(body,
                    at(rotated(port(main, x - step), Vec3d::UnitY(), -kPi / 2.0), -hx, 0.0, -4.0));
    for (int i = 0; i < ports; ++i) {
        body = subtract(body, at(port(5.5, hz), -hx + 20.0 + gap * i, 2.0, hz));
    }
    const Solid front = rotated(port(6.5, hy), Vec3d::UnitX(), kPi / 2.0);  // looks along -y
    body = subtract(body, at(front, -side * x, -hy, -4.0));
    const Solid back = along_y(port(4.2, hy));
    body = subtract(body, at(back, side * x, hy, -2.0));
    // A fitting screwed into the step.
    const double post_x = hx - 0.5 * step;
    const Solid fitting = at(post(7.5, -1.0, 12.0), post_x, -7.0, hz - 14.0);
    body = unite({body, fitting});
    body = subtract(body, at(post(3.5, -18.0, 20.0), post_x, -7.0, hz - 14.0));
    body = subtract(body, at(cylinder(2.7, 300.0), hx - 6.5, hy - 6.5, 0.0));
    return subtract(body, at(cylinder(2.7, 300.0), -hx + 6.5, hy - 6.5, 0.0));
}

// Volute of a centrifugal pump: a spiral that grows into a flanged outlet, open on one side for the
// impeller, on a foot. Chiral, no symmetry.
Solid build_pump_housing(Variation& vary) {
    const double ring = vary.length(29.0, 26.0, 33.0);
    const double thin = vary.length(8.0, 7.5, 9.0);
    const double thick = vary.length(14.0, 13.0, 15.5);
    const double outlet = ring + thick + vary.length(6.0, 4.0, 14.0);
    const double inlet = vary.length(12.0, 10.0, 14.0);
    const int holes = vary.count(6, 4, 7);
    const double foot = vary.length(66.0, 58.0, 74.0);
    constexpr int kSteps = 44;
    const auto spiral = [&](double shell) {
        std::vector<SweepBall> balls;
        for (int i = 0; i <= kSteps; ++i) {
            const double t = static_cast<double>(i) / kSteps;
            const double angle = 2.0 * kPi * t * 0.97;
            const double r = ring + 0.6 * (thick - thin) * t;
            const double tube = thin + (thick - thin) * t - shell;
            balls.push_back({Vec3d(r * std::cos(angle), r * std::sin(angle), 0.0), tube});
        }
        // The outlet goes on along the tangent, +y.
        const Vec3d end = balls.back().center;
        balls.push_back(
            {end + Vec3d(1.0, outlet + (shell > 0.0 ? 20.0 : 0.0), 0.0), thick - shell});
        return swept(balls);
    };
    const double out_x = ring + 0.6 * (thick - thin) + 1.0;
    Solid body = smooth_unite(spiral(0.0), cylinder(ring, 2.0 * thin), 4.0);
    const Solid foot_plate =
        block(-foot / 2.0, foot / 2.0, -ring - thick - 14.0, -ring - thick - 6.0, -16.0, 16.0);
    const Solid leg = block(-14.0, 14.0, -ring - thick - 10.0, -ring + 6.0, -7.0, 7.0);
    body = smooth_unite(body, leg, 5.0);
    const Solid front = post(ring + 7.0, 0.0, thin + 9.0);
    const Solid flange = pipe_flange(thick + 10.0, 7.0, 4, 2.9, thick + 5.5);
    body = unite({body, foot_plate, front, at(post(inlet + 5.0, -thin - 14.0, 0.0), 0.0, 0.0, 0.0),
                  at(along_y(flange), out_x, outlet - 10.0, 0.0)});
    // The outlet's ball ends beyond its flange.
    body = intersect(body, half_space(Vec3d::UnitY(), outlet - 3.0));
    body = subtract(body, spiral(4.0));
    body = subtract(body, post(ring - 2.0, -thin + 3.5, 60.0));
    body = subtract(body, post(inlet, -60.0, 0.0));
    body = subtract(body, at(bolt_circle(holes, ring + 2.5, 2.0, 8.0, 0.3), 0.0, 0.0, thin + 9.0));
    const Solid bolt =
        at(along_y(cylinder(3.4, 14.0)), foot / 2.0 - 8.0, -ring - thick - 10.0, 0.0);
    return subtract(body, with_mirror(bolt, 0));
}

}  // namespace ostraka
