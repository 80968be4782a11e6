#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs `ostraka advise` as a user would: JSON, report, bad input.

Usage: advise_test.py PATH_OF_OSTRAKA FOLDER_OF_PARTS
"""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

OSTRAKA = ""
PARTS = ""
USAGE = 2
NAMES = ["clevis", "flange", "l_bracket"]


def run(*arguments):
    return subprocess.run([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)


def without_seconds(value):
    if isinstance(value, dict):
        return {k: without_seconds(v) for k, v in value.items() if "seconds" not in k}
    if isinstance(value, list):
        return [without_seconds(v) for v in value]
    return value


class Advise(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="ostraka_advise_")
        cls.html = os.path.join(cls.folder.name, "advice.html")
        cls.models = [os.path.join(PARTS, name + ".ply") for name in NAMES]
        cls.asked = ["advise", *cls.models, "--unit", "mm", "--sensor", "structured-light-fine",
                     "--quick", "--scenes", 2, "--distances", "500,800", "--json", "-"]
        cls.done = run(*cls.asked, "--html", cls.html)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_json_answers_every_question(self):
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        advice = json.loads(self.done.stdout)
        self.assertEqual(advice["models"], NAMES)
        self.assertEqual([at["distance"] for at in advice["distances"]], [500, 800])
        objects = 0
        for part in advice["parts"]:
            self.assertIn(part["outlook"], ("good", "mixed", "bad"))
            self.assertTrue(part["verdict"])
            self.assertEqual(len(part["by_distance"]), 2)
            self.assertEqual(len(part["by_hidden"]), 4)
            for tried in part["by_distance"]:
                found = tried["found"]
                self.assertTrue(0 <= found["low"] <= found["value"] <= found["high"] <= 1)
                objects += tried["objects"]
            self.assertEqual(sum(t["objects"] for t in part["by_distance"]),
                             sum(t["objects"] for t in part["by_hidden"]))
        self.assertEqual(objects, sum(at["objects"] for at in advice["distances"]))
        self.assertEqual(objects, sum(advice["confusion"]))
        self.assertEqual([alike["part"] for alike in advice["look_alikes"]], NAMES)
        self.assertEqual(sum(trial["chosen"] for trial in advice["trials"]), 1)
        self.assertGreaterEqual(advice["sampling"]["by_rule"], advice["sampling"]["pixel_pitch"])
        for word in ("ostraka build", "--sampling", "--budget", *self.models):
            self.assertIn(word, advice["command"])

    def test_people_read_verdicts(self):
        for name in NAMES:
            self.assertRegex(self.done.stderr, rf"(?m)^{name}: .*found|^{name}: never")
        self.assertIn("ostraka build", self.done.stderr)

    def test_the_report_is_one_file(self):
        with open(self.html, encoding="utf-8") as file:
            page = file.read()
        self.assertIn("<svg", page)
        self.assertIn("data:image/png;base64", page)
        for name in NAMES:
            self.assertIn(name, page)
        outside = [url for url in re.findall(r"https?://[^\s\"'<>]+", page)
                   if not url.startswith("http://www.w3.org/")]
        self.assertEqual(outside, [])
        self.assertNotIn("<script", page)

    def test_threads_change_nothing_but_seconds(self):
        again = run(*self.asked, "--threads", 1)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(without_seconds(json.loads(again.stdout)),
                         without_seconds(json.loads(self.done.stdout)))

    def test_help_teaches(self):
        text = run("advise", "--help").stdout
        for word in ("structured-light-fine", "time-of-flight", "--distances", "--quick", "--html",
                     "Example"):
            self.assertIn(word, text)

    def test_wrong_command_lines(self):
        done = run("advise", *self.models, "--unit", "mm", "--sensor", "crystal-ball")
        self.assertEqual(done.returncode, USAGE, done.stderr)
        self.assertIn("crystal-ball", done.stderr)
        self.assertIn("structured-light", done.stderr)
        self.assertEqual(run("advise", *self.models, "--unit", "mm").returncode, USAGE)


if __name__ == "__main__":
    PARTS = os.path.abspath(sys.argv.pop(2))
    OSTRAKA = os.path.abspath(sys.argv.pop(1))
    unittest.main()
