#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs `ostraka symmetry` as a user would: the shipped parts, models_info.json, bad input.

Usage: symmetry_test.py PATH_OF_OSTRAKA FOLDER_OF_PARTS
"""
import json
import math
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

OSTRAKA = ""
PARTS = Path()
USAGE, INVALID, FILE = 2, 3, 4

# What the builders in src/ostraka/simulation/parts_*.cpp make. Most parts have one mirror plane or
# none, which leaves no turn. A bolt's hexagonal head is turned by 60 degrees, its thread is of rings;
# a wing nut's wings are two copies about z.
GROUPS = {"bolt": "C6", "wing_nut": "C2"}
UNSYMMETRIC = ["bearing_block", "cam", "clevis", "connecting_rod", "crank", "elbow", "flange", "fork",
               "gear", "heat_sink", "hook", "impeller", "knob", "l_bracket", "manifold_block",
               "pulley", "pump_housing", "stepped_shaft", "tee", "valve_body"]


def run(*arguments):
    return subprocess.run([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)


def write_cylinder(path):
    """Radius 10, from z = 0 to 60, 90 sides, as OBJ."""
    count = 90
    with open(path, "w", encoding="ascii") as file:
        for z in (0.0, 60.0):
            for i in range(count):
                angle = 2.0 * math.pi * i / count
                file.write(f"v {10.0 * math.cos(angle)} {10.0 * math.sin(angle)} {z}\n")
        for i in range(count):
            j = (i + 1) % count
            file.write(f"f {i + 1} {j + 1} {count + j + 1} {count + i + 1}\n")
        file.write("f " + " ".join(str(i + 1) for i in reversed(range(count))) + "\n")
        file.write("f " + " ".join(str(count + i + 1) for i in range(count)) + "\n")


def multiply(a, b):
    return [sum(a[4 * r + k] * b[4 * k + c] for k in range(4)) for r in range(4) for c in range(4)]


class Symmetry(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="ostraka_symmetry_")
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def assert_fails(self, done, code, *words):
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertTrue(done.stderr.startswith("ostraka: "), done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_shipped_parts_have_the_symmetry_they_were_made_with(self):
        expected = {**GROUPS, **{name: "C1" for name in UNSYMMETRIC}}
        files = sorted(PARTS.glob("*.ply"))
        self.assertEqual(sorted(expected), [file.stem for file in files])
        done = run("symmetry", *files, "--unit", "mm", "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        models = json.loads(done.stdout)["models"]
        self.assertEqual({m["model"]: m["group"] for m in models}, expected)
        for model in models:
            self.assertEqual(len(model["T_model_model"]), {"C6": 5, "C2": 1}.get(model["group"], 0))

    def test_visible_surface_gives_the_same(self):
        files = [PARTS / f"{name}.ply" for name in ("bolt", "wing_nut", "gear")]
        done = run("symmetry", *files, "--unit", "mm", "--outside", "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        groups = [model["group"] for model in json.loads(done.stdout)["models"]]
        self.assertEqual(groups, ["C6", "C2", "C1"])

    def test_table_names_groups_in_words(self):
        done = run("symmetry", PARTS / "bolt.ply", PARTS / "gear.ply", "--unit", "mm")
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        bolt, gear = done.stderr.splitlines()[-2:]
        self.assertIn("C6", bolt)
        self.assertIn("6-fold about (0 0 1)", bolt)
        self.assertIn("none", gear)

    def test_writes_models_info(self):
        write_cylinder(self.path("rod.obj"))
        done = run("symmetry", PARTS / "bolt.ply", self.path("rod.obj"), "--unit", "cm",
                   "-o", self.path("models_info.json"))
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path("models_info.json"), encoding="utf-8") as file:
            infos = json.load(file)
        self.assertEqual(list(infos), ["1", "2"])
        bolt, rod = infos["1"], infos["2"]
        self.assertEqual((bolt["name"], rod["name"]), ("bolt", "rod"))
        self.assertNotIn("symmetries_continuous", bolt)
        self.assertEqual(len(bolt["symmetries_discrete"]), 5)
        # Six times a sixth of a turn, about a line that needn't pass the origin, is no turn.
        power = turn = bolt["symmetries_discrete"][0]
        for _ in range(5):
            power = multiply(turn, power)
        for k in range(16):
            self.assertAlmostEqual(power[k], 1.0 if k % 5 == 0 else 0.0, places=6)
        # Lengths in the file are mm, whatever the unit of the model.
        self.assertAlmostEqual(rod["diameter"], 10.0 * math.hypot(20.0, 60.0), delta=4.0)
        for key, value in (("min_x", -100.0), ("min_z", 0.0), ("size_y", 200.0), ("size_z", 600.0)):
            self.assertAlmostEqual(rod[key], value, delta=0.5)
        (axis,) = rod["symmetries_continuous"]
        self.assertAlmostEqual(abs(axis["axis"][2]), 1.0, places=4)
        self.assertAlmostEqual(axis["offset"][0], 0.0, delta=2.0)
        self.assertAlmostEqual(axis["offset"][1], 0.0, delta=2.0)
        (flip,) = rod["symmetries_discrete"]
        self.assertAlmostEqual(flip[10], -1.0, places=6)  # z to -z, about the middle
        self.assertAlmostEqual(flip[11], 600.0, delta=3.0)

    def test_tolerance_is_used(self):
        write_cylinder(self.path("rod.obj"))
        groups = []
        for tolerance in (0.01, 0.00005):
            done = run("symmetry", self.path("rod.obj"), "--unit", "mm", "--tolerance", tolerance,
                       "--json", "-")
            self.assertEqual(done.returncode, 0, done.stderr)
            groups.append(json.loads(done.stdout)["models"][0]["group"])
        self.assertEqual(groups[0], "D-infinity")
        self.assertNotEqual(groups[1], "D-infinity")

    def test_threads_change_nothing(self):
        results = []
        for threads in (1, 2):
            done = run("symmetry", PARTS / "bolt.ply", "--unit", "mm", "--json", "-", "--threads",
                       threads)
            (model,) = json.loads(done.stdout)["models"]
            model.pop("milliseconds")
            results.append(model)
        self.assertEqual(*results)

    def test_bad_input_is_one_line(self):
        bolt = PARTS / "bolt.ply"
        self.assert_fails(run("symmetry"), USAGE, "models")
        self.assert_fails(run("symmetry", bolt), USAGE, "--unit")
        self.assert_fails(run("symmetry", bolt, "--unit", "mm", "--tolerance", 0.2), INVALID,
                          "tolerance")
        self.assert_fails(run("symmetry", bolt, bolt, "--unit", "mm"), INVALID, "bolt")
        self.assert_fails(run("symmetry", self.path("none.ply"), "--unit", "mm"), FILE, "none.ply")
        for option in ("--json", "-o"):
            done = run("symmetry", bolt, "--unit", "mm", option, self.path("no/folder/x.json"))
            self.assertEqual(done.returncode, FILE, done.stderr)
            self.assertTrue(done.stderr.splitlines()[-1].startswith("ostraka: "), done.stderr)


if __name__ == "__main__":
    OSTRAKA = os.path.abspath(sys.argv.pop(1))
    PARTS = Path(sys.argv.pop(1)).resolve()
    unittest.main()
