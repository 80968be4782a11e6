#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes sixteen parts as OBJ files, in mm: eight turned ones, nearly or quite symmetric about their axis, and
eight of bent sheet, thin and open. Recognition was not made on them.

Usage: turned_and_sheet_parts.py FOLDER
"""
import math
import os
import sys

SIDES = 96  # of a circle; a multiple of 6, so that hexagons have true corners


def with_sides(apothem, count, limit):
    """A prism of so many sides, its corners turned down to a radius."""
    def at(angle):
        step = 2.0 * math.pi / count
        off = (angle + step / 2.0) % step - step / 2.0
        return min(limit, apothem / math.cos(off))
    return at


def with_flat(radius, distance):
    """A flat at a distance from the axis, across x."""
    def at(angle):
        c = math.cos(angle)
        return min(radius, distance / c) if c > 1e-9 else radius
    return at


def with_slots(radius, depth, count, share):
    """Keyways or teeth: grooves that take a share of the circumference."""
    def at(angle):
        part = (angle * count / (2.0 * math.pi) + share / 2.0) % 1.0
        return radius - depth if part < share else radius
    return at


# Outlines: height and radius, where the radius may depend on the angle. A part starts and ends on the axis
# or, with a bore, at the bore's radius.
TURNED = {
    "d_shaft": (0, [(0, 10), (45, 10), (45, 15), (55, 15), (55, 9), (100, 9), (100, with_flat(8, 5)),
                    (130, with_flat(8, 5))]),
    "keyed_hub": (with_slots(11, -4, 1, 0.09), [(0, 45), (10, 45), (10, 22), (50, 22)]),
    "hex_bolt": (0, [(0, with_sides(18, 6, 20.2)), (13, with_sides(18, 6, 20.2)), (13, 10), (95, 10), (97, 8)]),
    "hex_nut": (10, [(0, with_sides(24, 6, 27)), (22, with_sides(24, 6, 27))]),
    "groove_pulley": (8, [(0, 40), (5, 40), (12, 28), (18, 28), (25, 40), (30, 40), (30, 15), (45, 15)]),
    "funnel": (4, [(0, 7), (30, 7), (60, 42), (70, 42), (70, 39), (60, 39), (32, 5)]),
    "spline_shaft": (0, [(0, 14), (40, 14), (40, with_slots(14, 3, 6, 0.5)), (90, with_slots(14, 3, 6, 0.5)),
                         (90, 9), (115, 9)]),
    "ball_stud": (0, [(0, 8), (50, 8), (50, 14), (56, 14), (56, 7), (64, 7)]
                  + [(79 - 16 * math.cos(a), 16 * math.sin(a)) for a in
                     [math.radians(26 + 11 * i) for i in range(14)]]),
}

# Sheets: a strip's corners from the side, its width, its thickness. What is bent is bent sharply.
SHEET = {
    "z_clip": ([(0, 0), (40, 0), (40, 30), (85, 30)], 45, 2),
    "hat": ([(0, 0), (25, 0), (25, 28), (75, 28), (75, 0), (100, 0)], 60, 2),
    "angle": ([(0, 0), (90, 0), (90, 45)], 30, 1.5),
    "hook_strip": ([(0, 0), (110, 0), (120, 12), (110, 24), (85, 24)], 22, 2),
    "roof": ([(0, 0), (50, 32), (100, 0)], 80, 1.5),
    "stairs": ([(0, 0), (30, 0), (30, 20), (60, 20), (60, 40), (90, 40)], 50, 2),
    "u_clamp": ([(0, 50), (0, 0), (40, 0), (40, 60), (62, 60)], 35, 2.5),
    "spiral": ([(0, 0), (80, 0), (80, 60), (15, 60), (15, 20), (55, 20)], 40, 2),
}


def radius_at(radius, angle):
    return radius(angle) if callable(radius) else radius


def turned(bore, outline):
    """Rings of points and the quads between them. All around and back through the bore."""
    first, last = (outline[0][0], bore), (outline[-1][0], bore)
    rings = [first] + outline + [last]
    if bore:
        rings.append(first)
    points = []
    for height, radius in rings:
        for i in range(SIDES):
            angle = 2.0 * math.pi * i / SIDES
            r = radius_at(radius, angle)
            points.append((r * math.cos(angle), r * math.sin(angle), height))
    faces = []
    for ring in range(len(rings) - 1):
        for i in range(SIDES):
            a, b = ring * SIDES + i, ring * SIDES + (i + 1) % SIDES
            faces += [(a, b, b + SIDES), (a, b + SIDES, a + SIDES)]
    return points, faces


def sheet(line, width, thickness):
    """Mitered at each bend."""
    def normal(a, b):
        length = math.dist(a, b)
        return (a[1] - b[1]) / length, (b[0] - a[0]) / length
    normals = [normal(a, b) for a, b in zip(line, line[1:])]
    side = []
    for i, (x, y) in enumerate(line):
        before, after = normals[max(i - 1, 0)], normals[min(i, len(normals) - 1)]
        scale = thickness / (1.0 + before[0] * after[0] + before[1] * after[1])
        side.append((x + scale * (before[0] + after[0]), y + scale * (before[1] + after[1])))
    points = []
    for (ax, ay), (bx, by) in zip(line, side):
        points += [(ax, 0, ay), (ax, width, ay), (bx, width, by), (bx, 0, by)]
    faces = [(0, 1, 2), (0, 2, 3)]
    for s in range(len(line) - 1):
        for k in range(4):
            a, b = 4 * s + k, 4 * s + (k + 1) % 4
            faces += [(a, a + 4, b + 4), (a, b + 4, b)]
    end = 4 * (len(line) - 1)
    return points, faces + [(end, end + 2, end + 1), (end, end + 3, end + 2)]


def write(path, points, faces):
    with open(path, "w", encoding="ascii") as file:
        for x, y, z in points:
            file.write(f"v {x:.5f} {y:.5f} {z:.5f}\n")
        for face in faces:
            file.write("f " + " ".join(str(i + 1) for i in face) + "\n")


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    os.makedirs(sys.argv[1], exist_ok=True)
    for name, (bore, outline) in TURNED.items():
        write(os.path.join(sys.argv[1], name + ".obj"), *turned(bore, outline))
    for name, strip in SHEET.items():
        write(os.path.join(sys.argv[1], name + ".obj"), *sheet(*strip))


if __name__ == "__main__":
    main()
