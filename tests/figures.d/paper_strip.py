"""How a small sheet stands for a strip of the standard: what its width and the distance of its jaws do to the paper tensile test."""

import math
from functools import partial
from pathlib import Path
from statistics import NormalDist
from typing import NamedTuple

from measuring import run
from paper import softwood
from paper_large import grouped, outcome_of
from words import Table, seconds

# ISO 1924-2: width and distance of the jaws [mm].
STRIP = (15, 100)
FIBRE = 1
SEEDS = 8
# Widths of sheets of one length, and lengths of sheets of one width [mm].
WIDTHS, LENGTH = (0.25, 0.5, 1, 2), 4
LENGTHS, WIDTH = (1, 2, 4, 8), 0.5
# A wider one, which what the others say is held against.
WIDER = 4


class Fibres(NamedTuple):
    """How fibres are modelled, and how finely they break; whether the whole strip is pulled as well."""

    model: dict
    precision: float
    is_whole: bool


BEAMS = Fibres({"level": "beam"}, 0.1, is_whole=False)
TRUSSES = Fibres({"level": "truss", "taut_strain": 1e-4}, 0.2, is_whole=True)


def sheet(fibres: Fibres, length: float, width: float, seeds: int = SEEDS, until: float = 0.9) -> dict:
    body = softwood(pulp__0__length_mm=FIBRE, test__repeats=seeds, test__stop_force_fraction=until)
    spec = body["spec"]
    spec["specimen"] = {"sheet": {"length_mm": length, "width_mm": width, "grammage_g_per_m2": 60}}
    spec["model"] = fibres.model
    spec["accuracy"] = {"segment_widths": 4, "bonds_at": "inside", "break_precision": fibres.precision}
    return body


def place(folder: Path, length: float, width: float) -> Path:
    return folder / f"strip_{round(1e3 * length)}_{round(1e3 * width)}_um"


def sizes() -> list[tuple[float, float]]:
    """Lengths and widths, cheapest first."""
    all_of_them = {(LENGTH, width) for width in (*WIDTHS, WIDER)} | {(length, WIDTH) for length in LENGTHS}
    return sorted(all_of_them, key=lambda size: size[0] * size[1])


def measure(fibres: Fibres, folder: Path) -> dict:
    for length, width in sizes():
        outcome = run(sheet(fibres, length, width), place(folder, length, width))
    if fibres.is_whole:
        width, length = STRIP
        # past the peak it parts at one elongation, in as many solutions as before
        outcome = run(sheet(fibres, length, width, seeds=1, until=0.97), place(folder, length, width), threads=2)
    return {"commit": outcome["provenance"]["engine_commit"]}


# ── from sheets to the strip ────────────────────────────────────────────────────────────────────────


def weakest(links: int) -> float:
    """By how many standard deviations the weakest of so many falls short of their mean, if they are normal."""
    normal, steps = NormalDist(), 20_000
    below = [links * (1 - normal.cdf(x)) ** (links - 1) * normal.pdf(x) * x for x in (16 * (i + 0.5) / steps - 8 for i in range(steps))]
    return -sum(below) * 16 / steps


def edges(widths, forces, errors) -> tuple[float, float, float]:
    """Of forces f (w − d) over widths w, by least squares: f, d and the standard error of d."""
    weights = [1 / error**2 for error in errors]
    total = sum(weights)
    x = sum(w * width for w, width in zip(weights, widths)) / total
    y = sum(w * force for w, force in zip(weights, forces)) / total
    xx = sum(w * (width - x) ** 2 for w, width in zip(weights, widths))
    slope = sum(w * (width - x) * force for w, width, force in zip(weights, widths, forces)) / xx
    lost = x - y / slope
    # d is where the line is nought: that of its height there
    return slope, lost, math.sqrt(1 / total + (lost - x) ** 2 / xx) / slope


def known(folder: Path, length: float, width: float, name: str) -> dict:
    return outcome_of(place(folder, length, width))["summary"][name]


def by_edges(folder: Path, name: str) -> tuple[float, float, float]:
    """Of a result over the width: what it is without edges, the width lost at these and the standard error of this [mm]."""
    means = [known(folder, LENGTH, width, name) for width in WIDTHS]
    forces = [mean["value"] * width for mean, width in zip(means, WIDTHS)]
    errors = [mean["deviation"] / math.sqrt(mean["n"]) * width for mean, width in zip(means, WIDTHS)]
    return edges(WIDTHS, forces, errors)


def strip(folder: Path) -> tuple[float, float]:
    """Of the strip of the standard: tensile index and its stiffness index."""
    slope, lost, _ = by_edges(folder, "tensile_index")
    widest = known(folder, LENGTH, WIDTHS[-1], "tensile_index")
    # sheets side by side share their scatter
    scatter = widest["deviation"] * math.sqrt(WIDTHS[-1] / STRIP[0])
    index = slope * (1 - lost / STRIP[0]) - weakest(STRIP[1] // LENGTH) * scatter
    stiff, lost, _ = by_edges(folder, "tensile_stiffness_index")
    return index, stiff * (1 - lost / STRIP[0])


def rows(fibres: Fibres, folder: Path) -> list[list[str]]:
    table = [["jaws apart", "width", "sheets", "fibres", "bonds", "tensile index [N m/g]", "reckoned", "stiffness index [kN m/g]", "reckoned", "stretch",
              "processor time of a sheet"]]
    link = known(folder, LENGTH, WIDTH, "tensile_index")
    whole, lost, error = by_edges(folder, "tensile_index")
    for length, width in sorted(sizes(), key=lambda size: (size[0] != LENGTH, size)):
        reckoned = ""
        if length > LENGTH:
            reckoned = f"{link['value'] - weakest(length // LENGTH) * link['deviation']:.2f}"
        elif width == WIDER:
            reckoned = f"{whole * (1 - lost / width):.2f}"
        table.append(row(folder, (length, width), SEEDS, reckoned, ""))
    width, length = STRIP
    reckoned = [f"{of_strip:.2f}" for of_strip in strip(folder)]
    if fibres.is_whole:
        table.append(row(folder, (length, width), 1, *reckoned))
    else:
        table.append([f"{length} mm", f"{width} mm", "none", "", "", "", reckoned[0], "", reckoned[1], "", ""])
    table.append(["lost at the edges, d", f"{lost:.3f} ± {error:.3f} mm", *[""] * 9])
    return table


def row(folder: Path, size: tuple[float, float], sheets: int, index: str, stiffness: str) -> list[str]:
    """What was pulled, beside what was reckoned of it."""
    outcome = outcome_of(place(folder, *size))
    summary = outcome["summary"]
    return [
        *(f"{one:g} mm" for one in size), str(sheets), grouped(summary["fibres"]["value"]), grouped(summary["bonds"]["value"]),
        scattered(summary["tensile_index"]), index, scattered(summary["tensile_stiffness_index"]), stiffness,
        f"{100 * summary['stretch']['value']:.2g} %", seconds(outcome["cost"]["cpu_s"] / sheets)]


def scattered(result: dict) -> str:
    """Of several sheets with their standard deviation."""
    scatter = f" (scatter {result['deviation']:.2f})" if "deviation" in result else ""
    return f"{result['value']:.2f}{scatter}"


TABLES = {
    "paper_strip": Table("30 min of processor time", partial(measure, BEAMS), partial(rows, BEAMS)),
    "paper_strip_trusses": Table("3 hours of processor time, 10 GB", partial(measure, TRUSSES), partial(rows, TRUSSES)),
}
