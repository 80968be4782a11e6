#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Brings STL parts of unknown and different units to one range of sizes, as OBJ files in mm.

Usage: industrial_parts.py FOLDER STL...

Of each part the diagonal of its box becomes 90 to 150 mm, by its name. Needs numpy.
"""
import hashlib
import os
import re
import struct
import sys

import numpy

RECORD = numpy.dtype([("numbers", "<f4", 12), ("attribute", "<u2")])


def corners_of(path):
    """Three corners of each triangle, (3 n, 3)."""
    with open(path, "rb") as file:
        data = file.read()
    if len(data) >= 84:
        count = struct.unpack("<I", data[80:84])[0]
        if len(data) == 84 + RECORD.itemsize * count:
            return numpy.frombuffer(data[84:], RECORD)["numbers"][:, 3:].reshape(-1, 3).astype(float)
    found = re.findall(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", data)
    if not found or len(found) % 3:
        sys.exit(f"{path}: neither binary nor ASCII STL")
    return numpy.array([[float(number) for number in corner] for corner in found])


def write(path, corners, diagonal):
    low, high = corners.min(axis=0), corners.max(axis=0)
    placed = (corners - (low + high) / 2.0) * (diagonal / numpy.linalg.norm(high - low))
    vertices, index = numpy.unique(placed.round(5), axis=0, return_inverse=True)
    with open(path, "w", encoding="ascii") as file:
        for x, y, z in vertices:
            file.write(f"v {x:g} {y:g} {z:g}\n")
        for a, b, c in index.reshape(-1, 3) + 1:
            if a not in (b, c) and b != c:
                file.write(f"f {a} {b} {c}\n")


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    os.makedirs(sys.argv[1], exist_ok=True)
    for path in sys.argv[2:]:
        name = os.path.splitext(os.path.basename(path))[0]
        share = int(hashlib.md5(name.encode()).hexdigest(), 16) % 1000 / 1000.0
        write(os.path.join(sys.argv[1], name + ".obj"), corners_of(path), 90.0 + 60.0 * share)


if __name__ == "__main__":
    main()
