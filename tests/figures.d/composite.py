"""Tables of the bent section of a composite."""

import copy
from pathlib import Path

from measuring import example, run
from words import Table, digits, percent

GRIDS = [10, 25, 50, 100, 200]
FINEST = 400


def body(angle: int, cells: int, per_fibre: int | None = None, lattice: dict | None = None) -> dict:
    """The paper's five fibres along x (0) or y (90)."""
    job = copy.deepcopy(example("composite_bending"))
    spec = job["spec"]
    for fibre in spec["fibres"]:
        if angle == 90:
            fibre.update(angle_deg=90, through_mm=list(reversed(fibre["through_mm"])))
    spec["grid"] = {"cells": [cells, cells]}
    if per_fibre:
        spec["grid"]["graded_cells_per_fibre"] = per_fibre
    if lattice:
        spec["lattice"] = lattice
    spec["output"] = {"picture": False}
    return job


def measure_convergence(folder: Path) -> dict:
    outcomes = [run(body(angle, cells), folder / f"{angle}_{cells}") for angle in (0, 90) for cells in GRIDS]
    for angle in (0, 90):
        run(body(angle, FINEST, 4), folder / f"{angle}_finest")
    return {"commit": outcomes[0]["provenance"]["engine_commit"]}


def convergence(folder: Path) -> list[list[str]]:
    rows = [["cells", "fibres along x: top", "said", "bottom", "said", "along y: top", "said", "bottom", "said", "time"]]
    truth = {angle: run(body(angle, FINEST, 4), folder / f"{angle}_finest")["summary"] for angle in (0, 90)}
    for cells in GRIDS:
        row, spent = [f"{cells} by {cells}"], 0.0
        for angle in (0, 90):
            outcome = run(body(angle, cells), folder / f"{angle}_{cells}")
            spent = max(spent, outcome["cost"]["cpu_s"])
            for name in ("mean_top_deflection", "mean_bottom_deflection"):
                found, right = outcome["summary"][name], truth[angle][name]["value"]
                row += [percent(found["value"] / right - 1), percent(found["error"]["value"] / right)]
        rows.append([*row, f"{digits(spent)} s"])
    return rows


PAPER = {
    "`p_wave`": {"paper": {"stiffness": "p_wave", "bonds": "cross"}},
    "`bare`": {"paper": {"stiffness": "bare", "bonds": "cross"}},
    "exact": {"exact": {}},
}
PAPERS_CELLS = [10, 200]


def measure_paper(folder: Path) -> dict:
    for angle in (0, 90):
        truth = run(body(angle, FINEST, 4), folder / f"{angle}_finest")
        for name, lattice in PAPER.items():
            for cells in PAPERS_CELLS:
                run(body(angle, cells, lattice=lattice), folder / f"{angle}_{cells}_{name.strip('`')}")
    return {"commit": truth["provenance"]["engine_commit"]}


def paper(folder: Path) -> list[list[str]]:
    head = ["fibres", "lattice", "cells", "top [mm]", "bottom [mm]", "too stiff at the top", "agreement as the paper counts it"]
    rows = [head]
    for angle in (0, 90):
        truth = run(body(angle, FINEST, 4), folder / f"{angle}_finest")["summary"]
        for name, lattice in PAPER.items():
            for cells in PAPERS_CELLS:
                found = run(body(angle, cells, lattice=lattice), folder / f"{angle}_{cells}_{name.strip('`')}")["summary"]
                top, bottom = (found[f"mean_{face}_deflection"]["value"] for face in ("top", "bottom"))
                stiff = truth["mean_top_deflection"]["value"] / top
                agreement = truth["deflection_ratio"]["value"] / found["deflection_ratio"]["value"]
                rows.append([f"{angle}°", name, f"{cells} by {cells}", f"{top:.5f}", f"{bottom:.5f}", f"{stiff:.2f} times", f"{100 * agreement:.0f} %"])
    return rows


TABLES = {
    "composite_convergence": Table("1 min of processor time", measure_convergence, convergence),
    "composite_paper": Table("1 min of processor time", measure_paper, paper),
}
