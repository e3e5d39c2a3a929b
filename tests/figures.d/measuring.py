"""Runs loadframe, and notes what figures are worth nothing without: command, machine, date, commit.

Whatever is measured lies in a folder of its own with `measured.json` beside it, so that tables can be made
again without measuring again.
"""

import json
import os
import resource
import subprocess
import sys
import time
from contextlib import contextmanager
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent.parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
BINARY = os.environ.get("LOADFRAME_BIN", str(TARGET / "release" / "loadframe"))
EXAMPLES = ROOT / "api" / "examples"
# Other processes' share of the cores from which on the machine is called shared.
QUIET = 0.05


def loadframe(*arguments) -> None:
    """Runs the executable; what it says goes to standard error."""
    if not Path(BINARY).exists():
        sys.exit(f"{BINARY} is missing: cargo build --release, or set LOADFRAME_BIN")
    subprocess.run([BINARY, *map(str, arguments)], cwd=ROOT, check=True, stdout=sys.stderr)


def run(body: dict, folder: Path, threads: int = 1) -> dict:
    """The outcome of a job; one that is there already is not run again."""
    outcome = folder / "outcome.json"
    if not outcome.exists():
        folder.parent.mkdir(parents=True, exist_ok=True)
        spec = folder.with_suffix(".json")
        spec.write_text(json.dumps(body))
        loadframe("run", spec, "--out", folder, "--threads", threads)
    return json.loads(outcome.read_text())


def example(name: str) -> dict:
    return json.loads((EXAMPLES / f"{name}.json").read_text())


def machine() -> str:
    """Processor and cores."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    model = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "unknown processor")
    return f"{model}, {os.cpu_count()} cores"


def study(name: str, work: Path) -> Path:
    """The folder of a finished study of parameters, which the page of the ballast shares. An interrupted one
    goes on there; one that this engine has finished is not run again and keeps its note."""
    folder = work / "studies" / name
    earlier = note_of(folder) if (folder / "measured.json").exists() else None
    path = f"api/studies/ballast_{name}.json"
    with measured(folder, f"loadframe study parameters {path}") as note:
        loadframe("study", "parameters", path, "--out", folder)
        note["commit"] = json.loads((folder / "parameters.json").read_text())["engine_commit"]
        if earlier and earlier["commit"] == note["commit"]:
            note.update(earlier)
    return folder


def commit_of_executable() -> str:
    """As the outcome of a small job tells it."""
    with TemporaryDirectory() as scratch:
        outcome = run(example("nonwoven_tensile_quick"), Path(scratch) / "quick")
    return outcome["provenance"]["engine_commit"]


def commit_of_tree() -> str:
    """Of the sources that a bench is built from."""
    answer = subprocess.run(["git", "rev-parse", "--short=12", "HEAD"], cwd=ROOT, capture_output=True, text=True)
    return answer.stdout.strip() or "unknown"


def _busy_s() -> float:
    """Processor time of the whole machine since its start [s], idle and waiting left out."""
    fields = [int(field) for field in Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:9]]
    return (sum(fields) - fields[3] - fields[4]) / os.sysconf("SC_CLK_TCK")


def _own_s() -> float:
    usage = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in usage)


@contextmanager
def measured(folder: Path, command: str):
    """Notes in `folder` where, when and beside how much other work something was measured; yields the note,
    to which the commit is added by who knows it."""
    folder.mkdir(parents=True, exist_ok=True)
    began, busy, own = time.monotonic(), _busy_s(), _own_s()
    note = {"command": command, "machine": machine(), "date": date.today().isoformat()}
    yield note
    cores = os.cpu_count() * (time.monotonic() - began)
    others = max(_busy_s() - busy - (_own_s() - own), 0) / max(cores, 1e-9)
    # who knows better has said so: figures may be those of an earlier study
    note.setdefault("others", round(others, 2))
    (folder / "measured.json").write_text(json.dumps(note))


def note_of(folder: Path) -> dict:
    return json.loads((folder / "measured.json").read_text())


def circumstances(note: dict) -> str:
    """What `measured` noted, in a line."""
    shared = f", {100 * note['others']:.0f} % of their time taken by other work" if note["others"] > QUIET else ""
    return f"`{note['command']}`; {note['machine']}{shared}; {note['date']}; commit {note['commit']}"
