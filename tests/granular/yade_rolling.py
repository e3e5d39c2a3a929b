# yade -n -x -j1 tests/granular/yade_rolling.py
# Oblique impacts with rolling and twisting resistance as Yade computes them, one JSON line each: the
# reference of worker/physics/tests/granular/rolling.jsonl. The spheres of yade_impacts.py in Yade's
# CohFrictMat without cohesion, whose moments grow by increments. With R = r1 r2/(r1 + r2) its constants are
# alphaKr = beta R^2/(r1 r2) and etaRoll = mu R/min(r1, r2).
import json

DT, STEPS = 1e-6, 600
R1, R2 = 0.01, 0.015
R = R1 * R2 / (R1 + R2)
CASES = {
    "rolling": dict(phi=1.2, damping=0.0, rolling=10.0, twisting=0.0, ratio=1.0),
    "yielding": dict(phi=0.5, damping=0.0, rolling=0.05, twisting=0.0, ratio=1.0),
    "twisting": dict(phi=0.5, damping=0.0, rolling=0.0, twisting=10.0, ratio=0.5),
    "both_yield": dict(phi=0.5, damping=0.3, rolling=0.1, twisting=0.02, ratio=2.0),
}

for name, case in CASES.items():
    O.reset()
    stiffness = case["ratio"] * R * R / (R1 * R2)
    common = dict(
        frictionAngle=case["phi"],
        momentRotationLaw=True,
        alphaKr=stiffness if case["rolling"] else 0,
        alphaKtw=stiffness if case["twisting"] else 0,
        etaRoll=case["rolling"] * R / R1,
        etaTwist=case["twisting"] * R / R1,
    )
    O.materials.append(CohFrictMat(young=1e8, poisson=0.3, density=2600, label="a", **common))
    O.materials.append(CohFrictMat(young=3e8, poisson=0.3, density=1800, label="b", **common))
    O.bodies.append(sphere((0, 0, 0.01005), R1, material="a"))
    O.bodies.append(sphere((0.006, -0.004, 0.0344), R2, material="b"))
    O.bodies[1].state.vel = (0.1, 0.2, -1.5)
    O.bodies[1].state.angVel = (5, -3, 20)
    O.bodies[0].state.vel = (0.3, -0.2, 0.7)
    O.bodies[0].state.angVel = (-10, 7, 15)
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb()]),
        InteractionLoop(
            [Ig2_Sphere_Sphere_ScGeom6D()],
            [Ip2_CohFrictMat_CohFrictMat_CohFrictPhys()],
            [Law2_ScGeom6D_CohFrictPhys_CohesionMoment(useIncrementalForm=True, always_use_moment_law=True)],
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
            middle = dict(
                step=step,
                overlap=i.geom.penetrationDepth,
                stiffness=[i.phys.kn, i.phys.ks, i.phys.kr, i.phys.ktw],
                fn=list(i.phys.normalForce),
                fs=list(i.phys.shearForce),
                moment=list(i.phys.moment_bending + i.phys.moment_twist),
            )
    states = [[list(b.state.pos), list(b.state.vel), list(b.state.angVel)] for b in O.bodies]
    print("JSON " + json.dumps(dict(name=name, dt=DT, steps=STEPS, touched=touched, middle=middle, states=states, **case)))
