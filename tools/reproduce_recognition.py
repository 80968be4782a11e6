#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Recognition in clutter: builds the libraries, recognizes all scenes of BENCHMARK.md, prints its tables and which
goals hold. See scripts/reproduce.

Usage: reproduce_recognition.py OSTRAKA DATA FOLDER [--only TEXT]

What FOLDER holds is not made anew: delete a row's JSON file, or a library, to do so. --only: rows whose name contains
TEXT. Scenes are evaluated from a confidence of 0.8 and counted from 0.94, the default.
"""
import json
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

LEAST_CONFIDENCE = 0.94
SINGLE_PART = "valve_body"
# name -> (options of `ostraka evaluate scenes`, libraries by name). A library's half is HALF/A and HALF/B:
# the scenes show all.
SCENES = {
    "rs1": ("--on scans --data DATA/uwa --data-unit mm", ["uwa"]),
    "layouts": ("--on layout --data DATA/uwa --data-unit mm --sensor laser-line", ["uwa", "uwa_plain"]),
    "statues dropped": ("--on drop --scenes 60 --noise 0.0005", ["bologna"]),
    "merged scans": ("--on scans --data DATA/bologna --data-unit m", ["bologna"]),
    "twelve parts in a bin": ("--on bin --scenes 12 --objects 12 --noise 0.3 --seed 7 --min-visible 0.5", ["parts"]),
    "one part in a bin": ("--on bin --scenes 12 --objects 12 --noise 0.3 --seed 7 --min-visible 0.5", ["single"]),
    "dropped": ("--on drop --scenes 12 --objects 8 --noise 0.3 --seed 21", ["parts", "turned", "boxy", "household"]),
    "in a bin": ("--on bin --scenes 12 --objects 10 --noise 0.3 --seed 21 --min-visible 0.5",
                 ["turned", "boxy", "household"]),
    "in bins of seeds 22": ("--on bin --scenes 12 --objects 10 --noise 0.3 --seed 22 --min-visible 0.5",
                            ["turned", "boxy"]),
    "in bins of seeds 23": ("--on bin --scenes 12 --objects 10 --noise 0.3 --seed 23 --min-visible 0.5", ["boxy"]),
    "faulty sensor, dropped": ("--on drop --scenes 12 --sensor structured-light --seed 5", ["parts"]),
    "faulty sensor, no table": ("--on random-views --scenes 12 --sensor structured-light --seed 9", ["parts"]),
    "noise 1 mm": ("--on drop --seed 3 --scenes 12 --noise 0.001", ["bologna"]),
    "noise 2 mm": ("--on drop --seed 3 --scenes 12 --noise 0.002", ["bologna"]),
    "noise 4 mm": ("--on drop --seed 3 --scenes 12 --noise 0.004", ["bologna"]),
    "1280 columns": ("--on drop --seed 3 --scenes 8 --noise 0.0005 --width 1280", ["bologna"]),
    "320 columns": ("--on drop --seed 3 --scenes 8 --noise 0.0005 --width 320", ["bologna"]),
    "200 columns": ("--on drop --seed 3 --scenes 8 --noise 0.0005 --width 200", ["bologna"]),
    "viewpoint unknown, 0.5 mm": ("--on drop --seed 3 --scenes 8 --noise 0.0005 --viewpoint-unknown",
                                  ["bologna_plain"]),
    "viewpoint unknown, 1 mm": ("--on drop --seed 3 --scenes 8 --noise 0.001 --viewpoint-unknown", ["bologna_plain"]),
    "viewpoint unknown, 2 mm": ("--on drop --seed 3 --scenes 8 --noise 0.002 --viewpoint-unknown", ["bologna_plain"]),
    "viewpoint unknown, 4 mm": ("--on drop --seed 3 --scenes 8 --noise 0.004 --viewpoint-unknown", ["bologna_plain"]),
    "half unknown, heaps of parts": ("--on drop --scenes 12 --objects 10 --noise 0.3 --seed 78",
                                     ["parts/A", "parts/B", "parts_calibrated/A", "parts_calibrated/B"]),
    "half unknown, no table": ("--on random-views --scenes 96 --noise 0.3 --seed 109", ["parts/A", "parts/B"]),
    "half unknown, no table, fewer": ("--on random-views --scenes 24 --noise 0.3 --seed 9",
                                      ["parts/A", "parts/B", "parts_calibrated/A", "parts_calibrated/B"]),
    "half unknown, statues": ("--on drop --scenes 15 --objects 8 --noise 0.0005 --seed 5",
                              ["bologna_plain/A", "bologna_plain/B", "bologna_calibrated/A", "bologna_calibrated/B"]),
    "half unknown, boxy": ("--on drop --scenes 24 --objects 8 --noise 0.3 --seed 131", ["boxy/A", "boxy/B"]),
    "half unknown, boxy, fewer": ("--on drop --scenes 10 --objects 8 --noise 0.3 --seed 31",
                                  ["boxy/A", "boxy/B", "boxy_calibrated/A", "boxy_calibrated/B"]),
    "half unknown, household": ("--on drop --scenes 12 --objects 8 --noise 0.3 --seed 31",
                                ["household/A", "household/B"]),
    "industrial parts dropped": ("--on drop --scenes 12 --objects 8 --noise 0.3 --seed 51", ["industrial"]),
    "industrial parts in a bin": ("--on bin --scenes 12 --objects 10 --noise 0.3 --seed 52 --min-visible 0.5",
                                  ["industrial"]),
    "half unknown, industrial": ("--on drop --scenes 12 --objects 8 --noise 0.3 --seed 53",
                                 ["industrial/A", "industrial/B"]),
    "half unknown, industrial, in front of nothing": (
        "--on random-views --scenes 24 --noise 0.3 --seed 55", ["industrial/A", "industrial/B"]),
    "half unknown, turned and sheet": ("--on drop --scenes 12 --objects 8 --noise 0.3 --seed 31",
                                       ["turned/A", "turned/B"]),
}
GENERATORS = {"boxy": "boxy_parts.py", "turned": "turned_and_sheet_parts.py", "household": "household_parts.py",
              "industrial": "industrial_parts.py"}


def run(command):
    """Runs a command, its progress to standard error."""
    print("$ " + " ".join(str(part) for part in command), file=sys.stderr, flush=True)
    subprocess.run([str(part) for part in command], check=True)


class Libraries:
    """Libraries by name, made when first asked for."""

    def __init__(self, ostraka, data, folder):
        self.ostraka, self.data, self.folder = ostraka, data, folder
        self.tools = Path(__file__).resolve().parent

    def models(self, name):
        """Meshes and their unit."""
        shipped = self.tools.parent / "data/parts"
        if name in GENERATORS:
            parts = self.folder / name
            if not parts.exists():
                run([sys.executable, self.tools / GENERATORS[name], parts, *self.given(name)])
            return sorted(parts.glob("*.obj")), "mm"
        if name == "parts":
            return sorted(shipped.glob("*.ply")), "mm"
        if name == "single":
            return [shipped / f"{SINGLE_PART}.ply"], "mm"
        data_set = name.removesuffix("_plain")
        return sorted((self.data / data_set / "models").glob("*.ply")), "m" if data_set == "bologna" else "mm"

    def given(self, name):
        """Files that a set of parts is made of; those of the others are generated."""
        return sorted((self.data / "industrial/stl").glob("*.stl")) if name == "industrial" else []

    def missing(self, name):
        return self.whole(name) == "industrial" and not self.given("industrial")

    def path(self, name):
        path = self.folder / (name.replace("/", "_") + ".ostraka")
        if path.exists():
            return path
        fresh = path.with_suffix(".new")
        if "/" in name:
            self.make_half(name, fresh)
        else:
            meshes, unit = self.models(name)
            calibrate = ["--calibrate"] if name in ("uwa", "bologna") else []
            run([self.ostraka, "build", *meshes, "--unit", unit, *calibrate, "-o", fresh])
        fresh.rename(path)
        return path

    def whole(self, name):
        return name.split("/")[0].replace("bologna_calibrated", "bologna_plain").removesuffix("_calibrated")

    def make_half(self, name, path):
        if "_calibrated" in name:
            plain = self.whole(name) + "/" + name[-1]
            shutil.copyfile(self.path(plain), path)
            run([self.ostraka, "calibrate", path])
            return
        meshes, _ = self.models(self.whole(name))
        left_out = [mesh.stem for mesh in meshes[0 if name[-1] == "B" else 1::2]]
        run([self.ostraka, "remove", self.path(self.whole(name)), *left_out, "-o", path])
        run([self.ostraka, "index", path])


def evaluate(libraries, name, library, options):
    """The row's JSON, of a run before if there is one."""
    out = libraries.folder / (f"{name} of {library}".replace(" ", "_").replace("/", "_").replace(",", "") + ".json")
    if not out.exists():
        scenes_of = ["--scenes-of", libraries.path(libraries.whole(library))] if "/" in library else []
        fresh = out.with_suffix(".new")
        words = [word.replace("DATA", str(libraries.data)) for word in options.split()]
        run([libraries.ostraka, "evaluate", "scenes", libraries.path(library), *scenes_of, *words,
             "--min-confidence", "0.8", "--json", fresh])
        fresh.rename(out)
    return json.loads(out.read_text())


class Row:
    """What is counted of one evaluation."""

    def __init__(self, name, library, result):
        self.name, self.library = name, library
        scenes = result["details"]
        hits = [hit for scene in scenes for hit in scene["hits"]]
        self.wrong_confidences = [report["confidence"] for scene in scenes for report in scene["wrong"]]
        self.right_confidences = [hit["confidence"] for hit in hits]
        self.found = [hit for hit in hits if hit["confidence"] >= LEAST_CONFIDENCE]
        self.missed = [miss for scene in scenes for miss in scene["misses"]]
        self.missed += [hit for hit in hits if hit["confidence"] < LEAST_CONFIDENCE]
        self.objects = len(self.found) + len(self.missed)
        self.wrong = sum(c >= LEAST_CONFIDENCE for c in self.wrong_confidences)
        self.reports = len(self.found) + self.wrong
        self.recall = len(self.found) / self.objects
        self.precision = len(self.found) / max(1, self.reports)
        self.adi = statistics.median(hit["adi"] for hit in self.found)
        self.greatest_adi = max(hit["adi"] for hit in self.found)
        self.mssd = result["average_recall"]["mssd"]
        self.seconds = result["seconds_per_scene"]
        pairs = [pair for scene in scenes for pair in scene["pairs"]]
        close = [pair for pair in pairs if pair["adi"] < 0.1 and pair["confidence"] >= LEAST_CONFIDENCE]
        self.degrees = statistics.median(pair["degrees"] for pair in close)
        self.turned = sum(pair["adi"] < 0.1 and pair["mssd"] > 0.05 for pair in pairs)

    def recall_up_to(self, occlusion):
        """Of the objects occluded no more than this."""
        found = sum(hit["visible_fraction"] >= 1.0 - occlusion for hit in self.found)
        missed = sum(miss["visible_fraction"] >= 1.0 - occlusion for miss in self.missed)
        return found / (found + missed)

    def text(self):
        return (f"| {self.name} | {self.library} | {self.objects} | {self.recall:.3f} | {self.precision:.3f} "
                f"| {self.wrong} of {self.reports} | {self.adi * 100:.2f} % | {self.degrees:.2f} | {self.mssd:.3f} "
                f"| {self.turned} | {self.seconds:.2f} |")


def goals_of(rows):
    """(text, holds) of each goal that issue 6 sets."""
    goals = []

    def goal(text, name, library, holds):
        row = rows.get((name, library))
        if row:
            goals.append((f"{text}: recall {row.recall:.3f}, precision {row.precision:.3f}, ADI {row.adi:.2%}, "
                          f"{row.degrees:.2f} degrees, {row.seconds:.2f} s", holds(row)))

    goal("rs1: 4 of 4, none false, each ADI below 0.5 %, 1 s", "rs1", "uwa",
         lambda r: r.recall == 1 and r.wrong == 0 and r.greatest_adi < 0.005 and r.seconds < 1.0)
    goal("layouts: recall .95, .989 up to 84 % occluded, precision .99, 1 s", "layouts", "uwa",
         lambda r: r.recall >= 0.95 and r.recall_up_to(0.84) >= 0.989 and r.precision >= 0.99 and r.seconds < 1.0)
    goal("statues dropped: recall .97, precision .99, ADI 1 %, 1 degree, 0.5 s", "statues dropped", "bologna",
         lambda r: r.recall >= 0.97 and r.precision >= 0.99 and r.adi < 0.01 and r.degrees < 1.0 and r.seconds < 0.5)
    goal("bin of twelve parts: recall .90", "twelve parts in a bin", "parts", lambda r: r.recall >= 0.9)
    goal("bin of one part: recall .90", "one part in a bin", "single", lambda r: r.recall >= 0.9)
    goal("merged scans: 9 of 9, each ADI below 2 %, none false", "merged scans", "bologna",
         lambda r: r.recall == 1 and r.wrong == 0 and r.greatest_adi < 0.02)
    for text, only in (("all", ""), ("heaps of parts", "heaps of parts"),
                       ("no table", "no table"), ("industrial", "industrial"),
                       ("statues", "statues"), ("boxy", "boxy"), ("household", "household"),
                       ("turned and sheet", "turned")):
        for calibrated in (False, True):
            halves = [row for (name, library), row in rows.items() if name.startswith("half unknown") and only in name
                      and ("_calibrated" in library) == calibrated]
            reports, wrong = sum(row.reports for row in halves), sum(row.wrong for row in halves)
            if reports:
                goals.append((f"half of the models unknown, {text}{', calibrated' if calibrated else ''}: {wrong} wrong "
                              f"of {reports} reports ({wrong / reports:.1%}), goal 1 %", wrong <= 0.01 * reports))
    return goals


def print_reliability(rows):
    """How many of the reports are right, by their confidence."""
    print("\n| confidence | library | reports | right |\n|---|---|---|---|")
    for low, high in ((0.8, 0.9), (0.9, 0.95), (0.95, 0.99), (0.99, 1.0)):
        for text, calibrated in (("calibrated", True), ("general", False)):
            pool = [row for row in rows.values()
                    if (row.library in ("uwa", "bologna") or "_calibrated" in row.library) == calibrated]
            def within(values):
                return sum(low <= c < high or high == 1.0 == c for c in values)
            right = sum(within(row.right_confidences) for row in pool)
            count = right + sum(within(row.wrong_confidences) for row in pool)
            print(f"| {low:g} to {high:g} | {text} | {count} | {right / max(1, count):.3f} |")


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    ostraka, data, folder = (Path(arg) for arg in sys.argv[1:4])
    only = sys.argv[sys.argv.index("--only") + 1] if "--only" in sys.argv else ""
    folder.mkdir(parents=True, exist_ok=True)
    libraries = Libraries(ostraka, data, folder)
    rows = {}
    for name, (options, names) in SCENES.items():
        for library in names:
            if only in name and libraries.missing(library):
                print(f"skipped, as DATA has no industrial/stl: {name} of {library}", file=sys.stderr)
            elif only in name:
                rows[name, library] = Row(name, library, evaluate(libraries, name, library, options))
                print(rows[name, library].text(), file=sys.stderr, flush=True)
    print("\n| scenes | library | objects | recall | precision | wrong of reports | median ADI | degrees | MSSD recall "
          "| a turn off | s/scene |\n" + "|---" * 11 + "|")
    for row in rows.values():
        print(row.text())
    print_reliability(rows)
    print("\nGoals\n")
    goals = goals_of(rows)
    for text, holds in goals:
        print(f"- {'holds' if holds else 'FAILS'}: {text}")
    return 0 if all(holds for _, holds in goals) else 1


if __name__ == "__main__":
    sys.exit(main())
