#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes twelve parts made of boxes as OBJ files, in mm: what recognition finds hardest to tell apart.

Usage: boxy_parts.py FOLDER
"""
import os
import sys

# Of each part its boxes, as lowest and highest corner. They may overlap: only what is seen counts.
PARTS = {
    "block": [((0, 0, 0), (100, 60, 35))],
    "plate": [((0, 0, 0), (120, 80, 6))],
    "bracket": [((0, 0, 0), (80, 50, 6)), ((0, 0, 0), (6, 50, 70))],
    "channel": [((0, 0, 0), (120, 50, 6)), ((0, 0, 0), (120, 6, 40)), ((0, 44, 0), (120, 50, 40))],
    "tee": [((0, 0, 0), (100, 40, 8)), ((46, 0, 0), (54, 40, 60))],
    "steps": [((0, 0, 0), (90, 60, 20)), ((0, 0, 0), (60, 60, 40)), ((0, 0, 0), (30, 60, 60))],
    "bar": [((0, 0, 0), (150, 20, 20))],
    "cross": [((0, 40, 0), (120, 60, 15)), ((50, 0, 0), (70, 100, 15))],
    "tray": [((0, 0, 0), (110, 80, 5)), ((0, 0, 0), (110, 5, 25)), ((0, 75, 0), (110, 80, 25)),
             ((0, 0, 0), (5, 80, 25)), ((105, 0, 0), (110, 80, 25))],
    "corner": [((0, 0, 0), (60, 60, 6)), ((0, 0, 0), (6, 60, 60)), ((0, 0, 0), (60, 6, 60))],
    "hbeam": [((0, 0, 0), (100, 40, 6)), ((0, 0, 44), (100, 40, 50)), ((0, 17, 0), (100, 23, 50))],
    "boss": [((0, 0, 0), (90, 70, 12)), ((15, 15, 0), (45, 45, 40))],
}
# Corners are numbered by their bits: x, y, z.
TRIANGLES = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
             (1, 3, 7), (1, 7, 5), (3, 2, 6), (3, 6, 7), (2, 0, 4), (2, 4, 6)]


def corners(box):
    low, high = box
    return [[(low, high)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)]


def write(path, boxes):
    with open(path, "w", encoding="ascii") as file:
        for box in boxes:
            for x, y, z in corners(box):
                file.write(f"v {x} {y} {z}\n")
        for b in range(len(boxes)):
            for triangle in TRIANGLES:
                file.write("f " + " ".join(str(8 * b + i + 1) for i in triangle) + "\n")


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    os.makedirs(sys.argv[1], exist_ok=True)
    for name, boxes in PARTS.items():
        write(os.path.join(sys.argv[1], name + ".obj"), boxes)


if __name__ == "__main__":
    main()
