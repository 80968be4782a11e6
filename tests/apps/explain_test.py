#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs `ostraka recognize` with --explain, --time-limit and --only as a user would.

Usage: explain_test.py PATH_OF_OSTRAKA
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

OSTRAKA = ""
PARTS = ["cam", "hook", "tee"]


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def run(*arguments):
    return subprocess.run([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)


class Explain(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="ostraka_explain_")
        parts = cls.path("parts")
        models = [os.path.join(parts, name + ".obj") for name in PARTS]
        cls.library = cls.path("three.ostraka")
        for command in (
                ["parts", *PARTS, "-o", parts, "--format", "obj"],
                ["build", *models, "-o", cls.library, "--unit", "mm", "--views", 20,
                 "--directions", 6, "--budget", 24],
                ["simulate", "tabletop", *models, "--unit", "mm", "-o", cls.path("scans"),
                 "--scenes", 1, "--objects", 3, "--noise", 0.1, "--seed", 4, "--width", 400]):
            done = run(*command)
            assert done.returncode == 0, done.stderr
        cls.scan = os.path.join(cls.path("scans"), "scene_0000.pcd")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    def recognize(self, *more):
        done = run("recognize", self.library, self.scan, "--json", "-", *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout), done.stderr

    def test_page_names_each_object_and_gives_reasons(self):
        page = self.path("why.html")
        found, said = self.recognize("--explain", page)
        self.assertIn("explanation: " + page, said)
        self.assertTrue(found["objects"])
        html = read(page)
        for number, thing in enumerate(found["objects"], 1):
            self.assertIn("%s #%d" % (thing["model"], number), html)
        self.assertEqual(html.count("<p>Reported: confidence"), len(found["objects"]))
        for words in ("Near misses", "nine in ten", "of the silhouette", "data:image/png"):
            self.assertIn(words, html)

    def test_explaining_changes_nothing(self):
        plain, _ = self.recognize()
        explained, _ = self.recognize("--explain", self.path("same.html"))
        self.assertEqual(plain["objects"], explained["objects"])

    def test_json_tells_what_the_confidence_comes_from(self):
        found, _ = self.recognize()
        self.assertIs(found["out_of_time"], False)
        for thing in found["objects"]:
            self.assertGreaterEqual(thing["round"], 0)
            self.assertGreater(thing["features"]["clearness"], 0.5)
            self.assertEqual(thing["features"]["constant"], 1)

    def test_time_limit_ends_the_search(self):
        page = self.path("late.html")
        found, said = self.recognize("--time-limit", "0.000001", "--explain", page)
        self.assertIs(found["out_of_time"], True)
        self.assertIn("the time limit ended the search: what is best so far is reported", said)
        self.assertIn("The time limit ended the search", read(page))
        wrong = run("recognize", self.library, self.scan, "--time-limit", "-1")
        self.assertEqual(wrong.returncode, 2, wrong.stderr)

    def test_only_restricts_the_search(self):
        everything, _ = self.recognize()
        names = {thing["model"] for thing in everything["objects"]}
        for name in names:
            found, _ = self.recognize("--only", name)
            self.assertEqual({thing["model"] for thing in found["objects"]}, {name})
        both, _ = self.recognize("--only", "cam, tee")
        self.assertLessEqual({thing["model"] for thing in both["objects"]}, {"cam", "tee"})

    def test_only_with_a_wrong_name_tells_which_there_are(self):
        for names in ("crank", "cam,crank", ","):
            done = run("recognize", self.library, self.scan, "--only", names)
            self.assertIn(done.returncode, (2, 3), done.stderr)
            self.assertEqual(done.stdout, "")
        done = run("recognize", self.library, self.scan, "--only", "cam,crank")
        self.assertIn('"crank"', done.stderr)
        for name in PARTS:
            self.assertIn(name, done.stderr)


if __name__ == "__main__":
    OSTRAKA = sys.argv.pop(1)
    unittest.main()
