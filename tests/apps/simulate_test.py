#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs `ostraka simulate` and `ostraka evaluate` on its scenes as a user would.

Usage: simulate_test.py PATH_OF_OSTRAKA FOLDER_OF_PARTS
"""
import hashlib
import json
import os
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from html.parser import HTMLParser
from pathlib import Path

OSTRAKA = ""
PARTS = Path()
USAGE, INVALID = 2, 3
SENSORS = ["ideal", "structured-light", "structured-light-fine", "stereo", "time-of-flight",
           "laser-line"]


def run(*arguments):
    return subprocess.run([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)


def digests(folder):
    return {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest()
            for p in sorted(Path(folder).rglob("*")) if p.is_file()}


def without_seconds(value):
    if isinstance(value, dict):
        return {k: without_seconds(v) for k, v in value.items() if not k.startswith("seconds")}
    return [without_seconds(v) for v in value] if isinstance(value, list) else value


def png_depths(path):
    """A 16-bit gray PNG's values; only filters 0 to 4, undone by hand."""
    data, place, packed = path.read_bytes(), 8, b""
    while place < len(data):
        size, kind = struct.unpack(">I4s", data[place:place + 8])
        if kind == b"IHDR":
            width, height = struct.unpack(">II", data[place + 8:place + 16])
        if kind == b"IDAT":
            packed += data[place + 8:place + 8 + size]
        place += 12 + size
    raw, values, above = zlib.decompress(packed), [], bytearray(2 * width)
    for y in range(height):
        start = y * (2 * width + 1)
        kind, row = raw[start], bytearray(raw[start + 1:start + 1 + 2 * width])
        for i in range(2 * width):
            a, b, c = (row[i - 2] if i > 1 else 0), above[i], (above[i - 2] if i > 1 else 0)
            guess = a + b - c
            paeth = min((abs(guess - a), 0, a), (abs(guess - b), 1, b), (abs(guess - c), 2, c))[2]
            row[i] = (row[i] + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
        values += struct.unpack(f">{width}H", bytes(row))
        above = row
    return values


def pcd_depths(path):
    """The z of every point of a binary PCD whose fields are all floats."""
    head, body = re.split(rb"(?<=DATA binary\n)", path.read_bytes(), maxsplit=1)
    words = {line.split()[0]: line.split()[1:] for line in head.decode().splitlines()
             if line and line[0] != "#"}
    assert set(words["SIZE"]) == {"4"}
    fields, count = words["FIELDS"], int(words["POINTS"][0])
    floats = struct.unpack(f"<{count * len(fields)}f", body[:4 * count * len(fields)])
    return floats[fields.index("z")::len(fields)]


class Balance(HTMLParser):
    """Every element that is opened is closed, in order."""
    VOID = {"meta", "link", "img", "br", "hr", "input", "col", "wbr"}

    def __init__(self):
        super().__init__()
        self.open, self.problems, self.seen = [], [], set()

    def handle_starttag(self, tag, attrs):
        self.seen.add(tag)
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.seen.add(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.problems.append((tag, self.getpos()))


class Simulate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory(prefix="ostraka_simulate_")
        cls.folder = Path(cls.holder.name)
        cls.parts = [PARTS / f"{name}.ply" for name in ("hook", "l_bracket", "wing_nut")]
        cls.library = cls.folder / "parts.ostraka"
        done = run("build", *cls.parts, "--unit", "mm", "-o", cls.library, "--views", 12,
                   "--directions", 6, "--fractions", 0.5, "--budget", 8, "--spread", 0,
                   "--sampling", 3)
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def setUp(self):
        self.own = Path(tempfile.mkdtemp(dir=self.folder))

    def run_well(self, *arguments):
        done = run(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def simulate(self, kind, name, *options, scenes=2):
        self.run_well("simulate", kind, *self.parts, "--unit", "mm", "--width", 160, "--scenes",
                      scenes, "--seed", 7, "-o", self.own / name, *options)
        return self.own / name

    def evaluate(self, what, *options):
        return json.loads(self.run_well("evaluate", what, self.library, *options, "--json", "-"))

    def assert_fails(self, code, done, *words):
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertTrue(done.stderr.startswith("ostraka: "), done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_truth_of_a_bop_set_judges_itself_as_right(self):
        root = self.simulate("drop", "set", "--format", "bop", "--objects", 5)
        lines = []
        truths = json.loads((root / "test/000001/scene_gt.json").read_text())
        for image, objects in truths.items():
            for o in objects:
                numbers = [" ".join(map(repr, o[k])) for k in ("cam_R_m2c", "cam_t_m2c")]
                lines.append(f"1,{image},{o['obj_id']},1,{numbers[0]},{numbers[1]},-1")
        (self.own / "truth.csv").write_text("\n".join(lines) + "\n")
        answer = self.evaluate("pose", "--on", "scans", "--data", root, "--results",
                               self.own / "truth.csv")
        self.assertEqual(answer["recall"], 1.0)
        self.assertEqual(answer["scenes"], 2)
        own = [p for scene in answer["details"] for p in scene["pairs"] if p["adi"] < 1e-3]
        self.assertEqual(len(own), 10)
        for pair in own:
            self.assertLess(pair["mssd"], 1e-9)
            self.assertLess(pair["mspd"], 1e-6)
        recalls = answer["average_recall"]
        self.assertAlmostEqual(recalls["mssd"], 1.0)
        self.assertAlmostEqual(recalls["mspd"], 1.0)
        self.assertAlmostEqual(recalls["vsd"], 1.0)

    def test_depth_images_hold_the_clouds_depths(self):
        clouds = self.simulate("tabletop", "clouds", "--sensor", "structured-light")
        images = self.simulate("tabletop", "images", "--sensor", "structured-light", "--format",
                               "depth")
        step = json.loads((images / "camera.json").read_text())["depth_scale"]
        self.assertAlmostEqual(step, 0.1)
        for scene in range(2):
            depths = pcd_depths(clouds / f"scene_{scene:04}.pcd")
            values = png_depths(images / f"scene_{scene:04}.png")
            self.assertEqual(len(depths), len(values))
            self.assertGreater(sum(v > 0 for v in values), 3000)
            for depth, value in zip(depths, values):
                if depth != depth:
                    self.assertEqual(value, 0)
                else:
                    self.assertLessEqual(abs(value * step - depth), 0.5001 * step)

    def test_every_kind_is_the_same_for_any_number_of_threads(self):
        layout = self.simulate("drop", "layout_set", "--format", "bop")
        for kind in ("tabletop", "drop", "bin", "random-views", "layout"):
            options = ["--data", layout] if kind == "layout" else []
            one, two = (digests(self.simulate(kind, f"{kind}_{n}", *options, "--threads", n,
                                              "--format", "bop", "--sensor", "stereo"))
                        for n in (1, 2))
            self.assertGreater(len(one), 5, kind)
            self.assertEqual(one, two, kind)

    def test_every_sensor_sees_something(self):
        seen = set()
        for sensor in SENSORS:
            folder = self.simulate("drop", sensor, "--sensor", sensor, scenes=1)
            depths = pcd_depths(folder / "scene_0000.pcd")
            self.assertGreater(sum(d == d for d in depths), 2000, sensor)
            seen.add(depths)
        self.assertEqual(len(seen), len(SENSORS))

    def test_bad_options_are_one_line(self):
        base = ["simulate", "bin", *self.parts, "--unit", "mm", "-o", self.own / "bad"]
        self.assert_fails(USAGE, run(*base, "--sensor", "sonar"), "sonar", "stereo")
        self.assert_fails(USAGE, run(*base, "--bin", "100,100"), "--bin")
        self.assert_fails(USAGE, run(*base, "--bin", "100,wide,50"), "--bin")
        self.assert_fails(INVALID, run(*base, "--bin", "100,-5,50"), "bin")
        self.assert_fails(USAGE, run("simulate", "layout", *base[2:]), "--data")
        self.assert_fails(USAGE, run("simulate", "heap", *base[2:]), "heap")
        self.assertFalse((self.own / "bad").exists())

    def test_report_is_one_well_formed_file(self):
        page = self.own / "page.html"
        self.evaluate("scenes", "--on", "drop", "--width", 160, "--scenes", 2, "--html", page)
        text = page.read_text(encoding="utf-8")
        self.assertTrue(text.lower().startswith("<!doctype html>"))
        # All that is loaded is in the file. (A namespace is a name, not a place.)
        links = re.findall(r"""(?:src|href)\s*=\s*["']?([^"'\s>]*)|url\(([^)]*)\)|@import""", text)
        for link in links:
            self.assertTrue("".join(link).startswith(("data:", "#")), link)
        self.assertFalse(re.search(r"https?://(?!www\.w3\.org/)", text))
        balance = Balance()
        balance.feed(text)
        balance.close()
        self.assertEqual((balance.open, balance.problems), ([], []))
        self.assertIn("svg", balance.seen)

    def test_journal_goes_on_after_truncation(self):
        journal = self.own / "journal"
        for what in ("scenes", "segments"):
            options = ["--on", "random-views", "--width", 160, "--scenes", 4, "--journal", journal]
            first = without_seconds(self.evaluate(what, *options))
            whole = journal.read_bytes()
            self.assertEqual(whole.count(b"\n"), 4)
            journal.write_bytes(whole[:len(whole) * 5 // 8])
            kept = journal.read_bytes().count(b"\n")
            self.assertTrue(0 < kept < 4)
            self.assertEqual(without_seconds(self.evaluate(what, *options)), first)
            self.assertEqual(journal.read_bytes().count(b"\n"), 4)
            journal.unlink()

    def test_segments_are_the_same_for_any_number_of_threads(self):
        one, two = (self.evaluate("segments", "--on", "random-views", "--width", 160, "--scenes", 4,
                                  "--k", "1,3", "--threads", n) for n in (1, 2))
        self.assertGreater(one["results"][0]["segments"], 2)
        self.assertEqual(one, two)


if __name__ == "__main__":
    OSTRAKA = os.path.abspath(sys.argv.pop(1))
    PARTS = Path(sys.argv.pop(1)).resolve()
    unittest.main()
