"""Tables of the bent section of a composite."""

import copy
import json
import statistics
import subprocess
import sys
from importlib.machinery import SourceFileLoader
from pathlib import Path

from measuring import BINARY, ROOT, example, loadframe, run
from words import Table, digits, percent, seconds

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


# ── what exactness costs ────────────────────────────────────────────────────────────────────────────


def study(job: dict, folder: Path, *knobs: str) -> dict:
    """An accuracy study of a section: errors and times at every setting of each knob."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    spec = folder.with_suffix(".json")
    spec.write_text(json.dumps(job))
    varied = [argument for knob in knobs for argument in ("--knob", knob)]
    loadframe("study", "accuracy", spec, "--out", folder, "--seeds", 1, *varied)
    return json.loads((folder / "accuracy.json").read_text())


def without_grid(job: dict) -> dict:
    """The grid left to the preset."""
    job["spec"].pop("grid", None)
    return job


def slanted() -> dict:
    """Six thin fibres at 45°, which every grid cuts in another way."""
    job = json.loads((ROOT / "tests" / "composite" / "cases" / "slanted_45_top.json").read_text())
    return {"kind": "composite_bending", "name": job["name"], "spec": job["spec"]}


SECTIONS = {
    "fibres along x": lambda: body(0, 10), "fibres along y": lambda: body(90, 10), "fibres at 45°": slanted,
    "cross-ply on rollers": lambda: example("composite_bending_three_point"),
}
DEFLECTIONS = ["mean_top_deflection", "mean_bottom_deflection"]


def largest(errors: dict) -> str:
    """The largest error of what the section is tested for."""
    names = DEFLECTIONS if DEFLECTIONS[0] in errors else ["flexural_modulus"]
    return percent(max(abs(errors[name]["mean"]) for name in names))


def measure_presets(folder: Path) -> dict:
    found = [study(without_grid(job()), folder / f"section_{place}", "preset") for place, job in enumerate(SECTIONS.values())]
    return {"commit": found[0]["engine_commit"]}


def presets(folder: Path) -> list[list[str]]:
    rows = [["`accuracy`", *(head for name in SECTIONS for head in (name, "time"))]]
    all_found = [json.loads((folder / f"section_{place}" / "accuracy.json").read_text())["knobs"][0]["rows"] for place in range(len(SECTIONS))]
    for preset in ("draft", "standard", "reference"):
        row = [f"`{preset}`"]
        for found in all_found:
            here = next(one for one in found if one["value"] == preset)
            row += [largest(here["errors"]), seconds(here["cpu_s"])]
        rows.append(row)
    return rows


def in_motion() -> dict:
    job = body(0, 50)
    for material, density in (("filler", 1200), ("fibre", 1800)):
        job["spec"]["materials"][material]["density_kg_per_m3"] = density
    job["spec"]["test"]["history"] = {"duration_s": 2e-3}
    job["spec"]["accuracy"] = {"solver": "verlet"}
    return job


KNOBS = {
    "cells": "cells in those of 50 by 50", "lattice": "lattice", "solver": "solver", "geometry": "geometry",
    "time_step": "time step in the automatic one",
}


def measure_knobs(folder: Path) -> dict:
    found = study(body(0, 50), folder / "at_rest", "cells=0.2,0.5,1,2,4", "lattice", "solver", "geometry")
    study(in_motion(), folder / "in_motion", "time_step=1,0.5,0.25")
    return {"commit": found["engine_commit"]}


def knobs(folder: Path) -> list[list[str]]:
    rows = [["knob", "value", "mean deflection of the top", "of the bottom", "natural frequency", "processor time"]]
    for part, names in (("at_rest", [*DEFLECTIONS, None]), ("in_motion", [None, None, "natural_frequency"])):
        for knob in json.loads((folder / part / "accuracy.json").read_text())["knobs"]:
            for number, row in enumerate(knob["rows"]):
                errors = [row["errors"].get(name) if name else None for name in names]
                cells = ["against it" if name and row["is_reference"] else percent(error["mean"]) if error else "" for name, error in zip(names, errors)]
                rows.append([KNOBS[knob["knob"]] if number == 0 else "", row["value"].replace("_", " "), *cells, seconds(row["cpu_s"])])
    return rows


# ── beside finite elements ──────────────────────────────────────────────────────────────────────────

BESIDE_CCX = ROOT / "tests" / "composite" / "beside_ccx"
# Elements of CalculiX' finest mesh: its references are then known to 0.15 % and better.
MOST_ELEMENTS = 6_500


def measure_beside_ccx(folder: Path) -> dict:
    runs = folder / "runs.json"
    # it ends with an error where a section is off by more than is demanded, which the table shows
    subprocess.run([sys.executable, BESIDE_CCX, "--loadframe", BINARY, "--elements", str(MOST_ELEMENTS), "--json", runs,
                    "--out", folder / "page.md", "--peer", folder / "peer.json"], cwd=ROOT, stdout=sys.stderr, check=False)
    return {"commit": json.loads(runs.read_text())[0]["uniform"][0]["commit"]}


def beside_ccx(folder: Path) -> list[list[str]]:
    """How many times CalculiX' processor time is ours at an error of 1 and of 0.1 %, case by case."""
    peer = peer_module()
    columns = [(mesh, of, target) for target in (1.0, 0.1) for mesh in ("ccx even", "ccx") for of in ("grid", "limit")]
    rows = [["section", *(f"{'even' if mesh == 'ccx even' else 'graded'}, {target:g} %: {of}" for mesh, of, target in columns), "off at 200 cells"]]
    gains = {column: [] for column in columns}
    for found in json.loads((folder / "runs.json").read_text()):
        row = [f"`{found['case']}`"]
        for mesh, of, target in columns:
            gain = peer.compared(found, target)[1][mesh, of] if peer.is_known(found, target) else None
            if gain:
                gains[mesh, of, target].append(gain)
            row.append(digits(gain) if gain else "–")
        rows.append([*row, percent(peer.error(found, found["uniform"][-1]) / 100)])
    rows.append(["median", *(digits(statistics.median(found)) if found else "–" for found in gains.values()), ""])
    rows.append(["5 times or more", *(f"{sum(gain >= 5 for gain in found)} of {len(found)}" for found in gains.values()), ""])
    return rows


# ── fibres at an angle ──────────────────────────────────────────────────────────────────────────────

SLANTED = sorted((ROOT / "tests" / "composite" / "cases").glob("slanted_*.json"))
SLANTED_GRIDS = {
    "`draft`": {"accuracy": "draft"}, "`standard`": {"accuracy": "standard"}, "`reference`": {"accuracy": "reference"},
    **{f"{cells} by {cells}": {"grid": {"cells": [cells, cells], "equal_cells": True}} for cells in (50, 100, 200)},
}
# Elements of the finest of three nested meshes; the limit of the three is then known to 0.5 % and better.
NESTED_ELEMENTS = 6_500


def peer_module():
    sys.path.insert(0, str(BESIDE_CCX.parent))
    return SourceFileLoader("beside_ccx", str(BESIDE_CCX)).load_module()


def by_finite_elements(spec: dict) -> dict:
    """Limits of CalculiX' deflections on three nested meshes [mm], each with its own error."""
    peer = peer_module()
    meshes = [peer.fe.first_mesh(spec, coarseness) for coarseness in (8.0, 4.0, 2.0, 1.0, 0.5)]
    mesh = [mesh for mesh in meshes if 16 * len(mesh.cells) <= NESTED_ELEMENTS][-1]
    answers = []
    for _ in range(3):
        answers.append(peer.fe.solve(spec, mesh))
        mesh = mesh.refined()
    return {face: peer.limit([answer[face] for answer in answers]) for face in ("top", "bottom")}


def on_grid(case: Path, name: str, folder: Path) -> dict:
    spec = json.loads(case.read_text())["spec"]
    spec = {key: value for key, value in spec.items() if key not in ("grid", "accuracy")}
    body = {"kind": "composite_bending", "spec": spec | SLANTED_GRIDS[name] | {"output": {"picture": False}}}
    return run(body, folder / f"{case.stem}_{name.strip('`').replace(' ', '_')}")


def measure_slanted(folder: Path) -> dict:
    folder.mkdir(parents=True, exist_ok=True)
    kept = folder / "finite_elements.json"
    truth = json.loads(kept.read_text()) if kept.exists() else {}
    for case in SLANTED:
        truth.setdefault(case.stem, None)
        truth[case.stem] = truth[case.stem] or by_finite_elements(json.loads(case.read_text())["spec"])
        kept.write_text(json.dumps(truth))
    found = [on_grid(case, name, folder) for case in SLANTED for name in SLANTED_GRIDS]
    return {"commit": found[0]["provenance"]["engine_commit"]}


def slanted_errors(folder: Path) -> list[list[str]]:
    """The larger error of both mean deflections, and the larger error over what was said of it."""
    truth = json.loads((folder / "finite_elements.json").read_text())
    rows = [["section", *(head for name in SLANTED_GRIDS for head in (name, "over said"))]]
    columns = {name: ([], []) for name in SLANTED_GRIDS}
    for case in SLANTED:
        row = [f"`{case.stem}`"]
        for name, (all_off, all_over) in columns.items():
            summary = on_grid(case, name, folder)["summary"]
            pairs = [(summary[f"mean_{face}_deflection"], truth[case.stem][face][0]) for face in ("top", "bottom")]
            off = max(abs(found["value"] / right - 1) for found, right in pairs)
            over = max(abs(found["value"] - right) / found["error"]["value"] for found, right in pairs)
            all_off.append(off)
            all_over.append(over)
            row += [percent(off), digits(over)]
        rows.append(row)
    for name, of in (("mean", statistics.mean), ("largest", max)):
        rows.append([name, *(cell for all_off, all_over in columns.values() for cell in (percent(of(all_off)), digits(of(all_over))))])
    return rows


TABLES = {
    "composite_slanted": Table("15 min of processor time; needs Debian's calculix-ccx", measure_slanted, slanted_errors),
    "composite_beside_ccx": Table("20 min of processor time; needs Debian's calculix-ccx", measure_beside_ccx, beside_ccx),
    "composite_presets": Table("2 min of processor time", measure_presets, presets),
    "composite_knobs": Table("2 min of processor time", measure_knobs, knobs),
    "composite_convergence": Table("1 min of processor time", measure_convergence, convergence),
    "composite_paper": Table("1 min of processor time", measure_paper, paper),
}
