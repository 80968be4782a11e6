#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks `ostraka evaluate pose` against pose errors written anew from their definitions.

Nothing here is Ostraka's: PLY, PNG and JSON are read, rays cast and errors worked out by this file.
MSSD, MSPD, VSD: Hodan et al. BOP Challenge 2020 on 6D Object Localization. ECCVW 2020, VSD with the
visibility of BOP's toolkit ("bop19"). ADI: Hinterstoisser et al. ACCV 2012.

Usage: pose_errors_test.py PATH_OF_OSTRAKA FOLDER_OF_PARTS
"""
import json
import math
import os
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

try:
    import numpy as np
except ImportError:
    # Debian's python3-numpy belongs to Debian's Python, while another may come first in PATH.
    debian = "/usr/bin/python3"
    if os.path.exists(debian) and "OSTRAKA_OTHER_PYTHON" not in os.environ:
        os.environ["OSTRAKA_OTHER_PYTHON"] = "1"
        os.execv(debian, [debian, *sys.argv])
    print("needs python3-numpy")
    sys.exit(77)

OSTRAKA = ""
PARTS = Path()
NAMES = ("bolt", "l_bracket", "wing_nut")  # C6, none, C2
SCENES, COPIES = 3, 6
DELTA = 15.0  # mm
TAUS = np.arange(1, 11) * 0.05


def run(*arguments):
    done = subprocess.run([OSTRAKA, *map(str, arguments)], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


# ---- reading ----

def read_ply(path):
    """Vertices and triangles of a binary little-endian PLY of floats and lists of ints."""
    data = Path(path).read_bytes()
    head, body = data.split(b"end_header\n", 1)
    count = {m[0]: int(m[1]) for m in re.findall(r"element (\w+) (\d+)", head.decode())}
    points = np.frombuffer(body, "<f4", 3 * count["vertex"]).reshape(-1, 3).astype(float)
    rows = np.frombuffer(body, np.dtype([("n", "u1"), ("v", "<i4", 3)]), count["face"],
                         12 * count["vertex"])
    assert (rows["n"] == 3).all()
    return points, rows["v"]


def read_png16(path):
    """A 16-bit gray PNG, with the five filters of its rows undone by hand."""
    data = Path(path).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    place, packed = 8, b""
    while place < len(data):
        size, kind = struct.unpack(">I4s", data[place:place + 8])
        chunk = data[place + 8:place + 8 + size]
        if kind == b"IHDR":
            width, height, bits, color, _, _, interlaced = struct.unpack(">IIBBBBB", chunk)
            assert (bits, color, interlaced) == (16, 0, 0)
        elif kind == b"IDAT":
            packed += chunk
        place += 12 + size
    raw = zlib.decompress(packed)
    before = bytearray(2 * width)
    image = []
    for y in range(height):
        kind = raw[y * (2 * width + 1)]
        row = bytearray(raw[y * (2 * width + 1) + 1:(y + 1) * (2 * width + 1)])
        for i in range(2 * width):
            a = row[i - 2] if i >= 2 else 0
            b = before[i]
            c = before[i - 2] if i >= 2 else 0
            if kind == 1:
                add = a
            elif kind == 2:
                add = b
            elif kind == 3:
                add = (a + b) // 2
            elif kind == 4:
                guess = a + b - c
                add = min((abs(guess - a), 0, a), (abs(guess - b), 1, b), (abs(guess - c), 2, c))[2]
            else:
                add = 0
            row[i] = (row[i] + add) & 255
        image.append(np.frombuffer(bytes(row), ">u2").astype(float))
        before = row
    return np.array(image)


def pose_of(rotation, translation):
    pose = np.eye(4)
    pose[:3, :3] = np.reshape(rotation, (3, 3))
    pose[:3, 3] = translation
    return pose


def turn(axis, angle):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def symmetries_of(info):
    """BOP's: every discrete one (or none), then every turn in 315 steps (or none)."""
    discrete = [np.eye(4)] + [np.reshape(m, (4, 4)) for m in info.get("symmetries_discrete", [])]
    turns = []
    for one in info.get("symmetries_continuous", []):
        offset = np.asarray(one["offset"], float)
        for step in range(315):
            rotation = turn(one["axis"], 2.0 * math.pi * step / 315)
            turns.append(pose_of(rotation, offset - rotation @ offset))
    return [t @ d for d in discrete for t in (turns or [np.eye(4)])]


class ModelData:
    def __init__(self, folder, number, info):
        self.name = info["name"]
        self.vertices, self.triangles = read_ply(folder / f"obj_{number:06}.ply")
        self.diameter = info["diameter"]
        self.symmetries = symmetries_of(info)


# ---- errors, in millimeters and pixels ----

def moved(pose, points):
    return points @ pose[:3, :3].T + pose[:3, 3]


def adi(surface, truth, estimate):
    a, b = moved(truth, surface), moved(estimate, surface)
    squares = (a ** 2).sum(1)[:, None] + (b ** 2).sum(1)[None, :] - 2.0 * a @ b.T
    nearest = squares.argmin(1)
    return np.linalg.norm(a - b[nearest], axis=1).mean()


def mssd(model, truth, estimate):
    at = moved(estimate, model.vertices)
    return min(np.linalg.norm(moved(truth @ s, model.vertices) - at, axis=1).max()
               for s in model.symmetries)


def project(camera, points):
    image = points @ camera.T
    return image[:, :2] / image[:, 2:]


def mspd(model, camera, truth, estimate):
    at = project(camera, moved(estimate, model.vertices))
    return min(np.linalg.norm(project(camera, moved(truth @ s, model.vertices)) - at, axis=1).max()
               for s in model.symmetries)


def distance_image(model, camera, pose, shape):
    """How far the camera's center is from what each pixel sees: Moeller, Trumbore 1997, for all
    triangles against the pixels in their box in the image."""
    height, width = shape
    image = np.full(shape, np.inf)
    points = moved(pose, model.vertices)
    pixels = project(camera, points)
    inverse = np.linalg.inv(camera)
    boxes = pixels[model.triangles]  # triangle, corner, axis
    lows = np.ceil(boxes.min(1) - 1e-6).astype(int).clip(0)
    highs = np.minimum(np.floor(boxes.max(1) + 1e-6).astype(int), (width - 1, height - 1))
    for index in np.flatnonzero((lows <= highs).all(1)):
        corners, (u0, v0), (u1, v1) = model.triangles[index], lows[index], highs[index]
        us, vs = np.meshgrid(np.arange(u0, u1 + 1), np.arange(v0, v1 + 1))
        rays = np.stack([us, vs, np.ones_like(us)], -1) @ inverse.T
        a, ab, ac = points[corners[0]], points[corners[1]] - points[corners[0]], \
            points[corners[2]] - points[corners[0]]
        p = np.cross(rays, ac)
        with np.errstate(divide="ignore", invalid="ignore"):
            determinant = p @ ab
            u = p @ -a / determinant
            q = np.cross(-a, ab)
            v = rays @ q / determinant
            t = ac @ q / determinant
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
        distance = np.where(hit, t * np.linalg.norm(rays, axis=-1), np.inf)
        part = image[v0:v1 + 1, u0:u1 + 1]
        np.minimum(part, distance, out=part)
    return np.where(np.isfinite(image), image, 0.0)


def vsd(scan, truth, estimate, diameter):
    """Errors for all tolerances, and the number of pixels in the union."""
    def visible(image):
        return (image > 0) & ((image - scan <= DELTA) | (scan == 0))
    true_visible = visible(truth)
    estimate_visible = visible(estimate) | (true_visible & (estimate > 0))
    both = true_visible & estimate_visible
    union = (true_visible | estimate_visible).sum()
    if union == 0:
        return np.ones(len(TAUS)), 0
    off = np.abs(truth - estimate)[both] / diameter
    errors = [((off >= tau).sum() + union - both.sum()) / union for tau in TAUS]
    return np.array(errors), union


# ---- the comparison ----

class PoseErrors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory(prefix="ostraka_pose_errors_")
        folder = Path(cls.holder.name)
        parts = [PARTS / f"{name}.ply" for name in NAMES]
        run("simulate", "drop", *parts, "--unit", "mm", "--format", "bop", "--width", 96,
            "--scenes", SCENES, "--objects", 6, "--seed", 3, "-o", folder / "set")
        library = folder / "parts.ostraka"
        run("build", *parts, "--unit", "mm", "-o", library, "--views", 12, "--directions", 6,
            "--fractions", 0.5, "--budget", 4, "--spread", 0, "--descriptors", "vfh",
            "--sampling", 2)
        run("export", library, "-o", folder / "export")
        cls.read_models(folder)
        cls.read_surfaces(run("export", library, "--dump", "-"))
        cls.read_scenes(folder / "set/test/000001")
        cls.write_results(folder / "results.csv")
        cls.answer = json.loads(run("evaluate", "pose", library, "--on", "scans", "--data",
                                    folder / "set", "--results", folder / "results.csv",
                                    "--min-confidence", 0, "--json", "-"))

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    @classmethod
    def read_models(cls, folder):
        """By BOP's number, meshes of the set; symmetries as the set says."""
        infos = json.loads((folder / "set/models/models_info.json").read_text())
        cls.models = {int(n): ModelData(folder / "set/models", int(n), info)
                      for n, info in infos.items()}
        # The library finds symmetries of its own, on samples of the surface: the same turns to
        # within its tolerance. Errors are judged by the library's.
        cls.set_symmetries = {m.name: m.symmetries for m in cls.models.values()}
        own = json.loads((folder / "export/models/models_info.json").read_text())
        by_name = {info["name"]: info for info in own.values()}
        for model in cls.models.values():
            model.symmetries = symmetries_of(by_name[model.name])
            model.diameter = by_name[model.name]["diameter"]

    @classmethod
    def read_surfaces(cls, dump):
        """ADI is of the library's surface points, which the dump holds as floats."""
        cls.surfaces = {}
        for line in dump.splitlines():
            cells = line.split("\t")
            if cells[0] != "model":
                continue
            floats = np.frombuffer(bytes.fromhex(cells[7]), "<f4").astype(float)
            cls.surfaces[cells[1]] = floats[:len(floats) // 2].reshape(-1, 3)

    @classmethod
    def read_scenes(cls, folder):
        cameras = json.loads((folder / "scene_camera.json").read_text())
        truths = json.loads((folder / "scene_gt.json").read_text())
        cls.cameras, cls.scans, cls.truths = {}, {}, {}
        for image in map(int, truths):
            camera = np.reshape(cameras[str(image)]["cam_K"], (3, 3))
            depth = read_png16(folder / f"depth/{image:06}.png")
            depth *= cameras[str(image)]["depth_scale"]
            us, vs = np.meshgrid(np.arange(depth.shape[1]), np.arange(depth.shape[0]))
            rays = np.stack([us, vs, np.ones_like(us)], -1) @ np.linalg.inv(camera).T
            cls.cameras[image] = camera
            cls.scans[image] = depth * np.linalg.norm(rays, axis=-1)
            cls.truths[image] = [(o["obj_id"], pose_of(o["cam_R_m2c"], o["cam_t_m2c"]))
                                 for o in truths[str(image)]]

    @classmethod
    def write_results(cls, path):
        """The truth, disturbed by 0 to 40 degrees and 0 to 40 % of the diameter. Every report has a
        score of its own, by which it is known again."""
        random = np.random.default_rng(5)
        lines = ["scene_id,im_id,obj_id,score,R,t,time"]
        cls.reports = {}
        for image, objects in cls.truths.items():
            for number, truth in objects:
                for _ in range(COPIES):
                    pose = truth.copy()
                    pose[:3, :3] = truth[:3, :3] @ turn(random.normal(size=3),
                                                        math.radians(random.uniform(0, 40)))
                    shift = random.normal(size=3)
                    shift *= random.uniform(0, 0.4) / np.linalg.norm(shift)
                    if random.uniform() < 0.3:  # in front of or behind what is there
                        shift = math.copysign(np.linalg.norm(shift), random.normal()) \
                            * truth[:3, 3] / np.linalg.norm(truth[:3, 3])
                    pose[:3, 3] += shift * cls.models[number].diameter
                    score = (len(cls.reports) + 1) / 1024
                    cls.reports[score] = (number, pose)
                    rotation = " ".join(f"{x:.17g}" for x in pose[:3, :3].ravel())
                    translation = " ".join(f"{x:.17g}" for x in pose[:3, 3])
                    lines.append(f"1,{image},{number},{score!r},{rotation},{translation},-1")
        path.write_text("\n".join(lines) + "\n")

    def pairs(self):
        for image, scene in enumerate(self.answer["details"]):
            self.assertEqual(scene["scene"], f"000001/{image:06}")
            for pair in scene["pairs"]:
                number, estimate = self.reports[pair["confidence"]]
                true_number, truth = self.truths[image][pair["truth"]]
                self.assertEqual(number, true_number)
                self.assertEqual(pair["model"], self.models[number].name)
                yield image, pair, self.models[number], truth, estimate

    def test_there_are_pairs_of_all_models_and_all_reports(self):
        pairs = list(self.pairs())
        self.assertGreaterEqual(len(pairs), 100)
        self.assertEqual({model.name for _, _, model, _, _ in pairs}, set(NAMES))
        self.assertEqual({pair["confidence"] for _, pair, _, _, _ in pairs}, set(self.reports))

    def test_library_and_set_agree_on_symmetry(self):
        for model in self.models.values():
            group = self.set_symmetries[model.name]
            self.assertEqual(len(group), {"bolt": 6, "wing_nut": 2, "l_bracket": 1}[model.name])
            for a in group:
                off = min(np.linalg.norm(moved(a, model.vertices) - moved(b, model.vertices),
                                         axis=1).max() for b in model.symmetries)
                self.assertLess(off, 0.02 * model.diameter)

    def worst(self, name, of):
        """The greatest relative deviation of an error; the values themselves must differ."""
        worst, values = 0.0, []
        for image, pair, model, truth, estimate in self.pairs():
            expected = of(image, model, truth, estimate)
            values.append(expected)
            worst = max(worst, abs(pair[name] - expected) / expected)
        self.assertGreater(np.ptp(values), 0.1 * max(values))
        print(f"{name}: {len(values)} pairs, worst relative deviation {worst:.2g}")
        return worst

    def test_adi(self):
        worst = self.worst("adi", lambda image, model, truth, estimate: adi(
            self.surfaces[model.name], truth, estimate) / model.diameter)
        self.assertLess(worst, 1e-5)

    def test_mssd(self):
        worst = self.worst("mssd", lambda image, model, truth, estimate: mssd(
            model, truth, estimate) / model.diameter)
        self.assertLess(worst, 1e-5)

    def test_mspd(self):
        worst = self.worst("mspd", lambda image, model, truth, estimate: mspd(
            model, self.cameras[image], truth, estimate))
        self.assertLess(worst, 1e-5)

    def test_vsd(self):
        images, worst, hidden, spread = {}, 0.0, 0, []
        for image, pair, model, truth, estimate in self.pairs():
            shape = self.scans[image].shape
            rendered = []
            for pose in (truth, estimate):
                key = (image, model.name, pose.tobytes())
                if key not in images:
                    images[key] = distance_image(model, self.cameras[image], pose, shape)
                rendered.append(images[key])
            expected, union = vsd(self.scans[image], *rendered, model.diameter)
            self.assertEqual(len(pair["vsd"]), 10)
            # Rays at silhouettes and at differences of just tau may go either way: a few pixels.
            pixels = np.abs(np.array(pair["vsd"]) - expected).max() * max(union, 1)
            worst = max(worst, pixels)
            hidden += ((rendered[0] > 0) & (rendered[0] - self.scans[image] > DELTA)
                       & (self.scans[image] > 0)).any()
            spread.append(expected.mean())
        print(f"vsd: {len(spread)} pairs, worst deviation {worst:.2g} pixels")
        self.assertLessEqual(worst, 3.0)
        self.assertGreater(np.ptp(spread), 0.5)
        self.assertGreater(hidden, 5)  # occlusion matters


if __name__ == "__main__":
    OSTRAKA = os.path.abspath(sys.argv.pop(1))
    PARTS = Path(sys.argv.pop(1)).resolve()
    unittest.main()
