# SPDX-License-Identifier: GPL-3.0-or-later
"""Images: files, filters by partial differential equations, segmentation."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Mapping, NamedTuple, Sequence, Union

import numpy as np

from . import _native

Point = Sequence[float]
Identity = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass
class Image:
    """An array of two or three dimensions, [j, i] or [k, j, i], and where it lies.

    >>> image = Image(np.zeros((4, 3, 2)), spacing=(1, 1, 2))
    >>> image.shape
    (4, 3, 2)
    """

    array: np.ndarray
    spacing: Point = (1.0, 1.0, 1.0)  #: mm between voxel centres along x, y, z (the last index is x)
    origin: Point = (0.0, 0.0, 0.0)  #: LPS mm of the first voxel's centre
    direction: Sequence[Point] = field(default=Identity)  #: columns: unit directions of the three axes

    @property
    def shape(self) -> tuple[int, ...]:
        return np.shape(self.array)

    def write(self, path: Union[str, os.PathLike]) -> None:
        """Writes .nii, .nii.gz, .nrrd, .mha or .mhd: whole numbers of 8 and 16 bits as they are, others as float32."""
        _native.write_image(os.fspath(path), np.asarray(self.array), _geometry(self))

    def like(self, array: np.ndarray) -> Image:
        """Another array in the same place."""
        return Image(array, self.spacing, self.origin, self.direction)


Pixels = Union[Image, np.ndarray]


def _image(pixels: Pixels) -> Image:
    return pixels if isinstance(pixels, Image) else Image(np.asarray(pixels))


def _geometry(image: Image) -> Any:
    return _native.Geometry(tuple(image.spacing), tuple(image.origin), tuple(map(tuple, image.direction)))


def _result(given: Pixels, array: np.ndarray) -> Any:
    """An Image for an Image, an array of the given shape for an array."""
    array = array.reshape(_image(given).shape)
    return given.like(array) if isinstance(given, Image) else array


def read_image(path: Union[str, os.PathLike]) -> Image:
    """Any image of grey values as float32: NIfTI, NRRD, MetaImage, 2D or 3D."""
    return Image(*_native.read_image(os.fspath(path)))


def read_ct(path: Union[str, os.PathLike]) -> Image:
    """A CT in Hounsfield units (int16): a file, or a folder with one DICOM series."""
    return Image(*_native.read_ct(os.fspath(path)))


def read_labels(path: Union[str, os.PathLike], preset: str = "heartgen", names: str = "") -> Image:
    """A label map with heartgen's tags (region_tags): a file, or a folder with one mask per structure.

    preset: what values and names mean, such as "totalsegmentator"; names: a table of them (.csv or .json).
    """
    image, _ = _native.read_labels(os.fspath(path), preset, os.fspath(names))
    return Image(*image)


def region_tags() -> dict[str, int]:
    """Tags of the regions of a label map.

    >>> region_tags()["lv_blood"]
    6
    """
    return dict(_native.regions)


def filters() -> dict[str, str]:
    """Names of the filters with what they do.

    >>> "perona_malik" in filters()
    True
    """
    return {name: f"{text}: {equation}" for name, text, equation, _ in _native.filters()}


def filter(pixels: Pixels, name: str, **parameters: float) -> Any:
    """An image after a filter, in float32; see filters(), and `heartgen filter --help` for the parameters.

    >>> smooth = filter(np.eye(8), "heat", iterations=2)
    >>> smooth.shape, bool(smooth.max() < 1)
    ((8, 8), True)
    """
    image = _image(pixels)
    return _result(pixels, _native.apply_filter(name, image.array, _geometry(image), parameters))


class ChanVese(NamedTuple):
    above: Any  #: 1 on the brighter side, else 0: as the image was given
    c_below: float  #: median (l1) or mean (l2) of each side
    c_above: float
    iterations: int
    converged: bool
    energy: float  #: mm3


def chan_vese(
    pixels: Pixels,
    domain: Union[np.ndarray, None] = None,
    norm: str = "l1",
    fidelity: float = 1.0,
    mu: float = 0.1,
    max_iterations: int = 100,
) -> ChanVese:
    """The two-phase Chan-Vese segmentation of an image, within a mask where one is given.

    mu is a length in mm at a fidelity (lambda) of 1: balls of a radius below 3 mu vanish, discs below 2 mu.

    >>> found = chan_vese(np.pad(np.full((10, 10), 5.0), 5), mu=0.2)
    >>> int(found.above.sum()), found.c_below, found.c_above
    (100, 0.0, 5.0)
    """
    image = _image(pixels)
    if domain is None:
        domain = np.ones(image.shape, np.uint8)
    above, *rest = _native.chan_vese(image.array, domain, _geometry(image), norm, fidelity, mu, max_iterations)
    return ChanVese(_result(pixels, above), *rest)


class Side(NamedTuple):
    mask: Any  #: 1 on this side of the split, else 0
    value: float  #: median or mean grey value


def segment(pixels: Pixels, steps: Sequence[Mapping[str, Any]]) -> dict[str, Side]:
    """A tree of two-phase splits: each step divides "all" or a side of an earlier one, such as "body.above".

    >>> sides = segment(np.pad(np.full((9, 9), 5.0), 4), [{"name": "square", "mu": 0.1}])
    >>> int(sides["square.above"].mask.sum())
    81
    """
    image = _image(pixels)
    sides = _native.segment(image.array, _geometry(image), [dict(step) for step in steps])
    return {name: Side(_result(pixels, mask), value) for name, (mask, value) in sides.items()}


class Contour(NamedTuple):
    level_set: Any  #: mm, negative inside
    end: str  #: how it ended: "settled" where all went well
    iterations: int


def contour(
    pixels: Pixels,
    seeds: Sequence[Point],
    radius_mm: float = 5.0,
    model: str = "geodesic",
    curvature_mm: float = 1.0,
    attraction_mm: float = 1.0,
    balloon: float = 0.0,
    smoothing_mm: float = 1.0,
    edge_per_mm: float = 0.0,
    max_iterations: int = 5000,
) -> Contour:
    """A geodesic or geometric active contour that starts as balls around seeds (LPS mm) and stops at edges.

    edge_per_mm: the slope of an edge in grey values per mm; 0: from the image.
    """
    image = _image(pixels)
    level_set, end, iterations = _native.contour(
        image.array,
        _geometry(image),
        [tuple(seed) for seed in seeds],
        radius_mm,
        model,
        curvature_mm,
        attraction_mm,
        balloon,
        smoothing_mm,
        edge_per_mm,
        max_iterations,
    )
    return Contour(_result(pixels, level_set), end, iterations)


def subjective_surface(
    pixels: Pixels,
    seeds: Sequence[Point],
    share: float = 0.5,
    smoothing_mm: float = 1.0,
    edge_per_mm: float = 0.0,
    max_iterations: int = 20000,
) -> Any:
    """The object around seeds (LPS mm) as a mask: edges with gaps are completed."""
    image = _image(pixels)
    mask, _, _ = _native.subjective_surface(
        image.array, _geometry(image), [tuple(seed) for seed in seeds], share, smoothing_mm, edge_per_mm, max_iterations
    )
    return _result(pixels, mask)


def distance(level_set: Pixels) -> Any:
    """The signed distance (mm, negative inside) to where a function changes its sign.

    >>> bool(abs(distance(np.linspace(-3, 3, 8)[None, :].repeat(8, 0))[4, 0] + 3.5) < 0.1)
    True
    """
    image = _image(level_set)
    return _result(level_set, _native.distance(image.array, _geometry(image)))


class Landmarks(NamedTuple):
    json: str  #: seeds, valve planes and apex, as `heartgen landmarks` writes them
    confidence: float  #: 0 to 1; below 0.5 it can hardly be a heart
    warnings: list[str]


def find_landmarks(ct: Image) -> Landmarks:
    """Chambers, valves and the long axis in a contrast-enhanced CT (read_ct)."""
    return Landmarks(*_native.find_landmarks(ct.array, _geometry(ct)))
