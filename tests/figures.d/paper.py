"""Tables of the paper tensile test: straight parts, trends over seeds, levels of the model, tubes, masses in motion,
a frame solved another way."""

import copy
import csv
import json
import math
import statistics
import subprocess
import sys
from pathlib import Path

from measuring import BINARY, ROOT, commit_of_executable, example, run
from words import Table, digits, percent, seconds

SEEDS = 12
SIGNIFICANT = 0.05
COLUMNS = {"tensile_index": "_n_m_per_g", "zero_span_index_of_fibres": "_n_m_per_g", "tensile_stiffness_index": "_kn_m_per_g"}


def softwood(**changed) -> dict:
    """Small sheets that take a tenth of a second: 0.6 mm x 0.4 mm, 20 g/m²."""
    pulp = {
        "name": "softwood", "length_mm": 0.5, "length_variation": 0.3, "width_um": 28, "wall_um": 2, "coarseness_mg_per_m": 0.245,
        "youngs_modulus_gpa": 30, "poisson_ratio": 0.3, "shear_modulus_gpa": 2.5, "strength_mpa": 600, "shape_factor": 0.97,
    }
    body = {
        "kind": "paper_tensile",
        "spec": {
            "version": 1, "seed": 1, "pulp": [pulp],
            "specimen": {"sheet": {"length_mm": 0.6, "width_mm": 0.4, "grammage_g_per_m2": 20}},
            "bond": {"normal_strength_mpa": 4, "shear_strength_mpa": 4, "stiffness_n_per_m_per_um2": 250, "strength_variation": 0.3},
            "test": {"max_strain": 0.1, "repeats": SEEDS},
            "accuracy": "draft",
            "output": {"snapshot_every_steps": 0},
        },
    }
    for path, value in changed.items():
        put(body["spec"], path.split("__"), value)
    return body


def put(place, names: list[str], value) -> None:
    """Sets what `pulp__0__length_mm` names; nothing removes it."""
    *ways, last = [int(name) if name.isdigit() else name for name in names]
    for name in ways:
        place = place[name] if isinstance(name, int) else place.setdefault(name, {})
    if value is None:
        place.pop(last, None)
    else:
        place[last] = value


def repeats(folder: Path, name: str) -> list[float]:
    """A result of every seed; its column ends in its unit."""
    with (folder / "repeats.csv").open() as file:
        return [float(row[name + COLUMNS.get(name, "")]) for row in csv.DictReader(file)]


def known(values: list[float]) -> str:
    """Mean ± standard error."""
    mean, error = statistics.mean(values), standard_error(values)
    places = max(-math.floor(math.log10(error)), 0) if error > 0 else 3
    return f"{mean:.{places}f} ± {error:.{places}f}".replace("-", "−")


def standard_error(values: list[float]) -> float:
    return statistics.stdev(values) / math.sqrt(len(values))


# ── statistics ──────────────────────────────────────────────────────────────────────────────────────


def student(t: float, freedom: int) -> float:
    """Probability of a |t| at least as large, by Simpson's rule over the density."""
    norm = math.exp(math.lgamma((freedom + 1) / 2) - math.lgamma(freedom / 2)) / math.sqrt(freedom * math.pi)
    density = lambda x: norm * (1 + x * x / freedom) ** (-(freedom + 1) / 2)
    count, end = 4000, min(abs(t), 200.0)
    step = end / count
    inner = sum((4 if number % 2 else 2) * density(number * step) for number in range(1, count))
    return max(1 - 2 * step / 3 * (density(0) + inner + density(end)), 0.0)


def against(values: list[float], expected: float = 0.0) -> tuple[float, float]:
    """t and its probability, of a mean that should be something."""
    error = standard_error(values)
    if error == 0:
        return (0.0, 1.0) if statistics.mean(values) == expected else (math.inf, 0.0)
    t = (statistics.mean(values) - expected) / error
    return t, student(t, len(values) - 1)


def slopes(x: list[float], rows: list[list[float]]) -> list[float]:
    """Of every seed, by least squares; over its mean."""
    middle = statistics.mean(x)
    spread = sum((one - middle) ** 2 for one in x)
    by_seed = zip(*rows)
    return [sum((one - middle) * y for one, y in zip(x, seed)) / spread / statistics.mean(seed) for seed in by_seed]


def chance(p: float) -> str:
    return "< 0.001" if p < 1e-3 else digits(p)


# ── trends ──────────────────────────────────────────────────────────────────────────────────────────


def walls(wall: float) -> dict:
    return {"pulp__0__wall_um": wall, "pulp__0__coarseness_mg_per_m": None}


# What is varied, its values with what each sets, the result, and which way it should go.
TRENDS = {
    "length": ("fibre length", "mm", {value: {"pulp__0__length_mm": value} for value in (0.2, 0.4, 0.8, 1.6)}, "tensile_index", "up"),
    "strength": ("bond strength, fibres that do not break", "MPa", {
        value: {"bond__normal_strength_mpa": value, "bond__shear_strength_mpa": value, "pulp__0__strength_mpa": None}
        for value in (1, 2, 4)}, "tensile_index", "up"),
    "breaking": ("bond strength, fibres of 600 MPa", "MPa", {
        value: {"bond__normal_strength_mpa": value, "bond__shear_strength_mpa": value} for value in (4, 8, 16, 32, 64)},
        "tensile_index", "up"),
    "bonds": ("relative bonded area, by the flexibility", "", {
        value: {"specimen__sheet__placement": {"deposition": {"flexibility": value}}} for value in (0.05, 0.1, 0.2, 0.3)},
        "tensile_index", "up"),
    "modulus": ("fibre modulus, bonds that break first", "GPa", {
        value: {"pulp__0__youngs_modulus_gpa": value, "pulp__0__strength_mpa": None} for value in (15, 30, 60)},
        "tensile_index", "none"),
    "light": ("grammage, light", "g/m²", {value: {"specimen__sheet__grammage_g_per_m2": value} for value in (5, 10, 20)},
        "tensile_index", "up"),
    "heavy": ("grammage, heavier", "g/m²", {value: {"specimen__sheet__grammage_g_per_m2": value} for value in (20, 40, 60)},
        "tensile_index", "none"),
    "coarse": ("wall, and with it coarseness", "µm", {value: walls(value) for value in (2, 3, 4, 5)}, "tensile_index", "down"),
    "curl": ("shape factor", "", {value: {"pulp__0__shape_factor": value} for value in (0.8, 0.9, 0.95, 1.0)},
        "tensile_stiffness_index", "up"),
    "curl_stretch": ("shape factor", "", {value: {"pulp__0__shape_factor": value} for value in (0.8, 0.9, 0.95, 1.0)}, "stretch", "down"),
    "anisotropy": ("concentration of directions", "", {
        value: {"specimen__sheet__orientation": {"von_mises": {"concentration": value}}, "test__direction": "both",
                "specimen__sheet__length_mm": 0.5, "specimen__sheet__width_mm": 0.5} for value in (0, 0.5, 1, 2)},
        "anisotropy_of_tensile_index", "up"),
    "size": ("length of the sheet, 2/3 as wide", "mm", {
        value: {"specimen__sheet__length_mm": value, "specimen__sheet__width_mm": 2 / 3 * value} for value in (0.3, 0.6, 1.2)},
        "tensile_index", "down"),
}
NUMBERS = {"length": "1", "strength": "2", "breaking": "2", "bonds": "2", "modulus": "2", "light": "3", "heavy": "3", "coarse": "4",
           "curl": "5", "curl_stretch": "5", "anisotropy": "6", "size": "8"}
WORDS = {"up": "rises", "down": "falls", "none": "stays"}
UNITS = {"tensile_index": "N m/g", "tensile_stiffness_index": "kN m/g", "stretch": "%", "anisotropy_of_tensile_index": ""}
NAMES = {"tensile_index": "tensile index", "tensile_stiffness_index": "stiffness index", "stretch": "stretch",
         "anisotropy_of_tensile_index": "tensile index along over across"}
# Straight fibres of one length, flat in one plane: every crossing is a contact.
CROSSINGS = {"pulp__0__length_mm": 0.5, "pulp__0__length_variation": 0, "pulp__0__shape_factor": 1, "test__max_strain": 1e-6,
             "specimen__sheet__placement": {"random": {"thickness_um": 5.8345}}, "specimen__sheet__length_mm": 5,
             "specimen__sheet__width_mm": 5, "specimen__sheet__grammage_g_per_m2": 2}


def place_of(folder: Path, name: str, number: int) -> Path:
    """One sheet tells of stiffness and stretch."""
    return folder / f"{name.removesuffix('_stretch')}_{number}"


def measure_trends(folder: Path) -> dict:
    for name, (_, _, cases, _, _) in TRENDS.items():
        for number, changed in enumerate(cases.values()):
            outcome = run(softwood(**changed), place_of(folder, name, number))
    run(softwood(**CROSSINGS), folder / "crossings")
    run(softwood(bond={}, test__max_strain=0.2), folder / "unlimited")
    return {"commit": outcome["provenance"]["engine_commit"]}


def trends(folder: Path) -> list[list[str]]:
    rows = [["", "varied", "result", "found", "should", "slope over mean", "p", ""]]
    for name, (what, unit, cases, result, way) in TRENDS.items():
        found = [repeats(place_of(folder, name, number), result) for number in range(len(cases))]
        factor = 100 if result == "stretch" else 1
        cells = ", ".join(known([factor * value for value in values]) for values in found)
        # by step of the list, which goes by factors in all but shape factors and walls
        slope = slopes(list(range(len(cases))), found)
        t, p = against(slope)
        if way == "none":
            verdict = "yes" if p >= SIGNIFICANT else "**no**"
        else:
            goes = "up" if t > 0 else "down"
            verdict = "yes" if p < SIGNIFICANT and goes == way else "**no**"
        values = ", ".join(f"{value:g}" for value in cases)
        rows.append([
            NUMBERS[name], f"{what} {values} {unit}".strip(), f"{NAMES[result]} {factor and UNITS[result]}".strip(), cells, WORDS[way],
            f"{100 * statistics.mean(slope):+.1f} ± {100 * standard_error(slope):.1f} %".replace("-", "−"), chance(p), verdict,
        ])
        if name == "length":
            rows.append(gains(found))
        if name == "strength":
            rows.append(exponent(found, cases))
        if name == "breaking":
            rows.append(saturation(folder))
        if name == "size":
            rows.append(scatter(found, cases))
    rows.append(["7", "rate of the pull", "", "", "stays", "", "", "holds by construction: every point is an equilibrium, nothing has a velocity"])
    rows.append(crossings(folder))
    return rows


def gains(found: list[list[float]]) -> list[str]:
    """What every step multiplies by, of the means; less each time where something saturates."""
    means = [statistics.mean(values) for values in found]
    steps = [after / before for before, after in zip(means, means[1:])]
    falls = all(after < before for before, after in zip(steps, steps[1:]))
    return ["1", "the same", "times more by every doubling", ", ".join(digits(step) for step in steps), "falls", "", "", "yes" if falls else "**no**"]


def exponent(found: list[list[float]], cases) -> list[str]:
    """T ∝ bᵏ between the ends."""
    ends = list(cases)
    powers = [math.log(last / first) / math.log(ends[-1] / ends[0]) for first, last in zip(found[0], found[-1])]
    off = max(abs(power - 1) for power in powers)
    return ["2", "the same", "exponent k of T ∝ bᵏ", f"{statistics.mean(powers):.6f}", "1", "", "", "yes" if off < 1e-6 else f"off by up to {digits(off)}"]


def saturation(folder: Path) -> list[str]:
    """Bonds without limit, over 8/9 of the zero-span index."""
    index, zero = (repeats(folder / "unlimited", name) for name in ("tensile_index", "zero_span_index_of_fibres"))
    ratios = [one / (8 / 9 * other) for one, other in zip(index, zero)]
    _, p = against(ratios, 1.0)
    return ["2", "bonds without limit", "tensile index over 8/9 Z", known(ratios), "1", "", chance(p), "yes" if p >= SIGNIFICANT else "**no**"]


def scatter(found: list[list[float]], cases) -> list[str]:
    """Deviation over mean, by Levene's way: slopes of the distances from the mean."""
    relative = [[abs(value / statistics.mean(values) - 1) for value in values] for values in found]
    slope = slopes(list(range(len(cases))), relative)
    t, p = against(slope)
    shares = ", ".join(percent(statistics.stdev(values) / statistics.mean(values)) for values in found)
    verdict = "yes" if p < SIGNIFICANT and t < 0 else "**no**"
    return ["8", "the same", "scatter of the tensile index", shares, "falls", f"{100 * statistics.mean(slope):+.0f} ± {100 * standard_error(slope):.0f} %".replace("-", "−"), chance(p), verdict]


def crossings(folder: Path) -> list[str]:
    """Contacts of ribbons l by w at random: ½ n² (2 l w + 2 (l + w)²/π) for each area, with n for each area."""
    bonds = repeats(folder / "crossings", "bonds")
    pulp, sheet = (softwood(**CROSSINGS)["spec"][name] for name in ("pulp", "specimen"))
    length, width = 1e3 * pulp[0]["length_mm"], pulp[0]["width_um"]
    area = 1e6 * sheet["sheet"]["length_mm"] * sheet["sheet"]["width_mm"]
    total = sheet["sheet"]["grammage_g_per_m2"] * 1e-6 * area / (1e-3 * pulp[0]["coarseness_mg_per_m"])
    count = total / length
    expected = 0.5 * count**2 / area * (2 * length * width + 2 * (length + width) ** 2 / math.pi)
    ratios = [bond / expected for bond in bonds]
    _, p = against(ratios, 1.0)
    return ["9", f"contacts of flat straight fibres, {expected:.0f} expected of ribbons at random", "found over expected", known(ratios), "1", "", chance(p), "yes" if p >= SIGNIFICANT else "**no**"]


# ── straight parts ──────────────────────────────────────────────────────────────────────────────────

PARTS = [0.25, 0.5, 1, 2, 4, 8]
HARDWOOD = {"specimen__sheet__length_mm": 0.6, "specimen__sheet__width_mm": 0.4, "pulp__0__length_mm": 0.8, "pulp__0__width_um": 18, "pulp__0__wall_um": 3, "pulp__0__coarseness_mg_per_m": 0.21}
SHEETS = {
    "flexibility 0.2, 25 g/m²": {},
    "flexibility 0.1": {"specimen__sheet__placement": {"deposition": {"flexibility": 0.1}}},
    "flexibility 0.4": {"specimen__sheet__placement": {"deposition": {"flexibility": 0.4}}},
    "15 g/m²": {"specimen__sheet__grammage_g_per_m2": 15},
    "60 g/m²": {"specimen__sheet__grammage_g_per_m2": 60, "specimen__sheet__length_mm": 0.5, "specimen__sheet__width_mm": 0.4},
    "wall 5 µm": {"pulp__0__wall_um": 5, "pulp__0__coarseness_mg_per_m": 0.54},
    "hardwood, 18 µm wide, wall 3 µm": HARDWOOD,
}


def straight(changed: dict, widths: float) -> dict:
    base = {"pulp__0__length_mm": 1.5, "pulp__0__length_variation": 0.4, "pulp__0__shape_factor": 0.95,
            "specimen__sheet__length_mm": 0.8, "specimen__sheet__width_mm": 0.5, "specimen__sheet__grammage_g_per_m2": 25, "test__max_strain": 1e-6, "test__repeats": 5}
    return softwood(**{**base, **changed, "accuracy": {"segment_widths": widths}})


def measure_straight(folder: Path) -> dict:
    for number, changed in enumerate(SHEETS.values()):
        for place, widths in enumerate(PARTS):
            outcome = run(straight(changed, widths), folder / f"{number}_{place}")
    return {"commit": outcome["provenance"]["engine_commit"]}


def straight_parts(folder: Path) -> list[list[str]]:
    rows = [["sheet", *(f"{widths:g} widths" for widths in PARTS[1:])]]
    for number, name in enumerate(SHEETS):
        lines, *others = [repeats(folder / f"{number}_{place}", "tensile_stiffness_index") for place in range(len(PARTS))]
        shares = [[100 * (one / line - 1) for one, line in zip(values, lines)] for values in others]
        rows.append([name, *(f"+{statistics.mean(share):.1f} ± {statistics.stdev(share):.1f} %" for share in shares)])
    return rows


# ── levels ──────────────────────────────────────────────────────────────────────────────────────────


def crossed(level: str) -> dict:
    """Two fibres at ±36.87° from jaw to jaw, bonded in the middle; the test of the engine has their closed form."""
    body = softwood()
    spec = body["spec"]
    fibres = [[[0, 0, 0], [400, 300, 0]], [[0, 300, 0], [400, 0, 0]]]
    spec["specimen"] = {"explicit": {
        "length_mm": 0.4, "width_mm": 0.3, "fibres": [{"pulp": "softwood", "centre_line_um": line} for line in fibres],
        "bonds": [{"fibres": [0, 1], "at_um": [250, 250], "area_um2": 784}]}}
    spec["test"] = {"max_strain": 0.1}
    spec.pop("accuracy")
    return levelled(body, level)


def levelled(body: dict, level: str) -> dict:
    body = copy.deepcopy(body)
    body["spec"]["model"] = {"level": level}
    return body


STRAIGHT_ON = {"pulp__0__length_mm": 5, "pulp__0__length_variation": 0, "pulp__0__shape_factor": 1,
               "specimen__sheet__orientation": {"von_mises": {"concentration": 4}}}
LEVELS = {
    "two crossed fibres": crossed,
    "short fibres, 0.6 mm x 0.4 mm, 20 g/m²": lambda level: levelled(softwood(), level),
    "fibres from jaw to jaw, along the pull": lambda level: levelled(softwood(**STRAIGHT_ON), level),
    "the same, flat": lambda level: levelled(softwood(**STRAIGHT_ON, specimen__sheet__placement={"random": {"thickness_um": 40}}), level),
}


def measure_levels(folder: Path) -> dict:
    run(single_fibre(), folder / "fibre")
    for number, body in enumerate(LEVELS.values()):
        for level in ("beam", "truss", "tube"):
            outcome = run(body(level), folder / f"{number}_{level}")
    return {"commit": outcome["provenance"]["engine_commit"]}


def single_fibre() -> dict:
    body = example("paper_tensile")
    body["spec"]["specimen"] = {"single_fibre": {"load": "buckle"}}
    return body


def levels(folder: Path) -> list[list[str]]:
    rows = [["specimen", "level", "stiffness", "strength", "stretch", "energy absorption", "unknowns", "processor time", "what it says"]]
    fibre = run(single_fibre(), folder / "fibre")
    value = {name: quantity["value"] for name, quantity in fibre["summary"].items()}
    for words, name, other in [
        ("E A", "axial_modulus", "axial_modulus_given"), ("G J", "shear_modulus", "shear_modulus_given"),
        ("E I", "bending_stiffness", "bending_stiffness_of_wall"), ("buckling load", "buckling_load", "buckling_load_of_column"),
    ]:
        against_what = "of a column of the tube's own E I" if words == "buckling load" else "of the beam"
        rows.append(["one fibre", "tube", f"{words}: {value[name] / value[other]:.4f} {against_what}", "", "", "", "", seconds(fibre["cost"]["cpu_s"]), ""])
    for number, (name, body) in enumerate(LEVELS.items()):
        for level in ("beam", "tube", "truss"):
            outcome = run(body(level), folder / f"{number}_{level}")
            summary = outcome["summary"]
            cell = lambda result, factor=1: result_of(summary[result], factor)
            codes = ", ".join(f"`{warning['code']}`" for warning in outcome["warnings"] if warning["code"] != "large_turns")
            rows.append([name, level, f"{cell('tensile_stiffness_index')} kN m/g", f"{cell('tensile_index')} N m/g", f"{cell('stretch', 100)} %",
                         f"{cell('energy_absorption_index', 1000)} J/kg", f"{outcome['cost']['work']['unknowns']:,}".replace(",", " "), seconds(outcome["cost"]["cpu_s"]), codes])
            if level == "beam" and "cox_stiffness_index" in summary:
                rows.append([name, "theory", f"{cell('cox_stiffness_index')} (Cox), {cell('shear_lag_stiffness_index')} (shear lag) kN m/g",
                             f"{cell('page_tensile_index')} (Page) N m/g", "", "", "", "", ""])
    return rows


def result_of(quantity: dict, factor: float) -> str:
    """Mean ± standard error where there is one."""
    value, parts = factor * quantity["value"], quantity.get("error", {}).get("parts", [])
    error = next((factor * part["value"] for part in parts if part["source"] == "specimens"), 0)
    return f"{value:.3g} ± {error:.2g}" if error else f"{value:.4g}"


# ── tubes ───────────────────────────────────────────────────────────────────────────────────────────

# Segments of tubes [µm]: the shortest of the window, and shorter ones with springs of the robust form.
SEGMENTS = {"window": {}, "16 µm": {"segment_um": 16, "on_inadmissible": "robust"}, "12 µm": {"segment_um": 12, "on_inadmissible": "robust"}}
# Distance of the bonds of a fibre that hangs on two others [µm]; its length from edge to edge is that and 300.
APART = [15, 30, 60, 120, 240]
TUBED = {f"{grammage} g/m²": {"specimen__sheet__grammage_g_per_m2": grammage} for grammage in (10, 20, 40)}
TUBED_SEEDS = 6


def explicit(fibres: list, bonds: list) -> dict:
    """Straight fibres between jaws 400 µm apart, before anything breaks."""
    body = softwood()
    body["spec"].pop("accuracy")
    body["spec"]["test"] = {"max_strain": 1e-6}
    body["spec"]["pulp"][0]["shape_factor"] = 1
    body["spec"]["specimen"] = {"explicit": {
        "length_mm": 0.4, "width_mm": 0.4, "fibres": [{"pulp": "softwood", "centre_line_um": line} for line in fibres],
        "bonds": [{"fibres": pair, "at_um": at, "area_um2": 784} for pair, at in bonds]}}
    return body


def hung(apart: float) -> dict:
    """A fibre from either jaw, and one across both, which alone holds them together."""
    lines = [[[0, 0, 0], [300, 0, 0]], [[100, apart, 0], [400, apart, 0]], [[200, -150, 6], [200, apart + 150, 6]]]
    return explicit(lines, [([0, 2], [200, 150]), ([1, 2], [100, apart + 150])])


def lapped() -> dict:
    return explicit([[[0, 0, 0], [300, 0, 0]], [[100, 0, 6], [400, 0, 6]]], [([0, 1], [200, 100])])


FEW = {"one fibre": lambda: explicit([[[0, 0, 0], [400, 0, 0]]], []), "two, one bond along both": lapped,
       **{f"three, the middle one bent between bonds {apart} µm apart": lambda apart=apart: hung(apart) for apart in APART}}


def tubed(changed: dict) -> dict:
    return softwood(**{**changed, "test__max_strain": 1e-6, "test__repeats": TUBED_SEEDS, "accuracy": "standard"})


def as_tubes(body: dict, segment: dict) -> dict:
    body = levelled(body, "tube")
    body["spec"]["model"].update(segment)
    return body


def measure_tubes(folder: Path) -> dict:
    for number, body in enumerate([*(few() for few in FEW.values()), *(tubed(changed) for changed in TUBED.values())]):
        outcome = run(body, folder / f"{number}_beam")
        for place, segment in enumerate(SEGMENTS.values()):
            run(as_tubes(body, segment), folder / f"{number}_{place}")
    return {"commit": outcome["provenance"]["engine_commit"]}


def tubes(folder: Path) -> list[list[str]]:
    """Stiffness of tubes over that of beams on the same lines."""
    rows = [["fibres", "points of bonds for each ring", *(f"segments {name}" if name != "window" else "segments of the window" for name in SEGMENTS)]]
    for number, name in enumerate([*FEW, *(f"sheets of 0.6 mm x 0.4 mm, {name}" for name in TUBED)]):
        is_sheet = number >= len(FEW)
        read = lambda part: repeats(folder / f"{number}_{part}", "tensile_stiffness_index") if is_sheet else [
            json.loads((folder / f"{number}_{part}" / "outcome.json").read_text())["summary"]["tensile_stiffness"]["value"]]
        beams = read("beam")
        cells = []
        for place in range(len(SEGMENTS)):
            shares = [tube / beam for tube, beam in zip(read(place), beams)]
            cells.append(f"{statistics.mean(shares):.3f}" + (f" ± {statistics.stdev(shares):.3f}" if is_sheet else ""))
        outcome = json.loads((folder / f"{number}_0" / "outcome.json").read_text())
        work, bonds = outcome["cost"]["work"], outcome["summary"]["bonds"]["value"]
        sheets = TUBED_SEEDS if is_sheet else 1
        rings = work["points"] / POINTS_ON_RING / sheets
        rows.append([name, f"{2 * bonds / rings:.2f}" if bonds else "", *cells])
    return rows


POINTS_ON_RING = 6

# ── masses in motion ────────────────────────────────────────────────────────────────────────────────

# Strains a second.
RATES = [5000, 1000, 200, 50, 15]
MOVED_SEEDS = 3


def rated(rate: float | None, seed: int) -> dict:
    body = softwood(seed=seed, test__repeats=None)
    if rate is not None:
        body["spec"]["test"]["dynamics"] = {"strain_rate_per_s": rate}
    return body


def measure_rates(folder: Path) -> dict:
    for seed in range(1, MOVED_SEEDS + 1):
        for rate in [None, *RATES]:
            outcome = run(rated(rate, seed), folder / f"{seed}_{rate}")
    return {"commit": outcome["provenance"]["engine_commit"]}


def rates(folder: Path) -> list[list[str]]:
    """Results of masses in motion over those at rest, of the same sheets."""
    rows = [["strain a second", *(f"{name}, over that at rest" for name in ("stiffness", "strength", "stretch", "energy absorption")),
             "kinetic over elastic energy", "difference of the jaws", "energy unaccounted for", "steps", "processor time"]]
    outcomes = lambda rate: [run(rated(rate, seed), folder / f"{seed}_{rate}") for seed in range(1, MOVED_SEEDS + 1)]
    value = lambda outcome, name: outcome["summary"][name]["value"]
    still = outcomes(None)
    for rate in RATES:
        moved = outcomes(rate)
        cells = []
        for name in ("tensile_stiffness_index", "tensile_index", "stretch", "energy_absorption_index"):
            shares = [value(one, name) / value(other, name) for one, other in zip(moved, still)]
            cells.append(f"{statistics.mean(shares):.3f} ({min(shares):.3f} to {max(shares):.3f})")
        most = lambda check: max(one["quality"][check]["value"] for one in moved)
        rows.append([f"{rate}", *cells, digits(most("kinetic_share")), digits(most("jaw_force_imbalance")), digits(most("energy_balance_error")),
                     f"{statistics.mean(one['cost']['work']['time_steps'] for one in moved):,.0f}".replace(",", " "),
                     seconds(statistics.mean(one["cost"]["cpu_s"] for one in moved))])
    rows.append(["at rest", "1", "1", "1", "1", "0", "", "", "", seconds(statistics.mean(one["cost"]["cpu_s"] for one in still))])
    return rows


# ── beside a frame that is solved whole ─────────────────────────────────────────────────────────────


def measure_frames(folder: Path) -> dict:
    command = [sys.executable, ROOT / "tests/paper/beside_frames", "--loadframe", BINARY, "--json", folder / "frames.json"]
    subprocess.run(command, check=True, stdout=sys.stderr)
    return {"commit": commit_of_executable()}


def frames(folder: Path) -> list[list[str]]:
    rows = [["centre lines apart", "sheets", "bonds", "force over that of the same frame, off by at most", "over that with moments carried"]]
    found = json.loads((folder / "frames.json").read_text())
    for apart in sorted({one["apart_um"] for one in found}):
        here = [one for one in found if one["apart_um"] == apart]
        carried = [one["over_carried"] for one in here]
        off = max(abs(one["over_frame"] - 1) for one in here)
        rows.append([f"{apart:g} µm", str(len(here)), str(sum(one["bonds"] for one in here)), f"{off:.0e}",
                     f"{statistics.mean(carried):.4f} ({min(carried):.4f} to {max(carried):.4f})"])
    return rows


TABLES = {
    "paper_rates": Table("2 min of processor time", measure_rates, rates),
    "paper_straight_parts": Table("2 min of processor time", measure_straight, straight_parts),
    "paper_trends": Table("2 min of processor time", measure_trends, trends),
    "paper_levels": Table("10 s of processor time", measure_levels, levels),
    "paper_tubes": Table("1 min of processor time", measure_tubes, tubes),
    "paper_frames": Table("5 s of processor time; needs numpy", measure_frames, frames),
}
