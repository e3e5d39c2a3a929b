"""Tables of the nonwoven tensile test."""

import json
import os
import subprocess
from pathlib import Path

from measuring import BINARY, ROOT, example, loadframe, run
from words import Table, digits, percent, seconds

# ── what an accuracy costs ──────────────────────────────────────────────────────────────────────────

PRESETS = [("`draft`", "5"), ("`standard`", "100"), ("`reference`", "1e4")]
SOLVERS = ["sequential", "parallel"]
RESULTS = ["strength", "strain_at_max_force", "modulus_at_10_percent", "poisson_ratio", "energy_absorption"]
FABRICS = ["PET", "floppy", "flat"]


def fabric(name: str) -> dict:
    """PET as the example has it; a floppy net of it without compression stiffness; a flat layer."""
    body = example("nonwoven_tensile")
    lattice = body["spec"]["fabric"]["lattice"]
    if name == "floppy":
        lattice.update(points_per_row=15, rows=17)
        body["spec"]["bond"]["compression_stiffness_n"] = 0
    if name == "flat":
        lattice.update(points_per_row=100, rows=101, layers=1, irregularity=[0.5, 0.5, 0])
    return body


def study_accuracy(body: dict, folder: Path, seeds: int, *knobs: str) -> dict:
    folder.mkdir(parents=True, exist_ok=True)
    spec = folder / "spec.json"
    spec.write_text(json.dumps(body))
    varied = [argument for knob in knobs for argument in ("--knob", knob)]
    loadframe("study", "accuracy", spec, "--out", folder, "--seeds", seeds, *varied)
    return json.loads((folder / "accuracy.json").read_text())


def measure_accuracy(folder: Path) -> dict:
    values = ",".join(value for _, value in PRESETS)
    studies = [study_accuracy(fabric(name), folder / name, 4, f"force_accuracy={values}") for name in FABRICS]
    study_accuracy(fabric("PET"), folder / "solvers", 2, f"solver={','.join(SOLVERS)}")
    return {"commit": studies[0]["engine_commit"]}


def settings(folder: Path) -> dict:
    """Rows of an accuracy study's only knob by value."""
    study = json.loads((folder / "accuracy.json").read_text())
    return {row["value"]: row for row in study["knobs"][0]["rows"]}


def accuracy(folder: Path) -> list[list[str]]:
    found = {name: settings(folder / name) for name in FABRICS}
    solvers = settings(folder / "solvers")
    worst = lambda row, result: row["errors"][result]["worst"]
    heads = ["maximum force", "strain there", "modulus at 10 %", "Poisson ratio", "energy"]
    rows = [["`accuracy`", "A_cc", *FABRICS, *heads]]
    for preset, value in PRESETS:
        times = [seconds(found[name][value]["cpu_s"]) for name in FABRICS]
        errors = {result: max(worst(found[name][value], result) for name in FABRICS) for result in RESULTS}
        cells = [percent(error) for error in errors.values()]
        cells[3] += f" (PET {percent(worst(found['PET'][value], 'poisson_ratio'))})"
        rows.append([preset, value, *times, *cells])
    for solver in SOLVERS:
        row = solvers[solver]
        cells = [percent(worst(row, result)) for result in RESULTS]
        rows.append([f'`"solver": "{solver}"` (PET, two seeds)', "100", seconds(row["cpu_s"]), "", "", *cells])
    return rows


# ── the thesis' ways to equilibrium ─────────────────────────────────────────────────────────────────

SPECIMENS, STRAIN = 3, 0.3
WAYS = {
    "`newton_cg`": {"solver": "newton_cg"},
    "`sequential`": {"solver": "sequential"},
    "`parallel`": {"solver": "parallel"},
    **{
        f"`{solver}`, {words}": {"solver": solver, "descent_gradient": gradient}
        for solver in ["gradient_descent", "barzilai_borwein"]
        for gradient, words in [("exact", "exact gradient"), ("as_printed", "as printed"), ("smoothed", "smoothed")]
    },
}


def way(folder: Path, number: int, seed: int) -> Path:
    return folder / f"{number}-{seed}"


def measure_solvers(folder: Path) -> dict:
    """A small fabric to 30 % strain in steps of 2 %, where the first of its bonds break."""
    body = example("nonwoven_tensile_quick")
    body["spec"]["fabric"]["lattice"].update(points_per_row=7, rows=9, layers=2)
    body["spec"]["test"].update(max_strain=STRAIN)
    for seed in range(1, SPECIMENS + 1):
        body["spec"]["seed"] = seed
        for number, knobs in enumerate([{"solver": "newton_cg", "force_accuracy": 1e5}, *WAYS.values()]):
            body["spec"]["accuracy"] = {"force_accuracy": 100, **knobs}
            failed = way(folder, number, seed) / "failure.json"
            try:
                if not failed.exists():
                    run(body, way(folder, number, seed))
            except subprocess.CalledProcessError:
                # nodes that are thrown end nowhere, and the test without a result
                if not failed.exists():
                    raise
    return {"commit": solved(folder, 0)[1]["provenance"]["engine_commit"]}


def solved(folder: Path, number: int) -> dict[int, dict]:
    """Outcomes of the specimens that have one, by seed."""
    paths = {seed: way(folder, number, seed) / "outcome.json" for seed in range(1, SPECIMENS + 1)}
    return {seed: json.loads(path.read_text()) for seed, path in paths.items() if path.exists()}


def solvers(folder: Path) -> list[list[str]]:
    rows = [["solver", "force at 30 %", "modulus at 10 %", "Poisson ratio", "steps not in balance", "evaluations of a bond", "processor time"]]
    results = ["max_force", "modulus_at_10_percent", "poisson_ratio"]
    exact = solved(folder, 0)
    mean = lambda values: sum(values) / len(values)
    for number, name in enumerate(WAYS, 1):
        found = solved(folder, number)
        lost = SPECIMENS - len(found)
        if lost:
            name += f", no result of {lost} of {SPECIMENS}"
        if not found:
            rows.append([name, *[""] * 6])
            continue
        value = lambda outcome, result: outcome["summary"][result]["value"]
        # what had parted before has no modulus
        off = lambda result: [abs(value(one, result) / value(exact[seed], result) - 1) for seed, one in found.items() if value(one, result) is not None]
        worst = [max(off(result), default=None) for result in results]
        evaluations = mean([o["cost"]["work"]["bond_evaluations"] / value(o, "bonds") for o in found.values()])
        rows.append([
            name, *("" if error is None else percent(error) for error in worst),
            f"{mean([o['quality']['unconverged_steps']['value'] for o in found.values()]):.0f} of {round(STRAIN / 0.02) + 1}",
            grouped(evaluations), seconds(mean([o["cost"]["cpu_s"] for o in found.values()])),
        ])
    return rows


# ── what features cost ──────────────────────────────────────────────────────────────────────────────

# Rows of `tests/bench features` in the words of the guide.
NETWORKS = {
    "lattice of three layers, breaking": "lattice 98 x 101 x 3, clamped rows",
    "the same, nothing can break": "the same, nothing can break",
    "the same, f_r = 0": "the same, f_r = 0",
    "one layer, rough: three dimensions": "one layer 170 x 171, rough: three dimensions",
    "one layer, flat: two dimensions": "one layer 170 x 171, flat: two dimensions",
    "given bond by bond, one law for all": "the first given bond by bond, one law for all",
    "given bond by bond, each its modulus": "the same, each bond its own modulus",
}


def bench(folder: Path) -> list[dict]:
    return json.loads((folder / "bench.json").read_text())["features"]


def measure_features(folder: Path) -> dict:
    command = ["tests/bench", "features", "--json", folder.resolve() / "bench.json"]
    subprocess.run(command, cwd=ROOT, check=True, env={**os.environ, "LOADFRAME_BIN": BINARY})
    return {"commit": bench(folder)[0]["engine_commit"]}


def features(folder: Path) -> list[list[str]]:
    rows = [["network", "bonds", "processor time", "per evaluation of a bond", "evaluations of a bond", "memory per bond"]]
    for row in bench(folder):
        each = 1e9 * row["cpu_s"] / row["bond_evaluations"]
        rows.append([
            NETWORKS[row["network"]], grouped(row["bonds"]), seconds(row["cpu_s"]), f"{digits(each)} ns",
            f"{row['bond_evaluations'] / row['bonds']:.0f}", f"{grouped(row['bytes_per_bond'])} bytes",
        ])
    return rows


def grouped(number: float) -> str:
    """Thousands apart: 107 263."""
    return f"{number:,.0f}".replace(",", " ")


# ── large networks ──────────────────────────────────────────────────────────────────────────────────

LARGE = {
    "lattice 490 x 511 x 3, half-bond jaws": {"points_per_row": 490, "rows": 511, "layers": 3, "jaws": "half_bond"},
    "lattice 200 x 201 x 20, clamped rows": {"points_per_row": 200, "rows": 201, "layers": 20, "jaws": "clamped_rows"},
}
ACCURACIES, THREADS = [10, 100], [1, 2]


def large_case(folder: Path, number: int, force_accuracy: int, threads: int) -> Path:
    return folder / f"{number}-{force_accuracy}-{threads}"


def measure_large(folder: Path) -> dict:
    """To 10 % strain in ten steps."""
    for number, lattice in enumerate(LARGE.values()):
        for force_accuracy in ACCURACIES:
            for threads in THREADS:
                body = example("nonwoven_tensile")
                body["spec"]["fabric"]["lattice"].update(lattice)
                body["spec"]["test"].update(strain_step=0.01, max_strain=0.1)
                body["spec"]["accuracy"] = {"solver": "newton_cg", "force_accuracy": force_accuracy}
                outcome = run(body, large_case(folder, number, force_accuracy, threads), threads)
    return {"commit": outcome["provenance"]["engine_commit"]}


def large(folder: Path) -> list[list[str]]:
    rows = [["network", "unknowns", "A_cc", "one thread", "two threads: processor time of both (wall time)", "memory"]]
    for number, name in enumerate(LARGE):
        for force_accuracy in ACCURACIES:
            paths = [large_case(folder, number, force_accuracy, threads) / "outcome.json" for threads in THREADS]
            one, two = [json.loads(path.read_text()) for path in paths]
            is_first = force_accuracy == ACCURACIES[0]
            unknowns = f"{3 * one['summary']['nodes']['value'] / 1e6:.1f} million"
            rows.append([
                name if is_first else "", unknowns if is_first else "", force_accuracy, seconds(one["cost"]["cpu_s"]),
                f"{seconds(two['cost']['cpu_s'])} ({seconds(two['cost']['wall_s'])})",
                f"{one['cost']['peak_memory_mb'] / 1000:.1f} GB",
            ])
    return rows


TABLES = {
    "nonwoven_accuracy": Table("4 min of processor time", measure_accuracy, accuracy),
    "nonwoven_solvers": Table("an hour of processor time", measure_solvers, solvers),
    "nonwoven_features": Table("10 s of processor time", measure_features, features),
    "nonwoven_large": Table("100 s of processor time, 1.1 GB of memory", measure_large, large),
}
