#!/usr/bin/python3
"""Potential of a torso while a front stands in the ventricles, with dolfinx.

    python3 {{mesh}}_potential.py            or on two processes: mpirun -n 2 python3 {{mesh}}_potential.py

div((s_i + s_e) grad phi) = -div(s_i grad v): v is the transmembrane potential, 100 mV within 30 mm of the middle of the
septum. Conductivities are per region, in muscle along and across the fibres. Writes {{mesh}}_potential.xdmf (mV).
"""
import os

import h5py
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.io import XDMFFile
from mpi4py import MPI
from petsc4py import PETSc

here = os.path.dirname(os.path.abspath(__file__))
name = os.path.join(here, "{{mesh}}")
mm = {{mm}}  # one millimetre in the mesh's unit
site = np.array([{{x}}, {{y}}, {{z}}])
# Intracellular and extracellular, along and across, S/m: Clerc, J Physiol 255:335 (1976).
i_along, i_across, e_along, e_across = 0.17, 0.019, 0.62, 0.24
ventricles = [{{ventricles}}]
# S/m at 10 Hz: Gabriel et al., Phys Med Biol 41:2271 (1996).
passive = {
{{python_conductivities}}}

comm = MPI.COMM_WORLD
with XDMFFile(comm, name + ".xdmf", "r") as file:
    domain = file.read_mesh(name="mesh")
    regions = file.read_meshtags(domain, name="mesh")

# The file's order of cells is not dolfinx's.
order = np.asarray(domain.topology.original_cell_index)
with h5py.File(name + ".h5", "r") as file:
    axes = file["cells/fiber"][()][order]
    region = file["mesh/cell_tags"][()][order]
fiber = fem.Function(fem.VectorFunctionSpace(domain, ("DG", 0)))
scalars = fem.FunctionSpace(domain, ("DG", 0))
cell_dofs = scalars.dofmap.list.array
fiber.x.array.reshape(-1, 3)[cell_dofs] = axes[: len(cell_dofs)]


def per_cell(values):
    function = fem.Function(scalars)
    function.x.array[cell_dofs] = values[: len(cell_dofs)]
    return function


muscle = np.linalg.norm(axes, axis=1) > 0.5
bath = np.array([passive.get(int(tag), 0.2) for tag in region])
active = np.isin(region, ventricles)
intra = per_cell(np.where(active, i_across, 0)) * ufl.Identity(3) + per_cell(np.where(active, i_along - i_across, 0)) * ufl.outer(fiber, fiber)
both_across, both_along = i_across + e_across, i_along + e_along
both = per_cell(np.where(muscle, both_across, bath)) * ufl.Identity(3) + per_cell(np.where(muscle, both_along - both_across, 0)) * ufl.outer(fiber, fiber)

space = fem.FunctionSpace(domain, ("CG", 1))
v = fem.Function(space)
v.interpolate(lambda x: 50 * (1 - np.tanh((np.linalg.norm(x.T - site, axis=1) - 30 * mm) / (3 * mm))))
u, w = ufl.TrialFunction(space), ufl.TestFunction(space)
a = fem.form(ufl.inner(both * ufl.grad(u), ufl.grad(w)) * ufl.dx)
L = fem.form(-ufl.inner(intra * ufl.grad(v), ufl.grad(w)) * ufl.dx)
A = fem.petsc.assemble_matrix(a)
A.assemble()
b = fem.petsc.assemble_vector(L)
b.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
constants = PETSc.NullSpace().create(constant=True, comm=comm)
A.setNullSpace(constants)
A.setNearNullSpace(constants)
constants.remove(b)
solver = PETSc.KSP().create(comm)
solver.setOperators(A)
solver.setType("cg")
solver.getPC().setType("gamg")
solver.setTolerances(rtol=1e-8, max_it=2000)
phi = fem.Function(space)
solver.solve(b, phi.vector)
phi.x.scatter_forward()
low, high = comm.allreduce(phi.x.array.min(), MPI.MIN), comm.allreduce(phi.x.array.max(), MPI.MAX)
if comm.rank == 0:
    print(f"{solver.getIterationNumber()} iterations, converged: {solver.getConvergedReason() > 0}")
    print(f"potential from {low:.2f} to {high:.2f} mV")
phi.name = "potential_mV"
with XDMFFile(comm, name + "_potential.xdmf", "w") as file:
    file.write_mesh(domain)
    file.write_function(phi)
if solver.getConvergedReason() <= 0 or not np.isfinite(low + high):
    raise SystemExit("no solution")
