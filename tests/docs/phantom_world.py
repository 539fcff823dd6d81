# SPDX-License-Identifier: GPL-3.0-or-later
"""The files that the pages name, made of a coarse phantom: what a reader has before the first command."""
import gzip
import shutil
import struct
import subprocess
from pathlib import Path

SIZE = ["--size", "74,70,60", "--spacing", "3.2,3.2,3.2"]
MESH = '\n[mesh]\nmeshes = ["myocardium", "chambers"]\nheart_edge_mm = 5\nblood_edge_mm = 10\n\n[fibers]\ngrid_mm = 4\ndemons_iterations = [10, 5]\n'
TAGS = {"lv_myocardium": 1, "rv_myocardium": 2, "papillary": 3, "la_wall": 4, "ra_wall": 5, "lv_blood": 6, "rv_blood": 7,
        "la_blood": 8, "ra_blood": 9, "aorta": 10, "pulmonary_artery": 11}
# Values of TotalSegmentator's task heartchambers_highres.
HEARTCHAMBERS = {"lv_myocardium": 1, "la_blood": 2, "lv_blood": 3, "ra_blood": 4, "rv_blood": 5, "aorta": 6,
                 "pulmonary_artery": 7, "papillary": 3}


class Labels:
    """A label map of one byte a voxel, as `heartgen phantom` writes it."""

    def __init__(self, path):
        data = gzip.decompress(Path(path).read_bytes())
        self.start = int(struct.unpack("<f", data[108:112])[0])
        assert struct.unpack("<h", data[70:72])[0] == 2, f"{path} does not hold bytes"
        self.head, self.voxels = data[:self.start], data[self.start:]
        self.size = struct.unpack("<3h", data[42:48])
        self.affine = [struct.unpack("<4f", data[280 + 16 * row:296 + 16 * row]) for row in range(3)]

    def mapped(self, value_of):
        return self.voxels.translate(bytes(value_of(value) for value in range(256)))

    def write(self, path, voxels):
        Path(path).write_bytes(gzip.compress(self.head + voxels, mtime=0))

    def box_lps(self, tag):
        """Corners of the voxels of a tag, in LPS mm."""
        where = [at for at, value in enumerate(self.voxels) if value == tag]
        nx, ny, _ = self.size
        lps = []
        for at in where:
            ijk = (at % nx, at // nx % ny, at // (nx * ny), 1)
            ras = [sum(a * b for a, b in zip(row, ijk)) for row in self.affine]
            lps.append((-ras[0], -ras[1], ras[2]))
        return [min(axis) for axis in zip(*lps)], [max(axis) for axis in zip(*lps)]


def write_box(path, low, high):
    """A closed box as an STL file in text."""
    corners = [(x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])]
    faces = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4),
             (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]
    lines = ["solid box"]
    for face in faces:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {x} {y} {z}" for x, y, z in (corners[c] for c in face)),
                  "endloop", "endfacet"]
    Path(path).write_text("\n".join(lines + ["endsolid box"]) + "\n", encoding="ascii")


def heartgen(folder, *words, accepted=(0,)):
    done = subprocess.run(["heartgen", *words], cwd=folder, capture_output=True, text=True)
    assert done.returncode in accepted, f"heartgen {' '.join(words)}: {done.stdout}{done.stderr}"


def make_labels(folder):
    """Label maps and masks under the names of the pages."""
    labels = Labels(folder / "phantom/truth/labels.nii.gz")
    for name in ("labels", "heart", "chambers", "stages/chambers"):
        (folder / name).parent.mkdir(exist_ok=True)
        labels.write(folder / f"{name}.nii.gz", labels.voxels)
    shutil.copyfile(folder / "phantom/truth/torso_mr_labels.nii.gz", folder / "torso.nii.gz")
    (folder / "masks").mkdir()
    for name, tag in TAGS.items():
        labels.write(folder / f"masks/{name}.nii.gz", labels.mapped(lambda value: int(value == tag)))
    numbers = {TAGS[name]: value for name, value in HEARTCHAMBERS.items()}
    labels.write(folder / "heartchambers.nii.gz", labels.mapped(lambda value: numbers.get(value, 0)))
    labels.write(folder / "edges.nii.gz", labels.mapped(lambda value: 5 if value == TAGS["lv_myocardium"] else 0))
    scar = bytearray(labels.mapped(lambda value: int(value == TAGS["lv_myocardium"])))
    half = len(scar) // 2
    scar[:half] = bytes(2 * value for value in scar[:half])
    labels.write(folder / "lge.nii.gz", bytes(scar))
    low, high = labels.box_lps(TAGS["la_wall"])
    write_box(folder / "line.stl", low, [(a + b) / 2 for a, b in zip(low, high)])


def make_images(folder):
    for name in ("ct", "patient", "in"):
        shutil.copyfile(folder / "phantom/ct.nii.gz", folder / f"{name}.nii.gz")
    for name in ("in.nrrd", "slice.nrrd"):
        heartgen(folder, "filter", "heat", "in.nii.gz", name, "--iterations", "1")
    for name in ("atlas.vtk", "landmarks.json"):
        shutil.copyfile(folder / "phantom" / name, folder / name)
    (folder / "fibers").mkdir()
    for axis in "xyz":
        shutil.copyfile(folder / f"phantom/truth/fiber_{axis}.nrrd", folder / f"fibers/fiber_{axis}.nrrd")
    shutil.copytree(folder / "phantom/truth", folder / "truth")


def make_meshes(folder):
    for name in ("mine", "heart"):
        shutil.copyfile(folder / "bundle/meshes/myocardium.vtu", folder / f"{name}.vtu")
    heartgen(folder, "export", "bundle", "--to", "msh,medit", "--mesh", "myocardium", "--output", "made")
    shutil.copyfile(folder / "made/msh/myocardium.msh", folder / "mine.msh")
    shutil.copyfile(folder / "made/medit/myocardium.mesh", folder / "remeshed.mesh")
    shutil.rmtree(folder / "made")
    heartgen(folder, "pack", "bundle", "heart-1.0.0.tar.zst")
    shutil.copytree(folder / "bundle", folder / "demo/bundle")
    shutil.copytree(folder / "phantom", folder / "demo/phantom")


def make_world(folder):
    heartgen(folder, "phantom", "phantom", *SIZE)
    make_labels(folder)
    make_images(folder)
    recipe = '[input]\nct = "ct.nii.gz"\natlas = "atlas.vtk"\nlandmarks = "landmarks.json"\n' + MESH
    (folder / "recipe.toml").write_text(recipe, encoding="utf-8")
    (folder / "coarse.toml").write_text(MESH, encoding="utf-8")
    heartgen(folder, "build", "recipe.toml", "--output", "bundle", "--quiet", accepted=(0, 3))
    make_meshes(folder)
