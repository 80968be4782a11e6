#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the ostraka command as a user would: main job, JSON, bad input, interrupts.

Usage: command_line_test.py PATH_OF_OSTRAKA
"""
import hashlib
import json
import math
import os
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

OSTRAKA = ""
PARTS = ["cam", "hook", "tee"]
QUICK = ["--unit", "mm", "--views", "20", "--directions", "6", "--budget", "24"]
USAGE, INVALID, FILE, FORMAT, INTERRUPTED = 2, 3, 4, 5, 130


def run(*arguments, **options):
    return subprocess.run([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, **options)


def rotation(axis, angle):
    x, y, z = (c / math.sqrt(sum(a * a for a in axis)) for c in axis)
    c, s = math.cos(angle), math.sin(angle)
    d = 1 - c
    return [[c + x * x * d, x * y * d - z * s, x * z * d + y * s],
            [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
            [z * x * d - y * s, z * y * d + x * s, c + z * z * d]]


def turn(R, p):
    return [sum(R[i][k] * p[k] for k in range(3)) for i in range(3)]


def product(A, B):
    return [[sum(A[i][k] * B[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def read_obj(path):
    vertices, faces = [], []
    for line in open(path):
        if line.startswith("v "):
            vertices.append([float(c) for c in line.split()[1:4]])
        elif line.startswith("f "):
            faces.append(line)
    return vertices, faces


def read_pcd(path):
    """Finite points of a binary PCD that holds x, y, z as floats."""
    data = open(path, "rb").read()
    start = data.index(b"DATA binary\n") + len(b"DATA binary\n")
    points = struct.iter_unpack("<3f", data[start:])
    return [p for p in points if not math.isnan(p[0])]


def write_xyz(path, points):
    with open(path, "w") as file:
        for p in points:
            file.write("%.9g %.9g %.9g\n" % tuple(p))


def lzf_literals(data):
    """A valid LZF stream of literal runs only: a length byte below 32, then that many + 1 bytes."""
    return b"".join(bytes([len(data[i:i + 32]) - 1]) + data[i:i + 32]
                    for i in range(0, len(data), 32))


def folder_state(folder):
    """Names and digests of all files, so that leftovers and changes show."""
    return {name: hashlib.sha256(open(os.path.join(folder, name), "rb").read()).hexdigest()
            for name in os.listdir(folder)}


class CommandLine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="ostraka_cli_")
        cls.parts = os.path.join(cls.folder, "parts")
        made = run("parts", *PARTS, "-o", cls.parts, "--format", "obj")
        assert made.returncode == 0, made.stderr
        cls.models = [os.path.join(cls.parts, name + ".obj") for name in PARTS]
        cls.library = os.path.join(cls.folder, "three.ostraka")
        cls.built = run("build", *cls.models, "-o", cls.library, *QUICK, "--threads", 1, "--json", "-")
        assert cls.built.returncode == 0, cls.built.stderr
        cls.scans = os.path.join(cls.folder, "scans")
        made = run("simulate", "tabletop", *cls.models, "--unit", "mm", "-o", cls.scans, "--scenes", 1,
                   "--objects", 3, "--noise", 0.1, "--seed", 4, "--width", 400)
        assert made.returncode == 0, made.stderr
        cls.scan = os.path.join(cls.scans, "scene_0000.pcd")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def path(self, name, content=None):
        path = os.path.join(self.folder, name)
        if content is not None:
            with open(path, "wb") as file:
                file.write(content if isinstance(content, bytes) else content.encode())
        return path

    def recognize(self, library, scan, *more):
        done = run("recognize", library, scan, "--unit", "mm", "--json", "-", *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def assert_fails(self, done, code):
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertTrue(done.stderr.startswith("ostraka: "), done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    # ---- help and output -------------------------------------------------------------------------

    def test_help_teaches(self):
        for command in ([], ["build"], ["recognize"], ["classify"], ["inspect"], ["views"], ["parts"],
                        ["simulate"], ["evaluate"], ["evaluate", "segments"], ["evaluate", "scenes"]):
            done = run(*command, "--help")
            self.assertEqual(done.returncode, 0)
            self.assertIn("--help", done.stdout)
        self.assertEqual(run("--version").returncode, 0)

    def test_help_explains_every_option(self):
        for command in ("build", "recognize", "classify", "inspect", "views", "parts", "simulate",
                        "evaluate segments", "evaluate scenes"):
            lines = run(*command.split(), "--help").stdout.splitlines()
            self.assertGreater(len(lines[0]), 20, command)  # what the command does
            options = [i for i, line in enumerate(lines) if line.startswith("  -")]
            self.assertGreater(len(options), 2, command)
            for i in options:
                # The explanation stands behind the option, or on the next line.
                _, _, text = lines[i].strip().partition("  ")
                text = text.strip() or (lines + [""])[i + 1].strip()
                self.assertGreater(len(text), 8, command + ": " + lines[i])
        text = run("--help").stdout
        for word in ("ostraka build", "ostraka recognize", "Exit codes", "130"):
            self.assertIn(word, text)

    def test_build_reports_every_rule(self):
        for model in json.loads(self.built.stdout)["models"]:
            dropped = sum(model[key] for key in
                          ("dropped_too_small", "dropped_redundant", "dropped_beyond_budget"))
            self.assertEqual(model["views"] + model["subparts_made"], dropped + model["kept"])
            self.assertEqual(model["kept"], 24)

    def test_recognize_finds_the_parts(self):
        picture, overlay = self.path("found.png"), self.path("found.ply")
        found = self.recognize(self.library, self.scan, "--picture", picture, "--overlay", overlay)
        self.assertEqual(found["unit"], "mm")
        self.assertIn("verify", found["seconds"])
        truth = json.load(open(os.path.join(self.scans, "scene_0000.json")))["objects"]
        self.assertEqual(sorted(o["model"] for o in found["objects"]),
                         sorted(o["model"] for o in truth))
        for thing in truth:
            same = [o for o in found["objects"] if o["model"] == thing["model"]]
            off = min(math.dist([o["T_scene_model"][i] for i in (3, 7, 11)],
                                [thing["T_scene_model"][i] for i in (3, 7, 11)]) for o in same)
            self.assertLess(off, 3.0)
        for thing in found["objects"]:
            self.assertEqual(len(thing["T_scene_model"]), 16)
            for key in ("confidence", "visible_fraction", "inlier_rms", "source"):
                self.assertIn(key, thing)
        self.assertEqual(open(picture, "rb").read(8), b"\x89PNG\r\n\x1a\n")
        self.assertTrue(open(overlay, "rb").read(3) == b"ply")

    def test_threads_change_nothing(self):
        two = self.path("two.ostraka")
        self.assertEqual(run("build", *self.models, "-o", two, *QUICK, "--threads", 2).returncode, 0)
        self.assertEqual(open(two, "rb").read(), open(self.library, "rb").read())
        one = self.recognize(self.library, self.scan, "--threads", 1)
        many = self.recognize(self.library, self.scan, "--threads", 2)
        self.assertEqual(one["objects"], many["objects"])

    def test_turning_models_and_scan_changes_no_answer(self):
        R_models = rotation([1, 2, 3], 2.0)
        turned = []
        for name, path in zip(PARTS, self.models):
            vertices, faces = read_obj(path)
            lines = ["v %.9g %.9g %.9g\n" % tuple(turn(R_models, v)) for v in vertices]
            os.makedirs(self.path("turned"), exist_ok=True)
            turned.append(self.path("turned/%s.obj" % name, "".join(lines + faces)))
        library = self.path("turned.ostraka")
        self.assertEqual(run("build", *turned, "-o", library, *QUICK).returncode, 0)
        R_scan = rotation([-2, 1, 0.5], 1.3)
        points = read_pcd(self.scan)
        write_xyz(self.path("plain.xyz"), points)
        write_xyz(self.path("turned.xyz"), [turn(R_scan, p) for p in points])
        before = self.recognize(self.library, self.path("plain.xyz"))["objects"]
        after = self.recognize(library, self.path("turned.xyz"))["objects"]
        self.assertEqual(sorted(o["model"] for o in before), sorted(o["model"] for o in after))
        R_models_back = [list(row) for row in zip(*R_models)]
        for a in before:
            T = a["T_scene_model"]
            expected_at = turn(R_scan, [T[3], T[7], T[11]])
            expected_R = product(product(R_scan, [T[0:3], T[4:7], T[8:11]]), R_models_back)
            def off(b):
                S = b["T_scene_model"]
                turned_by = sum(expected_R[i][k] * S[4 * i + k] for i in range(3) for k in range(3))
                return math.dist(expected_at, [S[3], S[7], S[11]]), (turned_by - 1) / 2
            same = [off(b) for b in after if b["model"] == a["model"]]
            distance, cosine = min(same)
            self.assertLess(distance, 1.0)
            self.assertGreater(cosine, math.cos(math.radians(3.0)))

    def test_every_format_gives_the_same_objects(self):
        points = read_pcd(self.scan)
        header = ("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH %d\nHEIGHT 1\n"
                  "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS %d\nDATA ascii\n" % (len(points), len(points)))
        text = "".join("%.9g %.9g %.9g\n" % p for p in points)
        ply = ("ply\nformat %s 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
               "property float z\nend_header\n")
        packed = b"".join(struct.pack("<3f", *p) for p in points)
        files = [self.path("a.pcd", header + text), self.path("a.xyz", text),
                 self.path("a.ply", ply % ("ascii", len(points)) + text),
                 self.path("b.ply", (ply % ("binary_little_endian", len(points))).encode() + packed)]
        # The other encodings of PCD: by points, by planes in LZF, and with a grid that has holes.
        binary = header.replace("DATA ascii", "DATA binary").encode()
        planes = b"".join(struct.pack("<%df" % len(points), *axis) for axis in zip(*points))
        compressed = lzf_literals(planes)
        grid = (header.replace("WIDTH %d" % len(points), "WIDTH 2")
                .replace("HEIGHT 1", "HEIGHT %d" % len(points))
                .replace("POINTS %d" % len(points), "POINTS %d" % (2 * len(points)))
                .replace("DATA ascii", "DATA binary").encode())
        hole = struct.pack("<3f", *[math.nan] * 3)
        files += [self.path("b.pcd", binary + packed),
                  self.path("c.pcd", binary.replace(b"DATA binary", b"DATA binary_compressed") +
                            struct.pack("<II", len(compressed), len(planes)) + compressed),
                  self.path("d.pcd", grid + b"".join(struct.pack("<3f", *p) + hole for p in points))]
        answers = [self.recognize(self.library, file)["objects"] for file in files]
        self.assertEqual(len(answers[0]), 3)
        for answer in answers[1:]:
            self.assertEqual(answer, answers[0])

    def test_units_are_converted(self):
        meters = self.path("meters.xyz")
        write_xyz(meters, [[c / 1000 for c in p] for p in read_pcd(self.scan)])
        done = run("recognize", self.library, meters, "--unit", "m", "--json", "-")
        found = json.loads(done.stdout)
        self.assertEqual(found["unit"], "m")
        self.assertEqual(len(found["objects"]), 3)
        self.assertLess(abs(found["objects"][0]["T_scene_model"][11]), 5.0)

    def test_classify_inspect_views_evaluate(self):
        done = run("views", self.models[0], "-o", self.path("views"), "--views", 12, "--json", "-")
        views = json.loads(done.stdout)["views"]
        self.assertEqual(len(views), 12)
        segment = os.path.join(self.path("views"), views[3]["file"])
        done = run("classify", self.library, segment, "--k", 3, "--json", "-")
        ranking = json.loads(done.stdout)["segments"][0]["ranking"]
        self.assertEqual(ranking[0]["model"], "cam")
        for key in ("score", "view", "subpart"):
            self.assertIn(key, ranking[0])
        sheet = self.path("sheet.png")
        done = run("inspect", self.library, "--picture", sheet, "--json", "-")
        self.assertEqual([m["model"] for m in json.loads(done.stdout)["models"]], PARTS)
        self.assertTrue(os.path.getsize(sheet) > 1000)
        done = run("evaluate", "scenes", self.library, "--scenes", 1, "--json", "-")
        self.assertIn("recall", json.loads(done.stdout))

    def test_nothing_found_is_a_result(self):
        ball = self.path("ball.xyz")
        write_xyz(ball, [(60 * math.sin(p) * math.cos(t), 60 * math.sin(p) * math.sin(t),
                          300 - 60 * math.cos(p))
                         for p in (0.01 * i for i in range(1, 150)) for t in (0.02 * j for j in range(314))])
        self.assertEqual(self.recognize(self.library, ball)["objects"], [])
        self.assertIn("no object", run("recognize", self.library, ball).stderr)

    def test_segments_random_views_and_variants(self):
        done = run("evaluate", "segments", self.library, "--scenes", 2, "--json", "-")
        rates = json.loads(done.stdout)["results"][0]["recognition_rate"]
        self.assertEqual(sorted(rates), ["esf", "fused", "gasd", "keypoints", "rops", "shot", "vfh"])
        self.assertTrue(all(0 <= rate <= 1 for rate in rates.values()))
        folder = self.path("random")
        done = run("simulate", "random-views", *self.models, "--unit", "mm", "--scenes", 1,
                   "--format", "ply", "-o", folder, "--json", "-")
        scenes = json.loads(done.stdout)["scenes"]
        self.assertEqual(json.load(open(os.path.join(folder, "scene_0000.json"))), scenes[0])
        self.assertTrue(os.path.exists(os.path.join(folder, scenes[0]["scene"])))
        done = run("parts", "cam", "--variants", 2, "--format", "stl", "-o", folder, "--json", "-")
        made = json.loads(done.stdout)
        self.assertEqual((made["unit"], made["parts"]), ("mm", ["cam.stl", "cam_1.stl"]))
        first, second = (open(os.path.join(folder, name), "rb").read() for name in made["parts"])
        self.assertNotEqual(first, second)

    # ---- bad input -------------------------------------------------------------------------------

    def test_bad_models(self):
        nan = "v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n"
        flat = "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"
        whole = open(self.models[0], "rb").read()
        stl = b"\0" * 80 + struct.pack("<I", 12) + b"\0" * 100
        cases = [("missing.ply", None, FILE), ("empty.ply", "", FORMAT), ("empty.stl", "", FORMAT),
                 ("cut.stl", stl, FORMAT), ("noise.ply", os.urandom(500), FORMAT),
                 ("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", INVALID), ("nan.obj", nan, None),
                 ("flat.obj", flat, INVALID), ("two.obj", "v 0 0 0\nv 1 0 0\nf 1 2 1\n", INVALID),
                 ("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", FORMAT),
                 ("model.docx", whole, INVALID)]
        before = open(self.library, "rb").read()
        for name, content, code in cases:
            with self.subTest(name):
                path = self.path(name, content) if content is not None else self.path(name)
                done = run("build", path, "-o", self.library, "--unit", "mm")
                self.assert_fails(done, code or done.returncode)
                self.assertIn(done.returncode, (INVALID, FILE, FORMAT))
                self.assertIn(name, done.stderr)
        self.assertEqual(open(self.library, "rb").read(), before)

    def test_bad_scans(self):
        far = "".join("%g %g 500000\n" % (1000 * (i % 50), 1000 * (i // 50)) for i in range(2500))
        cases = [("missing.pcd", None, FILE), ("empty.pcd", "", FORMAT), ("empty.xyz", "", None),
                 ("three.xyz", "0 0 9\n1 0 9\n0 1 9\n", INVALID), ("nan.xyz", "nan nan nan\n" * 50, INVALID),
                 ("equal.xyz", "1 2 3\n" * 500, INVALID), ("words.xyz", "one two three\n", FORMAT),
                 ("far.xyz", far, INVALID)]
        for name, content, code in cases:
            with self.subTest(name):
                path = self.path(name, content) if content is not None else self.path(name)
                outputs = [self.path("never.json"), self.path("never.png")]
                done = run("recognize", self.library, path, "--unit", "mm", "--json", outputs[0],
                           "--picture", outputs[1])
                self.assert_fails(done, code or done.returncode)
                self.assertNotEqual(done.returncode, 0)
                self.assertFalse(any(map(os.path.exists, outputs)))
                self.assert_fails(run("classify", self.library, path), done.returncode)
        for unit in ("m", "in"):
            if unit == "m":  # 1000 times too large
                self.assert_fails(run("recognize", self.library, self.scan, "--unit", unit), INVALID)
        tiny = self.path("tiny.xyz")
        write_xyz(tiny, [[c / 1000 for c in p] for p in read_pcd(self.scan)])
        self.assert_fails(run("recognize", self.library, tiny, "--unit", "mm"), INVALID)

    def test_bad_libraries(self):
        data = bytearray(open(self.library, "rb").read())
        self.assert_fails(run("inspect", self.path("cut.ostraka", bytes(data[:5000]))), FORMAT)
        self.assert_fails(run("inspect", self.path("text.ostraka", "no library" * 300)), FORMAT)
        self.assert_fails(run("inspect", self.path("none.ostraka")), FILE)
        self.assert_fails(run("inspect", self.path("half.ostraka", bytes(data[:len(data) // 2]))), FORMAT)
        foreign = bytearray(data)
        foreign[71] ^= 1  # SQLite keeps the application's number in bytes 68 to 71
        self.assert_fails(run("inspect", self.path("foreign.ostraka", bytes(foreign))), FORMAT)
        data[63] = 77  # and its format number in bytes 60 to 63
        done = run("inspect", self.path("later.ostraka", bytes(data)))
        self.assert_fails(done, FORMAT)
        self.assertIn("77", done.stderr)

    def test_bad_command_lines(self):
        done = run("build", *self.models, "-o", self.path("x.ostraka"))
        self.assert_fails(done, USAGE)
        self.assertIn("--unit", done.stderr)
        for arguments in (["build"], ["fly"], ["build", *self.models, "-o", "x", "--unit", "furlong"],
                          ["build", *self.models, "-o", "x", "--unit", "mm", "--descriptors", "sift"],
                          ["recognize", self.library, self.scan, "--viewpoint", "1,2"],
                          ["classify", self.library, self.scan, "--k", "0"]):
            self.assert_fails(run(*arguments), USAGE)
        done = run("build", *self.models, "-o", self.path("x.ostraka"), "--unit", "mm", "--views", 13)
        self.assert_fails(done, INVALID)
        done = run("build", self.models[0], self.models[0], "-o", self.path("x.ostraka"), "--unit", "mm")
        self.assert_fails(done, INVALID)
        self.assertFalse(os.path.exists(self.path("x.ostraka")))

    def test_unwritable_output(self):
        inside_a_file = os.path.join(self.models[0], "x.ostraka")
        self.assert_fails(run("build", *self.models, "-o", inside_a_file, *QUICK), FILE)
        self.assert_fails(run("build", *self.models, "-o", self.folder, *QUICK), FILE)

    def test_unwritable_reports_are_named(self):
        for option, command in (("--picture", ["recognize", self.library, self.scan]),
                                ("--overlay", ["recognize", self.library, self.scan]),
                                ("--json", ["inspect", self.library]),
                                ("--picture", ["inspect", self.library])):
            with self.subTest(command[0] + option):
                ending = {"--picture": ".png", "--overlay": ".ply", "--json": ".json"}[option]
                place = os.path.join(self.models[0], "x" + ending)
                done = run(*command, option, place)
                self.assertEqual(done.returncode, FILE, done.stderr)
                self.assertTrue(done.stderr.splitlines()[-1].startswith("ostraka: "), done.stderr)
                self.assertIn(place, done.stderr.splitlines()[-1])
        for command in (["parts", "cam"], ["views", self.models[0]]):
            self.assert_fails(run(*command, "-o", self.models[0]), FILE)

    @unittest.skipUnless(os.path.exists("/dev/full"), "needs /dev/full")
    def test_json_that_cannot_be_printed_is_an_error(self):
        with open("/dev/full", "w") as full:
            done = subprocess.run([OSTRAKA, "inspect", self.library, "--json", "-"], stdout=full,
                                  stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, FILE, done.stderr)
        self.assertTrue(done.stderr.splitlines()[-1].startswith("ostraka: "))

    def test_full_disk_keeps_the_earlier_library(self):
        folder = self.path("full")
        os.makedirs(folder)
        library = shutil.copy(self.library, folder)
        before = open(library, "rb").read()

        def small_files():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))

        done = run("build", *self.models, "-o", library, *QUICK, preexec_fn=small_files)
        self.assertEqual(done.returncode, FILE, done.stderr)
        self.assertEqual(open(library, "rb").read(), before)
        self.assertEqual(os.listdir(folder), [os.path.basename(library)])

    def test_interrupts_leave_nothing_behind(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            folder = self.path("interrupted_%d" % number)
            os.makedirs(folder)
            library = os.path.join(folder, "x.ostraka")
            if number == signal.SIGINT:
                shutil.copy(self.library, library)
            before = folder_state(folder)
            process = subprocess.Popen(
                [OSTRAKA, "build", *self.models, "-o", library, "--unit", "mm",
                 "--views", "642"], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            time.sleep(1.0)
            process.send_signal(number)
            _, errors = process.communicate(timeout=60)
            self.assertEqual(process.returncode, INTERRUPTED, errors)
            self.assertIn("ostraka: interrupted", errors)
            self.assertEqual(folder_state(folder), before)


if __name__ == "__main__":
    OSTRAKA = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2, warnings="ignore")
