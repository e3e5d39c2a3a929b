"""A `composite_bending` spec as a deck of CalculiX, and what CalculiX says of it.

Elements are quadratic (CPE8 and CPE6, or CPS8 and CPS6) and their edges lie on the faces of all
fibres: fibres along x or y, of any length, or fibres of one common angle that cross the section.
Other layouts are refused. Meshes of one series are nested: each element is cut in four.

Plane stress is done in two ways. "plane": plane strain elements of a material whose third direction
is not coupled with the plane and whose stiffness in the plane is that of plane stress; with no strain
out of the plane the stresses are exactly those of plane stress, whatever the thickness. "sheet":
CPS8 elements, which ccx makes bricks of and which tend to plane stress as the thickness goes to 0.
Angles of materials are left to ccx (*ORIENTATION).
"""

import math
import os
import re
import subprocess
import tempfile
from bisect import bisect_left
from pathlib import Path

FACES = ("left", "right", "bottom", "top")
GAUSS = ((-math.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (math.sqrt(0.6), 5 / 9))
# How much longer an element may be than its distance from a place of strong gradients.
GROWTH = 0.5


class NoMesh(Exception):
    """A layout whose faces the elements cannot follow."""


# ---------------------------------------------------------------- mesh of corners


def is_angle(angle, wanted):
    return abs((angle - wanted + 90) % 180 - 90) < 1e-9


def lines(length, places, largest):
    """Stations from 0 to `length` that hold all `places` [(coordinate, size wanted there or None)]."""
    places = [(at, size) for at, size in places if -1e-9 < at < length + 1e-9]
    stations = []
    for at in sorted([0.0, length] + [at for at, _ in places]):
        if not stations or at - stations[-1] > 1e-7 * length:
            stations.append(at)
    sizes = [(at, size) for at, size in places if size is not None]

    def size(x):
        return min([largest] + [h + GROWTH * abs(x - at) for at, h in sizes])

    filled = [stations[0]]
    for start, end in zip(stations, stations[1:]):
        # Stations at equal steps of the integral of 1/size.
        samples = 400
        step = (end - start) / samples
        passed = [0.0]
        for k in range(samples):
            passed.append(passed[-1] + step / size(start + (k + 0.5) * step))
        count = max(1, round(passed[-1]))
        for k in range(1, count):
            wanted = passed[-1] * k / count
            place = bisect_left(passed, wanted)
            share = (wanted - passed[place - 1]) / (passed[place] - passed[place - 1])
            filled.append(start + (place - 1 + share) * step)
        filled.append(end)
    return filled


class Mesh:
    """Corners [(x, y)], cells [(corners counterclockwise, three or four)], a group for each cell."""

    def __init__(self, nodes, cells, groups):
        self.nodes, self.cells, self.groups = nodes, cells, groups

    def refined(self):
        """Each cell cut in four."""
        nodes, middles, cells, groups = list(self.nodes), {}, [], []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(nodes)
                nodes.append(tuple(0.5 * (p + q) for p, q in zip(nodes[a], nodes[b])))
            return middles[key]

        for cell, group in zip(self.cells, self.groups):
            m = [middle(a, b) for a, b in zip(cell, cell[1:] + cell[:1])]
            if len(cell) == 3:
                new = [(cell[0], m[0], m[2]), (m[0], cell[1], m[1]), (m[2], m[1], cell[2]), (m[0], m[1], m[2])]
            else:
                centre = len(nodes)
                nodes.append(tuple(sum(nodes[n][k] for n in cell) / 4 for k in (0, 1)))
                new = [(cell[k], m[k], centre, m[k - 1]) for k in range(4)]
            cells += new
            groups += [group] * len(new)
        return Mesh(nodes, cells, groups)

    def quadratic(self):
        """Nodes with those in the middle of the edges, and elements of eight and six nodes."""
        nodes, middles, elements = list(self.nodes), {}, []
        for cell in self.cells:
            mids = []
            for a, b in zip(cell, cell[1:] + cell[:1]):
                key = (min(a, b), max(a, b))
                if key not in middles:
                    middles[key] = len(nodes)
                    nodes.append(tuple(0.5 * (p + q) for p, q in zip(nodes[a], nodes[b])))
                mids.append(middles[key])
            elements.append(tuple(cell) + tuple(mids))
        return nodes, elements, {key: mid for key, mid in middles.items()}


def first_mesh(spec, coarseness=1.0, even=None):
    """The coarsest mesh of a section: lines along the fibres crossed by lines along y.

    Elements are small at fibres and clamped edges, or with `even` as far as fibres let them all of
    one size, that many along the longer side.

    Where a line along a slanted fibre ends at the top or bottom there is a line along y too, so that
    between two of those nothing ends, and cells at the edges are triangles.
    """
    length, height = (spec["section"][key] for key in ("length_mm", "height_mm"))
    fibres, test = spec.get("fibres", []), spec["test"]
    slanted = [f for f in fibres if not is_angle(f["angle_deg"], 0) and not is_angle(f["angle_deg"], 90)]
    angle = 0.0
    if slanted:
        angle = (slanted[0]["angle_deg"] + 90) % 180 - 90
        if len(slanted) < len(fibres) or any(not is_angle(f["angle_deg"], angle) or f.get("length_mm") for f in fibres):
            raise NoMesh("slanted fibres must have one angle and cross the section")
    slope, lean = math.tan(math.radians(angle)), math.cos(math.radians(angle))
    lowest, highest = min(0.0, -length * slope), max(height, height - length * slope)

    # Places that lines must go through: x of lines along y, and height above the origin's line of
    # lines along the fibres.
    upright, along = [], []
    for fibre in fibres:
        (x, y), thickness = fibre["through_mm"], fibre["thickness_mm"]
        size = coarseness * thickness
        ends = fibre.get("length_mm")
        if is_angle(fibre["angle_deg"], 90):
            upright += [(x - thickness / 2, size), (x + thickness / 2, size)]
            along += [(y + sign * ends / 2, size) for sign in (-1, 1)] if ends else []
        else:
            middle, half = y - x * slope, thickness / (2 * lean)
            along += [(middle - half - lowest, size / lean), (middle + half - lowest, size / lean)]
            upright += [(x + sign * ends / 2, size) for sign in (-1, 1)] if ends else []
    # Clamped edges end in corners of high stress, the more so where a stiff fibre runs into them.
    fine = coarseness * min([min(length, height) / 30] + [fibre["thickness_mm"] / 4 for fibre in fibres])
    for face, support in test["supports"].items():
        if support != "free":
            upright += [(0.0 if face == "left" else length, fine)] if face in ("left", "right") else []
            if not slanted:
                along += [(0.0, fine), (height, fine)]
    on = test["load"]["on"]
    points = [tuple(point) for point in spec.get("probes_mm", [])]
    if isinstance(on, dict) and "point_mm" in on:
        points.append(tuple(on["point_mm"]))
    if isinstance(on, dict) and "patch" in on:
        patch = on["patch"]
        size = coarseness * (patch["to_mm"] - patch["from_mm"]) / 2
        ends = [(patch["from_mm"], size), (patch["to_mm"], size)]
        if patch["face"] in ("top", "bottom"):
            upright += ends
        elif not slanted:
            along += ends
        else:
            raise NoMesh("a patch on a side face beside slanted fibres")
    for x, y in points:
        upright.append((x, None))
        if 0 < y < height:
            along.append((y - x * slope - lowest, None))

    largest = [coarseness * side / 8 for side in (length, height)]
    if even:
        largest = [max(length, height) / even] * 2
        upright, along = ([(at, None) for at, _ in places] for places in (upright, along))
    levels = [at + lowest for at in lines(highest - lowest, along, largest[1] / lean)]
    if slanted:
        for level in levels:
            upright += [(edge, None) for edge in ((0 - level) / slope, (height - level) / slope)]
    stations = lines(length, upright, largest[0])

    nodes, numbers, cells, groups = [], {}, [], []

    def node(x, y):
        key = (round(x / length * 1e8), round(y / height * 1e8))
        if key not in numbers:
            numbers[key] = len(nodes)
            nodes.append((x, y))
        return numbers[key]

    def snapped(y):
        return 0.0 if abs(y) < 2e-7 * height else height if abs(y - height) < 2e-7 * height else y

    for x0, x1 in zip(stations, stations[1:]):
        inside = [level for level in levels if 1e-7 * height < level + slope * (x0 + x1) / 2 < (1 - 1e-7) * height]
        left = [0.0] + [snapped(level + slope * x0) for level in inside] + [height]
        right = [0.0] + [snapped(level + slope * x1) for level in inside] + [height]
        for k in range(len(left) - 1):
            corners = [node(x0, left[k]), node(x1, right[k]), node(x1, right[k + 1]), node(x0, left[k + 1])]
            corners = tuple(n for place, n in enumerate(corners) if n not in corners[:place])
            centre = [sum(nodes[n][axis] for n in corners) / len(corners) for axis in (0, 1)]
            cells.append(corners)
            groups.append(group_at(spec, centre))
    return Mesh(nodes, cells, groups)


def group_at(spec, point):
    """Name and angle of the material at a point."""
    for fibre in spec.get("fibres", []):
        angle = math.radians(fibre["angle_deg"])
        dx, dy = (point[k] - fibre["through_mm"][k] for k in (0, 1))
        along, across = dx * math.cos(angle) + dy * math.sin(angle), dy * math.cos(angle) - dx * math.sin(angle)
        if abs(across) < fibre["thickness_mm"] / 2 and abs(along) < fibre.get("length_mm", math.inf) / 2:
            return fibre["material"], fibre["angle_deg"]
    return spec["matrix"], spec.get("matrix_angle_deg", 0.0)


# ---------------------------------------------------------------- material


def constants(material):
    """E1, E2, E3, nu12, nu13, nu23, G12 [MPa], with what a spec may leave out."""
    if "isotropic" in material:
        e, nu = (material["isotropic"][key] for key in ("youngs_modulus_mpa", "poisson_ratio"))
        return e, e, e, nu, nu, nu, e / (2 * (1 + nu))
    given = material["orthotropic"]
    e1, e2, nu12 = (given[key] for key in ("modulus_1_mpa", "modulus_2_mpa", "poisson_ratio_12"))
    # Huber's estimate
    shear = math.sqrt(e1 * e2) / (2 * (1 + nu12 * math.sqrt(e2 / e1)))
    g12 = given.get("shear_modulus_12_mpa") or shear
    return (e1, e2, given.get("modulus_3_mpa", e2), nu12, given.get("poisson_ratio_13", nu12), given.get("poisson_ratio_23", nu12), g12)


def material_cards(material, way):
    e1, e2, e3, nu12, nu13, nu23, g12 = constants(material)
    if way != "plane":
        rows = (e1, e2, e3, nu12, nu13, nu23, g12, g12)
        return "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n" + ", ".join(f"{value:.12e}" for value in rows) + f",\n{g12:.12e}\n"
    part = 1 - nu12 * nu12 * e2 / e1
    d11, d12, d22 = e1 / part, nu12 * e2 / part, e2 / part
    return f"*ELASTIC, TYPE=ORTHO\n{d11:.12e}, {d12:.12e}, {d22:.12e}, 0., 0., {d22:.12e}, {g12:.12e}, {g12:.12e},\n{g12:.12e}\n"


# ---------------------------------------------------------------- loads


def face_edges(nodes, middles, face, length, height):
    axis, at = {"left": (0, 0.0), "right": (0, length), "bottom": (1, 0.0), "top": (1, height)}[face]
    side = (length, height)[axis]
    found = []
    for (a, b), mid in middles.items():
        if all(abs(nodes[n][axis] - at) < 1e-7 * side for n in (a, b)):
            found.append((a, mid, b))
    other = 1 - axis
    return sorted(found, key=lambda edge: nodes[edge[1]][other]), other


def edge_weights(nodes, edges, other):
    """Weights of nodes in the mean over edges: exact for quadratic edges."""
    total = sum(abs(nodes[b][other] - nodes[a][other]) for a, _, b in edges)
    weights = {}
    for a, mid, b in edges:
        share = abs(nodes[b][other] - nodes[a][other]) / total
        for node, part in ((a, 1 / 6), (mid, 2 / 3), (b, 1 / 6)):
            weights[node] = weights.get(node, 0.0) + share * part
    return weights


def body_weights(nodes, elements, area):
    """Weights of nodes in the mean over the section: three by three Gauss points in each quadrilateral."""
    weights = {}
    for element in elements:
        if len(element) == 6:
            (xa, ya), (xb, yb), (xc, yc) = (nodes[n] for n in element[:3])
            third = 0.5 * abs((xb - xa) * (yc - ya) - (xc - xa) * (yb - ya)) / area / 3
            for n in element[3:]:
                weights[n] = weights.get(n, 0.0) + third
            continue
        (x0, y0), (x1, y1), (x2, y2), (x3, y3) = (nodes[n] for n in element[:4])
        for r, wr in GAUSS:
            for s, ws in GAUSS:
                xr = (-(1 - s) * x0 + (1 - s) * x1 + (1 + s) * x2 - (1 + s) * x3) / 4
                yr = (-(1 - s) * y0 + (1 - s) * y1 + (1 + s) * y2 - (1 + s) * y3) / 4
                xs = (-(1 - r) * x0 - (1 + r) * x1 + (1 + r) * x2 + (1 - r) * x3) / 4
                ys = (-(1 - r) * y0 - (1 + r) * y1 + (1 + r) * y2 + (1 - r) * y3) / 4
                w = wr * ws * (xr * ys - xs * yr) / area
                shape = [0.25 * (1 + r * a) * (1 + s * b) * (r * a + s * b - 1) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
                shape += [0.5 * (1 - r * r) * (1 - s), 0.5 * (1 + r) * (1 - s * s), 0.5 * (1 - r * r) * (1 + s), 0.5 * (1 - r) * (1 - s * s)]
                for n, value in zip(element, shape):
                    weights[n] = weights.get(n, 0.0) + w * value
    return weights


# ---------------------------------------------------------------- deck, run, answer


def solve(spec, mesh, way=None, sheet_mm=None, keep=None):
    """Displacements and reactions of a mesh.

    `way`: "plane" (default in plane stress), "sheet" (of `sheet_mm` with the load in proportion), or
    "strain". Means and points are along the load.
    """
    section, test = spec["section"], spec["test"]
    length, height, thickness = (section[key] for key in ("length_mm", "height_mm", "thickness_mm"))
    way = way or ("strain" if section["state"] == "plane_strain" else "plane")
    used = sheet_mm or thickness
    scale = used / thickness
    nodes, elements, middles = mesh.quadratic()
    faces = {face: face_edges(nodes, middles, face, length, height) for face in FACES}

    force, on = test["load"]["force_n"], test["load"]["on"]
    if on == "body":
        loaded = body_weights(nodes, elements, length * height)
    elif "face" in on:
        loaded = edge_weights(nodes, *faces[on["face"]])
    elif "patch" in on:
        edges, other = faces[on["patch"]["face"]]
        inside = [edge for edge in edges if on["patch"]["from_mm"] < nodes[edge[1]][other] < on["patch"]["to_mm"]]
        loaded = edge_weights(nodes, inside, other)
    else:
        loaded = {node_at(nodes, on["point_mm"]): 1.0}
    assert abs(sum(loaded.values()) - 1) < 1e-9

    means = {face: edge_weights(nodes, *faces[face]) for face in ("top", "bottom")}
    probes = [node_at(nodes, point) for point in spec.get("probes_mm", [])]
    printed = sorted(set(means["top"]) | set(means["bottom"]) | set(probes))
    held = {}
    for face, support in test["supports"].items():
        if support not in ("clamped", "free", "rolling"):
            raise NoMesh(f"a face held as {support}")
        normal = 0 if face in ("left", "right") else 1
        axes = {"clamped": (0, 1), "free": (), "rolling": (normal,)}[support]
        for edge in faces[face][0]:
            for n in edge:
                held.setdefault(n, set()).update(axes)
    held = {n: axes for n, axes in held.items() if axes}

    deck = ["*NODE, NSET=ALL\n"]
    # ccx reads at most 20 characters of a number.
    deck += [f"{n}, {x:.12e}, {y:.12e}, 0.\n" for n, (x, y) in enumerate(nodes, 1)]
    groups = sorted(set(mesh.groups))
    kind = "CPS" if way == "sheet" else "CPE"
    for number, group in enumerate(groups):
        for size in (8, 6):
            rows = [(k, e) for k, e in enumerate(elements, 1) if len(e) == size and mesh.groups[k - 1] == group]
            if rows:
                deck.append(f"*ELEMENT, TYPE={kind}{size}, ELSET=E{number}\n")
                deck += [f"{k}, " + ", ".join(str(n + 1) for n in e) + "\n" for k, e in rows]
        name, angle = group
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        deck.append(f"*MATERIAL, NAME=M{number}\n" + material_cards(spec["materials"][name], way))
        deck.append(f"*ORIENTATION, NAME=O{number}\n{c:.12e}, {s:.12e}, 0., {-s:.12e}, {c:.12e}, 0.\n")
        deck.append(f"*SOLID SECTION, ELSET=E{number}, MATERIAL=M{number}, ORIENTATION=O{number}\n{used!r}\n")
    deck.append("*NSET, NSET=PRINTED\n" + "".join(f"{n + 1},\n" for n in printed))
    deck.append("*NSET, NSET=HELD\n" + "".join(f"{n + 1},\n" for n in sorted(held)))
    deck.append("*BOUNDARY\n" + "".join(f"{n + 1}, {axis + 1}, {axis + 1}\n" for n in sorted(held) for axis in sorted(held[n])))
    deck.append("*STEP\n*STATIC\n*CLOAD\n")
    for n in sorted(loaded):
        deck += [f"{n + 1}, {axis + 1}, {loaded[n] * force[axis] * scale:.12e}\n" for axis in (0, 1) if force[axis]]
    deck.append("*NODE PRINT, NSET=PRINTED\nU\n*NODE PRINT, NSET=HELD, TOTALS=ONLY\nRF\n")
    deck += [f"*EL PRINT, ELSET=E{number}, TOTALS=ONLY\nELSE\n" for number in range(len(groups))]
    deck.append("*END STEP\n")

    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(keep) if keep else Path(scratch)
        (folder / "deck.inp").write_text("".join(deck))
        cpu, output = run(["ccx", "-i", "deck"], folder)
        data = folder / "deck.dat"
        if "Job finished" not in output or not data.exists():
            raise RuntimeError("ccx did not finish:\n" + output[-2000:])
        text = data.read_text()
    u = {}
    for line in text.split("displacements", 1)[1].split("total", 1)[0].splitlines()[1:]:
        values = line.split()
        if len(values) == 4:
            u[int(values[0]) - 1] = [float(value) for value in values[1:3]]
    reaction = [float(value) for value in re.search(r"total force .*?\n\s*\n\s*(.*)\n", text).group(1).split()]
    energy = sum(float(value) for value in re.findall(r"total internal energy .*?\n\s*\n\s*(\S+)", text))
    # What is loaded where it is held goes straight into the support; ccx leaves it out.
    for n in set(loaded) & set(held):
        for axis in held[n]:
            reaction[axis] -= loaded[n] * force[axis] * scale
    size = math.hypot(*force)
    toward = [part / size for part in force]

    def along(displacement):
        return displacement[0] * toward[0] + displacement[1] * toward[1]

    return {
        "elements": len(elements), "nodes": len(nodes), "cpu_s": cpu,
        "top": sum(w * along(u[n]) for n, w in means["top"].items()),
        "bottom": sum(w * along(u[n]) for n, w in means["bottom"].items()),
        "points": [along(u[n]) for n in probes],
        "reaction_n": [part / scale for part in reaction[:2]],
        "energy_n_mm": energy / scale,
    }


def node_at(nodes, point):
    found = min(range(len(nodes)), key=lambda n: math.dist(nodes[n], point))
    if math.dist(nodes[found], point) > 1e-6 * max(map(max, nodes)):
        raise NoMesh(f"no node at {point}")
    return found


def run(command, folder=None):
    """Processor time (user and system) of a command on one thread [s], and what it printed."""
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", RAYON_NUM_THREADS="1", CCX_NPROC_EQUATION_SOLVER="1")
    with tempfile.TemporaryFile() as output:
        child = subprocess.Popen(command, cwd=folder, env=environment, stdout=output, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        text = output.read().decode(errors="replace")
    if child.returncode:
        raise RuntimeError(f"{command} ended with {child.returncode}:\n{text[-2000:]}")
    return usage.ru_utime + usage.ru_stime, text
