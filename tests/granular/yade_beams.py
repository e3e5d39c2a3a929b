# yade -n -x -j1 tests/granular/yade_beams.py
# A chain of four bonded spheres that is thrown, turns and swings, as Yade computes it, one JSON line each:
# the reference of worker/physics/tests/granular/beams.jsonl. Yade's CohFrictMat with the stiffnesses of beams of
# radius R_BEAM: kn = E r is EA/L, ks/kn is the ratio, kr = alphaKr r^2 ks is EI/L, ktw = alphaKtw r^2 ks is GJ/L.
import json
from math import pi

RADIUS, R_BEAM, MODULUS, RATIO, DENSITY = 0.01, 0.005, 1e9, 0.4, 2600
DT = 1e-6
YOUNG = MODULUS * pi * R_BEAM**2 / (2 * RADIUS) / RADIUS
CASES = {
    "bends": dict(velocity=(0, 1e-2, 0), spin=(0, 0, 0), damping=0.0),
    "twists": dict(velocity=(0, 0, 0), spin=(3, 0, 0), damping=0.0),
    "all": dict(velocity=(3e-3, 1e-2, -6e-3), spin=(3, -1, 2), damping=0.0),
    "damped": dict(velocity=(3e-3, 1e-2, -6e-3), spin=(3, -1, 2), damping=0.3),
}
STEPS = 1000

for name, case in CASES.items():
    O.reset()
    O.materials.append(
        CohFrictMat(
            young=YOUNG, poisson=RATIO, density=DENSITY, frictionAngle=0.5, momentRotationLaw=True,
            isCohesive=True, normalCohesion=1e20, shearCohesion=1e20, fragile=False, etaRoll=-1, etaTwist=-1,
            alphaKr=(R_BEAM / RADIUS)**2 / 4 / RATIO, alphaKtw=(R_BEAM / RADIUS)**2 / 2, label="a",
        )
    )
    for place in range(4):
        O.bodies.append(sphere((2 * RADIUS * place, 0, 0), RADIUS, material="a"))
    O.bodies[3].state.vel = case["velocity"]
    O.bodies[3].state.angVel = case["spin"]
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.1)]),
        InteractionLoop(
            [Ig2_Sphere_Sphere_ScGeom6D(interactionDetectionFactor=1.05)],
            [Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True, setCohesionOnNewContacts=False)],
            [Law2_ScGeom6D_CohFrictPhys_CohesionMoment(useIncrementalForm=True, always_use_moment_law=True)],
        ),
        NewtonIntegrator(gravity=(0, 0, 0), damping=case["damping"]),
    ]
    O.dt = DT
    for step in range(STEPS):
        O.step()
    bonds = []
    for i in sorted((i for i in O.interactions if i.isReal), key=lambda i: (i.id1, i.id2)):
        sign = 1 if i.id1 < i.id2 else -1
        moment = i.phys.moment_bending + i.phys.moment_twist
        bonds.append([[sign * x for x in v] for v in (i.phys.normalForce, i.phys.shearForce, moment)])
    states = [[list(b.state.pos), list(b.state.vel), list(b.state.angVel)] for b in O.bodies]
    i = next(i for i in O.interactions)
    stiffness = [i.phys.kn, i.phys.ks, i.phys.kr, i.phys.ktw]
    print("JSON " + json.dumps(dict(name=name, dt=DT, steps=STEPS, stiffness=stiffness, bonds=bonds, states=states, **case)))
