# CASE='{"seed": 1, "compaction": "none"}' yade -n -x -j1 tests/granular/yade_box.py
# The box test of the thesis in Yade 2023.02a, as tests/granular/box_beside_yade asks for it: E 2.8 MPa, spheres of
# 0.6 to 1.4 times 16.25 mm, a sleeper of 2280 spheres free along z, 3 kN at 1 Hz. Prints one JSON line: displacements
# [mm] from the start of the load and from set-down.
# compaction: none, renewed (contacts that exist get the friction of each stage) or kept (materials alone are changed,
# which in Yade does not reach contacts that exist). steel: friction angle of box and sleeper.
import json
import math
import os
import random

CASE = dict(seed=1, compaction="none", steel=0.5)
CASE.update(json.loads(os.environ.get("CASE", "{}")))
RADIUS, MODULUS, PEAK = 0.01625, 2.8e6, 3000.0
SMALLEST = 0.6 * RADIUS
draw = random.Random(CASE["seed"])
ANGLES = dict(aggregate=0.5, steel=CASE["steel"], rubber=0.7, sleeper=CASE["steel"])


def material(label, modulus, ratio, density):
    O.materials.append(
        FrictMat(young=modulus, poisson=ratio, frictionAngle=ANGLES[label], density=density, label=label)
    )


material("aggregate", MODULUS, 0.3, 2600)
material("steel", 10 * MODULUS, 0.25, 7850)
material("rubber", 0.1 * MODULUS, 0.5, 1000)
material("sleeper", 10 * MODULUS, 0.25, 34 / (2280 * 4 / 3 * math.pi * 0.005**3))
for place, axis, sense, of in (
    (0.0, 0, 1, "steel"), (0.7, 0, -1, "steel"), (0.0, 1, 1, "steel"), (0.3, 1, -1, "steel"), (0.0, 2, 1, "rubber"),
):
    O.bodies.append(utils.wall(place, axis, sense, material=of))
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()], verletDist=0.15 * SMALLEST),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_FrictPhys()],
        [Law2_ScGeom_FrictPhys_CundallStrack()],
    ),
    NewtonIntegrator(damping=0.3, gravity=(0, 0, -9.81)),
]
newton = O.engines[-1]
O.dt = 0.5 * SMALLEST * math.sqrt(2600 / MODULUS)


def grains():
    return [b for b in O.bodies if b and b.material and b.material.label == "aggregate" and isinstance(b.shape, Sphere)]


def pour(low, high, volume, sleeper_top=None):
    """Spheres at random places, none in another; above a sleeper none inside it."""
    placed = []
    while volume > 0:
        r = RADIUS * (1 + 0.4 * (2 * draw.random() - 1))
        for _ in range(400):
            x, y, z = draw.uniform(r, 0.7 - r), draw.uniform(r, 0.3 - r), draw.uniform(low + r, high - r)
            if sleeper_top and 0.225 - r < x < 0.475 + r and z < sleeper_top + r:
                continue
            if all((x - a)**2 + (y - b)**2 + (z - c)**2 > (r + s)**2 for a, b, c, s in placed):
                break
        else:
            high += 0.05
            continue
        placed.append((x, y, z, r))
        volume -= 4 / 3 * math.pi * r**3
    for x, y, z, r in placed:
        O.bodies.append(utils.sphere((x, y, z), r, material="aggregate"))


def settle(fall, longest=3):
    O.run(int(fall / O.dt), True)
    while fall < longest and utils.unbalancedForce() > 0.03:
        O.run(int(0.02 / O.dt), True)
        fall += 0.02


def cut(height):
    for b in grains():
        if b.state.pos[2] > height:
            O.bodies.erase(b.id)


def friction(factor, reaches_contacts):
    for m in O.materials:
        m.frictionAngle = math.atan(factor * math.tan(ANGLES[m.label]))
    for i in O.interactions if reaches_contacts else []:
        if i.isReal:
            angles = (O.bodies[j].material.frictionAngle for j in (i.id1, i.id2))
            i.phys.tangensOfFrictionAngle = math.tan(min(angles))


pour(0, 0.7055, 1.1 * 0.7 * 0.3 * 0.3 * 0.6)
settle(0.5)
cut(0.3)
heights = []
for b in grains():
    beside, r = max(0.225 - b.state.pos[0], b.state.pos[0] - 0.475, 0), b.shape.radius
    if beside < r:
        heights.append(b.state.pos[2] + math.sqrt(r**2 - beside**2))
set_down = max(heights) + 1e-6
shell = [
    (0.23 + 0.01 * i, 0.005 + 0.01 * j, set_down + 0.005 + 0.01 * k)
    for i in range(25) for j in range(30) for k in range(15) if i in (0, 24) or k in (0, 14)
]
number, _ = O.bodies.appendClumped([utils.sphere(p, 0.005, material="sleeper") for p in shell])
sleeper = O.bodies[number].state
sleeper.blockedDOFs = "xyXYZ"
first = sleeper.pos[2]
pour(0.36, 0.8, 1.4 * 0.45 * 0.3 * 0.15 * 0.6, set_down + 0.17)
settle(0.35)
cut(0.45)
settle(0.05, 2)
if CASE["compaction"] != "none":
    # 1 g at 20 Hz for 1 s, along x and y in turn, with a tenth of the friction
    reaches = CASE["compaction"] == "renewed"
    friction(0.1, reaches)
    steps, time = int(0.005 / O.dt), 0
    while time < 1:
        acceleration, along = 9.81 * math.sin(2 * math.pi * 20 * time), int(time * 20) % 2
        newton.gravity = (acceleration * (1 - along), acceleration * along, -9.81)
        O.run(steps, True)
        time += steps * O.dt
    newton.gravity = (0, 0, -9.81)
    friction(1, reaches)
    settle(0.1, 2)
start, began, rows = sleeper.pos[2], O.time, []


def load():
    force = 0.5 * PEAK * (1 - math.cos(2 * math.pi * (O.time - began)))
    O.forces.setPermF(number, (0, 0, -force))
    rows.append((force, 1e3 * (start - sleeper.pos[2])))


O.engines = O.engines[:3] + [PyRunner(command="load()", iterPeriod=1)] + O.engines[3:]
O.run(int(1 / O.dt), True)
at_peak, deepest = max(rows)[1], max(way for _, way in rows)
before = 1e3 * (first - start)
found = dict(at_largest_force_mm=at_peak, deepest_mm=deepest, from_set_down_mm=before + deepest, left_mm=rows[-1][1])
print("JSON " + json.dumps({**CASE, **found}), flush=True)
os._exit(0)
