#!/usr/bin/python3
"""Activation times of the ventricles from one site at the middle of the septum, with dolfinx.

    python3 {{mesh}}_activation.py            or on two processes: mpirun -n 2 python3 {{mesh}}_activation.py

The eikonal equation grad t . V grad t = 1 with V = v_f^2 f f' + v_s^2 (1 - f f'), by the heat method (Crane et al.,
ACM Trans Graph 32:152, 2013): a front that decays with distance gives the direction in which t grows, a Poisson problem
the times. Only the ventricles conduct: the atrioventricular junction insulates. Writes {{mesh}}_activation.xdmf.
"""
import json
import os

import h5py
import numpy as np
import ufl
from dolfinx import fem, mesh as meshes
from dolfinx.io import XDMFFile
from mpi4py import MPI
from petsc4py.PETSc import InsertMode, ScalarType, ScatterMode

here = os.path.dirname(os.path.abspath(__file__))
name = os.path.join(here, "{{mesh}}")
mm = {{mm}}  # one millimetre in the mesh's unit
# Conduction velocities along and across the fibres: Kotadia et al., Arrhythm Electrophysiol Rev 9:202 (2020).
along, across = 0.6 * mm, 0.3 * mm  # per ms
site, radius = np.array([{{x}}, {{y}}, {{z}}]), {{radius}}
smoothing_ms = 20.0  # of the direction; several times the time across a tetrahedron

comm = MPI.COMM_WORLD
with XDMFFile(comm, name + ".xdmf", "r") as file:
    domain = file.read_mesh(name="mesh")
    regions = file.read_meshtags(domain, name="mesh")
with open(name + "_markers.json") as file:
    tags = json.load(file)
ventricles = [tags[r][0] for r in ("lv_myocardium", "rv_myocardium", "papillary") if r in tags]

# The file's order of cells is not dolfinx's.
order = np.asarray(domain.topology.original_cell_index)
with h5py.File(name + ".h5", "r") as file:
    axes = file["cells/fiber"][()][order]
fiber = fem.Function(fem.VectorFunctionSpace(domain, ("DG", 0)))
cell_dofs = fiber.function_space.dofmap.list.array
fiber.x.array.reshape(-1, 3)[cell_dofs] = axes[: len(cell_dofs)]
fiber.x.scatter_forward()

cells = np.sort(regions.indices[np.isin(regions.values, ventricles)])
heart = meshes.meshtags(domain, 3, cells, np.ones(len(cells), dtype=np.int32))
dx = ufl.Measure("dx", domain=domain, subdomain_data=heart)(1)
lumped = dx(metadata={"quadrature_rule": "vertex", "quadrature_degree": 1})

space = fem.FunctionSpace(domain, ("CG", 1))
points = space.tabulate_dof_coordinates()
mark = fem.Function(space)  # a process may not have the cell that makes a node of its one of the ventricles
mark.x.array[fem.locate_dofs_topological(space, 3, cells)] = 1
mark.vector.ghostUpdate(addv=InsertMode.ADD, mode=ScatterMode.REVERSE)
mark.x.scatter_forward()
inside = mark.x.array.real > 0
start = np.flatnonzero(inside & (np.linalg.norm(points - site, axis=1) <= radius)).astype(np.int32)
idle = np.flatnonzero(~inside).astype(np.int32)


def solve(a, L, at_start, solver):
    bcs = [fem.dirichletbc(ScalarType(at_start), start, space), fem.dirichletbc(ScalarType(0), idle, space)]
    options = {"ksp_type": "cg", "ksp_rtol": 1e-12, "ksp_error_if_not_converged": True, **solver}
    problem = fem.petsc.LinearProblem(a, L, bcs, petsc_options=options)
    solution = problem.solve()
    solution.x.scatter_forward()
    if comm.rank == 0:
        print(f"{problem.solver.getIterationNumber()} iterations")
    return solution


u, w = ufl.TrialFunction(space), ufl.TestFunction(space)
V = across**2 * ufl.Identity(3) + (along**2 - across**2) * ufl.outer(fiber, fiber)
zero = fem.Constant(domain, ScalarType(0))
front = solve(u * w * lumped + smoothing_ms**2 * ufl.inner(V * ufl.grad(u), ufl.grad(w)) * dx, zero * w * dx, 1, {"pc_type": "jacobi"})
slope = ufl.grad(front)
slowness = -slope / ufl.sqrt(ufl.inner(V * slope, slope) + 1e-200)
time = solve(ufl.inner(V * ufl.grad(u), ufl.grad(w)) * dx, ufl.inner(V * slowness, ufl.grad(w)) * dx, 0, {"pc_type": "gamg"})

reached = inside & (front.x.array != 0)  # pieces of muscle that nothing connects with the site stay silent
values = time.x.array[reached]
if not np.all(np.isfinite(values)):
    raise SystemExit("the times are not finite")
last = comm.allreduce(values.max() if len(values) else -np.inf, MPI.MAX)
first = comm.allreduce(values.min() if len(values) else np.inf, MPI.MIN)
silent = comm.allreduce(int(np.count_nonzero(inside & ~reached)), MPI.SUM)
if comm.rank == 0:
    if silent:
        print(f"{silent} nodes of the ventricles hang together with nothing and are not activated")
    print(f"earliest {round(first, 2) + 0:.2f} ms (the site: 0), last {last:.1f} ms at 0.6 m/s along and 0.3 m/s across the fibres")
time.x.array[~reached] = -1
time.name = "activation_ms"  # -1: not activated
with XDMFFile(comm, name + "_activation.xdmf", "w") as file:
    file.write_mesh(domain)
    file.write_function(time)
if first < -1e-6 * last:
    raise SystemExit("a point is activated before the site")
