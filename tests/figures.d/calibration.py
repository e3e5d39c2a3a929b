"""The table of the calibration: the PET experiment from two sides."""

import json
from pathlib import Path

from measuring import example, run
from words import Table, seconds

PARAMETERS = {
    "bond_mean_strength_n": "mean strength",
    "bond_friction_modulus_n": "friction modulus f_r",
    "bond_compression_stiffness_n": "compression stiffness r_c",
}
RESULTS = {"max_force": ("maximum force", 1, " N"), "strain_at_max_force": ("strain there", 3, ""), "poisson_ratio": ("Poisson ratio", 3, "")}
SIDES = {"as_it_is": "strength and r_c from above, f_r from below", "from_the_other_side": "the other way round"}


def other_side(body: dict) -> dict:
    """Starts that are as far off on the other side of the thesis' parameters."""
    bond = body["spec"]["job"]["spec"]["bond"]
    for free in body["spec"]["free"]:
        true = bond[free["parameter"].removeprefix("/bond/")]
        free["start"] = round(true**2 / free["start"], 4)
    return body


def measure(folder: Path) -> dict:
    run(example("calibrate_pet"), folder / "as_it_is", threads=2)
    outcome = run(other_side(example("calibrate_pet")), folder / "from_the_other_side", threads=2)
    return {"commit": outcome["provenance"]["engine_commit"]}


def rows(folder: Path) -> list[list[str]]:
    outcomes = [json.loads((folder / side / "outcome.json").read_text()) for side in SIDES]
    summaries = [outcome["summary"] for outcome in outcomes]
    measured = {one["result"]: one["value"] for one in example("calibrate_pet")["spec"]["measured"]["results"]}
    table = [["", "measured", *SIDES.values()]]
    for name, (words, decimals, unit) in RESULTS.items():
        found = [f"{summary[name]['value']:.{decimals}f}{unit}" for summary in summaries]
        table.append([words, f"{measured[name]:g}{unit}", *found])
    for name, words in PARAMETERS.items():
        table.append([words, "", *(fitted(summary[name]) for summary in summaries)])
    counts = [f"{summary['trials']['value']:.0f} ({summary['tests']['value']:.0f})" for summary in summaries]
    table.append(["trials (tests)", "", *counts])
    table.append(["processor time", "", *(seconds(outcome["cost"]["cpu_s"]) for outcome in outcomes)])
    return table


def fitted(quantity: dict) -> str:
    """To the second digit of its interval's half width."""
    low, high = quantity["interval"]
    decimals = 4 if high - low < 0.01 else 2
    value, low, high = (f"{number:.{decimals}f}" for number in (quantity["value"], low, high))
    return f"{value} {quantity['unit']} ({low} … {high})"


TABLES = {"calibrate_pet": Table("4 min of processor time", measure, rows)}
