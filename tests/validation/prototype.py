#!/usr/bin/env python3
"""The nonwoven tensile test by a second program, which shares nothing with the engine.

  tests/validation/prototype.py                       means and deviations over seeds, each jaw form
  tests/validation/prototype.py --out FILE            keeps every test as JSON and goes on with what is there;
                                                      tests/validation/prototype.json is made so: delete it first
  tests/validation/prototype.py --specimens FILE      small specimens, bond by bond, and what is found of them:
                                                      tests/validation/specimens.json

Its own lattice, random streams, assembly and solver, so that engine and prototype can be wrong together
only in the model itself (equations of [Zilka2022], parameters of its tables 5 and 6):

  bond strain  u = (l - l0)/l0                    stress-free after the nodes were moved
  tension      T = e u + f_r u^2   for u > 0      energy l0 (e u^2/2 + f_r u^3/3)
  compression  T = r_c u           for u < 0      energy l0 r_c u^2/2
  strength     s exp(sigma N(0, 1)), drawn again while the factor exceeds 2; only tension breaks

After each strain step the network is brought to equilibrium, every bond above its strength breaks, and so on
until none does; then the jaw force is noted. Equilibrium is the least energy: Newton's method on sparse
matrices, inner conjugate gradients, until every resultant is below 1e-4 of the usual force limit
(e eps + f_r eps^2)/100. A test ends when the jaw force has fallen below 0.9 of its maximum: what is told of
it lies before, maximum force, strain there, and at 10 % strain secant stiffness and Poisson ratio.

Needs numpy and scipy (tests/requirements.txt). A specimen takes some two minutes until it parts and seconds
to 10 % strain; tests run side by side (--jobs).
"""

import argparse
import json
import os

# one thread each: tests run side by side instead
os.environ.setdefault("OMP_NUM_THREADS", "1")
import math  # noqa: E402
import platform  # noqa: E402
import statistics  # noqa: E402
import sys  # noqa: E402
import time  # noqa: E402
from concurrent.futures import ProcessPoolExecutor, as_completed  # noqa: E402
from pathlib import Path  # noqa: E402

import numpy as np  # noqa: E402
import scipy  # noqa: E402
from scipy.linalg import cho_solve_banded, cholesky_banded  # noqa: E402
from scipy.sparse import bsr_array, coo_array  # noqa: E402
from scipy.stats import t as student  # noqa: E402

# [Zilka2022] tables 5 and 6; lengths in mm, forces in N
PET = (49, 51, 3)
SPACING = np.array([20.0, 20.0, 10.0])
IRREGULARITY = 0.5
MODULUS, FRICTION_MODULUS, COMPRESSION_STIFFNESS = 0.399, 1.473, 0.157
MEAN_STRENGTH, STRENGTH_SIGMA, LARGEST_FACTOR = 3.397, 0.365, 2.0
STRAIN_STEP, LARGEST_STRAIN, AT_STRAIN = 0.01, 3.0, 0.1
FORCE_ACCURACY, SHARE_OF_LIMIT = 100.0, 1e-4
# The test has parted when the jaw force is below this part of its maximum.
PARTED = 0.9
# Iterations after which the factor that leads them is made anew.
TIRED = 15
JAWS = ["half_bond", "clamped_rows"]
QUANTITIES = ["max_force", "strain_at_max_force", "poisson_ratio", "secant_stiffness_at_10_percent"]


class Fabric:
    """Nodes, who is held, bonds with rest length and strength."""

    def __init__(self, jaws: str, seed: int, size: tuple[int, int, int] = PET) -> None:
        columns, rows, layers = size
        chance = np.random.default_rng([seed, JAWS.index(jaws)])
        places, number = [], {}
        for row in range(rows):
            # even rows have n_x points half a spacing in, odd rows one more
            for column in range(columns + row % 2):
                for layer in range(layers):
                    number[row, column, layer] = len(places)
                    places.append([column + 0.5 * (1 - row % 2), row, layer])
        places = np.array(places, float) * SPACING
        pairs = []
        for (row, column, layer), node in number.items():
            above = [column, column + 1] if row % 2 == 0 else [column - 1, column]
            others = [(row, column + 1, layer), (row, column, layer + 1)]
            others += [(row + 1, other, layer) for other in above]
            pairs += [(node, number[other]) for other in others if other in number]
        end_rows = [[node for (row, _, _), node in number.items() if row == end] for end in (0, rows - 1)]
        held = [np.array(nodes) for nodes in end_rows]
        self.gauge_length = (rows - 1) * SPACING[1]
        if jaws == "half_bond":
            # the diagonals beyond the end rows, cut in half; all layers meet in the mid-plane
            middle = 0.5 * (layers - 1) * SPACING[2]
            for end, side in ((0, -1), (1, 1)):
                first = len(places)
                height = places[end_rows[end][0], 1] + 0.5 * side * SPACING[1]
                points = [[0.5 * (k + 0.5) * SPACING[0], height, middle] for k in range(2 * columns)]
                places = np.vstack([places, points])
                column_of = {node: column for (_, column, _), node in number.items()}
                for node in end_rows[end]:
                    pairs += [(node, first + 2 * column_of[node] + half) for half in (0, 1)]
                held[end] = np.arange(first, len(places))
            self.gauge_length += SPACING[1]
        self.is_free = np.ones(len(places), bool)
        self.is_free[np.concatenate(held)] = False
        self.bottom, self.top = held
        moved = chance.uniform(-0.5, 0.5, places.shape) * IRREGULARITY * SPACING
        moved[~self.is_free] = 0
        places = places + moved
        pairs = np.array(pairs)
        pairs = pairs[self.is_free[pairs].any(axis=1)]
        self.places, self.ends = places, pairs
        self.rest = np.linalg.norm(places[pairs[:, 1]] - places[pairs[:, 0]], axis=1)
        self.strength = MEAN_STRENGTH * factors(chance, len(pairs))
        middle_rows = [row for row in range(rows) if (rows - 1) / 3 <= row <= 2 * (rows - 1) / 3]
        last = {row: columns + row % 2 - 1 for row in middle_rows}
        sides = [(number[row, 0, layer], number[row, last[row], layer]) for row in middle_rows for layer in range(layers)]
        self.left, self.right = np.array(sides).T

    def width(self, places: np.ndarray) -> float:
        """Mean length of the rows in the middle third, end to end, over all layers."""
        return float(np.mean(places[self.right, 0] - places[self.left, 0]))

    def job(self) -> dict:
        """The same specimen as a job for loadframe, node by node and bond by bond."""
        holds = np.full(len(self.places), "free", dtype=object)
        holds[self.bottom], holds[self.top] = "bottom", "top"
        bonds = [{"nodes": pair, "strength_n": strength} for pair, strength in zip(self.ends.tolist(), self.strength.tolist())]
        return {"kind": "nonwoven_tensile", "spec": {
            "version": 1,
            "fabric": {"network": {"nodes_mm": self.places.tolist(), "jaws": holds.tolist(), "bonds": bonds}},
            "bond": {
                "modulus_n": MODULUS, "friction_modulus_n": FRICTION_MODULUS,
                "compression_stiffness_n": COMPRESSION_STIFFNESS, "mean_strength_n": MEAN_STRENGTH,
            },
            "test": {"strain_step": STRAIN_STEP, "max_strain": LARGEST_STRAIN, "breaking": "all_over_strength"},
            "accuracy": {"solver": "newton_cg", "force_accuracy": FORCE_ACCURACY / SHARE_OF_LIMIT, "break_precision": None},
            "output": {"snapshot_every_steps": 0},
        }}


def factors(chance: np.random.Generator, count: int) -> np.ndarray:
    drawn = np.exp(STRENGTH_SIGMA * chance.standard_normal(count))
    while (high := drawn > LARGEST_FACTOR).any():
        drawn[high] = np.exp(STRENGTH_SIGMA * chance.standard_normal(high.sum()))
    return drawn


class Equilibrium:
    """The energy of the bonds that hold, as a function of the places of the free nodes."""

    def __init__(self, fabric: Fabric) -> None:
        self.fabric = fabric
        self.holds = np.ones(len(fabric.ends), bool)
        count, bonds = len(fabric.places), len(fabric.ends)
        first, second = fabric.ends.T
        numbers = np.arange(bonds)
        signs = np.concatenate([np.full(bonds, -1.0), np.ones(bonds)])
        both = (np.concatenate([first, second]), np.concatenate([numbers, numbers]))
        self.incidence = coo_array((signs, both), (count, bonds)).tocsr()
        self.touches = abs(self.incidence)
        # blocks of the matrix over the free nodes: a diagonal one each, two for a bond between free nodes
        index = np.cumsum(fabric.is_free) - 1
        self.inner = np.flatnonzero(fabric.is_free[fabric.ends].all(axis=1))
        free = int(fabric.is_free.sum())
        i, j = index[fabric.ends[self.inner]].T
        rows, columns = np.concatenate([np.arange(free), i, j]), np.concatenate([np.arange(free), j, i])
        pattern = coo_array((np.arange(len(rows)) + 1, (rows, columns)), (free, free)).tocsr()
        self.order, self.indices, self.indptr = pattern.data - 1, pattern.indices, pattern.indptr
        self.free, self.factor = free, None

    def state(self, places: np.ndarray):
        """Lengths, directions, strains and tensions of all bonds; broken ones have none."""
        first, second = self.fabric.ends.T
        along = places[second] - places[first]
        length = np.linalg.norm(along, axis=1)
        strain = length / self.fabric.rest - 1
        tension = np.where(strain > 0, (MODULUS + FRICTION_MODULUS * strain) * strain, COMPRESSION_STIFFNESS * strain)
        return length, along / length[:, None], strain, np.where(self.holds, tension, 0)

    def energy(self, places: np.ndarray) -> float:
        strain = self.state(places)[2]
        pulled = strain**2 * (MODULUS / 2 + FRICTION_MODULUS / 3 * strain)
        pressed = COMPRESSION_STIFFNESS / 2 * strain**2
        return float(np.sum(np.where(self.holds, np.where(strain > 0, pulled, pressed) * self.fabric.rest, 0)))

    def gradient(self, state) -> np.ndarray:
        """Of the energy, at all nodes: what pulls at a node is its negative."""
        _, direction, _, tension = state
        return self.incidence @ (tension[:, None] * direction)

    def stiffness(self, state, is_softened: bool) -> bsr_array:
        """Second derivatives over the free nodes; softened: without what pressed bonds take away."""
        length, direction, strain, tension = state
        slope = np.where(strain > 0, MODULUS + 2 * FRICTION_MODULUS * strain, COMPRESSION_STIFFNESS)
        slope = np.where(self.holds, slope, 0) / self.fabric.rest
        across = tension / length
        if is_softened:
            across = np.maximum(across, 0)
        blocks = (slope - across)[:, None, None] * direction[:, :, None] * direction[:, None, :]
        blocks += across[:, None, None] * np.eye(3)
        diagonal = (self.touches @ blocks.reshape(-1, 9))[self.fabric.is_free].reshape(-1, 3, 3)
        inner = -blocks[self.inner]
        data = np.concatenate([diagonal, inner, inner])[self.order]
        return bsr_array((data, self.indices, self.indptr), shape=(3 * self.free,) * 2)

    def factorise(self, state) -> None:
        """Cholesky factor of the softened matrix, in single precision: it only leads the iterations. Nodes
        are numbered row by row, so that the matrix is a band."""
        matrix = self.stiffness(state, True).tocoo()
        below = matrix.row - matrix.col
        band = np.zeros((below.max() + 1, 3 * self.free), np.float32)
        kept = below >= 0
        band[below[kept], matrix.col[kept]] = matrix.data[kept]
        # what hangs on one bond or none has no stiffness of its own
        band[0] += 1e-3 * band[0].mean()
        self.factor = cholesky_banded(band, overwrite_ab=True, lower=True, check_finite=False)

    def precondition(self, vector: np.ndarray) -> np.ndarray:
        return cho_solve_banded((self.factor, True), vector.astype(np.float32), check_finite=False).astype(float)

    def find(self, places: np.ndarray, limit: float) -> np.ndarray:
        """Places of least energy near these: every resultant below `limit` [N]."""
        free = self.fabric.is_free
        energy, before = self.energy(places), math.nan
        for _ in range(300):
            state = self.state(places)
            gradient = self.gradient(state)[free]
            largest = np.sqrt((gradient**2).sum(axis=1).max())
            if largest < limit:
                return places
            # the closer, the more exact, but never more than the limit asks for
            forcing = max(min(0.1, 0.5 * largest / before), 0.1 * limit / largest)
            before = largest
            if self.factor is None:
                self.factorise(state)
            step = self.conjugate_gradients(self.stiffness(state, False), -gradient.ravel(), forcing).reshape(-1, 3)
            slope = float((gradient * step).sum())
            # no node further than two spacings at once
            share = min(1.0, 2 * SPACING[1] / np.abs(step).max())
            for _ in range(40):
                trial = places.copy()
                trial[free] += share * step
                found = self.energy(trial)
                noise = 1e-14 * abs(energy)
                if found <= energy + 1e-4 * share * slope + noise:
                    break
                share /= 2
            else:
                raise ArithmeticError(f"no way down at a resultant of {largest:.1e} N, limit {limit:.1e} N")
            places, energy = trial, found
        raise ArithmeticError(f"not in equilibrium: {largest:.1e} N, limit {limit:.1e} N")

    def conjugate_gradients(self, matrix: bsr_array, rest: np.ndarray, forcing: float) -> np.ndarray:
        """Solves to `forcing` of the right side, or ends on the first way along which the energy bends down."""
        found, way, product = np.zeros_like(rest), np.zeros_like(rest), 1.0
        goal = forcing * np.linalg.norm(rest)
        for count in range(3000):
            better = self.precondition(rest)
            product, last = rest @ better, product
            way = better + product / last * way
            image = matrix @ way
            bend = way @ image
            if bend <= 0:
                return found + product / max(-bend, 1e-12 * product) * way
            found += product / bend * way
            rest = rest - product / bend * image
            if np.linalg.norm(rest) <= goal:
                break
        if count >= TIRED:
            self.factor = None
        return found


def test(jaws: str, seed: int, is_to_rupture: bool) -> dict:
    """Pulls one specimen, perhaps to 10 % strain only, and tells its results."""
    return {"jaws": jaws, "seed": seed, **pull(Fabric(jaws, seed), is_to_rupture)}


def pull(fabric: Fabric, is_to_rupture: bool) -> dict:
    begin = time.process_time()
    network = Equilibrium(fabric)
    places, curve, result = fabric.places, [], {}
    # what is elastic does not know the steps
    step = STRAIN_STEP if is_to_rupture else AT_STRAIN / 2
    for count in range(1, round(LARGEST_STRAIN / step) + 1):
        strain = count * step
        limit = SHARE_OF_LIMIT * (MODULUS * strain + FRICTION_MODULUS * strain**2) / FORCE_ACCURACY
        # all heights grow alike; nodes that have just snapped through would lead any extrapolation astray
        begun = places * [1, (1 + strain) / (1 + strain - step), 1]
        begun[~fabric.is_free] = fabric.places[~fabric.is_free]
        begun[fabric.top, 1] += strain * fabric.gauge_length
        places = network.find(begun, limit)
        while True:
            state = network.state(places)
            force = float(network.gradient(state)[fabric.top, 1].sum())
            over = state[3] > fabric.strength
            if not over.any() or force < PARTED * max(curve, default=0):
                break
            network.holds &= ~over
            places = network.find(places, limit)
        curve.append(force)
        if math.isclose(strain, AT_STRAIN):
            contraction = 1 - fabric.width(places) / fabric.width(fabric.places)
            result["poisson_ratio"] = contraction / strain
            result["secant_stiffness_at_10_percent"] = force / strain
        has_parted = force < PARTED * max(curve)
        if has_parted:
            result["max_force"] = max(curve)
            result["strain_at_max_force"] = (curve.index(max(curve)) + 1) * step
        if has_parted or (not is_to_rupture and result):
            return {**result, "cpu_s": round(time.process_time() - begin, 1)}
    raise ArithmeticError("the fabric did not part")


def summary(tests: list) -> list:
    """Mean and standard deviation of every result by jaws, and Student's t beyond which two means of the same
    distribution lie apart once in a hundred times."""
    rows = []
    for jaws in JAWS:
        own = sorted((test for test in tests if test["jaws"] == jaws), key=lambda test: test["seed"])
        for name in QUANTITIES:
            values = [test[name] for test in own if name in test]
            if len(values) < 2:
                continue
            mean, deviation = statistics.mean(values), statistics.stdev(values)
            row = {"jaws": jaws, "quantity": name, "mean": mean, "deviation": deviation, "n": len(values)}
            rows.append({**row, "student_99": float(student.ppf(0.995, len(values) - 1))})
    return rows


def write(path: Path, tests: list) -> None:
    """Every test, and what those of each jaw form say together."""
    tests = sorted(tests, key=lambda test: (test["jaws"], test["seed"]))
    lines = lambda rows: "[\n" + ",\n".join(f"  {json.dumps(row)}" for row in rows) + "\n ]"
    parts = {
        "command": json.dumps("tests/validation/prototype.py --out tests/validation/prototype.json"),
        "versions": json.dumps(f"Python {platform.python_version()}, numpy {np.__version__}, scipy {scipy.__version__}"),
        "results": lines(summary(tests)),
        "tests": lines(tests),
    }
    path.write_text("{\n" + ",\n".join(f' "{name}": {part}' for name, part in parts.items()) + "\n}\n")


def write_specimens(path: Path, size: tuple[int, int, int]) -> None:
    """A specimen of each jaw form, and what this program finds of it."""
    written = []
    for jaws in JAWS:
        fabric = Fabric(jaws, 1, size)
        job = {**fabric.job(), "name": f"{jaws}, {' x '.join(map(str, size))}"}
        found = pull(fabric, is_to_rupture=True)
        # a network given bond by bond has no rows: its width is read otherwise
        written.append({"job": job, "found": {name: found[name] for name in QUANTITIES if name != "poisson_ratio"}})
        print(f"{job['name']}: {written[-1]['found']}")
    path.write_text("[\n" + ",\n".join(map(json.dumps, written)) + "\n]\n")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ruptures", type=int, default=10, help="specimens of each jaw form pulled until they part (10)")
    parser.add_argument("--seeds", type=int, default=20, help="specimens of each jaw form in all, the others to 10 %% strain (20)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="tests side by side (all cores)")
    parser.add_argument("--out", type=Path, help="where every test is kept, as JSON; tests found there are not done again")
    parser.add_argument("--specimens", type=Path, help="write specimens as jobs with what is found of them, and nothing else")
    parser.add_argument("--size", default="7x9x2", help="of those: points per row, rows (odd), layers (7x9x2)")
    args = parser.parse_args()
    if args.specimens:
        write_specimens(args.specimens, tuple(map(int, args.size.split("x"))))
        return 0
    tests = json.loads(args.out.read_text())["tests"] if args.out and args.out.exists() else []
    known = {(found["jaws"], found["seed"]) for found in tests}
    asked = [(jaws, seed, seed <= args.ruptures) for seed in range(1, args.seeds + 1) for jaws in JAWS]
    with ProcessPoolExecutor(args.jobs) as pool:
        for done in as_completed([pool.submit(test, *one) for one in asked if one[:2] not in known]):
            found = done.result()
            tests.append(found)
            told = ", ".join(f"{name} {found[name]:.4f}" for name in QUANTITIES if name in found)
            print(f"{found['jaws']}, seed {found['seed']}: {told}; {found['cpu_s']:.0f} s", file=sys.stderr, flush=True)
            if args.out:
                write(args.out, tests)
    for row in summary(tests):
        print(f"{row['jaws']:>12} {row['quantity']:<30} {row['mean']:9.4f} ± {row['deviation']:.4f}, n = {row['n']}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
