"""A step of PositionBasedDynamics: distances and dihedral angles, 10 iterations, free fall.

OMP_NUM_THREADS=THREADS python pbd.py MESH.obj
"""

import os
import sys
import time

import numpy as np
import pypbd as pbd

STEPS = 40

vertices, corners = [], []
for line in open(sys.argv[1]):
    kind, *words = line.split() or [""]
    if kind == "v":
        vertices.append(np.array([float(word) for word in words[:3]]))
    elif kind == "f":
        corners += [int(word.split("/")[0]) - 1 for word in words[:3]]

simulation = pbd.Simulation.getCurrent()
simulation.initDefault()
model = simulation.getModel()
body = model.addTriangleModel(vertices, corners, testMesh=False)
offset = body.getIndexOffset()
particles = model.getParticles()
for i in range(particles.size()):
    particles.setMass(i, 1.0)

opposite = {}
for t in range(0, len(corners), 3):
    for k in range(3):
        a, b, c = (corners[t + (k + i) % 3] for i in range(3))
        opposite.setdefault((min(a, b), max(a, b)), []).append(c)
edges = sum(model.addDistanceConstraint(a + offset, b + offset, 1.0) for a, b in opposite)
hinges = sum(
    model.addDihedralConstraint(*(v + offset for v in (*wings, *edge)), 0.5)
    for edge, wings in opposite.items()
)

step = simulation.getTimeStep()
step.setValueUInt(pbd.TimeStepController.NUM_SUB_STEPS, 1)
step.setValueUInt(pbd.TimeStepController.MAX_ITERATIONS, 10)
pbd.TimeManager.getCurrent().setTimeStepSize(1 / 60)
times = []
for _ in range(STEPS):
    start = time.perf_counter()
    step.step(model)
    times.append(1e3 * (time.perf_counter() - start))
threads = os.environ.get("OMP_NUM_THREADS", "all")
counts = f"{edges} edges, {hinges} hinges, {threads} threads"
print(f"PositionBasedDynamics, {counts}: {min(times):.3f} ms")
sys.stdout.flush()
# Without destructors, which need an order of their own.
os._exit(0)
