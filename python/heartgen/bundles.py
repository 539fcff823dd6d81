# SPDX-License-Identifier: GPL-3.0-or-later
"""Model bundles: open, build, validate."""

from __future__ import annotations

import io
import json
import os
from functools import cached_property
from typing import Any, Callable, Mapping, Optional, Sequence

from . import _native
from .images import Image
from .meshes import Mesh, Path

Progress = Callable[[str, float, bool], Any]


class Certificate:
    """What was measured of a model, with bounds and verdicts."""

    def __init__(self, text: str) -> None:
        self._json = json.loads(text)

    def __repr__(self) -> str:
        return f"<heartgen.Certificate {self.verdict}: {len(self.rows)} rows, {len(self.failed)} failed>"

    @property
    def verdict(self) -> str:
        """ "passed", "warned", "failed" or "told"."""
        return self._json["verdict"]

    @property
    def rows(self) -> list[dict[str, Any]]:
        """Dictionaries with group, scope, metric, value, unit, bounds, verdict and reason."""
        return self._json["rows"]

    @property
    def failed(self) -> list[dict[str, Any]]:
        return [row for row in self.rows if row.get("verdict") == "failed"]

    @property
    def warnings(self) -> list[dict[str, Any]]:
        return self._json["warnings"]

    @property
    def uses(self) -> list[dict[str, Any]]:
        """What the model is fit for, from eikonal to finite volumes."""
        return self._json["uses"]

    def value(self, metric: str, scope: str) -> float:
        """One figure: value("dihedral_min", "myocardium")."""
        for row in self.rows:
            if row["metric"] == metric and row["scope"] == scope:
                return row["value"]
        raise KeyError(f"no row {metric!r} of {scope!r}")


class Bundle:
    """A folder with a model: open("bundle")."""

    def __init__(self, folder: Path) -> None:
        self.folder = os.fspath(folder)
        _native.require_bundle(self.folder)
        with io.open(os.path.join(self.folder, "manifest.json"), encoding="utf-8") as file:
            self.manifest: dict[str, Any] = json.load(file)

    def __repr__(self) -> str:
        return f"<heartgen.Bundle {self.name} {self.version}: {', '.join(self.mesh_names)}>"

    @property
    def name(self) -> str:
        return self.manifest["name"]

    @property
    def version(self) -> str:
        return self.manifest["version"]

    @property
    def content_id(self) -> str:
        """The same for the same model, wherever it was built."""
        return self.manifest["content_id"]

    @property
    def mesh_names(self) -> list[str]:
        return sorted(self.manifest["meshes"])

    def mesh(self, name: str = "myocardium") -> Mesh:
        """One of its meshes: points, cells, regions, surfaces, fibres."""
        return Mesh(_native.bundle_mesh(self.folder, name), name=name)

    @cached_property
    def labels(self) -> Image:
        """The label map; region_tags() has the names."""
        return Image(*_native.bundle_labels(self.folder))

    @cached_property
    def certificate(self) -> Certificate:
        """As it stands in the bundle; validate() measures again."""
        return Certificate(_native.certificate(self.folder))

    def verify(self) -> list[tuple[str, str]]:
        """Files that are not what the manifest says, with what is wrong; empty where the bundle is whole."""
        return _native.verify(self.folder)

    def export(self, format: str, folder: Path, meshes: Optional[Sequence[str]] = None, unit: str = "") -> list[str]:
        """Writes its meshes for another program, see formats(). Returns the files."""
        return [file for name in meshes or self.mesh_names for file in self.mesh(name).export(format, folder, unit)]

    def pack(self, archive: Path) -> None:
        """One file of it, .tar.zst."""
        _native.pack(self.folder, os.fspath(archive))


def open(folder: Path) -> Bundle:  # noqa: A001
    """A bundle in a folder."""
    return Bundle(folder)


def unpack(archive: Path, folder: Path) -> Bundle:
    """Unpacks a bundle that pack wrote, checks every file, and opens it."""
    _native.unpack(os.fspath(archive), os.fspath(folder))
    return Bundle(folder)


def validate(bundle: Bundle) -> Certificate:
    """The certificate of a bundle, measured again. A damaged bundle raises Error."""
    return Certificate(_native.validate(bundle.folder))


def build(
    recipe: Path = "",
    *,
    output: Path,
    ct: Path = "",
    labels: Path = "",
    preset: str = "",
    atlas: Path = "",
    settings: Optional[Mapping[str, Any]] = None,
    progress: Optional[Progress] = None,
    cache: Path = "",
    replace: bool = False,
    accept_doubtful: bool = False,
) -> Bundle:
    """Builds a bundle from a CT, or labels of it, as `heartgen build` does.

    recipe: a .toml file, or none for every setting's default. settings: what is changed of it, by section:
    {"name": "heart-7", "mesh": {"heart_edge_mm": 1.2}}. progress(stage, share, has_ended) is called as each stage begins
    and ends; what it raises ends the build. cache: a folder that keeps stages for the next build.
    """
    changed = {key: dict(value) if isinstance(value, Mapping) else value for key, value in (settings or {}).items()}
    given = {"ct": ct, "labels": labels, "atlas": atlas}
    files = {key: os.fspath(path) for key, path in given.items() if path}
    if files:
        changed["input"] = {**changed.get("input", {}), **files}
    if preset:
        changed["labels"] = {**changed.get("labels", {}), "preset": preset}
    _native.build(
        os.fspath(recipe), changed, os.fspath(output), os.fspath(cache), replace, accept_doubtful, progress
    )
    return Bundle(output)


def phantom(
    folder: Path,
    size: Sequence[int] = (256, 256, 160),
    spacing: Sequence[float] = (1.4, 1.4, 1.9),
    variant: int = 0,
    noise_hu: float = 22.0,
) -> str:
    """Writes an analytic thorax: CT, truth, landmarks, atlas. Returns the recipe that builds it."""
    _native.write_phantom(os.fspath(folder), tuple(size), tuple(spacing), variant, noise_hu)
    return os.path.join(os.fspath(folder), "recipe.toml")
