"""Tables of large sheets of paper: the first equilibrium, pulls to the peak, bonds inside straight parts, breaks of one solution."""

import json
import math
import os
import re
import shutil
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

from measuring import ROOT, TARGET, commit_of_tree, example, note_of, run
from plots import PICTURES, Plot, Series
from words import Table, digits, power, seconds

GRAMMAGE = 60
SMALL_STRAIN = 1e-6


def large(length: float) -> dict:
    """Softwood of 2 mm at 60 g/m², bonds inside straight parts of four widths; pulled to its first equilibrium."""
    body = example("paper_tensile_sheet")
    spec = body["spec"]
    spec["specimen"] = {"sheet": {"length_mm": length, "width_mm": length / 2, "grammage_g_per_m2": GRAMMAGE}}
    spec["accuracy"] = {"segment_widths": 4, "bonds_at": "inside", "break_precision": 0.05}
    spec["test"] = {"max_strain": SMALL_STRAIN}
    spec["output"] = {"snapshot_every_steps": 0}
    return body


def grouped(value: float) -> str:
    return f"{value:,.0f}".replace(",", " ")


def size(length: float) -> str:
    return f"{length:g} mm x {length / 2:g} mm"


def outcome_of(path: Path) -> dict:
    return json.loads((path / "outcome.json").read_text())


# ── the first equilibrium ───────────────────────────────────────────────────────────────────────────

# Lengths of sheets half as wide [mm], of 1 000 to 30 000 fibres.
LARGE = [2.6, 4.9, 9.5, 19.5]


def place_of_large(folder: Path, length: float) -> Path:
    return folder / f"rest_{round(1e3 * length)}_um"


def measure_large(folder: Path) -> dict:
    for length in LARGE:
        outcome = run(large(length), place_of_large(folder, length))
    return {"commit": outcome["provenance"]["engine_commit"]}


def per_fibre(folder: Path) -> list[list[str]]:
    rows = [["sheet", "fibres", "bonds", "unknowns", "iterations", "processor time", "memory", "time for each fibre", "memory for each fibre",
             "time for each bond and iteration"]]
    points = []
    for length in LARGE:
        outcome = outcome_of(place_of_large(folder, length))
        cost, summary = outcome["cost"], outcome["summary"]
        fibres, bonds, iterations = summary["fibres"]["value"], summary["bonds"]["value"], cost["work"]["iterations"]
        time, memory = 1e3 * cost["cpu_s"] / fibres, 1e3 * cost["peak_memory_mb"] / fibres
        points.append((fibres, time, memory))
        rows.append([
            size(length), grouped(fibres), grouped(bonds), grouped(cost["work"]["unknowns"]),
            str(iterations), seconds(cost["cpu_s"]), f"{grouped(cost['peak_memory_mb'])} MB",
            f"{digits(time)} ms", f"{digits(memory)} kB", f"{digits(1e6 * cost['cpu_s'] / (bonds * iterations))} µs"])
    plot = Plot("fibres", [
        Series("processor time for each fibre [ms]", [(fibres, time) for fibres, time, _ in points]),
        Series("memory for each fibre [kB]", [(fibres, memory) for fibres, _, memory in points])])
    (PICTURES / "paper_large.svg").write_text(plot.svg())
    return rows


# ── to the peak ─────────────────────────────────────────────────────────────────────────────────────

SCALE = os.environ.get("LOADFRAME_SCALE", str(TARGET / "release" / "examples" / "scale"))
# Keys of the example `scale` for each pull of beams; sheets are half as wide as long, at 60 g/m², bonds inside parts of 100 µm.
BEAMS = [
    {"length": 1, "precision": 0.1}, {"length": 1, "precision": 0.05}, {"length": 2, "precision": 0.1}, {"length": 3.4, "precision": 0.1},
]
# Of trusses.
TRUSSES = [{"length": 2, "precision": 0.1, "level": "truss", "taut": taut} for taut in (1e-3, 1e-4, 1e-5, 1e-9)]


class Pulled(NamedTuple):
    """What `scale` printed of one sheet."""

    asked: dict[str, str]
    fibres: int
    bonds: int
    unknowns: int
    # Processor time until the first equilibrium, and from there on [s].
    rest_s: float
    pull_s: float
    first_iterations: int
    memory_mb: float
    stiffness_mn: float
    solutions: int
    iterations: float
    peak_mn: float
    strain: float
    work_nj: float
    broken: int
    taut_share: float

    def number(self, key: str) -> float:
        return float(self.asked[key])

    def per_width_and_grammage(self, force_mn: float) -> float:
        """N m/g of a force in mN."""
        return force_mn / self.number("width") / self.number("grammage")


# fibres, bonds, unknowns, lay, contacts, rest, iterations, ms/fibre, stored, kB/fibre, residual, stiffness_mN
FIRST = re.compile(r"^ *(\d+) +(\d+) +(\d+) +([\d.]+) +[\d.]+ +([\d.]+) +(\d+) +[\d.]+ +\d+ +([\d.]+) +\S+ +([\d.]+)", re.MULTILINE)
LATER = re.compile(r"^ *(\d+) +([\d.]+) +[\d.]+$", re.MULTILINE)
PEAK = re.compile(r"^peak ([\d.]+) mN at ([\d.]+), ([\d.]+) nJ; (\d+) bonds and (\d+) segments broken in \d+ steps, ([\d.]+) s, .* taut share (\S+)$", re.MULTILINE)
ENDED = re.compile(r"^(ForceFraction|Parted|MaxStrain|NoPath)$", re.MULTILINE)


def pulled_of(log: Path) -> Pulled:
    """Reads a log of `scale` of one sheet; its first line says all that was asked."""
    text = log.read_text()
    asked = dict(pair.split("=", 1) for pair in text.split("\n", 1)[0].split() if "=" in pair)
    if missing := {"length", "width", "grammage", "level", "taut", "precision"} - asked.keys():
        sys.exit(f"{log}: its first line does not say {', '.join(sorted(missing))}, as `scale` prints them")
    if not (first := FIRST.search(text)):
        sys.exit(f"{log}: there is no row of a first equilibrium")
    fibres, bonds, unknowns, lay, rest, iterations, memory, stiffness = first.groups()
    peak, end = PEAK.search(text), ENDED.search(text)
    if not (peak and end):
        sys.exit(f"{log}: the pull has not come to its end")
    later = LATER.search(text, end.end())
    return Pulled(
        asked, int(fibres), int(bonds), int(unknowns), rest_s=float(lay) + float(rest), pull_s=float(peak[6]), first_iterations=int(iterations),
        memory_mb=1e-3 * float(memory) * int(fibres), stiffness_mn=float(stiffness), solutions=int(later[1]), iterations=float(later[2]),
        peak_mn=float(peak[1]), strain=float(peak[2]), work_nj=float(peak[3]), broken=int(peak[4]) + int(peak[5]), taut_share=float(peak[7]))


def log_of(folder: Path, case: dict) -> Path:
    return folder / ("_".join(f"{key}_{value}" for key, value in case.items()) + ".log")


def scale(folder: Path, cases: Iterable[dict]) -> dict:
    """Pulls each to its peak by the example; what is there and whole is not run again."""
    if not Path(SCALE).exists():
        sys.exit(f"{SCALE} is missing: cargo build --release -p loadframe-paper --example scale, or set LOADFRAME_SCALE")
    folder.mkdir(parents=True, exist_ok=True)
    for case in cases:
        log = log_of(folder, case)
        if not log.exists():
            print(log.stem, file=sys.stderr)
            keys = [f"{key}={value}" for key, value in case.items()]
            answer = subprocess.run([SCALE, *keys, "to=peak"], cwd=ROOT, check=True, capture_output=True, text=True)
            log.write_text(answer.stdout)
    return {"commit": commit_of_tree()}


def told(folder: Path, logs: list[Path]) -> None:
    """Keeps logs of runs made elsewhere with those that were measured here, and notes that."""
    note = note_of(folder)
    for log in logs:
        pulled_of(log)
        if not (folder / log.name).exists():
            note["command"] += f" --log {log.name}"
        shutil.copy(log, folder / log.name)
    (folder / "measured.json").write_text(json.dumps(note))


def pulls(folder: Path) -> list[Pulled]:
    """From small to large, and as finely."""
    found = [pulled_of(log) for log in folder.glob("*.log")]
    return sorted(found, key=lambda one: (one.number("length"), one.number("taut"), -one.number("precision")))


def beams_to_the_peak(folder: Path) -> list[list[str]]:
    rows = [["sheet", "fibres", "bonds", "unknowns", "`break_precision`", "tensile index", "stretch", "broken", "solutions", "iterations in each",
             "time of an iteration", "processor time", "memory"]]
    for one in pulls(folder):
        iterations = one.solutions * one.iterations
        rows.append([
            size(one.number("length")), grouped(one.fibres), grouped(one.bonds), grouped(one.unknowns), f"{one.number('precision'):g}",
            f"{one.per_width_and_grammage(one.peak_mn):.3g} N m/g", f"{100 * one.strain:.2g} %", grouped(one.broken), grouped(one.solutions),
            f"{one.iterations:.0f}", f"{digits(1e3 * one.pull_s / iterations)} ms", seconds(one.rest_s + one.pull_s), f"{grouped(one.memory_mb)} MB"])
    return rows


def trusses_to_the_peak(folder: Path) -> list[list[str]]:
    rows = [["sheet", "fibres", "bonds", "unknowns", "`taut_strain`", "stiffness index", "iterations to the first equilibrium", "tensile index", "stretch",
             "energy of tension", "solutions", "iterations in each", "processor time", "memory"]]
    for one in pulls(folder):
        row = [size(one.number("length")), grouped(one.fibres), grouped(one.bonds), grouped(one.unknowns), power(one.number("taut")),
               f"{1e-3 * one.per_width_and_grammage(one.stiffness_mn):.4g} kN m/g", grouped(one.first_iterations)]
        rows.append([
            *row, f"{one.per_width_and_grammage(one.peak_mn):.3g} N m/g", f"{100 * one.strain:.2g} %", f"{digits(100 * one.taut_share)} %",
            grouped(one.solutions), f"{one.iterations:.0f}", seconds(one.rest_s + one.pull_s), f"{grouped(one.memory_mb)} MB"])
    return rows


# ── bonds inside straight parts ─────────────────────────────────────────────────────────────────────

# Straight parts over the width of a fibre: 28 µm.
PARTS = [4, 2, 1]
FIBRE_UM = 28


def inside(widths: float, bonds_at: str) -> dict:
    body = large(1)
    body["spec"]["accuracy"] = {"segment_widths": widths, "bonds_at": bonds_at}
    return body


def measure_inside(folder: Path) -> dict:
    for widths in PARTS:
        for bonds_at in ("nodes", "inside"):
            outcome = run(inside(widths, bonds_at), folder / f"{bonds_at}_{widths}")
    return {"commit": outcome["provenance"]["engine_commit"]}


def bonds_inside(folder: Path) -> list[list[str]]:
    """Stiffness with bonds inside over that with bonds at nodes, of one sheet."""
    rows = [["straight parts", "too stiff by, `inside`", "points of bonds over free nodes of fibres", "unknowns, `inside` over `nodes`"]]
    for widths in PARTS:
        nodes, within = (outcome_of(folder / f"{bonds_at}_{widths}") for bonds_at in ("nodes", "inside"))
        stiffness = [one["summary"]["tensile_stiffness_index"]["value"] for one in (nodes, within)]
        unknowns = [one["cost"]["work"]["unknowns"] for one in (nodes, within)]
        crowding = 2 * within["summary"]["bonds"]["value"] / (unknowns[1] / MOTIONS)
        rows.append([f"{widths * FIBRE_UM} µm", f"{100 * (stiffness[1] / stiffness[0] - 1):.0f} %", f"{crowding:.2f}", f"{unknowns[1] / unknowns[0]:.2f}"])
    return rows


# Of a node of beams.
MOTIONS = 6

# ── breaking together ───────────────────────────────────────────────────────────────────────────────

PRECISIONS = [0.02, 0.05, 0.1, 0.2]
# Lengths of sheets half as wide [mm], each with its seeds.
TOGETHER = {0.7: (1, 2, 3), 1.0: (1, 2, 3), 1.5: (1, 2)}
# The same of trusses, which take minutes one by one beyond.
TRUSSES_TOGETHER = {0.7: (1, 2, 3), 0.85: (1, 2), 1.0: (1, 2, 3)}
RESULTS = {"max_force": "strength", "stretch": "stretch", "energy_absorption": "energy absorption"}


def together(length: float, seed: int, precision: float) -> dict:
    """Beams of softwood at 30 g/m², bonds at nodes: small enough for breaks one by one."""
    body = large(length)
    spec = body["spec"]
    spec["seed"] = seed
    spec["specimen"]["sheet"]["grammage_g_per_m2"] = 30
    spec["accuracy"] = {"segment_widths": 2, "break_precision": precision}
    spec["test"] = {"max_strain": 0.2}
    return body


def sheets(seeds_of: dict[float, tuple[int, ...]]) -> list[tuple[float, int]]:
    return [(length, seed) for length, seeds in seeds_of.items() for seed in seeds]


def place_together(folder: Path, length: float, seed: int, precision: float) -> Path:
    return folder / f"{round(1e3 * length)}_um_{seed}_{precision}"


def measure_together(folder: Path) -> dict:
    for length, seed in sheets(TOGETHER):
        for precision in [0, *PRECISIONS]:
            outcome = run(together(length, seed, precision), place_together(folder, length, seed, precision))
    return {"commit": outcome["provenance"]["engine_commit"]}


def of_job(folder: Path, length: float, seed: int, precision: float) -> list[float]:
    summary = outcome_of(place_together(folder, length, seed, precision))["summary"]
    return [summary[name]["value"] for name in RESULTS]


def case_of_truss(length: float, seed: int, precision: float) -> dict:
    """A truss at 60 g/m² until its force has fallen by a tenth: what its tension bears far beyond, where the sheet has parted, is no
    strength. Bonds are inside, or it folds, and bars taut, or iterations go by the hundred."""
    return {"length": length, "seed": seed, "level": "truss", "taut": 1e-4, "precision": precision}


def measure_trusses_together(folder: Path) -> dict:
    cases = (case_of_truss(length, seed, precision) for length, seed in sheets(TRUSSES_TOGETHER) for precision in [0, *PRECISIONS])
    return scale(folder, cases)


def of_truss(folder: Path, length: float, seed: int, precision: float) -> list[float]:
    one = pulled_of(log_of(folder, case_of_truss(length, seed, precision)))
    return [one.peak_mn, one.strain, one.work_nj]


def errors_together(folder: Path, measured: list[tuple[float, int]], results: Callable[[Path, float, int, float], list[float]]) -> list[list[str]]:
    """Results over those of breaks one by one, less one: mean ± deviation, extremes, and the root of the mean square."""
    rows = [["`break_precision`", *(f"{words}: mean, least to most, root mean square" for words in RESULTS.values())]]
    for precision in PRECISIONS:
        cells, off = [], {name: [] for name in RESULTS}
        for length, seed in measured:
            exact, found = (results(folder, length, seed, one) for one in (0, precision))
            for name, one, other in zip(RESULTS, found, exact):
                off[name].append(one / other - 1)
        for name in RESULTS:
            shares = [100 * share for share in off[name]]
            root = math.sqrt(statistics.mean(share * share for share in shares))
            cells.append(f"{statistics.mean(shares):+.1f} ({min(shares):+.1f} to {max(shares):+.1f}), {root:.1f} %".replace("-", "−"))
        rows.append([f"{precision:g}", *cells])
    return rows


TABLES = {
    "paper_large": Table("2 min of processor time, 3 GB", measure_large, per_fibre),
    "paper_large_pulled": Table("6 min of processor time", lambda folder: scale(folder, BEAMS), beams_to_the_peak, told),
    "paper_trusses": Table("6 min of processor time", lambda folder: scale(folder, TRUSSES), trusses_to_the_peak, told),
    "paper_bonds_inside": Table("1 min of processor time", measure_inside, bonds_inside),
    "paper_together": Table("3 min of processor time", measure_together, lambda folder: errors_together(folder, sheets(TOGETHER), of_job)),
    "paper_together_trusses": Table("6 min of processor time", measure_trusses_together, lambda folder: errors_together(folder, sheets(TRUSSES_TOGETHER), of_truss)),
}
