# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes: of label maps, of files, better ones, their fibres, and other programs' formats."""

from __future__ import annotations

import os
from typing import Any, NamedTuple, Optional, Sequence, Union

import numpy as np

from . import _native
from .images import Image, Landmarks, Pixels, _geometry, _image

Path = Union[str, os.PathLike]


class Row(NamedTuple):
    """What was measured of a mesh, and how it lies against its bounds."""

    scope: str  #: mesh, region or surface
    metric: str
    value: float
    unit: str
    verdict: str  #: "told" (it has no bounds), "passed", "warned" or "failed"


class Mesh:
    """Tetrahedra with regions, labelled faces and fibres. Arrays show the mesh's own memory.

    >>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> mesh = Mesh(points, [[0, 1, 2, 3]])
    >>> mesh.cells.shape, mesh.regions.tolist(), mesh.fiber is None
    ((1, 4), [1], True)
    """

    def __init__(self, points: Any, cells: Any = None, regions: Any = None, name: str = "mesh") -> None:
        self.name = name
        if isinstance(points, _native.TetMesh):
            self._native = points
            return
        regions = np.ones(len(cells), np.int32) if regions is None else regions
        self._native = _native.TetMesh(np.asarray(points), np.asarray(cells), np.asarray(regions))

    def __repr__(self) -> str:
        return f"<heartgen.Mesh {self.name}: {len(self.points)} points, {len(self.cells)} cells>"

    @property
    def points(self) -> np.ndarray:
        """(n, 3) LPS mm."""
        return self._native.points

    @property
    def cells(self) -> np.ndarray:
        """(m, 4) point ids; positively oriented."""
        return self._native.cells

    @property
    def regions(self) -> np.ndarray:
        """(m,) tag of each cell's region; region_names has their names."""
        return self._native.regions

    @property
    def region_names(self) -> dict[str, int]:
        return self._native.region_names

    @property
    def faces(self) -> Optional[np.ndarray]:
        """(f, 3) point ids of the outer boundary and of interfaces, each face once."""
        return self._native.faces

    @property
    def face_tags(self) -> Optional[np.ndarray]:
        """(f,) tag of each face's surface; surface_names has their names."""
        return self._native.face_tags

    @property
    def surface_names(self) -> dict[str, int]:
        return self._native.surface_names

    def surface(self, name: str) -> np.ndarray:
        """(s, 3) point ids of one surface, such as "epicardium"."""
        if name not in self.surface_names:
            raise KeyError(f"no surface {name!r}; there are {', '.join(self.surface_names)}")
        return self.faces[self.face_tags == self.surface_names[name]]

    @property
    def rims(self) -> dict[str, np.ndarray]:
        """Point ids of the curves where surfaces end, by name."""
        return self._native.rims

    @property
    def fiber(self) -> Optional[np.ndarray]:
        """(n, 3) unit axes on points, zero where there is no muscle; None without fibres. Signs mean nothing."""
        return self._native.fiber

    @property
    def sheet(self) -> Optional[np.ndarray]:
        return self._native.sheet

    @property
    def sheet_normal(self) -> Optional[np.ndarray]:
        return self._native.sheet_normal

    @property
    def cell_fiber(self) -> Optional[np.ndarray]:
        """(m, 3) unit axes on cells, or None."""
        return self._native.cell_fiber

    @property
    def cell_sheet(self) -> Optional[np.ndarray]:
        return self._native.cell_sheet

    @property
    def cell_sheet_normal(self) -> Optional[np.ndarray]:
        return self._native.cell_sheet_normal

    @property
    def fiber_source(self) -> Optional[np.ndarray]:
        """(n,) 0 none, 1 atlas, 2 inpainted, 3 rule."""
        return self._native.fiber_source

    def only(self, *regions: str) -> Mesh:
        """The cells of some regions: names, or "ventricles", "atria", "walls", "blood"."""
        return Mesh(_native.only_regions(self._native, list(regions)), name=self.name)

    def check(self) -> list[Row]:
        """Quality and validity, with bounds that solvers get on with."""
        verdicts = ("told", "passed", "warned", "failed")
        return [
            Row(scope, metric, value, unit, verdicts[verdict])
            for scope, metric, value, unit, verdict in _native.check_mesh(self._native, self.name)
        ]

    def write(self, path: Path) -> list[str]:
        """Writes .vtu, .vtk or .msh, with labelled faces and curves beside it. Returns the files."""
        return [os.fspath(file) for file in _native.write_mesh(os.fspath(path), self._native)]

    def export(self, format: str, folder: Path, unit: str = "") -> list[str]:
        """Writes the files of another program, see formats(). Returns them."""
        files = _native.export_mesh(format, self._native, self.name, os.fspath(folder), unit)
        return [os.fspath(file) for file in files]

    def _axes(self, on: str) -> dict[str, np.ndarray]:
        names = ("fiber", "sheet", "sheet_normal")
        found = {name: getattr(self, on + name) for name in names}
        return {name: axes for name, axes in found.items() if axes is not None}

    def to_meshio(self) -> Any:
        """A meshio.Mesh: tetrahedra and labelled triangles with "region", fibres on points and tetrahedra."""
        import meshio

        blocks = [("tetra", self.cells)]
        data = {"region": [self.regions]}
        axes = self._axes("cell_")
        for name, values in axes.items():
            data[name] = [values]
        if self.faces is not None:
            blocks.append(("triangle", self.faces))
            data["region"].append(self.face_tags)
            for name in axes:
                data[name].append(np.zeros((len(self.faces), 3)))
        return meshio.Mesh(self.points, blocks, point_data=self._axes(""), cell_data=data)

    def to_vtk(self) -> Any:
        """A vtkUnstructuredGrid that shows this mesh's points and arrays (it keeps the mesh)."""
        from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import VTK_TETRA, vtkCellArray, vtkUnstructuredGrid

        grid, points, cells = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
        points.SetData(numpy_to_vtk(self.points))
        ids = np.ascontiguousarray(self.cells, np.int64)
        offsets = np.arange(0, ids.size + 1, 4)
        cells.SetData(numpy_to_vtkIdTypeArray(offsets, 1), numpy_to_vtkIdTypeArray(ids.ravel(), 1))
        grid.SetPoints(points)
        grid.SetCells(VTK_TETRA, cells)
        for data, arrays in ((grid.GetPointData(), self._axes("")), (grid.GetCellData(), self._axes("cell_"))):
            for name, values in arrays.items():
                array = numpy_to_vtk(values)
                array.SetName(name)
                data.AddArray(array)
        regions = numpy_to_vtk(self.regions)
        regions.SetName("region")
        grid.GetCellData().AddArray(regions)
        grid.heartgen_mesh = self
        return grid

    def to_pyvista(self) -> Any:
        """A pyvista.UnstructuredGrid with "region" and fibres."""
        import pyvista

        return pyvista.wrap(self.to_vtk())

    def to_dolfinx(self, comm: Any = None, scale: float = 1.0) -> tuple[Any, Any, Any]:
        """dolfinx's mesh, the tags of its cells (regions) and of its facets (surfaces), on one process.

        scale: 0.1 gives centimetres. Where dolfinx put cells and points: mesh.topology.original_cell_index and
        mesh.geometry.input_global_indices.
        """
        import dolfinx
        import ufl
        from mpi4py import MPI

        element = ufl.VectorElement("Lagrange", ufl.tetrahedron, 1)
        cells = np.ascontiguousarray(self.cells, np.int64)
        mesh = dolfinx.mesh.create_mesh(comm or MPI.COMM_SELF, cells, scale * self.points, ufl.Mesh(element))
        order = np.asarray(mesh.topology.original_cell_index)
        here = np.arange(len(order), dtype=np.int32)
        cell_tags = dolfinx.mesh.meshtags(mesh, 3, here, np.ascontiguousarray(self.regions[order]))
        return mesh, cell_tags, self._facet_tags(mesh)

    def _facet_tags(self, mesh: Any) -> Any:
        import dolfinx

        mesh.topology.create_connectivity(2, 0)
        mesh.topology.create_connectivity(0, 2)
        if self.faces is None:
            return dolfinx.mesh.meshtags(mesh, 2, np.empty(0, np.int32), np.empty(0, np.int32))
        entities = np.ascontiguousarray(self.faces, np.int64)
        own = getattr(mesh, "_cpp_object", None) or getattr(mesh, "_mesh", mesh)  # from 0.6 on; 0.5
        local, values = dolfinx.cpp.io.distribute_entity_data(own, 2, entities, self.face_tags)
        return dolfinx.mesh.meshtags_from_entities(mesh, 2, dolfinx.cpp.graph.AdjacencyList_int32(local), values)


def read_mesh(path: Path, region: str = "", unit: str = "") -> Mesh:
    """Anybody's mesh: .vtu, .vtk, .msh, openCARP's .pts, TetGen's .node, Medit's .mesh.

    region: the array of its regions (default: a known name); unit: mm, um, cm or m (default: the format's).
    """
    mesh, name, _ = _native.read_mesh(os.fspath(path), region, unit)
    return Mesh(mesh, name=name)


def mesh_labels(labels: Pixels, edge_mm: Optional[float] = None, walls: bool = False, **settings: Any) -> Mesh:
    """The mesh of a label map with heartgen's tags (region_tags).

    edge_mm: edge length in the walls of the heart. settings: those of [mesh] in a recipe, such as blood_edge_mm or
    backend. walls: the walls of the heart alone.

    >>> k, j, i = np.mgrid[-9:10, -9:10, -9:10]
    >>> ball = np.where(k**2 + j**2 + i**2 < 49, 1, 17).astype(np.uint8)
    >>> mesh = mesh_labels(ball, edge_mm=3, torso_edge_mm=5)
    >>> sorted(mesh.region_names), mesh.surface("epicardium").shape[1]
    (['lv_myocardium', 'torso'], 3)
    """
    image = _image(labels)
    if edge_mm is not None:
        settings["heart_edge_mm"] = edge_mm
    return Mesh(_native.mesh_labels(image.array, _geometry(image), settings, walls), name="labels")


def improve(mesh: Mesh, goal_deg: float = 20.0, slide_mm: float = 0.0, budget: int = 10_000_000) -> Mesh:
    """A mesh with better angles; regions, surfaces and fibres stay.

    slide_mm: how far surfaces may come off the given ones; 0: their points and faces stay.
    """
    return Mesh(_native.improve(mesh._native, goal_deg, slide_mm, budget), name=mesh.name)


def map_fibers(
    mesh: Mesh,
    labels: Image,
    landmarks: Union[Landmarks, str, Path],
    atlas: Path = "",
    atlas_array: str = "",
    **settings: Any,
) -> Mesh:
    """The mesh of the walls with fibres of an atlas (default: the built-in stand-in), by registration.

    labels: the label map that the mesh is of; landmarks: find_landmarks, or a file. settings: those of [fibers] in a
    recipe, such as method.
    """
    if isinstance(landmarks, Landmarks):
        text = landmarks.json
    else:
        with open(landmarks, encoding="utf-8") as file:
            text = file.read()
    mapped, *_ = _native.map_fibers(
        mesh._native, labels.array, _geometry(labels), text, os.fspath(atlas), atlas_array, settings
    )
    return Mesh(mapped, name=mesh.name)


def transfer(source: Mesh, onto: Mesh, reach_mm: float = 5.0) -> Mesh:
    """Another mesh of the same heart, with the fibres of the source; zero farther than reach_mm from it."""
    return Mesh(_native.transfer(source._native, onto._native, reach_mm), name=onto.name)


def formats() -> dict[str, str]:
    """Names of the formats of export, with what reads them.

    >>> "opencarp" in formats()
    True
    """
    return {name: text for name, text, _ in _native.formats}


def export(meshes: Union[Mesh, Sequence[Mesh]], format: str, folder: Path, unit: str = "") -> list[str]:
    """Writes meshes for another program. Returns the files."""
    meshes = [meshes] if isinstance(meshes, Mesh) else meshes
    return [file for mesh in meshes for file in mesh.export(format, folder, unit)]
