# SCENE=scene.json yade -n -x -j1 tests/granular/yade_load.py
# A granular_scene of spheres and one clump between planes and triangles, under the forces that its drive stages put on
# the clump, as Yade 2023.02a computes it: asked for by tests/granular/loads_beside_yade, which writes the scene. Prints
# one JSON line: for each step time [s] and height of the clump [m], thinned to the rows that are asked for.
import json
import math
import os

SPEC = json.loads(open(os.environ["SCENE"]).read())["spec"]
AXES = "xyz"
# of Yade, by our names
DEGREES = dict(x="x", y="y", z="z", rx="X", ry="Y", rz="Z")

for name, of in SPEC["materials"].items():
    O.materials.append(FrictMat(
        young=of["youngs_modulus_pa"], poisson=of["stiffness_ratio"], frictionAngle=of["friction_angle_rad"],
        density=of["density_kg_per_m3"], label=name))
for plane in SPEC["planes"]:
    axis = AXES.index(plane["axis"])
    O.bodies.append(utils.wall(plane["position_m"], axis, plane["facing"], material=plane["material"]))
for mesh in SPEC.get("facets", []):
    for corners in mesh["triangles_m"]:
        O.bodies.append(utils.facet([Vector3(*corner) for corner in corners], material=mesh["material"]))
pushed = None
for body in SPEC["bodies"]:
    at = Vector3(*body["position_m"])
    if "clump" in body:
        members = [
            utils.sphere(at + Vector3(*member["offset_m"]), member["radius_m"], material=body["material"])
            for member in body["clump"]["members"]
        ]
        pushed, _ = O.bodies.appendClumped(members)
        O.bodies[pushed].state.blockedDOFs = "".join(DEGREES[degree] for degree in body["fixed"])
    else:
        O.bodies.append(utils.sphere(at, body["sphere"]["radius_m"], material=body["material"]))

smallest = min(body["sphere"]["radius_m"] for body in SPEC["bodies"] if "sphere" in body)
clump = O.bodies[pushed].state
stages = [stage["drive"] for stage in SPEC["stages"]]
EVERY = SPEC["record"]["every_steps"]
rows = []
O.dt = SPEC["time_step_s"]
stage, began = stages[0], 0.0


def push():
    """The force of the present stage, F₀ + (F₁ − F₀)(1 − cos 2πt/T)/2."""
    force = stage["bodies"][0]["force"]
    down = Vector3(*force["force_n"])
    if "period_s" in force:
        swing = 0.5 * (1 - math.cos(2 * math.pi * (O.time - began) / force["period_s"]))
        down += swing * (Vector3(*force["peak_force_n"]) - down)
    O.forces.setPermF(pushed, down)
    if O.iter % EVERY == 0:
        rows.append((O.time, clump.pos[2]))


O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb(), Bo1_Facet_Aabb()], verletDist=0.15 * smallest),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_FrictPhys()],
        [Law2_ScGeom_FrictPhys_CundallStrack()],
    ),
    PyRunner(command="push()", iterPeriod=1),
    NewtonIntegrator(damping=SPEC["laws"]["local_damping"], gravity=SPEC["gravity_m_per_s2"]),
]
for stage in stages:
    began = O.time
    O.run(round(stage["time_s"] / O.dt), True)
rows.append((O.time, clump.pos[2]))
print("JSON " + json.dumps(rows), flush=True)
os._exit(0)
