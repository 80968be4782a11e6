#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the Open MPI recipe of docs/many_machines.md, word for word.

Usage: many_machines_test.py PATH_OF_OSTRAKA PATH_OF_THE_PAGE
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile


def recipe(page):
    with open(page, encoding="utf-8") as file:
        section = re.search(r"## Open MPI\n(.*?)\n## ", file.read(), re.DOTALL).group(1)
    return re.search(r"```sh\n(.*?)```", section, re.DOTALL).group(1)


def main():
    ostraka, page = os.path.abspath(sys.argv[1]), sys.argv[2]
    if shutil.which("mpirun") is None:
        print("SKIPPED: there is no mpirun (Debian: openmpi-bin)")
        return 77
    environment = dict(os.environ, PATH=os.path.dirname(ostraka) + os.pathsep + os.environ["PATH"],
                       OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_plm_rsh_agent="")
    folder = tempfile.mkdtemp(prefix="ostraka_mpi_")
    try:
        def run(*command):
            subprocess.run(command, cwd=folder, env=environment, check=True, stdin=subprocess.DEVNULL)

        run("ostraka", "parts", "cam", "gear", "hook", "tee", "flange", "-o", "cad")
        run("sh", "-e", "-c", recipe(page))
        run("sh", "-c", "ostraka build cad/*.ply --unit mm -o whole.ostraka --threads 1")
        run("cmp", "library.ostraka", "whole.ostraka")
        shards = [name for name in os.listdir(folder) if name.startswith("shard")]
        assert len(shards) == 4, shards
    finally:
        shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
