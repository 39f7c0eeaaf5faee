"""Robots that a description imports from other files: read as any file of their format, complete, and with their meshes found."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes, formats, pipeline
from hymeko_x.assets.pack import is_of_package
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from hymeko_x.diagnostics import Report
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.source import Files

MAX_DEPTH = 20
"""Files that import files that import files."""

_Arguments = tuple[tuple[str, float | str], ...]


def with_imports(source: Source, report: Report) -> Source:
    """The source, so that the robots that it imports can be read; what reading them says goes into the report."""
    return replace(source, parts=Importer(source, report))


class Importer:
    """Reads the robots that a source imports, each file once for the same arguments; a :data:`hymeko_x.source.Parts`."""

    def __init__(self, source: Source, report: Report, chain: tuple[str, ...] = ()) -> None:
        self._source, self._report, self._chain = source, report, chain
        self._read: dict[tuple[str, _Arguments], Mechanism] = {}

    def __call__(self, path: str, arguments: _Arguments, origin: Origin) -> Mechanism:
        """The robot in a file. Raises: Refusal HX040 for no such file, HX063 for arguments and circles, HX003, and those of its reader."""
        if (path, arguments) not in self._read:
            self._read[path, arguments] = self._robot(path, arguments, origin)
        return self._read[path, arguments]

    def _robot(self, path: str, arguments: _Arguments, origin: Origin) -> Mechanism:
        place, data = self._content(path, origin)
        if place in self._chain or len(self._chain) >= MAX_DEPTH:
            raise refuse(codes.BAD_TEMPLATE, f"the import of '{path}' leads back to itself", origin)
        format = formats.of_input(place, data)
        files = _files_beside(place, self._source.files)
        source = _with_values(Source(place, data, files, environment=self._source.environment), format, arguments, origin)
        importer = Importer(source, self._report, (*self._chain, place))
        robot = pipeline.read_anyway(replace(source, parts=importer), format, self._report)
        whole = pipeline.inlined(pipeline.fully_completed(robot, files, self._report), files)
        return _located(pipeline.flattened(whole), files, self._source)

    def _content(self, path: str, origin: Origin) -> tuple[str, bytes]:
        files = self._source.files
        place = files.find(path)
        try:
            if place is not None:
                return place, files.read(place)
        except OSError as error:
            raise refuse(codes.CANNOT_READ, f"the imported file '{path}' cannot be read: {error.strerror or error}", origin) from error
        raise refuse(codes.UNDEFINED_REFERENCE, f"the imported file '{path}' was not found", origin)


def _files_beside(path: str, files: Files) -> Files:
    """The files around an imported file."""
    return replace(files, base=_folder(path)) if isinstance(files, DiskFiles) else files


def _folder(path: str) -> Path:
    from pathlib import Path

    return Path(path).parent


def _with_values(source: Source, format: Format, arguments: _Arguments, origin: Origin) -> Source:
    """The source with the values of its arguments, or with the choices of its variants. Raises: Refusal HX063 where there are none."""
    values = {name: value if isinstance(value, str) else f"{value:.17g}" for name, value in arguments}
    if format.has_arguments:
        return replace(source, arguments=values)
    if format.has_variants:
        return replace(source, variants=values)
    if values:
        raise refuse(codes.BAD_TEMPLATE, f"the robot in '{source.name}' is {format.name}, which takes no arguments", origin)
    return source


# ---- meshes and images -----------------------------------------------------------------------------------------------------------


def _located(robot: Mechanism, files: Files, host: Source) -> Mechanism:
    """The robot with uris that lead to its files from the folder of the file that imports it.

    Uris of packages stay as they are; the place of such a file is noted where it is not found from there.
    """
    moved: dict[Id, VertexPart] = {}
    places = dict(robot.places)
    for key, asset in robot.assets():
        uri = asset.uri
        path = files.find(robot.places.get(uri, uri)) if uri else None
        if path is None or not uri or host.files.find(uri) == path:
            continue
        if is_of_package(uri) or "://" in uri:
            places[uri] = path
        else:
            places.pop(uri, None)
            moved[key] = replace(asset, uri=_way(path, host.name))
    return replace(robot, graph=robot.graph.replace(vertices=moved), places=places) if moved or places else robot


def _way(path: str, host: str) -> str:
    """The path of a file as the folder of a description sees it: relative where both are, else as it is."""
    folder = os.path.dirname(host) or "."
    if os.path.isabs(path) != os.path.isabs(folder):
        path, folder = os.path.abspath(path), os.path.abspath(folder)
    return os.path.relpath(path, folder).replace(os.sep, "/")
