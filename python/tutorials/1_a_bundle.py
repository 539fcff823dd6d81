# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # You have a bundle
# A folder with meshes, labels, fibres and a certificate: `python3 1_a_bundle.py BUNDLE`.

# %%
import sys

import numpy as np

import heartgen

bundle = heartgen.open(sys.argv[1] if len(sys.argv) > 1 else "bundle")
print(bundle, "content id", bundle.content_id)
assert not bundle.verify(), "a file is damaged"

# %% [markdown]
# Arrays show the memory of the mesh: nothing is copied.

# %%
mesh = bundle.mesh("myocardium")
print(mesh.points.shape, mesh.cells.shape, mesh.region_names)
in_lv = mesh.cells[mesh.regions == mesh.region_names["lv_myocardium"]]
corners = mesh.points[in_lv]
volumes = np.einsum(
    "ij,ij->i", corners[:, 1] - corners[:, 0], np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 0])
)
assert (volumes > 0).all()
print(f"wall of the left ventricle: {volumes.sum() / 6000:.1f} ml")
lengths = np.linalg.norm(mesh.fiber, axis=1)
assert np.allclose(lengths[mesh.fiber_source > 0], 1)

# %% [markdown]
# A surface by its name, the curves where surfaces end, the figures of the certificate.

# %%
print(len(mesh.surface("epicardium")), "triangles of the epicardium;", ", ".join(mesh.rims))
print(bundle.certificate)
print("smallest dihedral angle:", bundle.certificate.value("dihedral_min", "myocardium"))
for use in bundle.certificate.uses:
    print(f"  {use['use']}: {use['fitness']}")

# %% [markdown]
# Other programs, in a line each.

# %%
try:
    print(mesh.to_meshio())
except ImportError as missing:
    print(missing)
print(bundle.export("opencarp", bundle.folder + ".opencarp", ["myocardium"])[0])
