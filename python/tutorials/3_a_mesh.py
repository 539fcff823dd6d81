# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # You have a label map or a mesh
# `python3 3_a_mesh.py FOLDER`.

# %%
import os
import sys

import numpy as np

import heartgen

folder = sys.argv[1] if len(sys.argv) > 1 else "mesh"
os.makedirs(folder, exist_ok=True)

# %% [markdown]
# An array of tags becomes a conforming mesh. Each face between regions is there once, with the name of its surface.

# %%
tags = heartgen.region_tags()
k, j, i = np.mgrid[-15:16, -15:16, -15:16]
radius = np.sqrt(k**2 + j**2 + i**2)
labels = np.full(radius.shape, tags["torso"], np.uint8)
labels[radius < 12] = tags["lv_myocardium"]
labels[radius < 8] = tags["lv_blood"]
mesh = heartgen.mesh_labels(labels, edge_mm=2.5, blood_edge_mm=4, torso_edge_mm=8)
print(mesh, mesh.region_names, mesh.surface_names)
assert not [row for row in mesh.check() if row.verdict == "failed"]

# %% [markdown]
# Any mesh can be written, read, improved. Here points are pushed about first.

# %%
generator = np.random.default_rng(1)
on_surface = np.unique(mesh.faces)
points = mesh.points.copy()
inside = np.setdiff1d(np.arange(len(points)), on_surface)
points[inside] += generator.uniform(-0.4, 0.4, (len(inside), 3))
rough = heartgen.Mesh(points, mesh.cells, mesh.regions, name="rough")
better = heartgen.improve(rough, goal_deg=20)


def smallest_angle(one: heartgen.Mesh) -> float:
    return next(row.value for row in one.check() if row.metric == "dihedral_min" and "/" not in row.scope)


print(f"smallest dihedral angle: {smallest_angle(rough):.1f} degrees, then {smallest_angle(better):.1f}")
assert smallest_angle(better) >= smallest_angle(rough)
files = better.write(os.path.join(folder, "better.vtu"))
again = heartgen.read_mesh(files[0])
assert np.array_equal(again.points, better.points)

# %% [markdown]
# Regions by name, and files for another program with a README and an input.

# %%
wall = mesh.only("walls")
print(wall, "for gmsh:", heartgen.export(wall, "msh", folder))
