#!/usr/bin/python3
"""Opens exported files with other people's readers and compares them with the bundle they came from.

usage: check_exports.py BUNDLE EXPORTS

EXPORTS holds a folder per format; the mesh is told by the file's name or its folder's. Compared: numbers of nodes, cells
and faces, cells per region and faces per surface by name, coordinates node by node (up to one factor, the unit), fibres.
Readers: VTK (required: it reads the bundle itself), gmsh, meshio, h5py.
Exit code 0: all equal; 1: a difference; 77: VTK is missing, nothing was checked.
"""
import collections
import copy
import functools
import json
import os
import re
import sys
import tempfile

try:
    import numpy as np
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError as error:
    print(f"skipped: {error}; install python3-vtk9 and python3-numpy")
    sys.exit(77)


def optional(name):
    try:
        return __import__(name)
    except ImportError:
        print(f"note: python module {name} is missing, its checks are left out")
        return None


gmsh, meshio, h5py = optional("gmsh"), optional("meshio"), optional("h5py")
checked = collections.Counter()
failures = []


def expect(condition, file, message):
    checked[file] += 1
    if not condition:
        failures.append(f"{file}: {message}")


def expect_equal(found, wanted, file, what):
    equal = found == wanted
    expect(equal, file, "" if equal else f"{what}: found {found}, the bundle has {wanted}")


def expect_same_rows(found, wanted, file, what):
    """Of two integer arrays; the message names the first row that differs."""
    found, wanted = np.asarray(found), np.asarray(wanted)
    if found.shape != wanted.shape:
        expect(False, file, f"{what}: {found.shape[0]} rows, the bundle has {wanted.shape[0]}")
        return
    unequal = np.flatnonzero((found != wanted).reshape(len(found), -1).any(axis=1))
    first = f"row {unequal[0]} is {found[unequal[0]]}, the bundle has {wanted[unequal[0]]}" if len(unequal) else ""
    expect(len(unequal) == 0, file, f"{what}: {len(unequal)} rows differ; {first}")


def face_keys(faces, node_count):
    """One number per face, whatever the order of its nodes."""
    a, b, c = np.sort(np.asarray(faces, np.int64), axis=1).T
    return (a * node_count + b) * node_count + c


def expect_close(found, wanted, file, what, tolerance=1e-12):
    found, wanted = np.asarray(found, float), np.asarray(wanted, float)
    if found.shape != wanted.shape:
        expect(False, file, f"{what}: shape {found.shape}, the bundle has {wanted.shape}")
        return
    worst = np.abs(found - wanted).max() if wanted.size else 0
    expect(worst <= tolerance, file, f"{what}: differs by {worst}")


def arrays_of(data):
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays()) if data.GetArray(i)}


class Failed(Exception):
    pass


def vtk_read(reader, path):
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    reader.SetFileName(path)
    reader.Update()
    if errors or reader.GetOutputDataObject(0) is None:
        raise Failed("VTK reports an error")
    return reader.GetOutputDataObject(0)


def cells_of(grid, nodes_per_cell):
    cells = grid.GetCells() if hasattr(grid, "GetCells") else grid.GetPolys()
    return vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, nodes_per_cell)


class Mesh:
    """One mesh of the bundle, as VTK reads it, beside its entry in the manifest."""

    def __init__(self, bundle, name, manifest):
        entry = manifest["meshes"][name]
        self.name, self.entry, self.manifest = name, entry, manifest
        volume = vtk_read(vtk.vtkXMLUnstructuredGridReader(), os.path.join(bundle, entry["file"]))
        faces = vtk_read(vtk.vtkXMLPolyDataReader(), os.path.join(bundle, entry["surface_file"]))
        self.nodes = vtk_to_numpy(volume.GetPoints().GetData())
        self.cells = cells_of(volume, 4)
        self.on_nodes, self.on_cells = arrays_of(volume.GetPointData()), arrays_of(volume.GetCellData())
        ids = vtk_to_numpy(faces.GetPointData().GetArray("GlobalNodeID")) - 1
        self.faces = ids[cells_of(faces, 3)]
        self.surface = vtk_to_numpy(faces.GetCellData().GetArray("surface"))
        self.region = self.on_cells["region"]
        where = entry["file"]
        expect_equal(len(self.nodes), entry["nodes"], where, "nodes")
        expect_equal(len(self.cells), entry["cells"], where, "cells")
        expect_equal(len(self.faces), entry["faces"], entry["surface_file"], "faces")
        expect_equal(self.counts(self.region, "regions"), entry["regions"], where, "cells per region")
        expect_equal(self.counts(self.surface, "surfaces"), entry["surfaces"], entry["surface_file"], "faces per surface")
        rims = {name: int(flags.sum()) for name, flags in arrays_of(faces.GetPointData()).items() if name in manifest["rims"]}
        expect_equal(rims, entry["rims"], entry["surface_file"], "nodes per rim")

    @functools.cached_property
    def outer_keys(self):
        """Keys of the faces that belong to one cell, ascending."""
        corners = ([0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3])
        keys = np.concatenate([face_keys(self.cells[:, c], len(self.nodes)) for c in corners])
        unique, count = np.unique(keys, return_counts=True)
        return unique[count == 1]

    def without_interfaces(self):
        """The mesh with the faces that belong to one cell."""
        outer = copy.copy(self)
        kept = np.isin(face_keys(self.faces, len(self.nodes)), self.outer_keys)
        outer.faces, outer.surface = self.faces[kept], self.surface[kept]
        outer.entry = {**self.entry, "surfaces": self.counts(outer.surface, "surfaces")}
        return outer

    def counts(self, tags, table):
        names = {tag: name for name, tag in self.manifest[table].items()}
        return {names.get(int(tag), f"unknown {tag}"): int(n) for tag, n in zip(*np.unique(tags, return_counts=True))}

    def check_nodes(self, nodes, file, rtol=1e-12):
        """Equal up to the unit, which is one factor."""
        nodes = np.asarray(nodes, float)
        if nodes.shape != self.nodes.shape:
            expect_equal(len(nodes), len(self.nodes), file, "nodes")
            return
        scales = np.array([1, 1000, 0.1, 0.001])
        fits = [np.allclose(nodes, s * self.nodes, rtol=rtol, atol=1e-9 * s) for s in scales]
        expect(any(fits), file, "coordinates differ from the bundle's in every unit")

    def check_cells(self, cells, file):
        expect_same_rows(cells, self.cells, file, "cells")

    def check_faces(self, faces, file):
        expect_same_rows(faces, self.faces, file, "faces")

    def check_regions(self, tags, file):
        expect_equal(self.counts(tags, "regions"), self.entry["regions"], file, "cells per region")

    def check_surfaces(self, tags, file):
        expect_equal(self.counts(tags, "surfaces"), self.entry["surfaces"], file, "faces per surface")

    def check_fibers(self, on_nodes, on_cells, file, tolerance=1e-12):
        for axis in ("fiber", "sheet", "sheet_normal"):
            for wanted, found, where in ((self.on_nodes, on_nodes, "nodes"), (self.on_cells, on_cells, "cells")):
                if axis in wanted and found is not None:
                    expect(axis in found, file, f"{axis} on {where} is missing")
                    if axis in found:
                        expect_close(found[axis], wanted[axis], file, f"{axis} on {where}", tolerance)


# --------------------------------------------------------------------------------------------------------- VTK


def check_volume(grid, mesh, file, region_array, has_node_fibers):
    mesh.check_nodes(vtk_to_numpy(grid.GetPoints().GetData()), file)
    mesh.check_cells(cells_of(grid, 4), file)
    on_cells = arrays_of(grid.GetCellData())
    expect(region_array in on_cells, file, f"cell array {region_array} is missing")
    if region_array in on_cells:
        mesh.check_regions(on_cells[region_array], file)
    mesh.check_fibers(arrays_of(grid.GetPointData()) if has_node_fibers else None, on_cells, file)


def check_surface(poly, mesh, file):
    faces, tags = cells_of(poly, 3), vtk_to_numpy(poly.GetCellData().GetArray("surface"))
    ids = poly.GetPointData().GetArray("GlobalNodeID")
    if ids is not None:
        ids = vtk_to_numpy(ids) - 1
        expect(ids.min() >= 0 and ids.max() < len(mesh.nodes), file, "GlobalNodeID out of range")
        faces = ids[faces]
    wanted = np.isin(mesh.surface, tags)
    expect_same_rows(faces, mesh.faces[wanted], file, "faces")
    if len(np.unique(tags)) > 1:
        mesh.check_surfaces(tags, file)


def check_with_vtk(path, mesh, file):
    if path.endswith("exterior.vtp"):
        check_surface(vtk_read(vtk.vtkXMLPolyDataReader(), path), mesh.without_interfaces(), file)
    elif path.endswith(".vtp"):
        check_surface(vtk_read(vtk.vtkXMLPolyDataReader(), path), mesh, file)
    elif path.endswith(".vtu"):
        grid = vtk_read(vtk.vtkXMLUnstructuredGridReader(), path)
        family = grid.GetCellData().GetArray("FIB_DIR")
        if family is not None:
            axis = "sheet" if path.endswith("sheet.vtu") else "fiber"
            muscle = np.linalg.norm(mesh.on_cells[axis], axis=1) > 0
            expect_close(vtk_to_numpy(family)[muscle], mesh.on_cells[axis][muscle], file, "FIB_DIR")
        elif grid.GetCellData().GetArray("DOMAIN_ID") is not None:
            mesh.check_nodes(vtk_to_numpy(grid.GetPoints().GetData()), file)
            mesh.check_cells(cells_of(grid, 4), file)
            mesh.check_regions(vtk_to_numpy(grid.GetCellData().GetArray("DOMAIN_ID")), file)
        else:
            check_volume(grid, mesh, file, "region", True)
    elif path.endswith("_surfaces.vtk"):
        check_surface(vtk_read(vtk.vtkPolyDataReader(), path), mesh, file)
    else:
        reader = vtk.vtkUnstructuredGridReader()
        for kind in ("Scalars", "Vectors"):
            getattr(reader, f"ReadAll{kind}On")()
        grid = vtk_read(reader, path)
        arrays = arrays_of(grid.GetCellData())
        region = next((name for name in ("region", "material", "tags") if name in arrays), "region")
        check_volume(grid, mesh, file, region, region == "region")


# ------------------------------------------------------------------------------------------------------ meshio


def check_with_meshio(path, mesh, file):
    found = meshio.read(path)
    triangles = path.endswith("_facets.xdmf")
    kind = "triangle" if triangles else "tetra"
    mesh.check_nodes(found.points, file)
    cells = np.vstack([block.data for block in found.cells if block.type == kind])
    grouped = path.endswith(".msh") and len([b for b in found.cells if b.type == "tetra"]) > 1
    order = np.argsort(mesh.region, kind="stable") if grouped else np.arange(len(mesh.region))
    if triangles:
        mesh.check_faces(cells, file)
    else:
        expect_same_rows(cells, mesh.cells[order], file, "cells")

    def of_kind(name, wanted):
        return np.concatenate([data for block, data in zip(found.cells, found.cell_data[name]) if block.type == wanted])

    if path.endswith(".msh"):
        mesh.check_regions(of_kind("gmsh:physical", "tetra"), file)
        mesh.check_surfaces(of_kind("gmsh:physical", "triangle"), file)
        names = {name: [int(v) for v in value] for name, value in found.field_data.items()}
        for table, dimension in (("regions", 3), ("surfaces", 2)):
            for name in mesh.entry[table]:
                expect_equal(names.get(name), [mesh.manifest[table][name], dimension], file, f"physical name {name}")
    elif path.endswith(".xdmf"):
        tags = of_kind("facet_tags" if triangles else "cell_tags", kind)
        (mesh.check_surfaces if triangles else mesh.check_regions)(tags, file)
        table = "surfaces" if triangles else "regions"
        for name in mesh.entry[table]:
            expect_equal(int(found.field_data[name][0]), mesh.manifest[table][name], file, f"tag of {name}")
    else:
        name = next(name for name in ("region", "material", "tags") if name in found.cell_data)
        mesh.check_regions(of_kind(name, "tetra"), file)
    if not triangles:
        back = np.argsort(order)
        on_cells = {n: of_kind(n, "tetra")[back] for n in ("fiber", "sheet", "sheet_normal") if n in found.cell_data}
        mesh.check_fibers(found.point_data if "fiber" in found.point_data else None, on_cells or None, file)


# -------------------------------------------------------------------------------------------------------- gmsh


def gmsh_groups(dimension):
    groups = {}
    for dim, tag in gmsh.model.getPhysicalGroups(dimension):
        elements = 0
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dim, tag):
            elements += sum(len(tags) for tags in gmsh.model.mesh.getElements(dim, entity)[1])
        groups[gmsh.model.getPhysicalName(dim, tag)] = elements
    return groups


def check_gmsh_model(mesh, file):
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    nodes = np.empty((len(tags), 3))
    nodes[np.asarray(tags, int) - 1] = np.reshape(coordinates, (-1, 3))
    mesh.check_nodes(nodes, file)
    expect_equal(gmsh_groups(3), mesh.entry["regions"], file, "cells per physical volume")
    expect_equal(gmsh_groups(2), mesh.entry["surfaces"], file, "faces per physical surface")


def check_gmsh_views(mesh, file):
    views = collections.defaultdict(list)
    for view in gmsh.view.getTags():
        index = gmsh.view.getIndex(view)
        views[gmsh.option.getString(f"View[{index}].Name")].append(view)
    for axis in ("fiber", "sheet", "sheet_normal"):
        for view in views[axis]:
            kind, tags, data, _, components = gmsh.view.getHomogeneousModelData(view, 0)
            expect_equal(components, 3, file, f"components of view {axis}")
            if kind == "NodeData":
                expect_same_rows(tags, np.arange(1, len(mesh.nodes) + 1), file, f"nodes of view {axis}")
                expect_close(np.reshape(data, (-1, 3)), mesh.on_nodes[axis], file, f"view {axis} on nodes")
            else:
                lengths = np.linalg.norm(np.reshape(data, (-1, 3))[: len(mesh.cells)], axis=1)
                wanted = np.linalg.norm(mesh.on_cells[axis], axis=1)
                expect_close(np.sort(lengths), np.sort(wanted), file, f"view {axis} on cells")
        wanted = (axis in mesh.on_nodes) + (axis in mesh.on_cells)
        expect_equal(len(views[axis]), wanted, file, f"views named {axis}")


def check_with_gmsh(path, mesh, file):
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(path)
        check_gmsh_model(mesh, file)
        of_cells = path[: -len(".msh")] + "_cells.msh"
        if os.path.exists(of_cells):
            gmsh.merge(of_cells)
        check_gmsh_views(mesh, file)
        with tempfile.TemporaryDirectory() as folder:  # names survive gmsh's own writing
            again = os.path.join(folder, "again.msh")
            gmsh.write(again)
            gmsh.open(again)
            check_gmsh_model(mesh, file + " written again by gmsh")
    finally:
        gmsh.finalize()


# ---------------------------------------------------------------------------------------------- HDF5 and text


def check_with_h5py(path, mesh, file):
    with h5py.File(path, "r") as h5:
        if path.endswith("_facets.h5"):
            mesh.check_faces(h5["facets/topology"][()], file)
            mesh.check_surfaces(h5["facets/facet_tags"][()], file)
            return
        mesh.check_nodes(h5["mesh/geometry"][()], file)
        mesh.check_cells(h5["mesh/topology"][()], file)
        mesh.check_regions(h5["mesh/cell_tags"][()], file)
        mesh.check_fibers(h5.get("nodes", {}), h5.get("cells", {}), file)
        rims = {name: len(nodes) for name, nodes in h5.get("rims", {}).items()}
        expect_equal(rims, mesh.entry["rims"], file, "nodes per rim")


def rows(path, columns, header=1):
    return np.loadtxt(path, skiprows=header, usecols=range(-columns, 0), encoding="ascii", ndmin=2)


def check_opencarp(path, mesh, file):
    base = path[: -len(".pts")]
    mesh.check_nodes(rows(path, 3), file, 2**-23)  # the shortest text of a 32-bit float
    elements = rows(base + ".elem", 5).astype(int)
    mesh.check_cells(elements[:, :4], file)
    mesh.check_regions(elements[:, 4], file)
    if "fiber" in mesh.on_cells:
        axes = rows(base + ".lon", 6)
        mesh.check_fibers(None, {"fiber": axes[:, :3], "sheet": axes[:, 3:], "sheet_normal": mesh.on_cells["sheet_normal"]}, file, 2**-23)
    for name, tag in mesh.manifest["surfaces"].items():
        if name in mesh.entry["surfaces"]:
            ids = rows(f"{base}_{name}.vtx", 1, header=2).astype(int).ravel()
            expect_same_rows(ids, np.unique(mesh.faces[mesh.surface == tag]), file, f"{name}.vtx")


def check_chaste(path, mesh, file):
    base = path[: -len(".node")]
    mesh.check_nodes(rows(path, 3), file)
    elements = rows(base + ".ele", 5).astype(int)
    mesh.check_cells(elements[:, :4], file)
    mesh.check_regions(elements[:, 4], file)
    faces = rows(base + ".face", 4).astype(int)[:, :3]
    expect_same_rows(np.sort(face_keys(faces, len(mesh.nodes))), mesh.outer_keys, file, "outer faces")
    if os.path.exists(base + ".ortho"):
        axes = rows(base + ".ortho", 9).reshape(-1, 3, 3)
        expect_close(axes @ axes.transpose(0, 2, 1), np.broadcast_to(np.eye(3), axes.shape), file, "orthonormal axes", 1e-4)


def check_markers(path, mesh, file):
    with open(path, encoding="utf-8") as stream:
        markers = json.load(stream)
    wanted = {name: [mesh.manifest[table][name], dimension]
              for table, dimension in (("regions", 3), ("surfaces", 2), ("rims", 0)) for name in mesh.entry[table]}
    expect_equal(markers, wanted, file, "markers")


def check_readme(bundle):
    """The Python that the bundle's README shows must run in the bundle's folder."""
    with open(os.path.join(bundle, "README.md"), encoding="utf-8") as stream:
        examples = re.findall(r"```python\n(.*?)```", stream.read(), flags=re.DOTALL)
    expect(len(examples) > 0, "README.md", "shows no Python")
    before = os.getcwd()
    os.chdir(bundle)
    for example in examples:
        if "meshio" in example and not meshio:
            continue
        try:
            exec(compile(example, "README.md", "exec"), {})
            expect(True, "README.md", "")
        except KeyError as error:  # a mesh without fibres has no such array
            expect(error.args == ("fiber",), "README.md", f"KeyError: {error}")
        except Exception as error:
            expect(False, "README.md", f"{type(error).__name__}: {error}")
    os.chdir(before)


def check_medit(path, mesh, file):
    found = meshio.read(path, file_format="medit")
    mesh.check_nodes(found.points, file)
    blocks = {block.type: (block.data, tags) for block, tags in zip(found.cells, found.cell_data["medit:ref"])}
    mesh.check_cells(blocks["tetra"][0], file)
    mesh.check_regions(blocks["tetra"][1], file)
    mesh.check_faces(blocks["triangle"][0], file)
    mesh.check_surfaces(blocks["triangle"][1], file)


def check_cell_vectors(path, mesh, file):
    axis = os.path.splitext(path)[0].rsplit("_", 1)[1]
    header = 5 if path.endswith(".gf") else 1
    expect_close(rows(path, 3, header), mesh.on_cells[axis], file, axis)


def check_abaqus(path, mesh, file):
    """Sets and surfaces by name; the side numbers as the manuals draw them."""
    sides = {"S1": (0, 1, 2), "S2": (0, 3, 1), "S3": (1, 3, 2), "S4": (2, 3, 0)}
    nodes, cells, regions, faces, axes, rows_of = [], {}, collections.Counter(), {}, {}, None
    with open(path, encoding="ascii") as stream:
        for line in stream:
            words = [word.strip() for word in line.rstrip("\n").split(",")]
            if line.startswith("*"):
                options = dict(word.upper().split("=", 1) for word in words[1:] if "=" in word)
                name = next((word.split("=", 1)[1] for word in words[1:] if word.split("=")[0] in ("ELSET", "NAME")), "")
                rows_of = words[0]
            elif rows_of == "*NODE":
                nodes.append([float(word) for word in words[1:]])
            elif rows_of == "*ELEMENT":
                cells[int(words[0])] = [int(word) - 1 for word in words[1:]]
                regions[name] += 1
            elif rows_of == "*SURFACE":
                cell = cells[int(words[0])]
                faces.setdefault(name, set()).add(tuple(sorted(cell[i] for i in sides[words[1]])))
            elif rows_of == "*DISTRIBUTION" and words[0]:
                axes[int(words[0])] = [float(word) for word in words[1:]]
    mesh.check_nodes(np.array(nodes), file)
    mesh.check_cells([cells[i + 1] for i in range(len(cells))], file)
    expect_equal(dict(regions), mesh.entry["regions"], file, "elements per set")
    names = {tag: name for name, tag in mesh.manifest["surfaces"].items()}
    wanted = collections.defaultdict(set)
    for face, tag in zip(mesh.faces, mesh.surface):
        wanted[names[int(tag)]].add(tuple(sorted(int(n) for n in face)))
    expect(faces == dict(wanted), file, "faces of the surfaces")
    if "fiber" in mesh.on_cells:
        found = np.array([axes[i + 1] for i in range(len(cells))])
        muscle = np.linalg.norm(mesh.on_cells["fiber"], axis=1) > 0
        wanted = np.hstack([mesh.on_cells["fiber"], mesh.on_cells["sheet"]])
        expect_close(found[muscle], wanted[muscle], file, "orientations")


def check_triangles(path, mesh, file):
    """Area and number of triangles of one surface, and that they look out of the lower region."""
    reader = {".stl": vtk.vtkSTLReader, ".ply": vtk.vtkPLYReader, ".obj": vtk.vtkOBJReader}[os.path.splitext(path)[1]]()
    poly = vtk_read(reader, path)
    name = os.path.splitext(os.path.basename(path))[0][len(mesh.name) + 1 :]
    chosen = mesh.faces[mesh.surface == mesh.manifest["surfaces"][name]]
    area = lambda nodes, faces: 0.5 * np.cross(nodes[faces[:, 1]] - nodes[faces[:, 0]], nodes[faces[:, 2]] - nodes[faces[:, 0]])
    found = area(vtk_to_numpy(poly.GetPoints().GetData()).astype(float), cells_of(poly, 3))
    wanted = area(mesh.nodes, chosen)
    expect_equal(len(found), len(wanted), file, "triangles")
    total = np.linalg.norm(wanted, axis=1).sum()  # coordinates may be 32-bit floats
    expect_close(found.sum(axis=0) / total, wanted.sum(axis=0) / total, file, "area vector", 1e-6)
    expect_close(np.linalg.norm(found, axis=1).sum() / total, 1, file, "area", 1e-6)


def checks_for(path):
    ending = os.path.splitext(path)[1]
    table = {
        ".vtk": [check_with_vtk], ".vtu": [check_with_vtk], ".vtp": [check_with_vtk], ".msh": [], ".xdmf": [],
        ".h5": [check_with_h5py] if h5py else [], ".pts": [check_opencarp], ".node": [check_chaste],
        ".stl": [check_triangles], ".ply": [check_triangles], ".obj": [check_triangles],
        ".mesh": [check_medit] if meshio and "medit" in path else [], ".inp": [check_abaqus],
        ".txt": [check_cell_vectors], ".gf": [check_cell_vectors],
        ".json": [check_markers] if path.endswith("_markers.json") else [],
    }
    if ending not in table or path.endswith(("_cells.msh", "_inflate.inp")):
        return []
    checks = list(table[ending])
    if gmsh and ending == ".msh":
        checks.append(check_with_gmsh)
    plain = not path.endswith("_surfaces.vtk") and "svmultiphysics" not in path
    if meshio and plain and (ending in (".vtk", ".vtu", ".msh") or (ending == ".xdmf" and h5py)):
        checks.append(check_with_meshio)
    return checks


def main(bundle, exports):
    with open(os.path.join(bundle, "manifest.json"), encoding="utf-8") as stream:
        manifest = json.load(stream)
    meshes = {name: Mesh(bundle, name, manifest) for name in manifest["meshes"]}
    outer = {name: mesh.without_interfaces() for name, mesh in meshes.items()}
    check_readme(bundle)
    for folder, _, names in sorted(os.walk(exports)):
        for name in sorted(names):
            path = os.path.join(folder, name)
            parts = os.path.relpath(path, exports).split(os.sep)[1:]
            owners = next(filter(None, ([m for m in meshes if re.match(re.escape(m) + r"(?![A-Za-z0-9])", part)]
                                        for part in parts)), [])  # a surface's name may begin with another mesh's
            for check in checks_for(path) if owners else []:
                file = f"{os.path.relpath(path, exports)} ({check.__name__[6:].replace('with_', '')})"
                mesh = meshes[max(owners, key=len)]
                print(f"... {file}", file=sys.stderr, flush=True)
                try:
                    check(path, outer[mesh.name] if "dealii" in path or "outer" in path else mesh, file)
                except Exception as error:  # any exception of a foreign reader is a failed export
                    expect(False, file, f"{type(error).__name__}: {error}")
    for file in sorted(checked):
        print(f"{checked[file]:4d} comparisons  {file}")
    for failure in failures:
        print("FAILED " + (failure if len(failure) < 600 else failure[:600] + " ..."))
    print(f"{sum(checked.values())} comparisons, {len(failures)} failed")
    return 1 if failures or not checked else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])))
