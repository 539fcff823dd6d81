# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # You have an image
# The filters and segmentations of the thesis on arrays, in two and three dimensions: `python3 4_an_image.py FOLDER`.

# %%
import os
import sys

import numpy as np

import heartgen

folder = sys.argv[1] if len(sys.argv) > 1 else "image"
os.makedirs(folder, exist_ok=True)
generator = np.random.default_rng(7)
j, i = np.mgrid[-64:64, -64:64]
disc = np.hypot(i, j) < 40
picture = (100 * disc + generator.normal(0, 30, disc.shape)).astype(np.float32)

# %% [markdown]
# Every filter by its name; `heartgen filter --help` has the parameters.

# %%
for name, text in heartgen.filters().items():
    print(f"{name}: {text}")
smooth = heartgen.filter(picture, "perona_malik", iterations=20)
quiet = heartgen.filter(picture, "tv_l2", iterations=100)
assert smooth[disc].std() < picture[disc].std() and quiet[disc].std() < picture[disc].std()

# %% [markdown]
# Chan-Vese finds the disc in its noise. `mu` weighs the contour's length in mm.

# %%
found = heartgen.chan_vese(picture, mu=2)
dice = 2 * (found.above * disc).sum() / (found.above.sum() + disc.sum())
print(f"Dice {dice:.3f}; grey values {found.c_below:.0f} and {found.c_above:.0f}")
assert dice > 0.98

# %% [markdown]
# Contours start at seeds, in LPS mm. An `Image` knows where its array lies.

# %%
image = heartgen.Image(picture, spacing=(0.5, 0.5, 1.0))
contour = heartgen.contour(image, seeds=[(32, 32, 0)], radius_mm=10, balloon=1, smoothing_mm=1)
inside = contour.level_set.array < 0
print(f"{contour.end} after {contour.iterations} steps: {inside.sum() / 4:.0f} mm2 of {disc.sum() / 4:.0f}")
bridged = heartgen.subjective_surface(image, seeds=[(32, 32, 0)])
bridged.write(os.path.join(folder, "object.nii.gz"))
assert heartgen.read_image(os.path.join(folder, "object.nii.gz")).array.sum() == bridged.array.sum()
