"""Tables of the tests of ballast: what knobs cost and find, presets, grains."""

import json
from pathlib import Path

from measuring import ROOT, loadframe, note_of, study
from words import Digits, Table, digits, power, seconds, signed

# ── knobs ───────────────────────────────────────────────────────────────────────────────────────────

HEADS = {
    "initial_porosity": "initial porosity", "unloading_stiffness": "unloading stiffness",
    "peak_displacement": "peak displacement", "residual_displacement": "residual displacement",
    "oedometric_modulus": "oedometric modulus",
}
KNOBS = {
    "critical_step_fraction": "time step over critical",
    "preparation_modulus_pa": "modulus while the bed is prepared",
    "inertial_number": "inertial number",
    "stiffness": "stiffness during the test",
}
# api/src/spec/ballast/accuracy.rs
PRESETS = {
    "critical_step_fraction": {"0.4": "draft, standard", "0.2": "reference"},
    "preparation_modulus_pa": {"1e8": "draft", "1e9": "standard", "1e15": "reference"},
    "inertial_number": {"2e-3": "draft", "5e-4": "standard", "1e-4": "reference"},
    "stiffness": {},
}
STANDARD = {"critical_step_fraction": 0.4, "preparation_modulus_pa": 1e9, "inertial_number": 5e-4}
DRAFT = {"critical_step_fraction": 0.4, "preparation_modulus_pa": 1e8, "inertial_number": 2e-3}


def job_of_study(name: str) -> dict:
    return json.loads((ROOT / "api" / "studies" / f"ballast_{name}.json").read_text())["job"]


def oedometer() -> dict:
    """The thesis' oedometer at full load: spheres of 10 GPa, 1500 kN."""
    body = job_of_study("oedometer_presets")
    body["spec"]["accuracy"] = {**STANDARD, "critical_step_fraction": 0.3}
    return body


def box() -> dict:
    """280 MPa, 3 to 40 kN, spheres, shaken."""
    body = job_of_study("box_presets")
    body["spec"]["accuracy"] = STANDARD
    return body


def railbed() -> dict:
    """Grains of 60 to 90 mm and 2.8 GPa under 50 kN."""
    body = json.loads((ROOT / "api" / "examples" / "ballast_railbed.json").read_text())
    body["spec"]["materials"]["aggregate"]["youngs_modulus_pa"] = 2.8e9
    body["spec"]["test"]["peak_force_n"] = 50e3
    body["spec"]["accuracy"] = DRAFT
    return body


class Accuracy:
    """Each knob by itself over some values, the finest last."""

    def __init__(self, body, beds: int, results: list[str], **values: str) -> None:
        self.body, self.beds, self.results, self.values = body, beds, results, values

    def measure(self, folder: Path) -> dict:
        spec = folder / "spec.json"
        spec.write_text(json.dumps({"name": folder.name, **self.body()}))
        varied = [argument for knob, values in self.values.items() for argument in ("--knob", f"{knob}={values}")]
        loadframe("study", "accuracy", spec, "--out", folder, "--seeds", self.beds, *varied)
        return {"commit": json.loads((folder / "accuracy.json").read_text())["engine_commit"]}

    def rows(self, folder: Path) -> list[list[str]]:
        found = json.loads((folder / "accuracy.json").read_text())
        table = [["knob", "value", "processor time of a test", *(HEADS[result] for result in self.results)]]
        for knob in found["knobs"]:
            for number, row in enumerate(knob["rows"]):
                if knob["knob"] == "stiffness" and row["is_reference"]:
                    continue
                errors = [row["errors"][result] for result in self.results]
                cells = ["" if row["is_reference"] else difference(error) for error in errors]
                name = KNOBS[knob["knob"]] if number == 0 else ""
                table.append([name, setting(knob["knob"], row["value"]), seconds(row["cpu_s"]), *cells])
        return table


def setting(knob: str, value: str) -> str:
    """A value as it is told, and the presets that have it."""
    words = power(float(value))
    if knob == "preparation_modulus_pa":
        words = "that of the test" if float(value) >= 1e15 else f"{words} Pa"
    same = [presets for one, presets in PRESETS[knob].items() if float(one) == float(value)]
    presets = ", ".join(f"`{preset}`" for preset in same[0].split(", ")) if same else ""
    return f"{words} ({presets})" if presets else words


def difference(error: dict | None) -> str:
    """Of the mean from that of the finest setting, with its standard error."""
    return "?" if error is None else signed(error["mean"], error["standard_error"])


OEDOMETER = Accuracy(
    oedometer, 5, ["initial_porosity", "unloading_stiffness", "peak_displacement", "oedometric_modulus"],
    critical_step_fraction="0.8,0.6,0.4,0.3,0.2,0.1", preparation_modulus_pa="1e7,1e8,1e9,1e15",
    inertial_number="1e-2,2e-3,1e-3,5e-4,1e-4", stiffness="0.1,1",
)
BOX = Accuracy(
    box, 5, ["initial_porosity", "unloading_stiffness", "peak_displacement", "residual_displacement"],
    critical_step_fraction="0.8,0.4,0.2,0.1", preparation_modulus_pa="1e7,1e8,1e15",
    inertial_number="1e-2,2e-3,5e-4,1e-4", stiffness="0.1,1",
)
RAILBED = Accuracy(
    railbed, 3, ["initial_porosity", "peak_displacement", "residual_displacement"],
    critical_step_fraction="0.8,0.6,0.4,0.2,0.1", preparation_modulus_pa="1e7,1e8,1e9,1e15",
    inertial_number="1e-2,2e-3,1e-3,3e-4,1e-4",
)

# ── presets ─────────────────────────────────────────────────────────────────────────────────────────


def cases(name: str, work: Path) -> list[dict]:
    return json.loads((work / "studies" / name / "parameters.json").read_text())["cases"]


def note_of_study(name: str, work: Path) -> dict:
    """When and where it was measured: perhaps for the page of the ballast."""
    return {key: value for key, value in note_of(study(name, work)).items() if key != "command"}


def scaled(result: dict, unit: str, factor: float = 1.0) -> str:
    """Mean ± deviation in a unit that is `factor` of the result's; large ones in powers of ten."""
    mean, deviation = (result[key] / factor for key in ("mean", "deviation"))
    shown = Digits(mean, deviation)
    power_of_ten = f"·{power(10.0**shown.exponent)}" if shown.exponent else ""
    numbers = [shown.show(value).split("e")[0] for value in (mean, deviation)]
    return f"{numbers[0]} ± {numbers[1]}{power_of_ten} {unit}"


class Presets:
    """What presets cost and find: a study that the page of the ballast shows too."""

    def __init__(self, name: str, results: list[str]) -> None:
        self.name, self.results = name, results

    def measure(self, folder: Path) -> dict:
        return note_of_study(self.name, folder.parent)

    def rows(self, folder: Path) -> list[list[str]]:
        rows = [["preset", "processor time", *(HEADS[result] for result in self.results)]]
        for case in cases(self.name, folder.parent):
            found = [case["results"][result] for result in self.results]
            cells = [scaled(one, "GPa", 1e9) if one["unit"] == "Pa" else scaled(one, one["unit"]) for one in found]
            rows.append([f"`{case['label']}`", seconds(case["cpu_s"]), *cells])
        return rows


# ── grains ──────────────────────────────────────────────────────────────────────────────────────────

SHAPES = {
    "spheres of 32.5 mm, E 2.8 MPa": "spheres",
    "r 8.48 mm, E 3 MPa": "clumps of 8 (members of 8.48 mm)",
    "r 7.2 mm, E 2.9 MPa": "members of 7.2 mm",
    "r 5.4 mm, E 4.5 MPa": "members of 5.4 mm",
    "r 3.6 mm, E 5.55 MPa": "members of 3.6 mm (135)",
}
DIAMETERS = {"2 D": "65 mm", "1.5 D": "49 mm", "1 D": "32.5 mm", "0.5 D": "16 mm"}
COMPARED = ["unloading_stiffness", "peak_displacement"]
BEDS = [1, 5, 10]


def measure_grains(folder: Path) -> dict:
    notes = [note_of_study(f"oedometer_{name}", folder.parent) for name in ("equal_stiffness", "diameter", "presets")]
    # the oldest speaks for all
    return min(notes, key=lambda note: note["date"])


def against_last(name: str, choice: str, labels: dict[str, str], work: Path) -> list[list[str]]:
    """A case's means against those of the last, the finest."""
    by_label = {case["label"]: case for case in cases(name, work)}
    finest = by_label[list(labels)[-1]]
    rows = []
    for number, (label, words) in enumerate(labels.items()):
        case = by_label[label]
        ratios = [case["results"][one]["mean"] / finest["results"][one]["mean"] - 1 for one in COMPARED]
        cells = ["" if case is finest else signed(ratio, None) for ratio in ratios]
        rows.append([choice if number == 0 else "", words, seconds(case["cpu_s"]), *cells])
    return rows


def grains(folder: Path) -> list[list[str]]:
    work = folder.parent
    rows = [["choice", "value", "processor time of a test", *(HEADS[one] for one in COMPARED)]]
    rows += against_last("oedometer_equal_stiffness", "shape", SHAPES, work)
    rows += against_last("oedometer_diameter", "diameter", DIAMETERS, work)
    standard = next(case for case in cases("oedometer_presets", work) if case["label"] == "standard")
    scatter = [standard["results"][one]["deviation"] / standard["results"][one]["mean"] for one in COMPARED]
    for number, beds in enumerate(BEDS):
        cells = [f"±{100 * one / beds**0.5:.0f} %" for one in scatter]
        times = "1" if beds == 1 else f"{beds} times"
        rows.append(["beds" if number == 0 else "", beds, times, *cells])
    return rows


OEDOMETER_PRESETS = Presets("oedometer_presets", ["unloading_stiffness", "peak_displacement", "residual_displacement", "oedometric_modulus"])
BOX_PRESETS = Presets("box_presets", ["unloading_stiffness", "peak_displacement", "residual_displacement"])

TABLES = {
    "ballast_oedometer_accuracy": Table("12 min of processor time", OEDOMETER.measure, OEDOMETER.rows),
    "ballast_oedometer_presets": Table("4 min of processor time", OEDOMETER_PRESETS.measure, OEDOMETER_PRESETS.rows),
    "ballast_grains": Table("12 min of processor time", measure_grains, grains),
    "ballast_box_accuracy": Table("22 min of processor time", BOX.measure, BOX.rows),
    "ballast_box_presets": Table("9 min of processor time", BOX_PRESETS.measure, BOX_PRESETS.rows),
    "ballast_railbed_accuracy": Table("17 min of processor time", RAILBED.measure, RAILBED.rows),
}
