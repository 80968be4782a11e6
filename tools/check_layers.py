#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rejects includes and file sizes that the project's layout forbids.

Checked, under src/ostraka and (sizes only) apps:
- a module includes only the modules that its row in MODULES allows;
- an included project header exists, and a public header includes public headers only;
- hidden libraries appear in no public header, and elsewhere only in the modules that own them;
- headers have at most 300 lines, sources at most 400.

Public headers are those that a module's CMakeLists.txt lists under HEADERS; only they are
installed. Prints one line a violation, "path:line: message", and exits 1 if there is any.

    check_layers.py [ROOT]      check the tree at ROOT (by default the one this file is in)
    check_layers.py --self-test check that each kind of violation is found in a made-up tree
"""

import re
import sys
import tempfile
from pathlib import Path

# Module -> modules it may include, besides itself. Data flows down this table.
MODULES = {
    "base": [],
    "cloud": ["base"],
    "mesh": ["base", "cloud"],
    "io": ["base", "cloud", "mesh"],
    "registration": ["base", "cloud"],
    "views": ["base", "cloud", "mesh"],
    "subparts": ["base", "cloud"],
    "segmentation": ["base", "cloud"],
    "descriptors": ["base", "cloud"],
    "library": ["base", "cloud", "mesh", "io", "registration", "views", "subparts", "descriptors"],
    "recognition": ["base", "cloud", "mesh", "io", "registration", "views", "subparts",
                    "segmentation", "descriptors", "library"],
    "simulation": ["base", "cloud", "mesh", "io", "views"],
    "report": ["base", "cloud", "mesh", "io"],
    "evaluation": ["base", "cloud", "mesh", "io", "registration", "views", "subparts",
                   "segmentation", "descriptors", "library", "recognition", "simulation",
                   "report"],
}

# Library -> (how its headers' names begin, modules that may use it; None: all of them).
HIDDEN = {
    "nanoflann": (r"nanoflann", ["cloud"]),
    "Embree": (r"embree\d*/", ["views"]),
    "TBB": (r"(tbb|oneapi)/", ["base"]),
    "SQLite": (r"sqlite3", ["library"]),
    "assimp": (r"assimp/", ["io"]),
    "libpng": (r"(libpng\d*/)?png\.h", ["io"]),
    "nlohmann-json": (r"nlohmann/", ["io", "evaluation"]),
    "fmt": (r"fmt/", None),
    "CLI11": (r"CLI/", []),
    "pybind11": (r"pybind11/", []),
    "PCL": (r"pcl/", []),
    "OpenCV": (r"opencv", []),
}

MAX_LINES = {".hpp": 300, ".cpp": 400}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
HEADERS_OF_MODULE = re.compile(r"\bHEADERS\b(.*?)(?=\b(?:SOURCES|DEPENDS|HIDDEN)\b|\))", re.DOTALL)


def public_headers(module_folder):
    """Names of the headers that the module's CMakeLists.txt lists, relative to its folder."""
    cmake = module_folder / "CMakeLists.txt"
    if not cmake.exists():
        return set()
    text = re.sub(r"#.*", "", cmake.read_text(encoding="utf-8"))
    return {name for match in HEADERS_OF_MODULE.finditer(text) for name in match.group(1).split()}


def check_project_include(module, is_public, target, public):
    """What is wrong with including `target` ("ostraka/...") there, or None."""
    parts = target.split("/", 2)
    if len(parts) < 3:
        return f'includes "{target}", which is for users of the library'
    other, name = parts[1], parts[2]
    if other not in MODULES:
        return f'includes "{target}": there is no module "{other}"'
    if other != module and other not in MODULES[module]:
        allowed = ", ".join(MODULES[module]) or "nothing"
        return f'{module} may not include {other} ("{target}"); allowed: {allowed}'
    if name not in public[other]:
        if is_public:
            return f'public header includes "{target}", which is not a public header of {other}'
        if other != module:
            return f'includes "{target}", which is private to {other}'
    return None


def check_library_include(module, is_public, target):
    """What is wrong with including the foreign header `target` there, or None."""
    for library, (pattern, homes) in HIDDEN.items():
        if not re.match(pattern, target):
            continue
        if is_public:
            return f"public header shows the hidden library {library} (<{target}>)"
        if homes is not None and module not in homes:
            return f"{library} (<{target}>) belongs to {', '.join(homes) or 'no module'}"
    return None


def check_includes(path, module, is_public, public, source_root):
    """(line, message) of every forbidden include of a file."""
    lines = path.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines, start=1):
        match = INCLUDE.match(line)
        if not match:
            continue
        quote, target = match.groups()
        if target.startswith("ostraka/"):
            message = check_project_include(module, is_public, target, public)
            if message is None and not (source_root / target).exists():
                message = f'includes "{target}", which does not exist'
        elif quote == '"':
            message = f'includes "{target}": write "ostraka/<module>/<file>.hpp"'
        else:
            message = check_library_include(module, is_public, target)
        if message:
            yield number, message


def check_size(path):
    """(line, message) if a file is too long."""
    limit = MAX_LINES[path.suffix]
    count = len(path.read_text(encoding="utf-8").splitlines())
    if count > limit:
        yield limit + 1, f"{count} lines; a {path.suffix} file has at most {limit}"


def code_files(folder):
    return sorted(path for path in folder.rglob("*") if path.suffix in MAX_LINES)


def violations(root):
    """Every violation in the tree as "path:line: message"."""
    source_root = root / "src"
    modules_root = source_root / "ostraka"
    public = {module: public_headers(modules_root / module) for module in MODULES}
    found = []

    def add(path, problems):
        place = path.relative_to(root)
        found.extend(f"{place}:{line}: {message}" for line, message in problems)

    for folder in sorted(path for path in modules_root.iterdir() if path.is_dir()):
        if folder.name not in MODULES:
            add(folder, [(1, "no such module in the table of tools/check_layers.py")])
            continue
        for name in sorted(public[folder.name]):
            if not (folder / name).exists():
                add(folder / "CMakeLists.txt", [(1, f"lists {name}, which does not exist")])
        for path in code_files(folder):
            is_public = path.relative_to(folder).as_posix() in public[folder.name]
            add(path, check_includes(path, folder.name, is_public, public, source_root))
    for top in (source_root, root / "apps"):
        for path in code_files(top):
            add(path, check_size(path))
    return found


# --- self-test -----------------------------------------------------------------------------------

SOUND = {
    "src/ostraka/base/CMakeLists.txt": "ostraka_module(base HEADERS a.hpp SOURCES a.cpp)",
    "src/ostraka/base/a.hpp": "#include <vector>\n",
    "src/ostraka/base/a.cpp": "#include <fmt/format.h>\n#include <tbb/parallel_for.h>\n",
    "src/ostraka/mesh/CMakeLists.txt": "ostraka_module(mesh HEADERS m.hpp  # b.hpp\n DEPENDS base)",
    "src/ostraka/mesh/m.hpp": '#include "ostraka/base/a.hpp"\n',
    "src/ostraka/mesh/secret.hpp": "#include <fmt/format.h>\n",
    "src/ostraka/io/CMakeLists.txt": "ostraka_module(io HEADERS i.hpp)",
    "src/ostraka/io/i.hpp": '#include "ostraka/mesh/m.hpp"\n',
    "src/ostraka/io/json.hpp": "#include <nlohmann/json.hpp>\n",
    "src/ostraka/io/i.cpp": '#include "ostraka/io/json.hpp"\n#include <assimp/scene.h>\n',
    "src/ostraka/recognition/r.cpp": '#include "ostraka/io/i.hpp"\n',
    "src/ostraka/evaluation/e.cpp": "#include <nlohmann/json.hpp>\n",
    "apps/ostraka/main.cpp": "#include <CLI/CLI.hpp>\n" + "//\n" * 399,
}

# (file to add or replace, its text, the violation's beginning, a part of its message)
BROKEN = [
    ("src/ostraka/base/b.cpp", '//\n#include "ostraka/mesh/m.hpp"\n',
     "src/ostraka/base/b.cpp:2:", "base may not include mesh"),
    ("src/ostraka/mesh/x.cpp", '#include "ostraka/io/i.hpp"\n',
     "src/ostraka/mesh/x.cpp:1:", "mesh may not include io"),
    ("src/ostraka/registration/x.cpp", '  #  include "ostraka/mesh/m.hpp"\n',
     "src/ostraka/registration/x.cpp:1:", "registration may not include mesh"),
    ("src/ostraka/base/a.hpp", "#include <fmt/core.h>\n",
     "src/ostraka/base/a.hpp:1:", "hidden library fmt"),
    ("src/ostraka/io/i.hpp", "#pragma once\n\n#include <nlohmann/json.hpp>\n",
     "src/ostraka/io/i.hpp:3:", "hidden library nlohmann-json"),
    ("src/ostraka/base/x.cpp", "#include <nanoflann.hpp>\n",
     "src/ostraka/base/x.cpp:1:", "nanoflann"),
    ("src/ostraka/cloud/x.cpp", "#include <embree3/rtcore.h>\n",
     "src/ostraka/cloud/x.cpp:1:", "Embree"),
    ("src/ostraka/cloud/x.cpp", "#include <tbb/parallel_sort.h>\n",
     "src/ostraka/cloud/x.cpp:1:", "TBB"),
    ("src/ostraka/io/x.cpp", "#include <sqlite3.h>\n", "src/ostraka/io/x.cpp:1:", "SQLite"),
    ("src/ostraka/mesh/x.cpp", "#include <assimp/scene.h>\n",
     "src/ostraka/mesh/x.cpp:1:", "assimp"),
    ("src/ostraka/views/x.cpp", "#include <png.h>\n", "src/ostraka/views/x.cpp:1:", "libpng"),
    ("src/ostraka/library/x.cpp", "#include <nlohmann/json.hpp>\n",
     "src/ostraka/library/x.cpp:1:", "nlohmann-json"),
    ("src/ostraka/recognition/x.hpp", "#include <sqlite3.h>\n",
     "src/ostraka/recognition/x.hpp:1:", "SQLite"),
    ("src/ostraka/mesh/m.hpp", '#include "ostraka/mesh/secret.hpp"\n',
     "src/ostraka/mesh/m.hpp:1:", "not a public header of mesh"),
    ("src/ostraka/io/x.cpp", '#include "ostraka/mesh/secret.hpp"\n',
     "src/ostraka/io/x.cpp:1:", "private to mesh"),
    ("src/ostraka/base/x.cpp", '#include "ostraka/base/gone.hpp"\n',
     "src/ostraka/base/x.cpp:1:", "does not exist"),
    ("src/ostraka/base/x.cpp", '#include "a.hpp"\n', "src/ostraka/base/x.cpp:1:", "write"),
    ("src/ostraka/base/x.cpp", '#include "ostraka/ostraka.hpp"\n',
     "src/ostraka/base/x.cpp:1:", "for users"),
    ("src/ostraka/stray/x.cpp", "\n", "src/ostraka/stray:1:", "no such module"),
    ("src/ostraka/mesh/CMakeLists.txt", "ostraka_module(mesh HEADERS m.hpp n.hpp)",
     "src/ostraka/mesh/CMakeLists.txt:1:", "n.hpp"),
    ("src/ostraka/base/long.hpp", "//\n" * 301, "src/ostraka/base/long.hpp:301:", "301 lines"),
    ("src/ostraka/base/long.cpp", "//\n" * 401, "src/ostraka/base/long.cpp:401:", "401 lines"),
    ("apps/ostraka/long.cpp", "//\n" * 500, "apps/ostraka/long.cpp:401:", "500 lines"),
]


def violations_in(files):
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        for place, text in files.items():
            path = root / place
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return violations(root)


def self_test():
    """Complaints about this checker itself; none if it works."""
    complaints = [f"a sound tree is rejected: {line}" for line in violations_in(SOUND)]
    for place, text, start, part in BROKEN:
        found = violations_in({**SOUND, place: text})
        if len(found) != 1 or not found[0].startswith(start) or part not in found[0]:
            complaints.append(f"expected one violation '{start} ... {part} ...', found {found}")
    return complaints


def main(arguments):
    if arguments == ["--self-test"]:
        problems = self_test()
    elif len(arguments) > 1 or any(argument.startswith("-") for argument in arguments):
        problems = [__doc__]
    else:
        root = Path(arguments[0]) if arguments else Path(__file__).resolve().parent.parent
        if not (root / "src/ostraka").is_dir():
            problems = [f"{root}: has no src/ostraka"]
        else:
            problems = violations(root)
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
