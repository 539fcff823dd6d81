#!/usr/bin/python3
"""What openCARP, Chaste, svMultiPhysics, OpenFOAM, FEBio and MFEM demand of the files they read, restated.

usage: reader_rules.py EXPORTS

EXPORTS holds a folder per format. Every mesh in it is read as those programs would; then copies of one mesh per format
are spoiled, each in one way, and must be refused. Exit code 0: all read, all spoiled ones refused; 1: not so; 77: VTK is missing.
"""
import glob
import os
import re
import shutil
import sys
import tempfile
import xml.etree.ElementTree as xml

try:
    import numpy as np
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
except ImportError as error:
    print(f"skipped: {error}; install python3-vtk9 and python3-numpy")
    sys.exit(77)


class Refused(Exception):
    pass


def demand(condition, message):
    if not condition:
        raise Refused(message)


def lines_of(path):
    demand(os.path.exists(path), f"{os.path.basename(path)} is missing")
    with open(path, encoding="ascii") as stream:
        return stream.read().splitlines()


def table(rows, columns, kind):
    demand(all(len(row.split()) == columns for row in rows), f"a row has not {columns} numbers")
    return np.array([row.split() for row in rows], dtype=kind).reshape(-1, columns)


def demand_ids(ids, count, what):
    demand(ids.size > 0 and ids.min() >= 0 and ids.max() < count, f"{what} out of range")


def demand_positive(nodes, cells):
    a, b, c, d = (nodes[cells[:, i]] for i in range(4))
    volume = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a))
    demand(volume.min() > 0, "a tetrahedron is turned inside out")


def demand_axes(axes, tolerance, zero_allowed):
    """axes: cells × families × 3."""
    length = np.linalg.norm(axes, axis=2)
    zero = (length == 0).all(axis=1)
    demand(zero_allowed or not zero.any(), "a fibre is zero")
    demand(np.abs(length[~zero] - 1).max(initial=0) <= tolerance, "a fibre is no unit vector")
    for i in range(axes.shape[1]):
        for j in range(i):
            demand(np.abs(np.einsum("ij,ij->i", axes[:, i], axes[:, j])).max(initial=0) <= tolerance, "axes are not orthogonal")
    return zero


# ---------------------------------------------------------------------------------------------------- openCARP


def opencarp_text(base):
    rows = lines_of(base + ".pts")
    demand(len(rows) - 1 == int(rows[0]), ".pts: count differs from its head")
    nodes = table(rows[1:], 3, float)
    rows = lines_of(base + ".elem")
    demand(len(rows) - 1 == int(rows[0]), ".elem: count differs from its head")
    demand(all(row.startswith("Tt ") for row in rows[1:]), ".elem: an element is no tetrahedron")
    elements = table([row[3:] for row in rows[1:]], 5, int)
    rows = lines_of(base + ".lon")
    demand(rows[0] in ("1", "2"), ".lon: its head is the number of families")
    axes = table(rows[1:], 3 * int(rows[0]), float).reshape(len(rows) - 1, -1, 3)
    return nodes, elements, axes


def opencarp_block(path, counts, kind, width):
    with open(path, "rb") as stream:
        data = stream.read()
    head = data[:1024].split(b"\0")[0].split()
    demand(len(head) == counts + 2 and head[-2] == b"0", f"{path}: head")
    rows = np.frombuffer(data[1024:], dtype=kind)
    demand(len(rows) == int(head[counts - 1]) * width, f"{path}: size differs from its head")
    return rows.reshape(-1, width)


def opencarp_binary(base):
    nodes = opencarp_block(base + ".bpts", 1, "<f4", 3)
    elements = opencarp_block(base + ".belem", 1, "<i4", 6)
    demand((elements[:, 0] == 0).all(), ".belem: an element is no tetrahedron")
    axes = opencarp_block(base + ".blon", 2, "<f4", 6).reshape(-1, 2, 3)
    return nodes.astype(float), elements[:, 1:], axes.astype(float)


def opencarp_ids(text, name):
    ids = [int(tag) for tag in re.findall(rf"^{re.escape(name)}\.ID\[\d+\] = (\d+)$", text, flags=re.M)]
    count = re.search(rf"^{re.escape(name)}\.num_IDs = (\d+)$", text, flags=re.M)
    demand(count is not None and int(count.group(1)) == len(ids), f"{name}: num_IDs")
    return ids


def opencarp_deck(base, elements, zero):
    text = "\n".join(lines_of(base + "_activation.par"))
    tags = set(elements[:, 4].tolist())
    groups = int(re.search(r"^num_gregions = (\d+)$", text, flags=re.M).group(1))
    named = [tag for group in range(groups) for tag in opencarp_ids(text, f"gregion[{group}]")]
    demand(sorted(named) == sorted(tags), "gregion: a tag is missing, named twice or in no element")
    muscle, everything = opencarp_ids(text, "phys_region[0]"), opencarp_ids(text, "phys_region[1]")
    demand(set(everything) == tags, "phys_region[1]: not all tags")
    is_muscle = np.isin(elements[:, 4], muscle)
    demand(not (is_muscle & zero).any(), "muscle without fibres")
    demand(not (~is_muscle & ~zero).any(), "fibres outside phys_region[0]")
    demand(opencarp_ids(text, "imp_region[0]") == muscle, "imp_region[0]: not the muscle")
    demand("{{" not in text, "an unfilled place")


def opencarp(base):
    binary = os.path.exists(base + ".bpts")
    nodes, elements, axes = opencarp_binary(base) if binary else opencarp_text(base)
    demand_ids(elements[:, :4], len(nodes), "node of an element")
    demand_positive(nodes, elements[:, :4])
    demand(len(axes) == len(elements), "fibres: not one row per element")
    zero = demand_axes(axes, 1e-4, True)
    for path in glob.glob(base + "_*.vtx"):
        rows = lines_of(path)
        demand(int(rows[0]) == len(rows) - 2 and rows[1] in ("intra", "extra"), f"{path}: head")
        demand_ids(np.array(rows[2:], dtype=int), len(nodes), f"{path}: node")
    for path in glob.glob(base + "_*.surf"):
        rows = lines_of(path)
        demand(int(rows[0]) == len(rows) - 1, f"{path}: head")
        demand(all(row.startswith("Tr ") for row in rows[1:]), f"{path}: no triangle")
        demand_ids(table([row[3:] for row in rows[1:]], 3, int), len(nodes), f"{path}: node")
    if not zero.all():
        opencarp_deck(base, elements, zero)


# ------------------------------------------------------------------------------------------------------ Chaste


def chaste(base):
    def read(ending, head, columns):
        rows = lines_of(base + ending)
        demand(rows[0].split()[1:] == head and int(rows[0].split()[0]) == len(rows) - 1, f"{ending}: head")
        values = table(rows[1:], columns, float)
        demand((values[:, 0] == np.arange(len(values))).all(), f"{ending}: ids are not consecutive")
        return values[:, 1:]

    nodes = read(".node", ["3", "0", "0"], 4)
    cells = read(".ele", ["4", "1"], 6).astype(int)
    faces = read(".face", ["1"], 5).astype(int)
    demand_ids(cells[:, :4], len(nodes), "node of an element")
    demand_positive(nodes, cells[:, :4])
    sides = np.sort(np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 1, 3]], cells[:, [0, 2, 3]], cells[:, [1, 2, 3]]]), axis=1)
    unique, count = np.unique(sides, axis=0, return_counts=True)
    outer = {tuple(face) for face in unique[count == 1]}
    demand({tuple(face) for face in np.sort(faces[:, :3], axis=1)} == outer, ".face: not the outer boundary")
    if os.path.exists(base + ".ortho"):
        rows = lines_of(base + ".ortho")
        demand(int(rows[0]) == len(rows) - 1 == len(cells), ".ortho: not one row per element")
        demand_axes(table(rows[1:], 9, float).reshape(-1, 3, 3), 1e-4, False)


# ---------------------------------------------------------------------------------------------- svMultiPhysics


def vtk_read(path):
    demand(os.path.exists(path), f"{os.path.basename(path)} is missing")
    reader = vtk.vtkXMLPolyDataReader() if path.endswith(".vtp") else vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def int32(data, name, where):
    array = data.GetArray(name)
    demand(array is not None and array.GetDataType() == vtk.VTK_INT, f"No '{name}' data of type Int32 found in {where}")
    return vtk_to_numpy(array)


def vtk_nodes(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def vtk_cells(data, corners):
    cells = data.GetPolys() if corners == 3 else data.GetCells()
    return vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, corners)


def svmultiphysics(folder):
    volume = vtk_read(os.path.join(folder, "mesh-complete.mesh.vtu"))
    nodes, cells = vtk_nodes(volume), vtk_cells(volume, 4)
    demand_positive(nodes, cells)
    demand((int32(volume.GetPointData(), "GlobalNodeID", "the volume") == np.arange(len(nodes)) + 1).all(), "GlobalNodeID")
    demand((int32(volume.GetCellData(), "GlobalElementID", "the volume") == np.arange(len(cells)) + 1).all(), "GlobalElementID")
    demand(int32(volume.GetCellData(), "DOMAIN_ID", "the volume").min() >= 1, "DOMAIN_ID below 1")
    domains = np.array(lines_of(os.path.join(folder, "domain_ids.dat")), dtype=int)
    demand(len(domains) == len(cells), "domain_ids.dat: not a domain per element")
    demand(domains.min() >= 1 and domains.max() <= 31, "domain_ids.dat: a domain that is no bit of 32 from 1")
    for path in glob.glob(os.path.join(folder, "mesh-surfaces", "*.vtp")) + [os.path.join(folder, "mesh-complete.exterior.vtp")]:
        face = vtk_read(path)
        where = os.path.basename(path)
        ids = int32(face.GetPointData(), "GlobalNodeID", where) - 1
        elements = int32(face.GetCellData(), "GlobalElementID", where) - 1
        demand_ids(ids, len(nodes), f"{where}: GlobalNodeID")
        demand_ids(elements, len(cells), f"{where}: GlobalElementID")
        demand(np.array_equal(nodes[ids], vtk_nodes(face)), f"{where}: nodes are not the volume's")
        triangles = ids[vtk_cells(face, 3)]
        behind = (cells[elements][:, :, None] == triangles[:, None, :]).any(axis=1).all(axis=1)
        demand(behind.all(), f"{where}: a face is not of its element")
    families = [os.path.join(folder, name + ".vtu") for name in ("fiber", "sheet")]
    if any(os.path.exists(path) for path in families):
        axes = []
        for path in families:
            array = vtk_read(path).GetCellData().GetArray("FIB_DIR")
            demand(array is not None and array.GetDataType() == vtk.VTK_DOUBLE, f"{path}: FIB_DIR")
            demand(array.GetNumberOfTuples() == len(cells) and array.GetNumberOfComponents() == 3, f"{path}: FIB_DIR")
            axes.append(vtk_to_numpy(array))
        demand_axes(np.stack(axes, axis=1), 1e-6, False)
    deck = folder.replace("-mesh-complete", "_activation.xml")
    if os.path.exists(deck):
        root = xml.parse(deck).getroot()
        ids = {int(domain.get("id")) for domain in root.iter("Domain")}
        demand(set(domains.tolist()) <= ids, "the deck lacks a domain")
        for path in root.iter("Face_file_path"):
            demand(os.path.exists(os.path.join(os.path.dirname(folder), path.text.strip())), "the deck names no face file")


# --------------------------------------------------------------------------------------------------- OpenFOAM


def foam_list(path):
    text = "\n".join(lines_of(path))
    body = text[text.index("}") + 1 :]
    count, rest = body.split("(", 1)
    return int(count), rest


def foam_labels(path):
    count, rest = foam_list(path)
    labels = np.array(rest[: rest.rindex(")")].split(), dtype=int)
    demand(len(labels) == count, f"{path}: count")
    return labels


def openfoam(case):
    mesh = os.path.join(case, "constant", "polyMesh")
    count, rest = foam_list(os.path.join(mesh, "points"))
    points = np.fromstring(rest.replace("(", " ").replace(")", " "), sep=" ").reshape(-1, 3)
    demand(len(points) == count, "points: count")
    count, rest = foam_list(os.path.join(mesh, "faces"))
    demand(rest.count("3(") == count, "faces: count")
    faces = np.fromstring(rest.replace("3(", " ").replace(")", " "), dtype=int, sep=" ").reshape(-1, 3)
    demand_ids(faces, len(points), "point of a face")
    owner, neighbour = foam_labels(os.path.join(mesh, "owner")), foam_labels(os.path.join(mesh, "neighbour"))
    inner = len(neighbour)
    demand(len(owner) == len(faces) and inner <= len(faces), "owner: not one per face")
    demand((owner[:inner] < neighbour).all(), "a neighbour is not above its owner")
    order = np.lexsort((neighbour, owner[:inner]))
    demand((order == np.arange(inner)).all(), "faces are not in upper triangular order")
    area = 0.5 * np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    total = np.zeros((max(owner.max(), neighbour.max(initial=0)) + 1, 3))  # the last cell may own no face
    np.add.at(total, owner, area)
    np.add.at(total, neighbour, -area[:inner])
    demand(np.abs(total).max() <= 1e-9 * np.abs(area).max(), "a cell is not closed")
    volume = np.zeros(len(total))
    flux = np.einsum("ij,ij->i", points[faces].mean(axis=1), area) / 3
    np.add.at(volume, owner, flux)
    np.add.at(volume, neighbour, -flux[:inner])
    demand(volume.min() > 0, "a cell has no positive volume")
    patches = re.findall(r"(\w+)\n\{\n    type patch;\n    nFaces (\d+);\n    startFace (\d+);", foam_list(os.path.join(mesh, "boundary"))[1])
    at = inner
    for name, faces_of_patch, start in patches:
        demand(int(start) == at, f"patch {name} does not follow the one before")
        at += int(faces_of_patch)
    demand(at == len(faces), "the patches do not hold every outer face")
    for name, kind, limit in (("cellZones", "cellLabels", len(total)), ("faceZones", "faceLabels", inner)):
        text = foam_list(os.path.join(mesh, name))[1]
        labels = re.findall(kind + r" List<label>\n(\d+)\n\(\n([\d\n]*)\)", text)
        for size, body in labels:
            ids = np.array(body.split(), dtype=int)
            demand(len(ids) == int(size), f"{name}: count")
            demand_ids(ids, limit, name)
        if name == "cellZones":
            demand(sum(int(size) for size, _ in labels) == len(total), "cellZones do not hold every cell")
    for name in ("fiber", "sheet"):
        if os.path.exists(os.path.join(case, "0", name)):
            text = "\n".join(lines_of(os.path.join(case, "0", name)))
            size = int(re.search(r"List<vector>\n(\d+)\n", text).group(1))
            demand(size == len(total), f"0/{name}: not one per cell")


# ------------------------------------------------------------------------------------------------ FEBio, MFEM


def febio(path):
    root = xml.parse(path).getroot()
    demand(root.get("version") == "4.0", "version")
    nodes = np.array([node.text.split(",") for node in root.iter("node")], dtype=float)
    sizes = {}
    for part in root.iter("Elements"):
        cells = np.array([element.text.split(",") for element in part], dtype=int) - 1
        demand_ids(cells, len(nodes), "node of an element")
        demand_positive(nodes, cells)
        sizes[part.get("name")] = len(cells)
    names = [surface.get("name") for surface in root.iter("Surface")]
    demand(len(set(names)) == len(names), "two surfaces of one name")
    for data in root.iter("ElementData"):
        demand(data.get("elem_set") in sizes, "mat_axis of no part")
        axes = np.array([[row.find(k).text.split(",") for k in "ad"] for row in data], dtype=float)
        demand([int(row.get("lid")) for row in data] == list(range(1, sizes[data.get("elem_set")] + 1)), "mat_axis: lid")
        demand_axes(axes, 1e-6, False)
    if os.path.exists(deck_of(path)):
        febio_deck(xml.parse(deck_of(path)).getroot(), set(sizes), names)


def febio_deck(root, parts, surfaces):
    """Sections in the order in which they are needed; the properties that a version 4.0 file must name."""
    order = [section.tag for section in root]
    demand(order[0] == "Module", "the deck does not begin with Module")
    demand(order.index("Material") < order.index("MeshDomains") < order.index("MeshData"), "the deck's order")
    demand(root.find("Control/solver") is not None, "Control: the required property solver is missing")
    for material in root.iter("material"):
        demand(material.get("type") != "trans iso Mooney-Rivlin" or material.find("fiber") is not None, "material: the required property fiber is missing")
    demand({domain.get("name") for domain in root.iter("SolidDomain")} == parts, "MeshDomains: not the mesh's parts")
    named = [bc.get("node_set") for bc in root.iter("bc")] + [load.get("surface") for load in root.iter("surface_load")]
    demand(named and set(named) <= set(surfaces), "the deck names a surface that is not there")


def mfem(path):
    words = iter("\n".join(lines_of(path)).split())
    demand([next(words) for _ in range(3)] == ["MFEM", "mesh", "v1.0"], "head")
    demand([next(words), next(words)] == ["dimension", "3"], "dimension")

    def block(name, columns):
        demand(next(words) == name, name)
        count = int(next(words))
        return np.array([next(words) for _ in range(count * columns)], dtype=int).reshape(-1, columns)

    cells, boundary = block("elements", 6), block("boundary", 5)
    demand(next(words) == "vertices", "vertices")
    count, dimension = int(next(words)), int(next(words))
    nodes = np.array(list(words), dtype=float).reshape(count, dimension)
    demand(cells[:, 0].min() >= 1 and boundary[:, 0].min() >= 1, "an attribute is below 1")
    demand((cells[:, 1] == 4).all() and (boundary[:, 1] == 2).all(), "geometry")
    demand_ids(cells[:, 2:], count, "node of an element")
    demand_ids(boundary[:, 2:], count, "node of the boundary")
    demand_positive(nodes, cells[:, 2:])
    fibers = path[: -len(".mesh")] + "_fiber.gf"
    if os.path.exists(fibers):
        rows = lines_of(fibers)
        demand(rows[:4] == ["FiniteElementSpace", "FiniteElementCollection: L2_3D_P0", "VDim: 3", "Ordering: 1"], "GridFunction")
        demand(len(table(rows[5:], 3, float)) == len(cells), "GridFunction: not one vector per element")


# ------------------------------------------------------------------------------------------------------- spoil


def edit(path, change):
    with open(path, encoding="ascii") as stream:
        text = stream.read()
    spoiled = change(text)
    assert spoiled != text, f"{path} was not spoiled"
    with open(path, "w", encoding="ascii") as stream:
        stream.write(spoiled)


def in_line(number, change):
    def apply(text):
        rows = text.split("\n")
        rows[number] = change(rows[number])
        return "\n".join(rows)

    return apply


def swap_words(i, j):
    def apply(row):
        words = row.split(" ")
        words[i], words[j] = words[j], words[i]
        return " ".join(words)

    return apply


def without_array(path, name):
    data = vtk_read(path)
    data.GetCellData().RemoveArray(name)
    writer = vtk.vtkXMLPolyDataWriter() if path.endswith(".vtp") else vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(path)
    writer.SetInputData(data)
    writer.Write()


def with_array(path, name, change):
    data = vtk_read(path)
    values = vtk_to_numpy(data.GetCellData().GetArray(name)).copy()
    array = numpy_to_vtk(change(values), deep=True)
    array.SetName(name)
    data.GetCellData().RemoveArray(name)
    data.GetCellData().AddArray(array)
    writer = vtk.vtkXMLPolyDataWriter() if path.endswith(".vtp") else vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(path)
    writer.SetInputData(data)
    writer.Write()


def cut_bytes(path, count):
    with open(path, "r+b") as stream:
        stream.truncate(os.path.getsize(path) - count)


def deck_of(feb):
    return feb[: -len(".feb")] + "_inflate.feb"


def first(pattern):
    return sorted(glob.glob(pattern))[0]


SPOILED = {
    opencarp: [
        ("a row of fibres is missing", lambda b: edit(b + ".lon", lambda t: t.rsplit("\n", 2)[0] + "\n")),
        ("a fibre of half length", lambda b: edit(b + ".lon", in_line(1, lambda r: "0.5 0 0 " + " ".join(r.split()[3:])))),
        ("an element turned inside out", lambda b: edit(b + ".elem", in_line(1, swap_words(1, 2)))),
        ("a node that is not there", lambda b: edit(b + ".elem", in_line(1, lambda r: "Tt 0 1 2 99999999 1"))),
        ("1-based nodes of a surface", lambda b: edit(first(b + "_*.vtx"), lambda t: t.rsplit("\n", 2)[0] + "\n99999999\n")),
        ("a surface without its count", lambda b: edit(first(b + "_*.surf"), lambda t: t.split("\n", 1)[1])),
        ("bath among the muscle", lambda b: edit(b + "_activation.par", lambda t: t.replace("phys_region[1].ID[0] = 1", "phys_region[1].ID[0] = 6"))),
        ("a tag in no gregion", lambda b: edit(b + "_activation.par", lambda t: t.replace("gregion[0].ID[0] = 1", "gregion[0].ID[0] = 55"))),
    ],
    chaste: [
        ("an interface among the faces", lambda b: edit(b + ".face", lambda t: t.replace("\n0 ", "\n0 0 1 2 5\n1 ", 1))),
        ("axes that are not orthonormal", lambda b: edit(b + ".ortho", in_line(1, lambda r: "1 0 0 1 0 0 0 0 1"))),
        ("a zero fibre", lambda b: edit(b + ".ortho", in_line(2, lambda r: "0 0 0 0 0 0 0 0 0"))),
        ("1-based ids", lambda b: edit(b + ".node", in_line(1, lambda r: "1 " + r.split(" ", 1)[1]))),
        ("an element turned inside out", lambda b: edit(b + ".ele", in_line(1, swap_words(1, 2)))),
    ],
    svmultiphysics: [
        ("a face without GlobalElementID", lambda f: without_array(first(f + "/mesh-surfaces/*.vtp"), "GlobalElementID")),
        ("GlobalElementID of 64 bits", lambda f: with_array(first(f + "/mesh-surfaces/*.vtp"), "GlobalElementID", lambda v: v.astype(np.int64))),
        ("0-based GlobalElementID", lambda f: with_array(f + "/mesh-complete.exterior.vtp", "GlobalElementID", lambda v: v - 1)),
        ("no DOMAIN_ID", lambda f: without_array(f + "/mesh-complete.mesh.vtu", "DOMAIN_ID")),
        ("a domain 0", lambda f: edit(f + "/domain_ids.dat", in_line(0, lambda r: "0"))),
        ("a domain 99", lambda f: edit(f + "/domain_ids.dat", in_line(0, lambda r: "99"))),
        ("zero fibres", lambda f: with_array(f + "/fiber.vtu", "FIB_DIR", lambda v: 0 * v)),
        ("fibre and sheet parallel", lambda f: shutil.copy(f + "/fiber.vtu", f + "/sheet.vtu")),
        ("fibres of 32 bits", lambda f: with_array(f + "/fiber.vtu", "FIB_DIR", lambda v: v.astype(np.float32))),
    ],
    openfoam: [
        ("owners out of order", lambda c: edit(c + "/constant/polyMesh/owner", lambda t: t.replace("\n(\n0\n", "\n(\n5\n"))),
        ("a face turned round", lambda c: edit(c + "/constant/polyMesh/faces", lambda t: re.sub(r"3\((\d+) (\d+) ", r"3(\2 \1 ", t, count=1))),
        ("a patch that begins too late", lambda c: edit(c + "/constant/polyMesh/boundary", lambda t: re.sub(r"startFace (\d+)", lambda m: f"startFace {int(m.group(1)) + 1}", t, count=1))),
        ("a zone of a cell too many", lambda c: edit(c + "/constant/polyMesh/cellZones", lambda t: re.sub(r"\(\n0\n", "(\n99999999\n", t, count=1))),
        ("a fibre field of another mesh", lambda c: edit(c + "/0/fiber", lambda t: re.sub(r"List<vector>\n\d+", "List<vector>\n7", t))),
    ],
    febio: [
        ("an element turned inside out", lambda p: edit(p, lambda t: re.sub(r'(<elem id="1">)(\d+),(\d+),', r"\1\3,\2,", t))),
        ("axes for a part that is not there", lambda p: edit(p, lambda t: t.replace('elem_set="lv', 'elem_set="xx'))),
        ("a step without its solver", lambda p: edit(deck_of(p), lambda t: re.sub(r"<solver.*?</solver>", "", t, flags=re.S))),
        ("a material without its fibre", lambda p: edit(deck_of(p), lambda t: re.sub(r"<fiber.*?</fiber>", "", t))),
        ("a load on a surface that is not there", lambda p: edit(deck_of(p), lambda t: t.replace('surface="', 'surface="xx_'))),
    ],
    mfem: [
        ("a boundary attribute 0", lambda p: edit(p, lambda t: re.sub(r"(boundary\n\d+\n)\d+ ", r"\g<1>0 ", t))),
        ("an element turned inside out", lambda p: edit(p, lambda t: re.sub(r"(elements\n\d+\n\d+ 4) (\d+) (\d+)", r"\1 \3 \2", t))),
    ],
}


def meshes_in(exports):
    """(reader, its argument) of every mesh in a folder of exports."""
    patterns = [
        (opencarp, "opencarp/*.pts"), (opencarp, "opencarp-binary/*.bpts"), (chaste, "chaste/*.node"),
        (svmultiphysics, "svmultiphysics/*-mesh-complete"), (openfoam, "openfoam/*/constant"), (febio, "febio/*.feb"), (mfem, "mfem/*.mesh"),
    ]
    for reader, pattern in patterns:
        for path in sorted(glob.glob(os.path.join(exports, pattern))):
            if reader is openfoam:
                yield reader, os.path.dirname(path)
            elif reader in (opencarp, chaste):
                yield reader, os.path.splitext(path)[0]
            elif not path.endswith("_inflate.feb"):
                yield reader, path


def refused_when_spoiled(reader, argument, spoil):
    with tempfile.TemporaryDirectory() as scratch:
        spoiled = os.path.join(scratch, os.path.basename(argument))
        if os.path.isdir(argument):
            shutil.copytree(argument, spoiled)
        else:
            for path in glob.glob(os.path.splitext(argument)[0] + "*"):  # the files of this mesh
                shutil.copy(path, scratch)
        spoil(spoiled)
        try:
            reader(spoiled)
        except (Refused, ValueError):  # ValueError: no number where one must be
            return True
    return False


def main(exports):
    failures, read, spoiled = [], 0, 0
    for reader, argument in meshes_in(exports):
        name = os.path.relpath(argument, exports)
        try:
            reader(argument)
            read += 1
        except Exception as error:
            failures.append(f"{name}: {type(error).__name__}: {error}")
    for reader, cases in SPOILED.items():
        arguments = [a for r, a in meshes_in(exports) if r is reader]
        if not arguments:
            continue
        argument = next((a for a in arguments if os.path.basename(a).startswith("myocardium")), arguments[0])
        for what, spoil in cases:
            spoiled += 1
            if not refused_when_spoiled(reader, argument, spoil):
                failures.append(f"{os.path.relpath(argument, exports)}: {what}: read without a word")
    for failure in failures:
        print("FAILED " + failure)
    print(f"{read} meshes read, {spoiled} spoiled copies, {len(failures)} failures")
    return 1 if failures or not read else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(os.path.abspath(sys.argv[1])))
