"""Runs every example, and reads its snapshots with the real VTK to hold them against the spec and the
tables: counts, names, the bond law, the jaw forces, and which bonds are broken; of scenes, where the
spheres are, and that contacts carry what the tables say. The first example of a kind, which users start
from, ends without a warning and with every check of its quality passed. No example gives a result that its
kind's schema does not name."""

import csv
import json
import os
import re
import subprocess
import sys
import tempfile
from fnmatch import fnmatch
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pyvista
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

# Examples that take longer are for their readers to run: on a core of such a speed, however slow this machine may be
# just now, with all that runs beside.
LONGEST_S = 20.0
BOND_EVALUATIONS_PER_S = 2e8
EXAMPLES = Path(__file__).parent.parent / "api" / "examples"

# Everything is written in double precision, so that only rounding is left: coordinates of a few
# 1000 mm are exact to 1e-12 mm, a bond of 1 mm or more therefore to 1e-12 of its length, and a jaw
# sums some hundred bonds.
ROUNDING = 1e-10

BOND_ARRAYS = {"strain", "force_n", "force_over_strength", "broken"}
POINT_ARRAYS = {"displacement_mm", "jaw"}
BOTTOM, TOP = 1, 2
WALL_ARRAYS = {"wall", "force_n", "velocity_m_per_s"}


def table(path: Path) -> list[dict[str, float]]:
    if not path.exists():
        return []
    with path.open(newline="") as lines:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines)]


def expected_counts(fabric: dict) -> tuple[int, int]:
    """Nodes and bonds, counted from the description of the lattice ([Zilka2022] table 2)."""
    if "network" in fabric:
        return len(fabric["network"]["nodes_mm"]), len(fabric["network"]["bonds"])
    lattice = fabric["lattice"]
    columns, rows, layers = (lattice.get(name, 1) for name in ("points_per_row", "rows", "layers"))
    assert lattice.get("jaws", "half_bond") == "half_bond", "count the other jaws here too"
    even, odd = rows - rows // 2, rows // 2
    points = even * columns + odd * (columns + 1)
    along_rows = even * (columns - 1) + odd * columns
    # each point of an even row has two diagonals to the row above and two to the row below
    diagonals = (even - 1) * 4 * columns
    # beyond each end row: 2 n_x jaw points, in which the cut diagonals of all layers end
    nodes = points * layers + 2 * 2 * columns
    bonds = (along_rows + diagonals) * layers + points * (layers - 1) + 2 * 2 * columns * layers
    return nodes, bonds


def check(condition, message: str) -> None:
    if not np.all(condition):
        raise AssertionError(message)


def law(bond: dict, strain: np.ndarray) -> np.ndarray:
    """Bond force of the spec's law ([Zilka2022] equations 1 and 2)."""
    modulus = bond["modulus_n"]
    friction = bond.get("friction_modulus_n", 0.0)
    compression = bond.get("compression_stiffness_n", 0.0)
    return np.where(strain > 0, modulus * strain + friction * strain**2, compression * strain)


def check_snapshot(mesh, strain: float, spec: dict, rows, events, nodes: int, bonds: int) -> None:
    check(mesh.n_points == nodes, f"{mesh.n_points} points instead of {nodes}")
    check(mesh.n_lines == bonds == mesh.n_cells, f"{mesh.n_lines} lines instead of {bonds}")
    check(set(mesh.cell_data.keys()) == BOND_ARRAYS, f"bond arrays {mesh.cell_data.keys()}")
    check(set(mesh.point_data.keys()) == POINT_ARRAYS, f"point arrays {mesh.point_data.keys()}")
    ends = mesh.lines.reshape(-1, 3)[:, 1:]
    points = mesh.points.astype(float)
    jaw = mesh.point_data["jaw"]
    force, bond_strain, broken = (mesh.cell_data[name] for name in ("force_n", "strain", "broken"))
    # of the two points of a fall the later one
    row = min(reversed(rows), key=lambda row: abs(row["nominal_strain"] - strain))
    check(row["nominal_strain"] == strain, f"the curve has no point at strain {strain}")

    # the force on each jaw is the sum of its bonds' forces along y
    vector = points[ends[:, 1]] - points[ends[:, 0]]
    length = np.linalg.norm(vector, axis=1)
    pull = force * vector[:, 1] / length
    for side, column in ((TOP, "force_n"), (BOTTOM, "force_bottom_jaw_n")):
        first, second = jaw[ends[:, 0]] == side, jaw[ends[:, 1]] == side
        sign = 1.0 if side == TOP else -1.0
        total = sign * (pull[second & ~first].sum() - pull[first & ~second].sum())
        allowed = ROUNDING * np.abs(force[first ^ second]).sum()
        check(abs(total - row[column]) <= allowed, f"{column}: {total} in the snapshot, {row[column]} in the curve at {strain}")

    # the broken ones are those of the events so far
    so_far = {int(event["bond"]) for event in events if event["nominal_strain"] <= strain}
    check(set(np.flatnonzero(broken)) == so_far, f"broken bonds at {strain} are not those of events.csv")
    check(broken.sum() == row["broken_bonds"], f"{broken.sum()} broken, the curve says {row['broken_bonds']}")
    check((force == 0) | (broken == 0), "a broken bond carries force")
    ratio = mesh.cell_data["force_over_strength"]
    check(ratio <= 1, f"an intact bond is over its strength: {ratio.max()}")

    # strain is length over rest length, the generated fabric starting without stress; force
    # follows from strain by the law
    start = points - mesh.point_data["displacement_mm"]
    loaded = force != 0
    if "lattice" in spec["fabric"]:
        rest = np.linalg.norm(start[ends[:, 1]] - start[ends[:, 0]], axis=1)
        check(np.abs(bond_strain - (length / rest - 1))[loaded] <= ROUNDING * (1 + np.abs(bond_strain))[loaded], f"strains at {strain}")
        expected = law(spec["bond"], bond_strain)
        check(np.abs(force - expected)[loaded] <= ROUNDING * np.abs(expected)[loaded], f"forces against the bond law at {strain}")
    check(mesh.point_data["displacement_mm"][jaw == BOTTOM] == 0, "the bottom jaw moves")
    moved = mesh.point_data["displacement_mm"][jaw == TOP]
    check(np.ptp(moved, axis=0) == 0, "the top jaw does not move as one")


def read(file: Path):
    """What VTK's own reader sees in a file."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(file))
    reader.Update()
    check(reader.GetErrorCode() == 0, f"VTK's error {reader.GetErrorCode()} in {file.name}")
    return reader.GetOutput()


def check_tensile(folder: Path, spec: dict, counts: tuple[int, int] | None) -> str:
    """One direction's snapshots; without counts, as many nodes and bonds as the first has."""
    rows, events = table(folder / "curve.csv"), table(folder / "events.csv")
    series = pyvista.get_reader(folder / "snapshots.pvd")
    strains = series.time_values
    check(len(strains) > 1, f"a series of {len(strains)}")
    files = sorted(folder.glob("snapshots/step_*.vtp"))
    check(len(files) == len(strains), f"{len(files)} files, {len(strains)} in the series")
    for strain, file in zip(strains, files, strict=True):
        series.set_active_time_value(strain)
        mesh = series.read()[0]
        counts = counts or (mesh.n_points, mesh.n_cells)
        check_snapshot(mesh, strain, spec, rows, events, *counts)
        check(read(file).GetNumberOfLines() == counts[1], file.name)
    return f"{len(strains)} snapshots of {counts[0]} nodes and {counts[1]} bonds, {len(events)} broken"


def check_loops(folder: Path) -> str:
    """Pictures of a test that goes up and down, at strains that come again: what is broken stays so."""
    files = sorted(folder.glob("snapshots/step_*.vtp"))
    check(len(files) > 1, f"a series of {len(files)}")
    meshes = [pyvista.wrap(read(file)) for file in files]
    broken = np.array([mesh.cell_data["broken"] for mesh in meshes])
    check(np.diff(broken.astype(int), axis=0) >= 0, "a broken bond is whole again")
    last = json.loads((folder / "outcome.json").read_text())["summary"]["broken_bonds"]["value"]
    check(broken[-1].sum() <= last, f"{broken[-1].sum()} broken in the last picture, {last} in all")
    return f"{len(files)} snapshots, {broken[-1].sum()} broken in the last"


def check_ballast(folder: Path) -> str:
    """A test of ballast tells its scene, and how that ended."""
    spec = json.loads((folder / "scene.json").read_text())["spec"]
    summary = json.loads((folder / "outcome.json").read_text())["summary"]
    last = {"step": summary["steps"]["value"], "contacts": summary["contacts"]["value"]}
    return check_scene(folder, spec, [last])


def check_scene(folder: Path, spec: dict, rows: list[dict]) -> str:
    bodies, contacts = (table(folder / f"{name}.csv") for name in ("bodies", "contacts"))
    radii, spheres = [], {}
    # bodies that are made, filled or taken out are not in the spec
    stages = {name for stage in spec["stages"] for name in stage}
    is_whole = not (spec.get("generate") or spec.get("import") or stages & {"insert", "cut"})
    body = 0
    for given in spec.get("bodies", []):
        if "sphere" in given:
            spheres[body] = len(radii)
            radii.append(given["sphere"]["radius_m"])
            body += 1
        else:
            shape = given.get("clump") or given["breakable"]
            is_whole = is_whole and "members" in shape
            radii += [member["radius_m"] for member in shape.get("members", [])]
            # what may break is as many bodies as it has members
            body += 1 if "clump" in given else len(shape.get("members", []))
    times = list(pyvista.get_reader(folder / "snapshots.pvd").time_values)
    check(len(times) > 1, f"a series of {len(times)}")
    check(list(pyvista.get_reader(folder / "contacts.pvd").time_values) == times, "contacts at other times")
    files = sorted(folder.glob("snapshots/step_*.vtp"))
    check(len(files) == len(times), f"{len(files)} files, {len(times)} in the series")
    triangles = sum(len(mesh["triangles_m"]) for mesh in spec.get("facets", []) if "triangles_m" in mesh)
    planes = len(spec.get("planes", []))
    compared = 0
    for file in files:
        step = int(file.stem.removeprefix("step_"))
        if planes + triangles:
            walls = pyvista.wrap(read(folder / f"snapshots/walls_{step:09}.vtp"))
            check(walls.n_cells == planes + triangles, f"{walls.n_cells} walls at step {step}")
            check(set(walls.cell_data.keys()) == WALL_ARRAYS, f"wall arrays {walls.cell_data.keys()}")
            check(np.isfinite(walls.points), f"walls at step {step}")
        points = pyvista.wrap(read(file))
        check(points.n_points == points.n_cells, f"{points.n_points} particles at step {step}")
        check(points.point_data["radius_m"] > 0, f"radii at step {step}")
        if is_whole:
            check(points.n_points == len(radii), f"{points.n_points} particles at step {step}")
            check(points.point_data["radius_m"] == radii, f"radii at step {step}")
        for row in (row for row in bodies if is_whole and row["step"] == step and row["body"] in spheres):
            place = spheres[row["body"]]
            for names, values in (
                (("x_m", "y_m", "z_m"), points.points[place]),
                (("vx_m_per_s", "vy_m_per_s", "vz_m_per_s"), points.point_data["velocity_m_per_s"][place]),
            ):
                check(values == [row[name] for name in names], f"sphere {row['body']} at step {step}")
        lines = pyvista.wrap(read(folder / f"snapshots/contacts_{step:09}.vtp"))
        listed = [row for row in contacts if row["step"] == step]
        # where bodies were taken out after a step, its last row is that of the snapshot
        for row in [row for row in rows if row["step"] == step][-1:]:
            compared += 1
            check(lines.n_lines == row["contacts"], f"{lines.n_lines} contacts at step {step}")
        if listed:
            check(len(listed) == lines.n_lines, f"{len(listed)} rows of contacts at step {step}")
            total = sum(np.linalg.norm([row[f"fn_{axis}_n"] for axis in "xyz"]) for row in listed)
            drawn = lines.cell_data["normal_force_n"].sum()
            check(abs(total - drawn) <= ROUNDING * total, f"normal forces at step {step}: {drawn}, {total} in the table")
    check(compared >= min(2, len(rows)), "hardly a snapshot has a row in the curve")
    return f"{len(times)} snapshots, {points.n_points} spheres in the last, {compared} held against the tables"


def check_section(folder: Path, spec: dict) -> str:
    """The deformed section: its cells fill the section, and its points moved as the tables say."""
    summary = json.loads((folder / "outcome.json").read_text())["summary"]
    cells, factor = int(summary["cells"]["value"]), summary["deformation_factor"]["value"]
    series = pyvista.get_reader(folder / "snapshots.pvd")
    series.set_active_time_value(series.time_values[-1])
    mesh = series.read()[0]
    check(mesh.n_cells == cells, f"{mesh.n_cells} cells instead of {cells}")
    breaks = "breaking" in spec["test"]
    last = "end.vtp" if breaks else "section.vtp"
    check(read(folder / "snapshots" / last).GetNumberOfPolys() == cells, "polygons of VTK's own reader")
    displacement = mesh.point_data["displacement_mm"]
    start = mesh.points.astype(float) - factor * displacement
    sides = np.array([spec["section"]["length_mm"], spec["section"]["height_mm"]])
    check(np.abs(np.ptp(start, axis=0)[:2] - sides) <= 1e-6 * sides, "the undeformed section has other sides")
    corners = start.reshape(cells, 4, 3)
    area = np.prod(np.ptp(corners, axis=1)[:, :2], axis=1)
    check(abs(area.sum() / sides.prod() - 1) < 1e-6, "the cells do not fill the section")
    # the top face's points are those of its table
    for row in table(folder / "faces" / "top.csv"):
        near = np.hypot(start[:, 0] - row["along_mm"], start[:, 1] - sides[1]) < 1e-6 * sides.max()
        check(near.any(), f"no point at {row['along_mm']} of the top face")
        check(np.abs(displacement[near][:, 1] - row["uy_mm"]) <= 1e-12 + 1e-9 * np.abs(row["uy_mm"]), "uy at the top")
    share = mesh.cell_data["fibre_share"]
    check((share >= 0) & (share <= 1), "shares of fibre")
    if breaks:
        damage = mesh.cell_data["damage"]
        check((damage >= 0) & (damage <= 1), "damage")
        check((damage > 0.999).sum() >= int(summary["broken_cells"]["value"]) > 0, "broken cells")
        cracks = pyvista.wrap(read(folder / "snapshots" / "cracks.vtp"))
        with (folder / "cracks.csv").open() as rows:
            areas = [float(row["crack_area_mm2"]) for row in csv.DictReader(rows)]
        opened = sum(area > 0 for area in areas)
        check(cracks.n_lines == opened, f"{cracks.n_lines} cracks, {opened} in the table")
        check(len(series.time_values) == 2, "pictures of the peak and of the end")
        return f"{cells} cells, {cracks.n_lines} cracks"
    bonds = pyvista.read(folder / "snapshots" / "bonds.vtp")
    check(np.isfinite(bonds.cell_data["force_n"]), "bond forces")
    check(bonds.n_points == int(summary["particles"]["value"]), "particles of the bonds")
    return f"{cells} cells, {bonds.n_lines} bonds"


def check_cell(folder: Path) -> str:
    """The unit cell: its grid fills it, its fibres have their share, its mean stress is the one applied."""
    cell = pyvista.wrap(read(folder / "snapshots" / "cell.vtp"))
    sides = np.ptp(cell.points.astype(float), axis=0)[:2]
    corners = cell.points.astype(float).reshape(cell.n_cells, 4, 3)
    area = np.prod(np.ptp(corners, axis=1)[:, :2], axis=1)
    check(abs(area.sum() / sides.prod() - 1) < 1e-5, "the grid does not fill the cell")
    share = np.average(cell.cell_data["fibre_share"], weights=area)
    told = json.loads((folder / "outcome.json").read_text())["summary"]["fibre_fraction"]["value"]
    check(abs(share / told - 1) < 1e-4, f"a share of fibre of {share}, {told} told")
    for name, applied in (("22", 1), ("11", 0), ("33", 0), ("23", 0), ("13", 0), ("12", 0)):
        mean = np.average(cell.cell_data[f"stress_{name}_mpa"], weights=area)
        check(abs(mean - applied) < 1e-4, f"a mean stress {name} of {mean} MPa")
    return f"{cell.n_cells} cells"


def check_tube(folder: Path) -> str:
    """A fibre as a tube of springs: whole rings, springs of every sort, finite forces."""
    series = pyvista.get_reader(folder / "snapshots.pvd")
    series.set_active_time_value(series.time_values[-1])
    mesh = series.read()[0]
    check(np.isfinite(mesh.points), "points of the tube")
    check(np.isfinite(mesh.cell_data["force_n"]), "spring forces")
    check(mesh.cell_data["stiffness_mn_per_um"] > 0, "springs of no or negative stiffness")
    check(mesh.point_data["mass_ug"] > 0, "masses")
    return f"{mesh.n_points} points, {mesh.n_lines} springs"


def check_sheet(folder: Path) -> str:
    """A sheet of paper from start to end: the same lines in every picture, as many broken as its results say."""
    summary = json.loads((folder / "outcome.json").read_text())["summary"]
    series = pyvista.get_reader(folder / "snapshots.pvd")
    check(len(series.time_values) >= 2, f"a series of {len(series.time_values)}")
    lines = set()
    for time in series.time_values:
        series.set_active_time_value(time)
        mesh = series.read()[0]
        lines.add(mesh.n_lines)
        check(np.isfinite(mesh.points), "points of the sheet")
        check(np.isfinite(mesh.cell_data["force_n"]), "forces")
    check(len(lines) == 1, f"pictures of {lines} lines")
    is_bond, broken = (mesh.cell_data[name].astype(bool) for name in ("is_bond", "broken"))
    told = summary["broken_bonds"]
    if "n" not in told:
        count = (is_bond & broken).sum()
        check(count == told["value"], f"{count} broken bonds drawn, {told['value']} told")
    return f"{(~is_bond).sum()} parts of fibres, {is_bond.sum()} bonds, {broken.sum()} broken"


def check_fabric(folder: Path, spec: dict) -> str:
    """A nonwoven: of both directions, or of loops."""
    if spec["test"].get("history"):
        return check_loops(folder)
    found = [check_tensile(folder, spec, expected_counts(spec["fabric"]))]
    if "x" in spec["test"].get("directions", []):
        found.append(check_tensile(folder / "along_x", spec, None))
    return "; ".join(found)


def check_pictures(folder: Path) -> str:
    """Pictures of any kind: VTK reads them, their numbers are finite, and series list files that there are."""
    pictures = sorted(folder.rglob("*.vtp"))
    points = 0
    for file in pictures:
        mesh = pyvista.wrap(read(file))
        points += mesh.n_points
        numbers = {"points": mesh.points, **mesh.point_data, **mesh.cell_data}
        for name, values in numbers.items():
            check(np.isfinite(values), f"{name} in {file.name}")
    # a single one may well be: grains that do not touch yet have no contacts
    check(points > 0, "all pictures are empty")
    for series in folder.rglob("*.pvd"):
        listed = [element.attrib for element in ElementTree.parse(series).getroot().iter("DataSet")]
        check(len(listed) > 0, f"{series.name} lists nothing")
        for entry in listed:
            check((series.parent / entry["file"]).exists(), f"{series.name} lists {entry['file']}")
            check(np.isfinite(float(entry["timestep"])), f"a moment of {series.name}")
    return f"{len(pictures)} pictures"


def check_unwarned(folder: Path) -> None:
    outcome = json.loads((folder / "outcome.json").read_text())
    doubtful = {name: told["value"] for name, told in outcome["quality"].items() if not told["ok"]}
    check(not doubtful, f"doubtful: {doubtful}")
    warnings = [warning["detail"] for warning in outcome["warnings"]]
    check(not warnings, f"warnings: {warnings}")


def check_results(binary: str, kind: str, folder: Path) -> None:
    """What the job gives is what the kind's schema says that its jobs may give."""
    schema = subprocess.run([binary, "schema", kind], check=True, stdout=subprocess.PIPE)
    known = [(entry["name"], entry["unit"]) for entry in json.loads(schema.stdout)["x-results"]]
    for name, result in json.loads((folder / "outcome.json").read_text())["summary"].items():
        own = re.sub("_along_(x|y|md|cd)$", "", name)
        fits = [unit for pattern, unit in known if fnmatch(name, pattern) or fnmatch(own, pattern)]
        check(result["unit"] in fits, f"{name} in {result['unit']} is not among the results of {kind}")


def check_example(binary: str, example: Path) -> str:
    job = json.loads(example.read_text())
    spec = job["spec"]
    # an example by its kind's name is the kind's first
    is_first = example.stem == job["kind"]
    validated = subprocess.run([binary, "validate", "--json", example], check=True, stdout=subprocess.PIPE)
    told = json.loads(validated.stdout)
    here = told["calibration"]["bond_evaluations_per_s"]
    seconds = told["estimate"]["wall_s"] * min(1, here / BOND_EVALUATIONS_PER_S)
    check(not is_first or seconds <= LONGEST_S, f"the first example of a kind takes {seconds:.0f} s")
    if seconds > LONGEST_S:
        return f"not run, it would take {seconds:.0f} s"
    if job["kind"] == "calibrate" and not is_first:
        return "not run, a calibration has no snapshots"
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / "result"
        subprocess.run([binary, "run", example, "--out", folder], check=True, stdout=subprocess.DEVNULL)
        if is_first:
            check_unwarned(folder)
        if job["kind"] == "calibrate":
            return "no warning"
        check_results(binary, job["kind"], folder)
        if not list(folder.rglob("*.vtp")):
            wanted = spec.get("record", {}) | spec.get("output", {})
            default = 1 if job["kind"] == "nonwoven_tensile" else 0
            check(wanted.get("snapshot_every_steps", default) == 0, "snapshots are missing")
            return "no snapshots asked for"
        found = check_pictures(folder)
        # what a kind's pictures must agree with beyond that; of other kinds they are pictures and nothing more
        match job["kind"]:
            case "nonwoven_tensile":
                return check_fabric(folder, spec)
            case "composite_bending":
                return check_section(folder, spec)
            case "composite_cell":
                return check_cell(folder)
            case "paper_tensile":
                return check_tube(folder) if "single_fibre" in spec["specimen"] else check_sheet(folder)
            case "granular_scene":
                return check_scene(folder, spec, table(folder / "curve.csv"))
            case "ballast_oedometer" | "ballast_box" | "ballast_railbed":
                return check_ballast(folder)
            case _:
                return found


def main() -> int:
    binary = os.environ.get("LOADFRAME_BIN", "target/release/loadframe")
    failed = 0
    for example in sorted(EXAMPLES.glob("*.json")):
        try:
            print(f"{example.stem}: {check_example(binary, example)}")
        except AssertionError as error:
            failed += 1
            print(f"{example.stem}: FAILED: {error}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
