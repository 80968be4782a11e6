#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Libraries from libraries on the command line: shards, merge, add, remove, rename.

Usage: library_edit_test.py PATH_OF_OSTRAKA
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

OSTRAKA = ""
PARTS = ["cam", "hook", "tee"]
QUICK = ["--unit", "mm", "--views", "12", "--directions", "6", "--budget", "12"]
INVALID = 3


def run(*arguments):
    return subprocess.run([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True)


def content(path):
    with open(path, "rb") as file:
        return file.read()


class LibraryEdit(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="ostraka_edit_")
        made = run("parts", *PARTS, "-o", cls.folder, "--format", "obj")
        assert made.returncode == 0, made.stderr
        cls.models = [cls.path(name + ".obj") for name in PARTS]
        cls.whole = cls.path("whole.ostraka")
        built = run("build", *cls.models, "-o", cls.whole, *QUICK)
        assert built.returncode == 0, built.stderr

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    def succeed(self, *arguments):
        result = run(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr)

    def digest(self, path):
        result = run("verify", path, "--json", "-")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)["sha256"]

    def refuse(self, *arguments, says):
        result = run(*arguments)
        self.assertEqual(result.returncode, INVALID, result.stderr)
        self.assertIn(says, result.stderr)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)

    def test_merged_shards_are_the_library_built_at_once(self):
        shards = []
        for i in (1, 2):
            shards.append(self.path(f"shard{i}.ostraka"))
            self.succeed("build", *self.models, "-o", shards[-1], *QUICK, "--shard", f"{i}/2",
                         "--threads", i)
        merged = self.path("merged.ostraka")
        self.succeed("merge", *reversed(shards), "-o", merged)
        self.assertEqual(content(merged), content(self.whole))

    def test_remove_and_add_again(self):
        library = self.path("edited.ostraka")
        shutil.copy(self.whole, library)
        self.succeed("remove", library, "hook")
        self.assertNotEqual(self.digest(library), self.digest(self.whole))
        self.refuse("remove", library, "hook", says="hook")
        self.succeed("add", library, self.path("hook.obj"))
        self.assertEqual(self.digest(library), self.digest(self.whole))
        self.succeed("add", library, self.path("hook.obj"))  # is there already: nothing to do
        self.assertEqual(self.digest(library), self.digest(self.whole))
        other = self.path("other")
        os.mkdir(other)
        shutil.copy(self.path("cam.obj"), os.path.join(other, "hook.obj"))
        self.refuse("add", library, os.path.join(other, "hook.obj"), says="hook")
        self.assertEqual(self.digest(library), self.digest(self.whole))
        shards = [self.path(f"edited{i}.ostraka") for i in (1, 2)]
        self.succeed("remove", library, "hook", "-o", shards[0])
        self.succeed("remove", library, "cam", "tee", "-o", shards[1])
        self.succeed("merge", *shards, "-o", self.path("again.ostraka"))
        self.assertEqual(content(self.path("again.ostraka")), content(self.whole))

    def test_rename_there_and_back(self):
        renamed = self.path("renamed.ostraka")
        self.succeed("rename", self.whole, "cam", "zeta", "-o", renamed)
        self.assertNotEqual(self.digest(renamed), self.digest(self.whole))
        self.succeed("rename", renamed, "zeta", "cam")
        self.assertEqual(self.digest(renamed), self.digest(self.whole))
        self.refuse("rename", renamed, "cam", "tee", says="tee")

    def test_a_setting_that_differs_is_named(self):
        other = self.path("other.ostraka")
        self.succeed("build", self.models[0], "-o", other, *QUICK, "--sampling", 3)
        self.refuse("merge", self.whole, other, "-o", self.path("none.ostraka"), says="sampling")
        self.assertFalse(os.path.exists(self.path("none.ostraka")))

    def test_a_model_may_have_a_unit_of_its_own(self):
        in_cm = self.path("cam_cm")
        os.mkdir(in_cm)
        with open(self.models[0]) as source, open(os.path.join(in_cm, "cam.obj"), "w") as target:
            for line in source:
                if line.startswith("v "):
                    line = "v " + " ".join(str(float(c) / 10) for c in line.split()[1:4]) + "\n"
                target.write(line)
        result = run("build", os.path.join(in_cm, "cam.obj") + ":cm", self.models[1],
                     "-o", self.path("mixed.ostraka"), *QUICK, "--json", "-")
        self.assertEqual(result.returncode, 0, result.stderr)
        alike = run("build", *self.models[:2], "-o", self.path("alike.ostraka"), *QUICK, "--json", "-")
        sizes = [[m["diameter"] for m in json.loads(r.stdout)["models"]] for r in (result, alike)]
        for a, b in zip(*sizes):
            self.assertAlmostEqual(a, b, delta=1e-4 * b)

    def test_export_writes_what_other_programs_read(self):
        folder = self.path("exported")
        self.succeed("export", self.whole, "-o", folder, "--entries")
        with open(os.path.join(folder, "models", "models_info.json")) as file:
            infos = json.load(file)
        self.assertEqual(sorted(infos), ["1", "2", "3"])
        self.assertTrue(os.path.exists(os.path.join(folder, "models", "obj_000003.ply")))
        self.assertEqual(len([f for f in os.listdir(os.path.join(folder, "entries", "tee"))
                              if f.endswith(".ply")]), 12)
        with open(os.path.join(folder, "entries", "tee", "vfh.csv")) as file:
            rows = [line.split(",") for line in file]
        self.assertEqual([len(row) for row in rows], [308] * 12)

    def test_a_dump_is_equal_for_equal_content(self):
        edited = self.path("dumped.ostraka")
        shutil.copy(self.whole, edited)
        self.succeed("rename", edited, "cam", "zeta")
        self.succeed("rename", edited, "zeta", "cam")
        self.assertNotEqual(content(edited), content(self.whole))
        dumps = [run("export", path, "--dump", "-").stdout for path in (edited, self.whole)]
        self.assertGreater(len(dumps[0]), 100_000)
        self.assertEqual(*dumps)
        self.assertEqual(run("export", edited).returncode, 2)

    def test_wrong_shards_are_refused(self):
        for shard in ("0/2", "3/2", "1", "a/b", "1/2/3"):
            result = run("build", *self.models, "-o", self.path("x.ostraka"), *QUICK, "--shard", shard)
            self.assertEqual(result.returncode, 2, result.stderr)
        self.refuse("build", *self.models, "-o", self.path("x.ostraka"), *QUICK, "--shard", "5/5",
                    says="fewer shards")


if __name__ == "__main__":
    OSTRAKA = sys.argv.pop(1)
    unittest.main()
