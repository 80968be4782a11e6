#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A library of models that are given as points recognizes scans of the true meshes.

The parts are sampled anew here, with noise of a third of the spacing; the scene and its truth are
shipped. ADI: Hinterstoisser et al. ACCV 2012, of the diameter.

Usage: cloud_model_test.py PATH_OF_OSTRAKA DATA_FOLDER
"""
import json
import math
import random
import re
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

OSTRAKA = ""
DATA = Path()
PARTS = ("hook", "cam")
POINTS = 8000


def run(*arguments, code=0):
    done = subprocess.run([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    return done


def read_ply(path):
    data = Path(path).read_bytes()
    head, body = data.split(b"end_header\n", 1)
    count = {m[0]: int(m[1]) for m in re.findall(r"element (\w+) (\d+)", head.decode())}
    points = list(struct.iter_unpack("<3f", body[:12 * count["vertex"]]))
    rows = struct.iter_unpack("<B3i", body[12 * count["vertex"]:][:13 * count["face"]])
    return points, [row[1:] for row in rows]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def scan(path, count):
    """Random points of the surface, by area."""
    points, faces = read_ply(path)
    areas = []
    for a, b, c in faces:
        u = [points[b][k] - points[a][k] for k in range(3)]
        v = [points[c][k] - points[a][k] for k in range(3)]
        areas.append(math.hypot(*cross(u, v)) / 2)
    draw = random.Random(1)
    noise = 0.33 * math.sqrt(sum(areas) / count)
    cloud = []
    for face in draw.choices(faces, areas, k=count):
        s, t = math.sqrt(draw.random()), draw.random()
        weights = (1 - s, s * (1 - t), s * t)
        cloud.append([sum(w * points[i][k] for w, i in zip(weights, face)) + draw.gauss(0, noise)
                      for k in range(3)])
    return cloud


def moved(pose, p):
    return [sum(pose[4 * r + k] * p[k] for k in range(3)) + pose[4 * r + 3] for r in range(3)]


def adi(points, estimate, truth):
    """Mean distance from points at the true pose to the nearest at the estimated one."""
    there = [moved(estimate, p) for p in points]
    here = [moved(truth, p) for p in points[::10]]
    return sum(min(math.dist(a, b) for b in there) for a in here) / len(here)


class CloudModel(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.at = Path(self.folder.name)
        self.addCleanup(self.folder.cleanup)

    def write(self, name, points):
        (self.at / name).write_text("".join("%.4f %.4f %.4f\n" % tuple(p) for p in points))
        return self.at / name

    def test_is_recognized_in_scans_of_the_true_part(self):
        clouds = [self.write(name + ".xyz", scan(DATA / "parts" / (name + ".ply"), POINTS))
                  for name in PARTS]
        library = self.at / "parts.ostraka"
        built = run("build", *clouds, "-o", library, "--unit", "mm")
        for name in PARTS:
            self.assertEqual(built.stderr.count(name + ".xyz has no faces: its surface was rebuilt "
                                                "from 8000 points at a spacing of "), 1)
        found = json.loads(run("recognize", library, DATA / "scenes" / "table_2.pcd", "--unit",
                               "mm", "--json", "-").stdout)
        truth = json.loads((DATA / "scenes" / "table_2.json").read_text())
        for name in PARTS:
            points = read_ply(DATA / "parts" / (name + ".ply"))[0]
            diameter = max(math.dist(a, b) for a in points[::7] for b in points[::7])
            poses = [o["T_scene_model"] for o in truth["objects"] if o["model"] == name]
            hits = [o["T_scene_model"] for o in found["objects"] if o["model"] == name]
            self.assertEqual(len(poses), 1)
            self.assertGreaterEqual(len(hits), 1, name)
            error = min(adi(points, hit, poses[0]) for hit in hits) / diameter
            print(name, "ADI %.4f of the diameter" % error)
            self.assertLess(error, 0.02)

    def test_that_is_no_surface_is_refused_by_name(self):
        few = self.write("few.xyz", [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
        draw = random.Random(2)
        plane = self.write("plane.xyz", [[draw.random(), draw.random(), 0] for _ in range(2000)])
        for path in (few, plane):
            message = run("build", path, "-o", self.at / "x.ostraka", "--unit", "mm", code=3).stderr
            self.assertIn(path.name + ": no faces; ", message)
            self.assertFalse((self.at / "x.ostraka").exists())


if __name__ == "__main__":
    OSTRAKA, DATA = sys.argv[1], Path(sys.argv[2])
    unittest.main(argv=sys.argv[:1], verbosity=2)
