"""Tables of the granular scene: beside Yade and LAMMPS, on two threads, by feature."""

import csv
import json
import math
import os
import random
import statistics
import subprocess
from pathlib import Path

from measuring import BINARY, ROOT, commit_of_executable, commit_of_tree, run
from words import Digits, Table, digits


def script(name: str, *arguments) -> None:
    environment = {**os.environ, "LOADFRAME_BIN": BINARY}
    subprocess.run([ROOT / "tests" / "granular" / name, *map(str, arguments)], cwd=ROOT, check=True, env=environment)


def bench(name: str, **settings) -> list[dict]:
    """The JSON lines that a bench of the physics prints."""
    environment = {**os.environ, **{key: str(value) for key, value in settings.items()}}
    command = ["cargo", "bench", "-p", "loadframe-physics", "--bench", name]
    output = subprocess.run(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True, check=True).stdout
    return [json.loads(line) for line in output.splitlines() if line.startswith("{")]


# ── beside Yade in the mean ─────────────────────────────────────────────────────────────────────────

SEEDS = 10
QUANTITIES = {
    "mean height [mm]": ("mean height", "mm"),
    "contacts per sphere": ("contacts per sphere", ""),
    "mean way from the axis [mm]": ("mean way from the axis", "mm"),
    "way of nine tenths [mm]": ("way of nine tenths of the spheres", "mm"),
}


def measure_statistics(folder: Path) -> dict:
    script("statistics_beside_yade", "--seeds", SEEDS, "--scene", "column", "--loadframe", BINARY, "--json", folder.resolve() / "column.json")
    return {"commit": commit_of_executable()}


def yade_statistics(folder: Path) -> list[list[str]]:
    found = json.loads((folder / "column.json").read_text())["column"]
    rows = [[f"column of 432 spheres, {SEEDS} realisations", "loadframe", "Yade", "difference", "its standard error"]]
    for quantity, values in found.items():
        words, unit = QUANTITIES[quantity]
        unit = f" {unit}" if unit else ""
        programs = [values["loadframe"], values["yade"]]
        means = [statistics.mean(one) for one in programs]
        error = math.sqrt(sum(statistics.variance(one) / len(one) for one in programs))
        shown = [Digits(mean, statistics.stdev(one)) for mean, one in zip(means, programs)]
        cells = [f"{digit.show(mean)} ± {digit.show(statistics.stdev(one))}{unit}" for digit, mean, one in zip(shown, means, programs)]
        # to the second digit of the standard error
        last = Digits(error, error)
        difference = f"{means[0] - means[1]:+.{last.decimals}f}".replace("-", "−")
        rows.append([words, *cells, f"{difference}{unit}", f"{last.show(error)}{unit}"])
    return rows


# ── one bed in Yade and here ────────────────────────────────────────────────────────────────────────

# Beds of each; ten cycles take Yade a quarter of an hour.
BEDS_LOADED = {"cycles": 1, "stiff": 2, "railbed": 2}
LOADS = {
    "cycles-poured": "box, 28 MPa, ten times 3 kN, as poured", "cycles-shaken": "the same, shaken",
    "stiff-poured": "box, 280 GPa, 3 to 40 kN in 30 ms, as poured", "stiff-shaken": "the same, shaken",
    "railbed-poured": "rail bed, 2.8 MPa, 2 kN, as poured", "railbed-shaken": "the same, shaken",
}


def measure_loads(folder: Path) -> dict:
    for test, beds in BEDS_LOADED.items():
        cases = [case for case in LOADS if case.startswith(test)]
        script("loads_beside_yade", "--beds", beds, "--json", folder.resolve() / "loads.json", *cases)
    return {"commit": commit_of_executable()}


def loads(folder: Path) -> list[list[str]]:
    found = json.loads((folder / "loads.json").read_text())
    programs = {"yade": "Yade", "loadframe": "loadframe", "test": "the test"}
    columns = [f"{way}: {programs['yade']} [mm]" for way in ("first cycle", "last cycle", "stays")]
    rows = [["bed", *(cell for column in columns for cell in (column, "loadframe", "the test"))]]
    for case, words in LOADS.items():
        for bed in range(1, BEDS_LOADED[case.split("-")[0]] + 1):
            told = found[f"{case} {bed}"]
            cells = [f"{told[program][way]:.3g}" for way in range(3) for program in programs]
            rows.append([f"{words}, bed {bed}", *cells])
    return rows


# ── restitution ─────────────────────────────────────────────────────────────────────────────────────

PRESETS = ("draft", "standard", "reference")
ASKED = (0.05, 0.1, 0.3, 0.5, 0.7, 0.9)
# Places of the first touch in the raster of steps.
PHASES = 100
IMPACT_M_PER_S = 0.5
# Longer than the way of any preset's step.
WAY_M = 2e-5


def impact(asked: float, preset: str, phase: int) -> dict:
    """A sphere of 1 mm that flies at a plane."""
    material = {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "restitution": asked}
    height = 1e-3 + WAY_M * (1 + (phase + 0.5) / PHASES)
    spec = {
        "version": 1, "gravity_m_per_s2": [0, 0, 0], "materials": {"g": material}, "accuracy": preset,
        "bodies": [{"sphere": {"radius_m": 1e-3}, "material": "g", "position_m": [0, 0, height], "velocity_m_per_s": [0, 0, -IMPACT_M_PER_S]}],
        "planes": [{"name": "floor", "axis": "z", "position_m": 0, "facing": 1, "material": "g"}],
        "stages": [{"run": {"time_s": 4e-4}}], "record": {"every_steps": 1_000_000},
    }
    return {"kind": "granular_scene", "name": "impact", "spec": spec}


def measure_restitution(folder: Path) -> dict:
    found = {}
    for preset in PRESETS:
        for asked in ASKED:
            speeds = []
            for phase in range(PHASES):
                place = folder / f"{preset}-{asked}-{phase}"
                run(impact(asked, preset, phase), place)
                with (place / "bodies.csv").open() as table:
                    last = list(csv.DictReader(table))[-1]
                speeds.append(float(last["vz_m_per_s"]) / IMPACT_M_PER_S)
            found[f"{preset} {asked}"] = speeds
    (folder / "restitution.json").write_text(json.dumps(found))
    return {"commit": commit_of_executable()}


def restitution(folder: Path) -> list[list[str]]:
    found = json.loads((folder / "restitution.json").read_text())
    rows = [["asked", *(f"found, `{preset}`: mean (least to largest)" for preset in PRESETS)]]
    for asked in ASKED:
        cells = [found[f"{preset} {asked}"] for preset in PRESETS]
        rows.append([f"{asked}", *(f"{statistics.mean(one):.3f} ({min(one):.3f} to {max(one):.3f})" for one in cells)])
    return rows


# ── beds at rest ────────────────────────────────────────────────────────────────────────────────────

# Spheres: edge of the square box [m], timed steps.
BEDS = {2_000: (0.45, 9000), 20_000: (1.0, 3600), 100_000: (2.24, 2250)}
RADIUS_M = 0.01625
# Of the raster that spheres fall from: they do not touch there.
SPACING_M = 0.046
# In which they fall and come to rest.
SETTLE_S = 1.2


def bed(count: int, work: Path) -> Path:
    """Spheres of 16.25 mm, 0.6 to 1.4 times that, poured and at rest, as lines `x y z r`; made once."""
    path = work / "beds" / f"{count}.xyzr"
    if path.exists():
        return path
    width, _ = BEDS[count]
    chance = random.Random(1)
    across = int(width / SPACING_M)
    spheres = []
    for number in range(count):
        radius = RADIUS_M * chance.uniform(0.6, 1.4)
        cell = (number % across, number // across % across, number // across**2)
        # anywhere in its cell
        spheres.append([SPACING_M * place + chance.uniform(radius, SPACING_M - radius) for place in cell] + [radius])
    plane = lambda name, axis, at, facing: {"name": name, "axis": axis, "position_m": at, "facing": facing, "material": "stone"}
    sides = [plane(f"{axis}_{side}", axis, at, facing) for axis in "xy" for side, at, facing in (("low", 0, 1), ("high", width, -1))]
    spec = {
        "version": 1,
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "stiffness_ratio": 0.3, "friction_angle_rad": 0.5}},
        "bodies": [{"sphere": {"radius_m": r}, "material": "stone", "position_m": [x, y, z]} for x, y, z, r in spheres],
        "planes": [plane("base", "z", 0, 1), *sides],
        "laws": {"local_damping": 0.3}, "time_step_s": 2e-5,
        "stages": [{"run": {"time_s": SETTLE_S}}],
        "record": {"every_steps": 1_000_000, "bodies": list(range(count))},
    }
    folder = path.with_suffix("")
    run({"kind": "granular_scene", "name": f"bed of {count}", "spec": spec}, folder, threads=2)
    with (folder / "bodies.csv").open() as table:
        last = {int(float(row["body"])): row for row in csv.DictReader(table)}
    lines = [f"{last[body]['x_m']} {last[body]['y_m']} {last[body]['z_m']} {sphere[3]!r}\n" for body, sphere in enumerate(spheres)]
    path.write_text("".join(lines))
    return path


# ── beside LAMMPS and Yade in speed ─────────────────────────────────────────────────────────────────

PEERS = {"loadframe": "loadframe", "lammps": "LAMMPS", "yade": "Yade"}


def measure_peers(folder: Path) -> dict:
    for count, (width, steps) in BEDS.items():
        script("side_by_side", bed(count, folder.parent), width, "--steps", steps, "--json", folder.resolve() / f"{count}.json")
    return {"commit": commit_of_tree()}


def peers(folder: Path) -> list[list[str]]:
    rows = [["spheres", "steps", *PEERS.values()]]
    for count, (_, steps) in BEDS.items():
        found = json.loads((folder / f"{count}.json").read_text())["particle_steps_per_cpu_s"]
        shown = lambda rate: f"{rate / 1e6:.1f}" if rate > 1e6 else digits(rate / 1e6)
        cells = [
            f"{shown(statistics.median(found[peer]))} ({shown(min(found[peer]))} to {shown(max(found[peer]))})" if peer in found else "not installed"
            for peer in PEERS
        ]
        rows.append([f"{count:,}".replace(",", " "), steps, *cells])
    return rows


# ── two threads ─────────────────────────────────────────────────────────────────────────────────────

TURNS, SHARED_BEDS = 60, [20_000, 100_000]


def measure_threads(folder: Path) -> dict:
    for count in SHARED_BEDS:
        path = bed(count, folder.parent)
        (line,) = bench("granular", TURNS=TURNS, BED=path.resolve(), WIDTH=BEDS[count][0])
        (folder / f"{count}.json").write_text(json.dumps(line))
    return {"commit": commit_of_tree()}


def threads(folder: Path) -> list[list[str]]:
    rows = [["spheres", "two threads over one: median (middle half)", "two jobs over one"]]
    for count in SHARED_BEDS:
        gain = json.loads((folder / f"{count}.json").read_text())["times_one_thread"]
        low, median, high = gain["two_threads"]
        rows.append([f"{count:,}".replace(",", " "), f"{median:.2f} ({low:.2f} to {high:.2f})", f"{gain['two_jobs'][1]:.2f}"])
    return rows


# ── what features cost ──────────────────────────────────────────────────────────────────────────────

# Rows of the bench in the words of the guide.
FEATURES = {
    "frictionless": "no friction: two indices and a spring",
    "frictionless, restitution": "no friction, restitution: a dashpot and its force more",
    "frictionless, Hertz": "no friction, Hertz",
    "friction": "friction: spins, and the shear force",
    "friction, logarithmic": "friction, logarithmic strain: the last normal kept",
    "friction, restitution": "friction, restitution",
    "friction, shear restitution": "friction, shear restitution: a dashpot across the normal and the force of both more",
    "Hertz-Mindlin": "Hertz-Mindlin: the last normal and overlap",
    "Hertz-Mindlin, restitution": "Hertz-Mindlin, restitution",
    "bonds": "bonds: strengths, rest and state",
    "friction, a row of the curve every 100 steps": "friction, a row of the curve every 100 steps",
    "the same, with a region": "the same, with a region",
    "clumps of eight": "friction, clumps of eight in a loose bed, for each member: a clump is under five spheres",
    "equal sizes": "friction, 12 000 spheres of one size",
    "sizes 1:20": "the same around one of twenty times their radius",
    "500 in a cylinder of facets": "friction, 500 spheres in a cylinder of 48 facets",
    "5000 in a cylinder of facets": "friction, 5000 spheres in a cylinder of 48 facets",
}


def measure_features(folder: Path) -> dict:
    (folder / "bench.json").write_text(json.dumps(bench("features", SETTLE=150_000, STEPS=9000)))
    return {"commit": commit_of_tree()}


def features(folder: Path) -> list[list[str]]:
    rows = [["feature", "ns per particle step", "bytes per particle", "bytes per candidate"]]
    for row in json.loads((folder / "bench.json").read_text()):
        figures = [row["ns_per_particle_step"], row["bytes_per_particle"], row["bytes_per_candidate"]]
        rows.append([FEATURES[row["feature"]], *(f"{figure:.0f}" for figure in figures)])
    return rows


# ── what it costs that contacts are watched ─────────────────────────────────────────────────────────

WATCHED_BED, ROUNDS = 2_000, 15
# Of which instructions are counted: the difference of a long and a short run leaves out how it begins.
COUNTED = (90, 1170)


def executable(*features: str) -> str:
    """The bench, built with these features of the physics."""
    command = ["cargo", "bench", "-p", "loadframe-physics", "--bench", "granular", "--no-run", "--message-format=json"]
    if features:
        command += ["--features", ",".join(features)]
    output = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True).stdout
    messages = [json.loads(line) for line in output.splitlines() if line.startswith("{")]
    (path,) = [message["executable"] for message in messages if message.get("executable")]
    return path


def instructions(bench: str, environment: dict, folder: Path) -> float:
    """Instructions of a particle step, counted by valgrind, which knows vectors of 256 bits at most."""
    counts = []
    for steps in COUNTED:
        out = folder / "callgrind.out"
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", bench, "--bench"]
        subprocess.run(command, env={**environment, "WARM": "0", "STEPS": str(steps)}, check=True, stdout=subprocess.DEVNULL)
        (total,) = [line.split()[1] for line in out.read_text().splitlines() if line.startswith(("totals:", "summary:"))][:1]
        counts.append(int(total))
    return (counts[1] - counts[0]) / (COUNTED[1] - COUNTED[0]) / WATCHED_BED


def measure_watched(folder: Path) -> dict:
    width, steps = BEDS[WATCHED_BED]
    bed_file = str(bed(WATCHED_BED, folder.parent).resolve())
    builds = {"watched": executable(), "unwatched": executable("unwatched")}
    found = {}
    for friction in ("0.5", "0"):
        environment = {**os.environ, "BED": bed_file, "WIDTH": str(width), "FRICTION": friction, "STEPS": str(steps)}
        rates: dict[str, list[float]] = {name: [] for name in builds}
        for _ in range(ROUNDS):
            for name, build in builds.items():
                line = subprocess.run([build, "--bench"], env=environment, stdout=subprocess.PIPE, text=True, check=True).stdout
                # by the wall, of a machine that does nothing else: processor time is told in hundredths of a second
                rates[name].append(json.loads(line)["particle_steps_per_s"])
        counts = {name: instructions(build, environment, folder) for name, build in builds.items()}
        found[friction] = {"rates": rates, "instructions": counts}
    (folder / "watched.json").write_text(json.dumps(found))
    return {"commit": commit_of_tree()}


def watched(folder: Path) -> list[list[str]]:
    rows = [["bed of 2000 at rest", "time of a step: median (middle half)", "instructions of a step"]]
    share = lambda ratio: f"{100 * (ratio - 1):+.1f} %".replace("-", "−")
    for friction, words in (("0.5", "friction"), ("0", "no friction")):
        found = json.loads((folder / "watched.json").read_text())[friction]
        # time is the inverse of the rate
        ratios = [without / own for own, without in zip(found["rates"]["watched"], found["rates"]["unwatched"])]
        low, median, high = statistics.quantiles(ratios, n=4)
        counts = found["instructions"]
        rows.append([words, f"{share(median)} ({share(low)} to {share(high)})", share(counts["watched"] / counts["unwatched"])])
    return rows


TABLES = {
    "granular_restitution": Table("2 min of processor time", measure_restitution, restitution),
    "granular_yade_statistics": Table("3 min of processor time; needs yade", measure_statistics, yade_statistics),
    "granular_yade_loads": Table("1 h of processor time; needs yade, and vtk of tests/requirements.txt", measure_loads, loads),
    "granular_peers": Table("20 min of processor time, beds included; needs lammps and yade", measure_peers, peers),
    "granular_threads": Table("8 min of two cores, beds included", measure_threads, threads),
    "granular_watched": Table("15 min on a quiet machine; needs valgrind", measure_watched, watched),
    "granular_features": Table("5 min of processor time", measure_features, features),
}
