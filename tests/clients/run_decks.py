#!/usr/bin/python3
"""Runs the decks of exported meshes, as their READMEs say, in the programs that are installed.

usage: run_decks.py EXPORTS [BUNDLE]

EXPORTS holds a folder per format, and outer/ what was written with --no-interfaces. dolfinx on one and two processes,
FreeFEM, OpenFOAM's checkMesh, CalculiX, deal.II; each mesh that has the deck. Activations must agree between dolfinx
and FreeFEM, checkMesh's figures with those of BUNDLE's certificate. Exit code 0: all ran; 1: not so; 77: none of the
programs is installed.
"""
import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1"}
FOAM = {"WM_PROJECT_DIR": "/usr/share/openfoam"}
DEALII = r"""
#include <deal.II/grid/grid_in.h>
#include <deal.II/grid/tria.h>
#include <fstream>
#include <iostream>
#include <set>
int main(int, char** arguments) {
  dealii::Triangulation<3> mesh;
  dealii::GridIn<3> reader(mesh);
  std::ifstream file(arguments[1]);
  reader.read_msh(file);
  std::set<unsigned> materials, boundaries;
  double volume = 0;
  for (const auto& cell : mesh.active_cell_iterators()) {
    materials.insert(cell->material_id());
    volume += cell->measure();
    for (const auto f : cell->face_indices())
      if (cell->face(f)->at_boundary()) boundaries.insert(cell->face(f)->boundary_id());
  }
  std::cout << mesh.n_active_cells() << " cells, volume " << volume << ", " << materials.size() << " materials, "
            << boundaries.size() << " boundaries, lowest " << *boundaries.begin() << "\n";
}
"""
DOLFINX = r"""
import sys
import h5py, numpy as np, ufl
from dolfinx import fem
from dolfinx.io import XDMFFile
from mpi4py import MPI
base = sys.argv[1]
with XDMFFile(MPI.COMM_WORLD, base + ".xdmf", "r") as file:
    mesh = file.read_mesh(name="mesh")
    regions = file.read_meshtags(mesh, name="mesh")
mesh.topology.create_connectivity(2, 3)
with XDMFFile(MPI.COMM_WORLD, base + "_facets.xdmf", "r") as file:
    surfaces = file.read_meshtags(mesh, name="facets")
with h5py.File(base + ".h5") as file:
    nodes, cells, tags = file["mesh/geometry"][()], file["mesh/topology"][()], file["mesh/cell_tags"][()]
with h5py.File(base + "_facets.h5") as file:
    faces, labels = file["facets/topology"][()], file["facets/facet_tags"][()]
a, b, c, d = (nodes[cells[:, i]] for i in range(4))
volume = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6
a, b, c = (nodes[faces[:, i]] for i in range(3))
area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
sides = np.sort(np.concatenate([cells[:, k] for k in ([0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3])]), axis=1)
unique, count = np.unique(sides, axis=0, return_counts=True)
single = {tuple(side) for side in unique[count == 1]}
outer = np.array([tuple(face) in single for face in np.sort(faces, axis=1)])
one = fem.Constant(mesh, 1.0)
for tag in np.unique(tags):
    found = fem.assemble_scalar(fem.form(one * ufl.Measure("dx", domain=mesh, subdomain_data=regions)(int(tag))))
    assert abs(found / volume[tags == tag].sum() - 1) < 1e-9, ("volume of region", tag)
for tag in np.unique(labels):
    wanted = area[(labels == tag) & outer].sum()
    found = fem.assemble_scalar(fem.form(one * ufl.Measure("ds", domain=mesh, subdomain_data=surfaces)(int(tag))))
    assert abs(found - wanted) < 1e-9 * area.sum(), ("area of surface", tag)
own = mesh.geometry.x[mesh.geometry.dofmap.array.reshape(-1, 4)].mean(axis=1)
assert np.abs(own - nodes[cells].mean(axis=1)[mesh.topology.original_cell_index]).max() < 1e-9 * np.abs(nodes).max()
assert len(surfaces.values) == len(faces) and len(regions.values) == len(cells)
print(len(cells), "cells,", len(faces), "facets, volumes, areas and the order of cells agree")
"""
failures, ran = [], 0


def run(what, command, folder, wanted=None, environment=None):
    """The output, or None when it failed or does not hold `wanted` (a pattern)."""
    global ran
    start = time.time()
    result = subprocess.run(command, cwd=folder, env={**os.environ, **(environment or {})}, capture_output=True, text=True)
    output = result.stdout + result.stderr
    found = re.search(wanted, output) if wanted else True
    ran += 1
    if result.returncode != 0 or not found:
        failures.append(f"{what}: exit code {result.returncode}\n{output[-1500:]}")
        return None
    print(f"{what}: {found.group(0) if wanted else 'ran'}  ({time.time() - start:.0f} s)", flush=True)
    return output


def last_time(output):
    return float(re.search(r"last ([\d.]+)", output).group(1)) if output else None


def has_module(name):
    return subprocess.run(["/usr/bin/python3", "-c", f"import {name}"], capture_output=True).returncode == 0


def decks(exports, pattern):
    return [(os.path.dirname(path), os.path.basename(path)) for path in sorted(glob.glob(os.path.join(exports, pattern)))]


def run_dolfinx(exports, last):
    for path in sorted(glob.glob(os.path.join(exports, "xdmf", "*_facets.xdmf"))):
        base = path[: -len("_facets.xdmf")]
        run(f"dolfinx reads {os.path.basename(base)}", ["/usr/bin/python3", "-c", DOLFINX, base], os.path.dirname(path), r"\d+ cells, .*", ROOT)
    for folder, deck in decks(exports, "xdmf/*_activation.py"):
        for ranks in (1, 2):
            mpirun = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
            output = run(f"dolfinx, {ranks} ranks, {deck}", mpirun + ["/usr/bin/python3", deck], folder, r"earliest.*", ROOT)
            last.setdefault(deck.split("_activation")[0], []).append(last_time(output))
    for folder, deck in decks(exports, "xdmf/*_potential.py"):
        run(f"dolfinx, {deck}", ["/usr/bin/python3", deck], folder, r"\d+ iterations, converged: True\n.*", ROOT)


def run_freefem(exports, last):
    for folder, deck in decks(exports, "medit/*_activation.edp"):
        output = run(f"FreeFEM, {deck}", ["FreeFem++", "-nw", "-v", "0", deck], folder, r"earliest.*")
        last.setdefault(deck.split("_activation")[0], []).append(last_time(output))


def certificate_of(bundle):
    if bundle is None:
        return {}
    with open(os.path.join(bundle, "validation", "metrics.json"), encoding="utf-8") as stream:
        return {(row["scope"], row["metric"]): row["value"] for row in json.load(stream)["rows"]}


def run_openfoam(exports, certificate):
    """checkMesh prints six digits: its figures are the certificate's to that."""
    figures = {"non_orthogonality_max": r"non-orthogonality Max: ([\d.]+)", "non_orthogonality_mean": r"average: ([\d.]+)",
               "skewness_max": r"Max skewness = ([\d.]+)"}
    for folder in sorted(glob.glob(os.path.join(exports, "openfoam", "*", "constant"))):
        case = os.path.dirname(folder)
        name = os.path.basename(case)
        output = run(f"checkMesh, {name}", ["checkMesh", "-case", case, "-allTopology"], case, r"Mesh OK", FOAM)
        for metric, pattern in figures.items() if output and certificate else ():
            found, wanted = float(re.search(pattern, output).group(1)), certificate[name, metric]
            print(f"    {metric} {found}, the certificate has {wanted:.6g}")
            if abs(found - wanted) > 1e-5 * abs(wanted):
                failures.append(f"checkMesh, {name}: {metric} is {found}, the certificate has {wanted}")


def run_gmsh_to_foam(exports):
    """Its zones must have the names of the regions: it looks names up by number alone."""
    for path in sorted(glob.glob(os.path.join(exports, "msh2", "*.msh"))):
        name = os.path.basename(path)[: -len(".msh")]
        system = os.path.join(exports, "openfoam", name, "system")
        if not os.path.exists(system):
            continue
        with open(path, encoding="ascii") as stream:
            head = stream.read(100000)
        wanted = set(re.findall(r'^3 \d+ "(\w+)"', head, flags=re.M))
        with tempfile.TemporaryDirectory() as case:
            shutil.copytree(system, os.path.join(case, "system"))
            output = run(f"gmshToFoam, {name}", ["gmshToFoam", "-case", case, path], case, r"to cellZone", FOAM)
        zones = set(re.findall(r"to cellZone (\w+)", output or ""))
        if output and zones != wanted:
            failures.append(f"gmshToFoam, {name}: zones {sorted(zones)}, regions {sorted(wanted)}")


def run_calculix(exports):
    for folder, deck in decks(exports, "abaqus/*_inflate.inp"):
        name = deck[: -len(".inp")]
        if not run(f"CalculiX, {deck}", ["ccx", name], folder, r"Job finished"):
            continue
        with open(os.path.join(folder, name + ".dat"), encoding="ascii") as stream:
            rows = [line.split() for line in stream if len(line.split()) == 4]
        largest = max(sum(float(x) ** 2 for x in row[1:]) ** 0.5 for row in rows)
        print(f"    the endocardium moves by up to {largest:.2f}")
        if not 0 < largest < 1e3:
            failures.append(f"CalculiX, {deck}: the endocardium moves by {largest}")


def run_dealii(exports):
    patterns = ("dealii/*.msh", "outer/msh2/*.msh", "outer/msh-ascii/*.msh")
    found = [path for pattern in patterns for path in sorted(glob.glob(os.path.join(exports, pattern)))]
    meshes = [path for path in found if not path.endswith("_cells.msh")]
    with tempfile.TemporaryDirectory() as scratch:
        source, program = os.path.join(scratch, "read.cc"), os.path.join(scratch, "read")
        with open(source, "w", encoding="ascii") as stream:
            stream.write(DEALII)
        includes = ["-I/usr/lib/x86_64-linux-gnu/openmpi/include", "-I/usr/include/trilinos", "-I/usr/include/suitesparse"]
        if run("deal.II, its reader compiled", ["mpicxx", "-std=c++17", "-w", *includes, source, "-o", program, "-Wl,--copy-dt-needed-entries", "-ldeal.ii", "-ltbb"], scratch) is None:
            return
        for path in meshes:
            run(f"deal.II, {os.path.relpath(path, exports)}", [program, path], scratch, r"\d+ cells.*", ROOT)


def main(exports, bundle=None):
    last = {}
    if has_module("dolfinx"):
        run_dolfinx(exports, last)
    if shutil.which("FreeFem++"):
        run_freefem(exports, last)
    if shutil.which("checkMesh"):
        run_openfoam(exports, certificate_of(bundle))
        run_gmsh_to_foam(exports)
    if shutil.which("ccx"):
        run_calculix(exports)
    if os.path.exists("/usr/include/deal.II/grid/grid_in.h"):
        run_dealii(exports)
    for mesh, times in last.items():
        if None not in times and max(times) > 1.02 * min(times):
            failures.append(f"{mesh}: the last times of activation differ: {times} ms")
    for failure in failures:
        print("FAILED " + failure)
    print(f"{ran} runs, {len(failures)} failures")
    if not ran:
        return 77
    return 1 if failures else 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    sys.exit(main(*map(os.path.abspath, sys.argv[1:])))
