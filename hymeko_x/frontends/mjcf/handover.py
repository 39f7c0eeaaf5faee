"""A model with its sub-models and files, as they are handed to MuJoCo for expansion: all in one folder, each under a name of its own.

MuJoCo writes the files of a sub-model without the folder that they are in, so the way back is remembered here.
"""

from __future__ import annotations

import contextlib
import posixpath
from typing import TYPE_CHECKING

from msgspec import Struct, field
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf.tree import Element, parse, verbatim
from hymeko_x.formats.mjcf.words import joined, settings_of
from hymeko_x.frontends.mjcf.include import expand_includes
from hymeko_x.ir.mechanism import file_stem

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.formats.mjcf.codec import Settings
    from hymeko_x.source import Source

_FOLDERS = ("assetdir", "meshdir", "texturedir", "strippath")
_HOLDERS = ("mesh", "texture", "hfield", "skin", "flexcomp")
_NAMED_BY_FILE = ("mesh", "texture", "hfield")


class Handover(Struct):
    """What MuJoCo is given beside the main model: ``models`` and ``assets`` by their names there.

    ``uris`` are the paths of the files from the main model, ``tokens`` the way back, ``said`` how the main model itself calls its own ones.
    """

    settings: Settings
    folders: dict[str, str]
    models: dict[str, bytes] = field(default_factory=dict)
    assets: dict[str, bytes] = field(default_factory=dict)
    tokens: dict[str, str] = field(default_factory=dict)
    uris: dict[str, str] = field(default_factory=dict)
    said: dict[str, str] = field(default_factory=dict)
    has_keyframes: bool = False

    def restore(self, root: Element) -> None:
        """Give the files in an expanded model their own names again."""
        foreign = self.uris.keys() - self.said.keys()
        in_full = bool(foreign) and (self.settings.strip_path or self.settings.mesh_folder[:1] == "/")
        for element in root.walk():
            for name, text in element.attributes.items():
                if text in self.uris and name.startswith("file"):
                    element.attributes[name] = self.uris[text] if in_full else self._own_name(element.tag, text)
        if self.folders and not in_full:
            root.children.insert(0, Element("compiler", dict(self.folders)))

    def _own_name(self, tag: str, name: str) -> str:
        if name in self.said:
            return self.said[name]
        folder = self.settings.texture_folder if tag == "texture" else self.settings.mesh_folder
        uri = self.uris[name]
        return posixpath.relpath(uri, folder) if folder and not uri.startswith("/") else uri

    def in_own_words(self, message: str) -> str:
        """A message of MuJoCo with the files' own names."""
        for name, uri in self.uris.items():
            message = message.replace(f"'{name}'", f"'{uri}'")
        return message


def hand_over(root: Element, source: Source, report: Report) -> Handover:
    """Give every file of a model, and of all models that it attaches, a name without a folder, in place.

    Raises: Refusal for a sub-model that is missing, unreadable, or that attaches itself.
    """
    compilers = [child.attributes for child in root.children if child.tag == "compiler"]
    folders = {name: text for attributes in compilers for name, text in attributes.items() if name in _FOLDERS}
    handover = Handover(settings_of(compilers), folders)
    waiting: list[tuple[Element, str, tuple[str, ...]]] = [(root, "", ())]
    while waiting:
        model, folder, above = waiting.pop()
        for element, uri in _flattened(model, folder, handover, source, own=not above):
            if uri in above:
                raise refuse(codes.REPEATED, f"the model '{uri}' attaches itself", element.origin)
            child = _opened(element, uri, source, report)
            waiting.append((child, posixpath.dirname(uri), (*above, uri)))
            handover.has_keyframes = handover.has_keyframes or any(node.tag == "key" for node in child.walk())
        if above:
            handover.models[_token(above[-1], handover)] = verbatim(model).encode()
    return handover


def _flattened(model: Element, folder: str, handover: Handover, source: Source, *, own: bool) -> list[tuple[Element, str]]:
    """Rename the files of one model; returns the <model> elements in it with their paths."""
    compilers = [child.attributes for child in model.children if child.tag == "compiler"]
    settings = settings_of(compilers)
    for attributes in compilers:
        for name in _FOLDERS:
            attributes.pop(name, None)
    models: list[tuple[Element, str]] = []
    for element in model.walk():
        if element.tag == "model" and "file" in element.attributes:
            uri = posixpath.normpath(posixpath.join(folder, element.attributes["file"].replace("\\", "/")))
            models.append((element, uri))
            element.attributes["file"] = _token(uri, handover)
        elif element.tag in _HOLDERS:
            _rename_files(element, folder, settings, handover, source, own=own)
    return models


def _rename_files(element: Element, folder: str, settings: Settings, handover: Handover, source: Source, *, own: bool) -> None:
    below = settings.texture_folder if element.tag == "texture" else settings.mesh_folder
    for name in [name for name in element.attributes if name.startswith("file")]:
        said = element.attributes[name]
        uri = posixpath.join(folder, joined(below, said, settings))
        token = element.attributes[name] = _token(uri, handover)
        if own:
            handover.said[token] = said
        if name == "file" and element.tag in _NAMED_BY_FILE:
            element.attributes.setdefault("name", file_stem(said) or element.tag)
        path = source.files.find(uri)
        if path is not None and token not in handover.assets:
            with contextlib.suppress(OSError):  # to MuJoCo it is missing, which it says where it needs it
                handover.assets[token] = source.files.read(path)
        if token in handover.assets and element.tag == "flexcomp":
            handover.models[token] = handover.assets[token]  # it is read where models are, before assets


def _token(uri: str, handover: Handover) -> str:
    """The name of a file where MuJoCo sees it: with its suffix, which says what it is."""
    token = handover.tokens.setdefault(uri, f"file{len(handover.tokens)}{posixpath.splitext(uri)[1]}")
    handover.uris[token] = uri
    return token


def _opened(element: Element, uri: str, source: Source, report: Report) -> Element:
    path = source.files.find(uri)
    if path is None:
        raise refuse(codes.CANNOT_READ, f"the model '{uri}' was not found", element.origin)
    try:
        data = source.files.read(path)
    except OSError as error:
        raise refuse(codes.CANNOT_READ, f"the model '{uri}' cannot be read: {error.strerror}", element.origin) from error
    model = parse(replace(source, name=uri, data=data), report)
    return expand_includes(model, source, report)
