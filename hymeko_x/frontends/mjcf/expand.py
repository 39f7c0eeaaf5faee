"""Elements that stand for others: <include>, and what only MuJoCo can expand: <replicate>, <attach> and <flexcomp>.

MuJoCo expands in a process of its own: a model that attaches itself overflows its stack, and copies may take for ever. It gets the model
with its sub-models and files in one folder, each under a name of its own, since it writes the files of a sub-model without the folder
that they are in.
"""

from __future__ import annotations

import contextlib
import os
import posixpath
import re
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec import Struct, field
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.child_process import environment_with, python
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf.tree import parse, parse_text, verbatim
from hymeko_x.formats.mjcf.words import EXPANDED_BY_MUJOCO, joined, settings_of
from hymeko_x.source import file_stem
from hymeko_x.xml.tree import XmlNode

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.formats.mjcf.codec import Settings
    from hymeko_x.source import Source

# ---- <include> -----------------------------------------------------------------------------------------------------------------


def expand_includes(root: XmlNode, source: Source, report: Report) -> XmlNode:
    """The tree with every <include> replaced by what the file's root contains; nested ones as well.

    Raises: Refusal for a file that is missing, or included twice.
    """
    seen: dict[str, XmlNode] = {}
    stack = [root]
    while stack:
        parent = stack.pop()
        for child in parent.children:
            if child.tag == "include":
                parent.children = _with_included(parent.children, source, report, seen)
                break
        stack += [child for child in parent.children if child.children]
    return root


def _with_included(children: list[XmlNode], source: Source, report: Report, seen: dict[str, XmlNode]) -> list[XmlNode]:
    found: list[XmlNode] = []
    queue = list(reversed(children))
    while queue:
        child = queue.pop()
        if child.tag != "include":
            found.append(child)
            continue
        queue.extend(reversed(_included(child, source, report, seen).children))
    return found


def _included(include: XmlNode, source: Source, report: Report, seen: dict[str, XmlNode]) -> XmlNode:
    path, inner = included_source(include, source)
    if path in seen:
        first = seen[path].origin
        raise refuse(codes.REPEATED, f"the file '{inner.name}' is included twice; the first time in {first}", include.origin)
    seen[path] = include
    return parse(inner, report)


def included_source(include: XmlNode, source: Source) -> tuple[str, Source]:
    """The path of the file that an <include> names, and the file. Raises: Refusal when it names none, or one that cannot be read."""
    uri = include.attributes.get("file")
    if not uri:
        raise refuse(codes.MISSING_ATTRIBUTE, "<include> needs a file", include.origin)
    if include.children:
        raise refuse(codes.UNKNOWN_WORD, "<include> has no children", include.origin)
    uri = uri.replace("\\", "/")
    place, path = uri, source.files.find(uri)
    if path is None:
        place = posixpath.join(folder_from(source.name, include.file), uri)
        path = source.files.find(place)
    if path is None:
        raise refuse(codes.CANNOT_READ, f"the included file '{uri}' was not found", include.origin)
    name = os.path.normpath(os.path.join(os.path.dirname(source.name), place))
    try:
        return path, replace(source, name=name, data=source.files.read(path))
    except OSError as error:
        raise refuse(codes.CANNOT_READ, f"the included file '{uri}' cannot be read: {error.strerror}", include.origin) from error


def folder_from(main: str, file: str) -> str:
    """The folder of an included file as seen from that of the main one; empty for the same folder."""
    folder = os.path.relpath(os.path.dirname(file) or ".", os.path.dirname(main) or ".").replace(os.sep, "/")
    return "" if folder == "." else folder


# ---- expansion by MuJoCo -------------------------------------------------------------------------------------------------------

_CHILD = Path(__file__).with_name("child.py")
_LINE = re.compile(r",? line \d+\b")
"""A place in the text that MuJoCo gets, which is not the author's."""
_SECTIONS = frozenset({"mujoco", "asset", "worldbody", "deformable", "contact", "equality", "tendon", "actuator", "sensor", "keyframe"})
"""Elements without names of which a model has one of each."""
_REFUSED = 3
"""The exit code of the process when MuJoCo refuses the model; its message is the output."""

MOST_COPIES = 4000
"""How many elements an expansion may make. MuJoCo's time grows with their square: this many take some seconds."""
MOST_SECONDS = 30
MOST_BYTES = 2**31
"""What the process may use."""


def expand_by_mujoco(root: XmlNode, source: Source, report: Report) -> XmlNode:
    """The tree as MuJoCo writes it when something in it has to be expanded; else the tree as it is.

    Raises: Refusal when MuJoCo refuses the file, or is not there; HX007 when the expansion exceeds a limit.
    """
    found = next((element for element in root.walk() if element.tag in EXPANDED_BY_MUJOCO), None)
    if found is None:
        return root
    _check_size(root)
    if find_spec("mujoco") is None:
        raise refuse(codes.ENGINE_MISSING, f"<{found.tag}> is expanded by MuJoCo, which is not installed", found.origin)
    flat = flatten(root, source, report)
    code, text = _run_mujoco(verbatim(root), flat)
    if code == _REFUSED:
        reason = flat.with_own_names(_LINE.sub("", " ".join(text.split())))
        raise refuse(codes.ENGINE_REFUSED, f"MuJoCo refuses to expand <{found.tag}>: {reason}", found.origin)
    if code != 0:
        raise refuse(codes.TOO_LARGE, f"expanding <{found.tag}> ended MuJoCo ({text}): it has no end, or takes too much", found.origin)
    report.note(codes.REWRITTEN, f"<{found.tag}> was expanded by MuJoCo; what it became has its line", found.origin)
    expanded = parse_text(text)
    flat.restore(expanded)
    _give_origins(expanded, root, found)
    return expanded


def _give_origins(expanded: XmlNode, root: XmlNode, found: XmlNode) -> None:
    """Let what the author wrote be where it was written, and what was made of another element be where that is."""
    written = {(element.tag, element.attributes.get("name")): element for element in reversed([*root.walk()])}
    for element in expanded.walk():
        name = element.attributes.get("name")
        inherited = found if name is not None or element.parent is None else element.parent
        known = written.get((element.tag, name)) if name is not None or element.tag in _SECTIONS else None
        element.file, element.line = (known or inherited).origin.file, (known or inherited).origin.line


def _check_size(root: XmlNode) -> None:
    """Refuse what would fill the memory: copies of copies of copies.

    Raises: Refusal HX007.
    """
    total = 0
    stack = [(root, 1)]
    while stack:
        element, copies = stack.pop()
        if element.tag in ("replicate", "flexcomp"):
            copies *= _count(element)
        total += copies if copies > 1 else 0
        if total > MOST_COPIES:
            message = f"<{element.tag}> would make more than {MOST_COPIES} elements"
            raise refuse(codes.TOO_LARGE, message, element.origin, hint="expand it with MuJoCo, and convert the result")
        stack.extend((child, copies) for child in element.children)


def _count(element: XmlNode) -> int:
    """How often an element's content is made; 1 where the text is no number, which MuJoCo will refuse."""
    product = 1
    for word in element.attributes.get("count", "1").split()[:3]:
        product *= int(word) if word.isascii() and word.isdigit() and len(word) < 12 else MOST_COPIES if word.isdigit() else 1
    return product


def _run_mujoco(text: str, flat: FlatModel) -> tuple[int, str]:
    """The exit code of the process, and its output, or how it ended."""
    import json
    import subprocess

    parts = [text.encode(), *flat.models.values(), *flat.assets.values()]
    job = {
        "models": {name: len(data) for name, data in flat.models.items()},
        "assets": {name: len(data) for name, data in flat.assets.items()},
        "text": len(parts[0]),
        "compile": flat.has_keyframes,
    }
    command = python(str(_CHILD), str(MOST_SECONDS), str(MOST_BYTES))
    given = json.dumps(job).encode() + b"\n" + b"".join(parts)
    environment = environment_with("mujoco")
    try:
        ended = subprocess.run(command, input=given, env=environment, capture_output=True, timeout=2 * MOST_SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return -1, f"it took more than {2 * MOST_SECONDS} s"
    if ended.returncode in (0, _REFUSED):
        return ended.returncode, ended.stdout.decode("utf-8", "replace")
    return -1, f"exit code {ended.returncode}"


# ---- the model for MuJoCo ------------------------------------------------------------------------------------------------------

_FOLDERS = ("assetdir", "meshdir", "texturedir", "strippath")
_HOLDERS = ("mesh", "texture", "hfield", "skin", "flexcomp")
_NAMED_BY_FILE = ("mesh", "texture", "hfield")


class FlatModel(Struct):
    """What MuJoCo gets beside the main model: ``models`` and ``assets`` by their names there.

    ``uris`` are the paths of the files from the main model, ``tokens`` the way back, ``written`` how the main model refers to its own ones.
    """

    settings: Settings
    folders: dict[str, str]
    models: dict[str, bytes] = field(default_factory=dict)
    assets: dict[str, bytes] = field(default_factory=dict)
    tokens: dict[str, str] = field(default_factory=dict)
    uris: dict[str, str] = field(default_factory=dict)
    written: dict[str, str] = field(default_factory=dict)
    has_keyframes: bool = False

    def restore(self, root: XmlNode) -> None:
        """Give the files in an expanded model their own names again."""
        foreign = self.uris.keys() - self.written.keys()
        in_full = bool(foreign) and (self.settings.strip_path or self.settings.mesh_folder[:1] == "/")
        for element in root.walk():
            for name, text in element.attributes.items():
                if text in self.uris and name.startswith("file"):
                    element.attributes[name] = self.uris[text] if in_full else self._own_name(element.tag, text)
        if self.folders and not in_full:
            root.children.insert(0, XmlNode("compiler", dict(self.folders)))

    def _own_name(self, tag: str, name: str) -> str:
        if name in self.written:
            return self.written[name]
        folder = self.settings.texture_folder if tag == "texture" else self.settings.mesh_folder
        uri = self.uris[name]
        return posixpath.relpath(uri, folder) if folder and not uri.startswith("/") else uri

    def with_own_names(self, message: str) -> str:
        """A message of MuJoCo with the files' own names."""
        for name, uri in self.uris.items():
            message = message.replace(f"'{name}'", f"'{uri}'")
        return message


def flatten(root: XmlNode, source: Source, report: Report) -> FlatModel:
    """Give every file of a model, and of all models that it attaches, a name without a folder, in place.

    Raises: Refusal for a sub-model that is missing, unreadable, or that attaches itself.
    """
    compilers = [child.attributes for child in root.children if child.tag == "compiler"]
    folders = {name: text for attributes in compilers for name, text in attributes.items() if name in _FOLDERS}
    flat = FlatModel(settings_of(compilers), folders)
    waiting: list[tuple[XmlNode, str, tuple[str, ...]]] = [(root, "", ())]
    while waiting:
        model, folder, outer = waiting.pop()
        for element, uri in _flattened(model, folder, flat, source, own=not outer):
            if uri in outer:
                raise refuse(codes.REPEATED, f"the model '{uri}' attaches itself", element.origin)
            child = _opened(element, uri, source, report)
            waiting.append((child, posixpath.dirname(uri), (*outer, uri)))
            flat.has_keyframes = flat.has_keyframes or any(node.tag == "key" for node in child.walk())
        if outer:
            flat.models[_token(outer[-1], flat)] = verbatim(model).encode()
    return flat


def _flattened(model: XmlNode, folder: str, flat: FlatModel, source: Source, *, own: bool) -> list[tuple[XmlNode, str]]:
    """Rename the files of one model; returns the <model> elements in it with their paths."""
    compilers = [child.attributes for child in model.children if child.tag == "compiler"]
    settings = settings_of(compilers)
    for attributes in compilers:
        for name in _FOLDERS:
            attributes.pop(name, None)
    models: list[tuple[XmlNode, str]] = []
    for element in model.walk():
        if element.tag == "model" and "file" in element.attributes:
            uri = posixpath.normpath(posixpath.join(folder, element.attributes["file"].replace("\\", "/")))
            models.append((element, uri))
            element.attributes["file"] = _token(uri, flat)
        elif element.tag in _HOLDERS:
            _rename_files(element, folder, settings, flat, source, own=own)
    return models


def _rename_files(element: XmlNode, folder: str, settings: Settings, flat: FlatModel, source: Source, *, own: bool) -> None:
    below = settings.texture_folder if element.tag == "texture" else settings.mesh_folder
    for name in [name for name in element.attributes if name.startswith("file")]:
        text = element.attributes[name]
        uri = posixpath.join(folder, joined(below, text, settings))
        token = element.attributes[name] = _token(uri, flat)
        if own:
            flat.written[token] = text
        if name == "file" and element.tag in _NAMED_BY_FILE:
            element.attributes.setdefault("name", file_stem(text) or element.tag)
        path = source.files.find(uri)
        if path is not None and token not in flat.assets:
            with contextlib.suppress(OSError):  # then it is missing, which MuJoCo reports where it needs the file
                flat.assets[token] = source.files.read(path)
        if token in flat.assets and element.tag == "flexcomp":
            flat.models[token] = flat.assets[token]  # it is read where models are, before assets


def _token(uri: str, flat: FlatModel) -> str:
    """The name of a file where MuJoCo sees it: with its suffix, which tells the type."""
    token = flat.tokens.setdefault(uri, f"file{len(flat.tokens)}{posixpath.splitext(uri)[1]}")
    flat.uris[token] = uri
    return token


def _opened(element: XmlNode, uri: str, source: Source, report: Report) -> XmlNode:
    path = source.files.find(uri)
    if path is None:
        raise refuse(codes.CANNOT_READ, f"the model '{uri}' was not found", element.origin)
    try:
        data = source.files.read(path)
    except OSError as error:
        raise refuse(codes.CANNOT_READ, f"the model '{uri}' cannot be read: {error.strerror}", element.origin) from error
    model = parse(replace(source, name=uri, data=data), report)
    return expand_includes(model, source, report)
