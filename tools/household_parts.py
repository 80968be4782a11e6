#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes sixteen things of a household or workshop as OBJ files, in mm: a mug, a bowl, a bottle, a hook, a pipe
elbow, a spring... Some are made of solids that stick in each other. Neither recognition nor its confidence was made
on them.

Usage: household_parts.py FOLDER [SCALE]

With SCALE every other part is scaled by it, for a library of large and small ones.
"""
import math
import os
import sys

import numpy as np

UP_Y = np.array([0.0, 1.0, 0.0])


def circle(radius, count=24):
    """Corners of a regular polygon."""
    return [(radius * math.cos(2 * math.pi * i / count), radius * math.sin(2 * math.pi * i / count))
            for i in range(count)]


def line(start, end, count=12):
    """Points along a line, without its end."""
    start, end = np.array(start, float), np.array(end, float)
    return [tuple(start + (end - start) * i / count) for i in range(count)]


def arc(center, radius, start, end, count=24):
    """Points along an arc in x and z, degrees."""
    angles = [math.radians(start + (end - start) * i / count) for i in range(count + 1)]
    return [(center[0] + radius * math.cos(a), 0.0, center[1] + radius * math.sin(a)) for a in angles]


def revolved(profile, count=72):
    """Heights and radii turned about z."""
    rows = len(profile)
    vertices = [(r * math.cos(2 * math.pi * k / count), r * math.sin(2 * math.pi * k / count), z)
                for k in range(count) for z, r in profile]
    triangles = []
    for k in range(count):
        for i in range(rows - 1):
            a, b = k * rows + i, k * rows + i + 1
            c, d = (k + 1) % count * rows + i + 1, (k + 1) % count * rows + i
            triangles += [(a, d, c), (a, c, b)]
    return np.array(vertices), np.array(triangles)


def swept(path, section, up=UP_Y):
    """A section moved along a path."""
    path = np.array(path, float)
    count, corners = len(path), len(section)
    vertices, triangles = [], []
    for k in range(count):
        tangent = path[min(k + 1, count - 1)] - path[max(k - 1, 0)]
        side = np.cross(up, tangent)
        side /= np.linalg.norm(side)
        other = np.cross(tangent / np.linalg.norm(tangent), side)
        vertices += [path[k] + a * side + b * other for a, b in section]
    for k in range(count - 1):
        for i in range(corners):
            a, b = k * corners + i, k * corners + (i + 1) % corners
            c, d = b + corners, a + corners
            triangles += [(a, b, c), (a, c, d)]
    first, last = len(vertices), len(vertices) + 1
    vertices += [path[0], path[-1]]
    for i in range(corners):
        j = (i + 1) % corners
        triangles += [(first, j, i), (last, (count - 1) * corners + i, (count - 1) * corners + j)]
    return np.array(vertices), np.array(triangles)


def cross(o, a, b):
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def is_ear(points, left, q):
    i, j, k = left[q - 1], left[q], left[(q + 1) % len(left)]
    a, b, c = points[i], points[j], points[k]
    if cross(a, b, c) <= 1e-9:
        return False
    return not any(cross(a, b, points[w]) >= 0 and cross(b, c, points[w]) >= 0 and cross(c, a, points[w]) >= 0
                   for w in left if w not in (i, j, k))


def extruded(outline, height):
    """A polygon, cut into triangles by its ears."""
    points = [tuple(map(float, p)) for p in outline]
    count = len(points)
    if sum(cross((0, 0), points[i], points[(i + 1) % count]) for i in range(count)) < 0:
        points.reverse()
    left, caps = list(range(count)), []
    while len(left) > 3:
        q = next(q for q in range(len(left)) if is_ear(points, left, q))
        caps.append((left[q - 1], left[q], left[(q + 1) % len(left)]))
        left.pop(q)
    caps.append(tuple(left))
    vertices = [(x, y, 0.0) for x, y in points] + [(x, y, height) for x, y in points]
    triangles = [(a, c, b) for a, b, c in caps] + [(a + count, b + count, c + count) for a, b, c in caps]
    for i in range(count):
        j = (i + 1) % count
        triangles += [(i, j, j + count), (i, j + count, i + count)]
    return np.array(vertices), np.array(triangles)


def moved(mesh, shift=(0, 0, 0), about_z=0.0, z_to_x=False):
    vertices, triangles = mesh
    c, s = math.cos(math.radians(about_z)), math.sin(math.radians(about_z))
    turn = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]) if z_to_x else np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return vertices @ turn.T + np.array(shift), triangles


def joined(*meshes):
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    return (np.vstack([vertices for vertices, _ in meshes]),
            np.vstack([triangles + start for (_, triangles), start in zip(meshes, starts)]))


def cylinder(radius, length):
    return revolved([(0, 0), (0, radius), (length, radius), (length, 0)])


def bowl():
    outer = [(4 + 50 * math.sin(math.radians(a)), 30 + 48 * (1 - math.cos(math.radians(a)))) for a in range(10, 91, 10)]
    inner = [(10 + 44 * math.sin(math.radians(a)), 26 + 48 * (1 - math.cos(math.radians(a)))) for a in range(90, 9, -10)]
    return revolved([(0, 0), (0, 25), (4, 30)] + outer + [(54, 75)] + inner + [(10, 0)])


def wrench():
    eye = [(-14 * math.sin(math.radians(a)) - 8, 14 * math.cos(math.radians(a))) for a in range(20, 161, 20)]
    return extruded([(0, -9), (90, -9), (100, -20), (122, -20), (130, -11), (110, -9), (106, 0), (110, 9), (130, 11),
                     (122, 20), (100, 20), (90, 9), (0, 9)] + eye, 9)


def star_knob():
    radii = [(math.radians(a), 26 + 6 * math.cos(5 * math.radians(a))) for a in range(0, 360, 4)]
    lobes = extruded([(r * math.cos(a), r * math.sin(a)) for a, r in radii], 16)
    return joined(lobes, moved(revolved([(0, 0), (0, 12), (25, 10), (25, 0)]), (0, 0, 14)))


def gear_rack():
    teeth = [p for k in range(12) for p in ((120 - 10 * k, 14), (118 - 10 * k, 20), (114 - 10 * k, 20), (112 - 10 * k, 14))]
    return extruded([(0, 0), (120, 0)] + teeth + [(0, 14)], 16)


def camshaft():
    radii = [(math.radians(a), 13 + 9 * max(0, math.cos(math.radians(a))) ** 3) for a in range(0, 360, 6)]
    cam = extruded([(r * math.cos(a), r * math.sin(a)) for a, r in radii], 14)
    return joined(cylinder(9, 130), *[moved(cam, (0, 0, z), turn) for z, turn in
                                      ((12, 0), (44, 120), (78, 250), (104, 40))])


def hook():
    path = line((0, 0, 0), (0, 0, 60)) + arc((30, 60), 30, 180, 0)[1:] + line((60, 0, 60), (60, 0, 45), 4)[1:]
    foot = extruded([(-18, -14), (18, -14), (18, 14), (-18, 14)], 5)
    return joined(swept(path, circle(6)), moved(foot, (0, 0, -5)))


def saddle():
    strip = swept(arc((0, 0), 30, 0, 180), [(-12, -3), (12, -3), (12, 3), (-12, 3)])
    return joined(strip, moved(extruded([(0, -12), (30, -12), (30, 12), (0, 12)], 6), (27, 0, -3)),
                  moved(extruded([(-30, -12), (0, -12), (0, 12), (-30, 12)], 6), (-27, 0, -3)))


def elbow():
    path = line((0, 0, -25), (0, 0, 0)) + arc((40, 0), 40, 180, 90)[1:] + line((40, 0, 40), (65, 0, 40))[1:]
    return joined(swept(path, circle(18)), moved(cylinder(25, 12), (0, 0, -30)),
                  moved(cylinder(25, 12), (60, 0, 40), z_to_x=True))


def parts():
    bore = (0, 30), (0, 50), (40, 50), (40, 30), (0, 30)
    bottle = [(0, 0), (0, 32), (5, 35), (120, 35), (135, 30), (150, 14), (180, 12), (180, 9), (150, 10), (130, 20),
              (100, 30), (10, 30), (10, 0)]
    dome = [(20 + 18 * math.sin(math.radians(a)), 8 + 14 * math.cos(math.radians(a))) for a in range(0, 90, 15)]
    coil = [(16 * math.cos(t), 16 * math.sin(t), 2.4 * t) for t in np.linspace(0, 10 * math.pi, 240)]
    key = line((0, 0, 0), (0, 0, 110)) + arc((12, 110), 12, 180, 90)[1:] + line((12, 0, 122), (45, 0, 122), 6)[1:]
    return {
        "mug": joined(revolved([(0, 0), (0, 40), (95, 42), (95, 38), (6, 36), (6, 0)]),
                      swept(arc((40, 48), 28, 75, -75), circle(6))),
        "bottle": revolved(bottle),
        "bowl": bowl(),
        "tape_roll": revolved(bore),
        "hook": hook(),
        "hex_key": swept(key, circle(6, 6)),
        "elbow": elbow(),
        "tee_pipe": joined(moved(cylinder(18, 110), (0, 0, -55)), moved(cylinder(14, 50), (0, 0, 8), z_to_x=True),
                           moved(cylinder(23, 10), (0, 0, -60)), moved(cylinder(23, 10), (0, 0, 50))),
        "wrench": wrench(),
        "knob": revolved([(0, 0), (0, 10), (18, 10), (20, 22)] + dome + [(38, 0)]),
        "star_knob": star_knob(),
        "pulley_arm": joined(extruded([(-12, -12), (95, -7), (100, 0), (95, 7), (-12, 12)], 10),
                             moved(cylinder(18, 22), (0, 0, -5)), moved(cylinder(11, 30), (90, 0, -12))),
        "gear_rack": gear_rack(),
        "spring": swept(coil, circle(3.5, 12), np.array([0.0, 0.0, 1.0])),
        "camshaft": camshaft(),
        "saddle": saddle(),
    }


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    os.makedirs(sys.argv[1], exist_ok=True)
    scale = float(sys.argv[2]) if len(sys.argv) == 3 else 1.0
    for number, (name, (vertices, triangles)) in enumerate(parts().items()):
        with open(os.path.join(sys.argv[1], name + ".obj"), "w", encoding="ascii") as file:
            for vertex in vertices * (scale if number % 2 else 1.0):
                file.write("v %.5f %.5f %.5f\n" % tuple(vertex))
            for triangle in triangles + 1:
                file.write("f %d %d %d\n" % tuple(triangle))


if __name__ == "__main__":
    main()
