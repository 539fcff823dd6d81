# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # You have a scan
# A contrast-enhanced CT, or a segmentation of it. Here a phantom stands in for the patient:
# `python3 2_a_scan.py FOLDER`.

# %%
import os
import sys

import heartgen

folder = sys.argv[1] if len(sys.argv) > 1 else "scan"
recipe = heartgen.phantom(os.path.join(folder, "phantom"), size=(64, 64, 48), spacing=(5.4, 5.4, 6.3))

# %% [markdown]
# The build tells of its stages. Settings are those of a recipe, by section; this phantom is coarse, and so is its mesh.

# %%
stages = []


def tell(stage: str, share: float, has_ended: bool) -> None:
    if has_ended:
        stages.append(stage)
        print(f"{100 * share:3.0f} %  {stage}")


bundle = heartgen.build(
    recipe,
    output=os.path.join(folder, "bundle"),
    replace=True,
    progress=tell,
    settings={
        "name": "tutorial",
        "mesh": {"heart_edge_mm": 6.0, "meshes": ["myocardium"]},
        "fibers": {"grid_mm": 4.0, "depth_grid_mm": 2.5, "demons_iterations": [4, 2, 1]},
    },
)
assert stages[0] == "read" and stages[-1] == "bundle"
print(bundle)

# %% [markdown]
# The label map lies on the CT's grid; the certificate can be measured again at any time.

# %%
ct = heartgen.read_ct(os.path.join(folder, "phantom", "ct.nii.gz"))
assert bundle.labels.shape == ct.shape
blood = bundle.labels.array == heartgen.region_tags()["lv_blood"]
print(f"blood of the left ventricle: {ct.array[blood].mean():.0f} HU")
certificate = heartgen.validate(bundle)
print(certificate)
assert certificate.value("dihedral_min", "myocardium") == bundle.certificate.value("dihedral_min", "myocardium")

# %% [markdown]
# A mistake is an `heartgen.Error` that says what to do.

# %%
try:
    heartgen.build(ct="missing.nii.gz", output=os.path.join(folder, "other"))
except heartgen.Error as error:
    print(f"{error.where}: {error.problem} ({error.remedy})")
else:
    raise AssertionError("a missing CT was taken")
