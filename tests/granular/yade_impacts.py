# yade-batch is not needed: yade -n -x -j1 tests/granular/yade_impacts.py
# Oblique impacts as Yade computes them, one JSON line each: the reference of
# worker/physics/tests/granular/impacts.json. Spheres of radius 0.01 and 0.015 m, or one of 0.01 m
# and a wall or a facet, hit on its face, an edge or a corner; state after STEPS steps of DT.
import json

DT, STEPS = 1e-6, 600
CASES = {
    "sliding": dict(phi=0.1, damping=0.0, wall=False),
    "sticking": dict(phi=1.2, damping=0.0, wall=False),
    "damped": dict(phi=0.5, damping=0.3, wall=False),
    "wall_sliding": dict(phi=0.1, damping=0.0, wall=True),
    "wall_sticking": dict(phi=1.2, damping=0.2, wall=True),
    "facet_sliding": dict(phi=0.1, damping=0.0, wall=True, facet=[[-0.05, -0.04, 0], [0.06, -0.03, 0], [0.01, 0.07, 0]]),
    "facet_sticking": dict(phi=1.2, damping=0.2, wall=True, facet=[[-0.05, -0.04, 0], [0.01, 0.07, 0], [0.06, -0.03, 0]]),
    "facet_edge": dict(phi=0.5, damping=0.0, wall=True, facet=[[0.003, -0.04, 0.0004], [0.06, 0.01, -0.006], [0.0035, 0.05, 0.0003]]),
    "facet_corner": dict(phi=0.5, damping=0.0, wall=True, facet=[[0.002, -0.0015, 0.0003], [0.06, -0.03, -0.006], [0.04, 0.04, 0.002]]),
}

for name, case in CASES.items():
    O.reset()
    common = dict(poisson=0.3, frictionAngle=case["phi"])
    O.materials.append(FrictMat(young=1e8, density=2600, label="a", **common))
    O.materials.append(FrictMat(young=3e8, density=1800, label="b", **dict(common, poisson=0.4)))
    O.bodies.append(sphere((0, 0, 0.01005), 0.01, material="a"))
    if "facet" in case:
        O.bodies.append(facet(case["facet"], material="b"))
    elif case["wall"]:
        O.bodies.append(wall(0, axis=2, sense=1, material="b"))
    else:
        O.bodies.append(sphere((0.006, -0.004, 0.0344), 0.015, material="b"))
        O.bodies[1].state.vel = (0.1, 0.2, -1.5)
        O.bodies[1].state.angVel = (5, -3, 20)
    O.bodies[0].state.vel = (0.3, -0.2, -1.0 if case["wall"] else 0.7)
    O.bodies[0].state.angVel = (-10, 7, 15)
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb(), Bo1_Facet_Aabb()]),
        InteractionLoop(
            [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()],
            [Ip2_FrictMat_FrictMat_FrictPhys()],
            [Law2_ScGeom_FrictPhys_CundallStrack()],
        ),
        NewtonIntegrator(gravity=(0, 0, -9.81), damping=case["damping"]),
    ]
    O.dt = DT
    touched, middle = 0, None
    for step in range(1, STEPS + 1):
        O.step()
        real = [i for i in O.interactions if i.isReal]
        touched += len(real)
        if len(real) and touched == 100:
            i = real[0]
            sign = -1 if case["wall"] else 1
            middle = dict(
                step=step,
                overlap=i.geom.penetrationDepth,
                fn=[sign * c for c in i.phys.normalForce],
                fs=[sign * c for c in i.phys.shearForce],
            )
    spheres = [b for b in O.bodies if isinstance(b.shape, Sphere)]
    states = [[list(b.state.pos), list(b.state.vel), list(b.state.angVel)] for b in spheres]
    print("JSON " + json.dumps(dict(name=name, dt=DT, steps=STEPS, touched=touched, middle=middle, states=states, **case)))
