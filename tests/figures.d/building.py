"""The table of the first build: what the newcomer's command takes, and where it goes."""

import json
import os
import re
import resource
import shutil
import subprocess
import sys
from pathlib import Path

from measuring import ROOT, commit_of_tree
from words import Table, seconds

# Crates that are named; and which are counted as small [s].
NAMED, SMALL_S = 14, 3.0


def measure(folder: Path) -> dict:
    """Builds the executable from nothing, as a cold clone does; what is downloaded is not counted."""
    target = folder / "target"
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir(parents=True)
    build = ["cargo", "build", "--release", "--locked"]
    environment = {name: value for name, value in os.environ.items() if name != "RUSTC_WORKSPACE_WRAPPER"}
    environment["CARGO_TARGET_DIR"] = str(target)
    subprocess.run(["cargo", "fetch", "--locked"], cwd=ROOT, check=True, stdout=sys.stderr)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([*build, "--timings"], cwd=ROOT, env=environment, check=True, stdout=sys.stderr)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    page = (target / "cargo-timings" / "cargo-timing.html").read_text()
    units = json.loads(re.search(r"const UNIT_DATA = (\[.*?\]);", page, re.DOTALL).group(1))
    found = {
        "cpu_s": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
        "bytes": (target / "release" / "loadframe").stat().st_size,
        "units": [(unit["name"] + unit["target"], unit["duration"]) for unit in units],
    }
    (folder / "build.json").write_text(json.dumps(found))
    shutil.rmtree(target)
    return {"commit": commit_of_tree()}


def rows(folder: Path) -> list[list[str]]:
    found = json.loads((folder / "build.json").read_text())
    units = sorted(found["units"], key=lambda unit: -unit[1])
    small = [duration for _, duration in units[NAMED:] if duration < SMALL_S]
    between = [duration for _, duration in units[NAMED:] if duration >= SMALL_S]
    return [
        ["what is compiled", "takes"],
        [f"all: processor time, for an executable of {found['bytes'] / 1e6:.0f} MB", seconds(found["cpu_s"])],
        *([f"`{name}`", seconds(duration)] for name, duration in units[:NAMED]),
        [f"{len(between)} further ones of {SMALL_S:.0f} s or more", seconds(sum(between))],
        [f"{len(small)} small ones", seconds(sum(small))],
    ]


TABLES = {"first_build": Table("15 min of processor time", measure, rows)}
