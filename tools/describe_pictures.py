#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the pictures in docs/images/descriptors: one descriptor each, of one view of a shipped part.

Usage: describe_pictures.py OSTRAKA [FOLDER]   (FOLDER: docs/images/descriptors of this tree)
"""
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PART, VIEW = "clevis", 0
NAMES = ["vfh", "esf", "gasd", "shot", "rops", "gasd_color", "cvfh", "our_cvfh", "shot_local",
         "rops_local", "pfh", "fpfh", "spin_image"]


def paint(view, colored):
    """Writes the view's points as text, painted by thirds along x: parts come without colors."""
    data = view.read_bytes()
    start = data.index(b"DATA binary\n") + len(b"DATA binary\n")
    points = [p for p in struct.iter_unpack("<3f", data[start:]) if not math.isnan(p[0])]
    low, high = min(p[0] for p in points), max(p[0] for p in points)
    paints = [(196, 60, 50), (70, 160, 80), (60, 110, 200)]
    with open(colored, "w") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(points))
        file.write("".join("property float %s\n" % axis for axis in "xyz"))
        file.write("".join("property uchar %s\n" % color for color in ("red", "green", "blue")))
        file.write("end_header\n")
        for p in points:
            third = min(2, int(3 * (p[0] - low) / (high - low)))
            file.write("%.9g %.9g %.9g %d %d %d\n" % (*p, *paints[third]))


def main():
    ostraka = sys.argv[1]
    folder = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT / "docs/images/descriptors"
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run([ostraka, "views", ROOT / "data/parts" / (PART + ".ply"), "-o", scratch,
                        "--views", "20"], check=True)
        view = pathlib.Path(scratch) / ("%s_%04d.pcd" % (PART, VIEW))
        colored = pathlib.Path(scratch) / (PART + ".ply")
        paint(view, colored)
        for name in NAMES:
            cloud = colored if name == "gasd_color" else view
            subprocess.run([ostraka, "describe", cloud, "--descriptor", name, "--image",
                            folder / (name + ".png")], check=True)


if __name__ == "__main__":
    main()
