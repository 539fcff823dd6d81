# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulation-ready heart models from a CT.

Four roads, as on the command line:

>>> import heartgen
>>> bundle = heartgen.open("bundle")                      # a bundle   # doctest: +SKIP
>>> bundle = heartgen.build(ct="ct.nii.gz", output="b")   # a scan     # doctest: +SKIP
>>> mesh = heartgen.mesh_labels(labels, edge_mm=1.5)      # a label map or a mesh   # doctest: +SKIP
>>> smooth = heartgen.filter(image, "perona_malik")       # an image   # doctest: +SKIP

Lengths are millimetres in the frame LPS: x to the patient's left, y to the back, z to the head. Arrays of images are
indexed [k, j, i]: the last index is the first axis of the image. Arrays of meshes show the mesh's own memory. Long work
runs without Python's lock. What is wrong is raised as ``heartgen.Error``, a ValueError that says what to do.
"""

from ._native import Error, set_threads, threads
from ._native import version as __version__
from .bundles import Bundle, Certificate, build, open, phantom, unpack, validate
from .images import (
    ChanVese,
    Contour,
    Image,
    Landmarks,
    Side,
    chan_vese,
    contour,
    distance,
    filter,
    filters,
    find_landmarks,
    read_ct,
    read_image,
    read_labels,
    region_tags,
    segment,
    subjective_surface,
)
from .meshes import Mesh, Row, export, formats, improve, map_fibers, mesh_labels, read_mesh, transfer

__all__ = [
    "Bundle",
    "Certificate",
    "ChanVese",
    "Contour",
    "Error",
    "Image",
    "Landmarks",
    "Mesh",
    "Row",
    "Side",
    "__version__",
    "build",
    "chan_vese",
    "contour",
    "distance",
    "export",
    "filter",
    "filters",
    "find_landmarks",
    "formats",
    "improve",
    "map_fibers",
    "mesh_labels",
    "open",
    "phantom",
    "read_ct",
    "read_image",
    "read_labels",
    "read_mesh",
    "region_tags",
    "segment",
    "set_threads",
    "subjective_surface",
    "threads",
    "transfer",
    "unpack",
    "validate",
]
