"""What a second thread gains a job of each kind: its wall time on one thread over that on two, by turns, so that
what else the machine does disturbs both."""

import json
import random
import statistics
from pathlib import Path

from measuring import example, run
from words import Table, seconds

ROUNDS = 3


# A row is worth so many particle steps, or a few seconds.
PARTICLE_STEPS = 1.5e8


def lattice(repeats: int, points: int, rows: int, strain: float) -> dict:
    """Nonwovens of three layers, strained so far."""
    body = example("nonwoven_tensile_repeats")
    body["spec"] |= {"output": {"snapshot_every_steps": 0}}
    body["spec"]["fabric"]["lattice"] |= {"points_per_row": points, "rows": rows}
    body["spec"]["test"] = {"strain_step": 0.01, "max_strain": strain, "repeats": repeats}
    return body


def heap(count: int) -> dict:
    """Spheres that were poured a moment ago, and lie in a box one on another."""
    chance, radius, spacing = random.Random(1), 0.01, 0.0205
    across = round((count / 2) ** (1 / 3))
    width = across * spacing
    bodies = []
    for number in range(count):
        cell = (number % across, number // across % across, number // across**2)
        own = radius * chance.uniform(0.7, 1)
        position = [spacing * place + chance.uniform(own, spacing - own) for place in cell]
        bodies.append({"sphere": {"radius_m": own}, "material": "stone", "position_m": position})
    plane = lambda name, axis, at, facing: {"name": name, "axis": axis, "position_m": at, "facing": facing, "material": "stone"}
    sides = [plane(f"{axis}_{side}", axis, at, facing) for axis in "xy" for side, at, facing in (("low", 0, 1), ("high", width, -1))]
    return {"kind": "granular_scene", "spec": {
        "version": 1,
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "stiffness_ratio": 0.3,
                                "friction_angle_rad": 0.5}},
        "bodies": bodies, "planes": [plane("base", "z", 0, 1), *sides],
        "laws": {"local_damping": 0.3}, "time_step_s": 2e-5,
        "stages": [{"run": {"steps": round(PARTICLE_STEPS / count)}}], "record": {"every_steps": 1_000_000},
    }}


def section(cells: int, solver: str) -> dict:
    body = example("composite_bending")
    body["spec"] |= {"grid": {"cells": [cells, cells]}, "accuracy": {"solver": solver}, "output": {"picture": False}}
    return body


def unit_cells(repeats: int) -> dict:
    body = example("composite_cell")
    body["spec"]["repeats"] = repeats
    return body


def sheets(repeats: int, **sheet) -> dict:
    body = example("paper_tensile_sheet")
    body["spec"]["specimen"]["sheet"] |= sheet
    body["spec"]["test"]["repeats"] = repeats
    return body


# In the words of the guide.
JOBS = {
    "nonwoven, ten specimens side by side": lambda: lattice(10, 37, 41, 2.0),
    "nonwoven, one specimen of 4 000 nodes": lambda: lattice(1, 37, 41, 2.0),
    "nonwoven, one specimen of 36 000 nodes": lambda: lattice(1, 109, 121, 0.6),
    "nonwoven, one specimen of 300 000 nodes": lambda: lattice(1, 317, 321, 0.1),
    "spheres, 1 000": lambda: heap(1_000),
    "spheres, 2 000": lambda: heap(2_000),
    "spheres, 5 000": lambda: heap(5_000),
    "spheres, 20 000": lambda: heap(20_000),
    "section of 200 by 200 cells, `static`": lambda: section(200, "static"),
    "section of 150 by 150 cells, `verlet`": lambda: section(150, "verlet"),
    "unit cells, four side by side": lambda: unit_cells(4),
    "unit cell, one": lambda: unit_cells(1),
    "paper, four sheets side by side": lambda: sheets(4, length_mm=1, width_mm=0.6),
    "paper, one sheet": lambda: sheets(1),
}


def measure(folder: Path) -> dict:
    for name, body in JOBS.items():
        for turn in range(ROUNDS):
            for threads in (1, 2):
                outcome = run(body(), at(folder, name, turn, threads), threads)
    return {"commit": outcome["provenance"]["engine_commit"]}


def at(folder: Path, name: str, turn: int, threads: int) -> Path:
    return folder / f"{list(JOBS).index(name)}_{turn}_{threads}"


def rows(folder: Path) -> list[list[str]]:
    table = [["job", "on one thread", "two threads over one: median (least and most)"]]
    for name in JOBS:
        walls = [[json.loads((at(folder, name, turn, threads) / "outcome.json").read_text())["cost"]["wall_s"]
                  for threads in (1, 2)] for turn in range(ROUNDS)]
        gains = sorted(one / two for one, two in walls)
        table.append([name, seconds(statistics.median(one for one, _ in walls)),
                      f"{statistics.median(gains):.2f} ({gains[0]:.2f} to {gains[-1]:.2f})"])
    return table


TABLES = {"threads": Table("8 min of wall time", measure, rows)}
