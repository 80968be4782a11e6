#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs `ostraka calibrate` and `ostraka build --calibrate` as a user would.

Usage: calibrate_test.py PATH_OF_OSTRAKA
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

OSTRAKA = ""
PARTS = ["cam", "hook", "tee"]
COARSE = ["--unit", "mm", "--views", 20, "--directions", 6, "--budget", 24, "--sampling", 2]


def run(*arguments):
    return subprocess.run([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)


def succeed(*arguments):
    done = run(*arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


class Calibrate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="ostraka_calibrate_")
        succeed("parts", *PARTS, "-o", cls.path("parts"), "--format", "obj")
        cls.models = [os.path.join(cls.path("parts"), name + ".obj") for name in PARTS]
        cls.library = cls.path("at_once.ostraka")
        succeed("build", *cls.models, "-o", cls.library, *COARSE, "--calibrate")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    def dump(self, library):
        return succeed("export", library, "--dump", "-")

    def test_examples_are_what_it_learned_from(self):
        library = self.path("examples.ostraka")
        succeed("build", *self.models, "-o", library, *COARSE)
        path = self.path("examples.csv")
        learned = json.loads(succeed("calibrate", library, "--scenes", 3, "--examples", path, "--json", "-"))
        with open(path, encoding="ascii") as file:
            header, *rows = [line.strip().split(",") for line in file]
        self.assertEqual(header, [*learned["weights"], "right"])
        self.assertEqual(len(rows), learned["examples"])
        self.assertEqual(sum(int(row[-1]) for row in rows), learned["right"])
        self.assertTrue(all(float(row[0]) == 1.0 for row in rows))

    def test_build_does_what_the_three_commands_do_whatever_the_threads(self):
        steps = self.path("steps.ostraka")
        succeed("build", *self.models, "-o", steps, *COARSE)
        succeed("index", steps)
        learned = json.loads(succeed("calibrate", steps, "--json", "-", "--threads", 1))
        self.assertEqual(self.dump(steps), self.dump(self.library))
        with open(steps, "rb") as one, open(self.library, "rb") as other:
            self.assertEqual(one.read(), other.read())
        self.assertLess(learned["right"], learned["examples"])
        self.assertGreater(learned["right"], 20)
        self.assertGreater(len(learned["weights"]), 8)

    def test_recognition_says_whose_confidence_it_is(self):
        scans = self.path("scans")
        succeed("simulate", "drop", *self.models, "--unit", "mm", "-o", scans, "--scenes", 1,
                "--objects", 4, "--noise", 0.1, "--seed", 8, "--width", 400)
        page = self.path("why.html")
        succeed("recognize", self.library, os.path.join(scans, "scene_0000.pcd"), "--explain", page)
        with open(page, encoding="utf-8") as file:
            self.assertTrue("own, fitted to its models" in file.read())

    def test_other_scenes_give_other_weights(self):
        other = self.path("other.ostraka")
        with open(self.library, "rb") as source, open(other, "wb") as target:
            target.write(source.read())
        learned = json.loads(
            succeed("calibrate", other, "--scenes", 4, "--seed", 5, "--json", "-"))
        self.assertLess(learned["examples"], 40)
        with open(other, "rb") as one, open(self.library, "rb") as before:
            self.assertNotEqual(one.read(), before.read())

    def test_a_shard_is_not_calibrated(self):
        shard = self.path("shard.ostraka")
        done = run("build", *self.models, "-o", shard, *COARSE, "--shard", "1/2", "--calibrate")
        self.assertEqual(done.returncode, 2)
        self.assertIn("shard", done.stderr)
        self.assertFalse(os.path.exists(shard))

    def test_changed_models_make_the_weights_void(self):
        smaller = self.path("smaller.ostraka")
        succeed("remove", self.library, "cam", "-o", smaller)
        page = self.path("void.html")
        scans = self.path("void_scans")
        succeed("simulate", "drop", *self.models, "--unit", "mm", "-o", scans, "--scenes", 1,
                "--objects", 4, "--noise", 0.1, "--seed", 8, "--width", 400)
        succeed("recognize", smaller, os.path.join(scans, "scene_0000.pcd"), "--explain", page)
        with open(page, encoding="utf-8") as file:
            self.assertTrue("the general ones" in file.read())


if __name__ == "__main__":
    OSTRAKA = sys.argv.pop(1)
    unittest.main()
