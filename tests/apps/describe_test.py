#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs `ostraka describe` as a user would: rows as CSV, JSON and pictures, bad input.

Usage: describe_test.py PATH_OF_OSTRAKA
"""
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

OSTRAKA = ""
LENGTHS = {"vfh": 308, "esf": 640, "gasd": 512, "shot": 352, "rops": 135, "cvfh": 308,
           "our_cvfh": 308, "shot_local": 352, "rops_local": 135, "pfh": 125, "fpfh": 33,
           "spin_image": 153}
LOCAL = ("shot_local", "rops_local", "pfh", "fpfh", "spin_image")
USAGE, INVALID, FILE, FORMAT = 2, 3, 4, 5


def run(*arguments):
    return subprocess.run([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)


def text_of(path):
    with open(path) as file:
        return file.read()


def picture_size(path):
    """Width and height of an 8-bit RGB PNG, whose pixels must be all there."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", data[16:24])
    packed, at = b"", 8
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    raw = zlib.decompress(packed)
    assert len(raw) == height * (1 + 3 * width)
    return width, height


class Describe(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="ostraka_describe_")
        assert run("parts", "clevis", "-o", cls.folder, "--format", "obj").returncode == 0
        made = run("views", os.path.join(cls.folder, "clevis.obj"), "-o", cls.folder, "--views", 12)
        assert made.returncode == 0, made.stderr
        cls.view = os.path.join(cls.folder, "clevis_0003.pcd")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def describe(self, name, *more):
        done = run("describe", self.view, "--descriptor", name, "--json", "-", *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def assert_fails(self, done, code, *words):
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertTrue(done.stderr.startswith("ostraka: "), done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_help_teaches(self):
        text = run("describe", "--help").stdout
        for word in ("our_cvfh", "spin_image", "--image", "--csv", "square roots", "ostraka views"):
            self.assertIn(word, text)

    def test_every_descriptor_says_what_it_is(self):
        for name, length in LENGTHS.items():
            found = self.describe(name, "--sampling", 3)
            self.assertEqual((found["descriptor"], found["length"]), (name, length))
            rows = found["rows"]
            kind = "local" if name in LOCAL else "regional" if "cvfh" in name else "global"
            self.assertEqual(found["kind"], kind)
            self.assertGreaterEqual(len(rows), 1)
            if kind != "regional":
                self.assertEqual(len(rows), found["points"] if kind == "local" else 1)
            for row in rows:
                self.assertEqual(len(row["values"]), length)
                self.assertTrue(all(math.isfinite(value) for value in row["values"]))
            self.assertTrue(any(value != 0 for value in rows[0]["values"]), name)
            self.assertEqual("point" in rows[0], kind == "local")

    def test_regions_have_frames(self):
        found = self.describe("our_cvfh")
        regions = found["regions"]
        self.assertGreaterEqual(len(regions), 2)
        sizes = [region["points"] for region in regions]
        self.assertEqual(sizes, sorted(sizes, reverse=True))
        for row in found["rows"]:
            pose = row["T_frame_cloud"]
            center = regions[row["region"]]["centroid"]
            for axis in range(3):
                moved = sum(pose[4 * axis + k] * center[k] for k in range(3)) + pose[4 * axis + 3]
                self.assertAlmostEqual(moved, 0.0, places=3)

    def test_csv_holds_the_same_numbers(self):
        file = self.path("rows.csv")
        for name, first in (("cvfh", "row"), ("fpfh", "x,y,z")):
            expected = self.describe(name, "--csv", file)["rows"]
            lines = text_of(file).splitlines()
            self.assertTrue(lines[0].startswith(first + ",0,1,2,"))
            self.assertEqual(len(lines), len(expected) + 1)
            numbers = [float(text) for text in lines[1].split(",")][len(first.split(",")):]
            for a, b in zip(numbers, expected[0]["values"]):
                self.assertAlmostEqual(a, b, delta=1e-6 * max(1.0, abs(b)))
        printed = run("describe", self.view, "--descriptor", "fpfh", "--csv", "-").stdout
        self.assertEqual(printed, text_of(file))

    def test_pictures_are_drawn(self):
        one, three = self.path("one.png"), self.path("three.png")
        self.describe("vfh", "--image", one)
        self.describe("shot_local", "--image", three, "--draw", "0,5,9")
        self.assertEqual(picture_size(one)[0], picture_size(three)[0])
        self.assertGreater(picture_size(three)[1], picture_size(one)[1])
        self.assertLess(os.path.getsize(one), 40_000)

    def test_threads_change_nothing(self):
        one = run("describe", self.view, "--descriptor", "our_cvfh", "--csv", "-", "--threads", 1)
        two = run("describe", self.view, "--descriptor", "our_cvfh", "--csv", "-", "--threads", 2)
        self.assertEqual(one.stdout, two.stdout)

    def test_bad_input_is_one_line(self):
        self.assert_fails(run("describe", self.view, "--descriptor", "vhf"), USAGE, "vhf", "our_cvfh")
        self.assert_fails(run("describe", self.view), USAGE, "--descriptor")
        self.assert_fails(run("describe", self.view, "--descriptor", "vfh", "--radius", 2), USAGE)
        self.assert_fails(run("describe", self.view, "--descriptor", "vfh", "--image",
                              self.path("x.png"), "--draw", 1), USAGE, "row 1")
        self.assert_fails(run("describe", self.view, "--descriptor", "gasd_color"), INVALID, "colors")
        self.assert_fails(run("describe", self.view, "--descriptor", "shot_local", "--radius", -1),
                          INVALID, "radius")
        self.assert_fails(run("describe", self.path("none.pcd"), "--descriptor", "vfh"), FILE)
        with open(self.path("two.xyz"), "w") as file:
            file.write("0 0 0\n1 0 0\n")
        for name in ("vfh", "cvfh", "fpfh"):
            self.assert_fails(run("describe", self.path("two.xyz"), "--descriptor", name), INVALID)
        self.assert_fails(run("describe", self.view, "--descriptor", "vfh", "--csv",
                              self.path("no/folder/rows.csv")), FILE)


if __name__ == "__main__":
    OSTRAKA = os.path.abspath(sys.argv.pop(1))
    unittest.main()
