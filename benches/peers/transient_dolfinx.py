"""A forward transient by FEniCSx (dolfinx), as a user would write it: for comparison with `nastic solve` on benches/peers/transient.json.

A bar of 1 x 0.1 x 0.1 m, clamped at x = 0, falls under its weight from rest: Mooney-Rivlin, backward Euler, consistent mass, quadratic
hexahedra (20 x 2 x 2), full Newton with a sparse LU factorisation by MUMPS in every iteration, to a residual of 1e-8 of the first of each step.

    OMP_NUM_THREADS=1 python3 transient_dolfinx.py [steps]

prints one JSON object: seconds per step (without compiling the forms), Newton iterations, the displacement of the end.
"""

import json
import sys
import time

import dolfinx.fem.petsc as petsc
import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc

MU1, MU2, MU3, DENSITY, GRAVITY, STEP = 50e3, 20e3, 200e3, 1000.0, 9.81, 5e-3
STEPS = int(sys.argv[1]) if len(sys.argv) > 1 else 40

domain = mesh.create_box(MPI.COMM_WORLD, [[0, 0, 0], [1, 0.1, 0.1]], [20, 2, 2], mesh.CellType.hexahedron)
space = fem.functionspace(domain, ("Lagrange", 2, (3,)))
dx = ufl.Measure("dx", domain=domain, metadata={"quadrature_degree": 5})
u, before, velocity = fem.Function(space), fem.Function(space), fem.Function(space)
test, trial = ufl.TestFunction(space), ufl.TrialFunction(space)

F = ufl.Identity(3) + ufl.grad(u)
C, J = F.T * F, ufl.det(F)
cofactor = 0.5 * (ufl.tr(C) ** 2 - ufl.inner(C, C))
stored = MU1 * ufl.tr(C) + MU2 * cofactor + MU3 * (J - 1) ** 2 - 2 * (MU1 + 2 * MU2) * ufl.ln(J)
weight = DENSITY * ufl.as_vector((0, 0, -GRAVITY))
inertia = DENSITY / STEP**2 * ufl.inner(u - before - STEP * velocity, test) * dx
residual = ufl.derivative(stored * dx, u, test) + inertia - ufl.inner(weight, test) * dx
tangent = ufl.derivative(residual, u, trial)
residual, tangent = fem.form(residual), fem.form(tangent)

held = mesh.locate_entities_boundary(domain, 2, lambda x: np.isclose(x[0], 0))
clamp = fem.dirichletbc(np.zeros(3), fem.locate_dofs_topological(space, 2, held), space)
fixed = clamp.dof_indices()[0]
matrix, vector = petsc.create_matrix(tangent), petsc.create_vector(space)
change = vector.duplicate()
solver = PETSc.KSP().create(domain.comm)
solver.setOperators(matrix)
solver.setType("preonly")
solver.getPC().setType("lu")
solver.getPC().setFactorSolverType("mumps")


def assembled_residual():
    with vector.localForm() as local:
        local.set(0)
    petsc.assemble_vector(vector, residual)
    vector.array[fixed] = 0
    return vector.norm()


def advance():
    first, count = None, 0
    while True:
        size = assembled_residual()
        first = first or size
        if size <= 1e-8 * first:
            return count
        matrix.zeroEntries()
        petsc.assemble_matrix(matrix, tangent, bcs=[clamp])
        matrix.assemble()
        solver.setOperators(matrix)
        solver.solve(vector, change)
        u.x.array[:] -= change.array
        count += 1


newton = 0
began = time.perf_counter()
for _ in range(STEPS):
    before.x.array[:] = u.x.array
    newton += advance()
    velocity.x.array[:] = (u.x.array - before.x.array) / STEP
seconds = time.perf_counter() - began
places = space.tabulate_dof_coordinates()
end = int(np.argmin(np.linalg.norm(places - [1, 0.05, 0.05], axis=1)))
print(json.dumps({
    "unknowns": len(u.x.array), "steps": STEPS, "newton": newton, "seconds_per_step": seconds / STEPS,
    "end": u.x.array[3 * end:3 * end + 3].tolist(),
}))
