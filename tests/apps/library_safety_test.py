#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Nothing is lost: kill -9, a full disk, a read-only file, two writers at once.

Usage: library_safety_test.py PATH_OF_OSTRAKA

OSTRAKA_KILLS (default 50) is the number of kills, spread over build, add and merge.
"""
import json
import os
import random
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
import unittest

OSTRAKA = ""
PARTS = ["cam", "gear", "hook", "tee"]
QUICK = ["--unit", "mm", "--views", "12", "--directions", "6", "--budget", "12", "--sampling", "1.5"]
FILE_ERROR = 4
NOBODY = 65534


def run(*arguments, **options):
    return subprocess.run([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, check=False, **options)


def start(*arguments):
    return subprocess.Popen([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL,
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def content(path):
    with open(path, "rb") as file:
        return file.read()


def digest(path):
    """What the library says; asserts that verify passes."""
    result = run("verify", path, "--json", "-")
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)["sha256"]


class LibrarySafety(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="ostraka_safety_")
        os.chmod(cls.folder, 0o755)
        assert run("parts", *PARTS, "-o", cls.folder).returncode == 0
        cls.models = [cls.path(name + ".ply") for name in PARTS]
        cls.whole = cls.path("whole.ostraka")
        started = time.monotonic()
        built = run("build", *cls.models, "-o", cls.whole, *QUICK)
        cls.build_seconds = time.monotonic() - started
        assert built.returncode == 0, built.stderr
        cls.one = cls.path("one.ostraka")
        assert run("build", cls.models[0], "-o", cls.one, *QUICK).returncode == 0
        cls.rest = cls.path("rest.ostraka")
        assert run("build", *cls.models[1:], "-o", cls.rest, *QUICK).returncode == 0

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    def kill_often(self, kills, seconds, command, target, after_each):
        """Kills the command at random moments; returns how often it was killed before its end."""
        chance = random.Random(len(command))
        killed = 0
        for _ in range(kills):
            process = start(*command)
            time.sleep(chance.uniform(0.0, seconds))
            process.send_signal(signal.SIGKILL)
            killed += process.wait() == -signal.SIGKILL
            if os.path.exists(target):
                after_each()
        return killed

    def litter(self, name):
        return [f for f in os.listdir(self.folder) if name in f and f != name]

    def test_killed_builds_go_on_where_they_stopped(self):
        target = self.path("built.ostraka")
        shutil.copy(self.one, target)  # an earlier library stays until the new one is complete
        before, whole = digest(self.one), digest(self.whole)
        command = ["build", *self.models, "-o", target, *QUICK]
        kills = int(os.environ.get("OSTRAKA_KILLS", "50")) * 2 // 5
        killed = self.kill_often(kills, self.build_seconds, command, target,
                                 lambda: self.assertIn(digest(target), (before, whole)))
        self.assertGreater(killed, 0)
        self.assertEqual(run(*command).returncode, 0)
        self.assertEqual(content(target), content(self.whole))
        self.assertEqual(self.litter("built.ostraka"), [])

    def test_a_build_does_not_repeat_what_is_done(self):
        target = self.path("resumed.ostraka")
        command = ["build", *self.models, "-o", target, *QUICK, "--threads", "1", "--json", "-"]
        for share in (0.7, 1.0, 1.3, 1.6, 1.9):  # until a model or more, but not all, are done
            process = start(*command)
            time.sleep(self.build_seconds * share)
            process.send_signal(signal.SIGKILL)
            process.wait()
            result = run(*command)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(content(target), content(self.whole))
            if json.loads(result.stdout)["resumed"] > 0:
                return
        self.fail("no build went on from another")

    def test_an_unfinished_build_with_other_settings_is_not_used(self):
        target = self.path("other.ostraka")
        process = start("build", *self.models, "-o", target, *QUICK, "--seed", "5")
        time.sleep(self.build_seconds * 0.8)
        process.send_signal(signal.SIGKILL)
        process.wait()
        result = run("build", *self.models, "-o", target, *QUICK, "--json", "-")
        self.assertEqual(json.loads(result.stdout)["resumed"], 0)
        self.assertEqual(content(target), content(self.whole))

    def test_killed_adds_can_be_repeated(self):
        target = self.path("added.ostraka")
        whole = digest(self.whole)
        seconds = self.build_seconds * 0.75
        kills = int(os.environ.get("OSTRAKA_KILLS", "50")) * 3 // 10
        command = ["add", target, *self.models]
        killed = 0
        for _ in range(3):
            shutil.copy(self.one, target)
            killed += self.kill_often(kills // 3, seconds, command, target, lambda: digest(target))
        self.assertGreater(killed, 0)
        self.assertEqual(run(*command).returncode, 0)
        self.assertEqual(digest(target), whole)
        self.assertEqual(self.litter("added.ostraka"), [])

    def test_killed_merges_can_be_repeated(self):
        target = self.path("merged.ostraka")
        shutil.copy(self.one, target)
        before, whole = digest(self.one), digest(self.whole)
        command = ["merge", self.rest, self.one, "-o", target]
        started = time.monotonic()
        self.assertEqual(run(*command[:-1], self.path("timed.ostraka")).returncode, 0)
        seconds = time.monotonic() - started
        kills = int(os.environ.get("OSTRAKA_KILLS", "50")) * 3 // 10
        self.kill_often(kills, seconds, command, target,
                        lambda: self.assertIn(digest(target), (before, whole)))
        self.assertEqual(run(*command).returncode, 0)
        self.assertEqual(content(target), content(self.whole))
        self.assertEqual(self.litter("merged.ostraka"), [])

    def refuse_and_keep(self, *command, target, says, **options):
        before = content(target) if os.path.exists(target) else None
        result = run(*command, **options)
        self.assertEqual(result.returncode, FILE_ERROR, result.stderr)
        self.assertIn(says, result.stderr)
        if before is not None:
            self.assertEqual(content(target), before)

    def test_a_file_that_may_not_grow_is_an_error(self):
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (2 << 20, 2 << 20))

        target = self.path("limited.ostraka")
        shutil.copy(self.one, target)
        options = {"preexec_fn": limit, "restore_signals": False}
        self.refuse_and_keep("merge", self.one, self.rest, "-o", target, target=target,
                             says="limited.ostraka", **options)
        self.refuse_and_keep("build", *self.models, "-o", target, *QUICK, target=target,
                             says="limited.ostraka", **options)
        before = digest(target)
        self.assertEqual(run("add", target, *self.models[1:], **options).returncode, FILE_ERROR)
        run("verify", target)  # takes back what was half-written
        digest(target)
        self.assertEqual(before, digest(self.one))
        self.assertEqual(run("add", target, *self.models).returncode, 0)
        self.assertEqual(digest(target), digest(self.whole))

    def test_a_full_disk_is_an_error(self):
        disk = self.path("disk")
        os.mkdir(disk)
        script = (f"mount -t tmpfs -o size=3m none {disk} && cp {self.one} {disk}/a.ostraka && "
                  f"{OSTRAKA} merge {self.one} {self.rest} -o {disk}/a.ostraka; echo $?; "
                  f"{OSTRAKA} add {disk}/a.ostraka {' '.join(self.models[1:])}; echo $?; "
                  f"{OSTRAKA} verify {disk}/a.ostraka; echo $?; ls -A {disk}")
        result = subprocess.run(["unshare", "-rm", "sh", "-c", script], capture_output=True, text=True,
                                check=False)
        if "mount" in result.stderr or "unshare" in result.stderr:
            self.skipTest("this machine doesn't let a test mount a small disk: "
                          + result.stderr.strip().splitlines()[0])
        self.assertEqual(result.stdout.split(), [str(FILE_ERROR), str(FILE_ERROR), "0", "a.ostraka"],
                         result.stderr)
        self.assertEqual(result.stderr.count("no space left on the disk"), 2, result.stderr)

    def test_a_read_only_file_is_an_error(self):
        folder = self.path("read_only")
        os.mkdir(folder)
        target = os.path.join(folder, "a.ostraka")
        shutil.copy(self.one, target)
        os.chmod(target, stat.S_IRUSR | stat.S_IRGRP | stat.S_IROTH)
        os.chmod(folder, 0o755)

        def drop_rights():
            if os.geteuid() == 0:
                os.setuid(NOBODY)  # nothing is read-only to root

        if os.geteuid() == 0:
            probe = subprocess.run([OSTRAKA, "--help"], preexec_fn=drop_rights, capture_output=True,
                                   check=False)
            if probe.returncode != 0:
                self.skipTest("runs as root, and another user may not run the program")
        options = {"preexec_fn": drop_rights}
        for command in (["add", target, self.models[1]], ["remove", target, "cam"],
                        ["rename", target, "cam", "x"], ["merge", self.one, self.rest, "-o", target],
                        ["build", self.models[1], "-o", target, *QUICK]):
            self.refuse_and_keep(*command, target=target, says="a.ostraka", **options)
        self.assertEqual(run("verify", target, **options).returncode, 0)

    def test_two_builds_of_one_library_at_once(self):
        target = self.path("twice.ostraka")
        command = ["build", *self.models, "-o", target, *QUICK]
        both = [start(*command), start(*command)]
        codes = sorted(process.wait() for process in both)
        self.assertIn(codes, ([0, 0], [0, FILE_ERROR]))  # the second may begin after the first's end
        self.assertEqual(content(target), content(self.whole))
        self.assertEqual(self.litter("twice.ostraka"), [])

    def test_two_adds_at_once_both_count(self):
        target = self.path("shared.ostraka")
        shutil.copy(self.one, target)
        both = [start("add", target, self.models[1]), start("add", target, *self.models[2:])]
        self.assertEqual([process.wait() for process in both], [0, 0])
        self.assertEqual(digest(target), digest(self.whole))

    def test_damage_is_found(self):
        damaged = self.path("damaged.ostraka")
        for position in (100_000, 1_000_003, os.path.getsize(self.whole) - 5000):
            shutil.copy(self.whole, damaged)
            with open(damaged, "r+b") as file:
                file.seek(position)
                byte = file.read(1)[0]
                file.seek(position)
                file.write(bytes([byte ^ 0x10]))
            result = run("verify", damaged)
            self.assertEqual(result.returncode, 5, f"byte {position}: {result.stderr}")
            self.assertIn("damaged.ostraka", result.stderr)


if __name__ == "__main__":
    OSTRAKA = os.path.abspath(sys.argv.pop(1))
    unittest.main()
