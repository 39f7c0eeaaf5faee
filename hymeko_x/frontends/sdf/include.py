"""<include>: the models of other files, put where they are included, as elements of the one tree."""

from __future__ import annotations

import posixpath
import re
from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x import codes
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.formats import sdf as words
from hymeko_x.frontends.sdf.old import modernised
from hymeko_x.source import Source
from hymeko_x.xml.parse import parse
from hymeko_x.xml.tree import XmlNode

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

MOST_FILES = 10_000
"""How many files one file may include in all; models that include each other could otherwise grow without bound."""
MOST_BYTES = 256 * 1024 * 1024

_REMOTE = re.compile(r"https?:", re.IGNORECASE)
_OVERRIDES = ("pose", "static")
_PARAMS = "experimental:params"
"""Changes of the included model, by the names of its elements."""
_OF_INCLUDE = ("uri", "name", "placement_frame")
"""The children of an <include> that are no elements of the model."""
_WITH_POSE = ("link", "frame", "model")
_REFERENCES = (("pose", "relative_to"), ("xyz", "expressed_in"))


class Included(Struct):
    """The texts of all files that elements come from, and the version of SDF in which each is written, by the name of the file.

    ``inserted`` has what comes into the place of each <include>, and ``parents`` the elements around these, by identity; ``paths`` the
    files that were found, by uri and folder.
    """

    source: Source
    report: Report
    texts: dict[str, bytes] = field(default_factory=dict)
    versions: dict[str, int] = field(default_factory=dict)
    inserted: dict[int, list[XmlNode]] = field(default_factory=dict)
    parents: dict[int, XmlNode] = field(default_factory=dict)
    paths: dict[tuple[str, str], list[str]] = field(default_factory=dict)
    count: int = 0
    bytes: int = 0


class _Place(Struct, frozen=True):
    """An <include> in the file ``path``, which ``chain`` of files leads to."""

    node: XmlNode
    folder: str
    chain: tuple[str, ...]


def expand_includes(root: XmlNode, source: Source, data: bytes, version: int, report: Report) -> Included:
    """Put the models of other files where they are included; an <include> that leads nowhere stays as it is. Not recursive."""
    found = Included(source, report, {source.name: data}, {source.name: version})
    stack = [_Place(node, "", ()) for node in _includes(root)]
    while stack:
        place = stack.pop()
        stack += [_Place(node, *below) for node, below in _expand(place, found)]
    for parent in found.parents.values():
        parent.children = list(_expanded(parent, found.inserted))
    return found


def _expanded(parent: XmlNode, inserted: Mapping[int, list[XmlNode]]) -> Iterator[XmlNode]:
    """The children of an element with models in the places of their includes, also of those in merged models. Not recursive."""
    stack = parent.children[::-1]
    while stack:
        node = stack.pop()
        if id(node) in inserted:
            stack += reversed(inserted[id(node)])
        else:
            yield node


def _includes(node: XmlNode) -> Iterator[XmlNode]:
    """The includes of worlds and models, also of nested ones; not those in plugins and other elements."""
    stack = [node]
    while stack:
        for child in stack.pop().children:
            if child.tag == "include":
                yield child
            elif child.tag in ("world", "model"):
                stack.append(child)


def _expand(place: _Place, found: Included) -> list[tuple[XmlNode, tuple[str, tuple[str, ...]]]]:
    """Put one model in the place of its include. Returns the includes in it, with the folder and the chain of files that led there."""
    uri = _text(place.node, "uri")
    path = _path(uri, place, found)
    if path is None:
        return []
    model = _model(path, place.node, found)
    if model is None:
        return []
    below = [(node, (posixpath.dirname(path), (*place.chain, path))) for node in _includes(model)]
    _check(place.node, uri, found.report)
    _override(model, place.node)
    parent = place.node.parent
    assert parent is not None
    merges = (place.node.attributes.get("merge") or "").lower() in ("true", "1")
    inserted = _merged(model, place.node) if merges else [model]
    for node in inserted:
        node.parent = parent
    found.inserted[id(place.node)] = inserted
    found.parents[id(parent)] = parent
    return below


# ---- finding ---------------------------------------------------------------------------------------------------------------


def _path(uri: str, place: _Place, found: Included) -> str | None:
    """The path of the model's file; None where there is none, which is reported."""
    problem = "is not found"
    if _REMOTE.match(uri):
        problem = "is on the network, and nothing is ever fetched; download it and name its folder with --package"
    elif uri:
        paths = _paths(uri.rstrip("/"), place, found)
        path = next((path for path in paths if path not in place.chain), None)
        if path is not None:
            return path
        problem = "includes itself" if paths else problem
    code = codes.CYCLE if problem == "includes itself" else codes.INCLUDE_NOT_FOUND
    found.report.error(code, f"the model '{uri}' {problem}; the <include> is kept as written", place.node.origin)
    return None


def _paths(uri: str, place: _Place, found: Included) -> list[str]:
    """The files that a uri in a file of this folder may mean: there, from the main file, or as the name of a model's folder."""
    folder = place.folder
    known = found.paths.get((uri, folder))
    if known is not None:
        return known
    is_path = ":" not in uri and not uri.startswith("/")
    near = posixpath.join(folder, uri) if folder and is_path else uri
    names = dict.fromkeys((near, uri, f"model://{uri}" if is_path else uri))
    paths = [path for name in names if (path := found.source.files.find(name) or _of_folder(name, place.node, found)) is not None]
    return found.paths.setdefault((uri, folder), paths)


def _of_folder(uri: str, include: XmlNode, found: Included) -> str | None:
    """The file that the `model.config` of a folder names for the highest version, else its `model.sdf`."""
    files = found.source.files
    config = files.find(f"{uri}/model.config")
    if config is None:
        path = files.find(f"{uri}/model.sdf")
        if path is not None:
            message = f"the folder of '{path}' has no model.config, without which libsdformat does not include it; it is included"
            found.report.warn(codes.MISSING_PART, message, include.origin)
        return path
    try:
        root = parse(Source(config, files.read(config)), Report()).root
    except (Refusal, OSError):
        return None
    versions = [(words.minor(node.attributes.get("version", "1.0")), node.text or "") for node in root.children if node.tag == "sdf"]
    known = [entry for entry in versions if entry[0] <= words.minor(words.VERSIONS[-1])]
    name = max(known, key=lambda entry: entry[0])[1].strip() if known else "model.sdf"
    return files.find(posixpath.join(posixpath.dirname(config), name))


def _model(path: str, include: XmlNode, found: Included) -> XmlNode | None:
    """The <model> of a file; None where it has none, which is reported."""
    report = found.report
    try:
        data = found.source.files.read(path)
        found.count, found.bytes = found.count + 1, found.bytes + len(data)
        if found.count > MOST_FILES or found.bytes > MOST_BYTES:
            report.error(codes.TOO_LARGE, f"more than {MOST_FILES} files are included; this one is not", include.origin)
            return None
        document = modernised(parse(Source(path, data), report), report)
    except (Refusal, OSError) as error:
        reason = error.diagnostic.message if isinstance(error, Refusal) else error.strerror
        report.error(codes.INCLUDE_NOT_FOUND, f"'{path}' cannot be read: {reason}; the <include> is kept as written", include.origin)
        return None
    root = document.root
    tops = [node for node in root.children if node.tag in ("model", "actor", "light")] if root.tag == "sdf" else []
    model = next((node for node in tops if node.tag == "model"), None)
    if len(tops) > 1 and model is not None:
        message = f"'{path}' has more than one <model>, <actor> or <light>, which libsdformat refuses; its first model is included"
        report.warn(codes.REPEATED, message, include.origin)
    if model is None:
        message = f"'{path}' has no <model>; the <include> is kept as written"
        report.warn(codes.MISSING_PART, message, include.origin)
        return None
    found.texts[path] = document.data
    version = root.attributes.get("version", words.DEFAULT_VERSION)
    found.versions[path] = words.minor(version if version in words.VERSIONS else words.DEFAULT_VERSION)
    return model


# ---- changing --------------------------------------------------------------------------------------------------------------


def _text(node: XmlNode, tag: str) -> str:
    return next(((child.text or "").strip() for child in node.children if child.tag == tag), "")


def _check(include: XmlNode, uri: str, report: Report) -> None:
    """Report what libsdformat reads otherwise in an include."""
    if _text(include, "placement_frame") and include.child("pose") is None:
        message = f"the <include> of '{uri}' has a <placement_frame> and no <pose>, which libsdformat refuses; the pose is zero"
        report.warn(codes.MISSING_PART, message, include.origin)
    if (params := include.child(_PARAMS)) is not None:
        message = f"<{_PARAMS}> of the <include> of '{uri}' is not read: the model is included as its file has it"
        report.warn(codes.UNKNOWN_WORD, message, params.origin)


def _override(model: XmlNode, include: XmlNode) -> None:
    """What the include gives in place of the model's own, and besides: name, pose, whether it stands, placement frame, further elements."""
    name = _text(include, "name")
    if name:
        model.attributes["name"] = name
    placement = _text(include, "placement_frame")
    if placement:
        model.attributes["placement_frame"] = placement
    for child in include.children:
        if child.tag in _OVERRIDES:
            model.children = [own for own in model.children if own.tag != child.tag]
        if child.tag not in _OF_INCLUDE:
            child.parent = model
            model.children.append(child)


def _merged(model: XmlNode, include: XmlNode) -> list[XmlNode]:
    """The content of a model for the model around it; a frame stands for the model's own."""
    name = f"_merged__{model.attributes.get('name', 'model')}__model_frame__"
    links = [node.attributes.get("name", "") for node in model.children if node.tag == "link"]
    frame = XmlNode("frame", {"name": name}, None, include.file, include.line, include.start)
    canonical = model.attributes.get("canonical_link") or next(iter(links), "")
    if canonical:
        frame.attributes["attached_to"] = canonical
    pose = model.child("pose") or XmlNode("pose", {}, frame, include.file, include.line)
    pose.attributes.setdefault("relative_to", words.MODEL_FRAME)
    pose.parent = frame
    frame.children = [pose]
    content = [node for node in model.children if node.is_element and node.tag not in ("pose", "static")]
    for node in content:
        _refer_to(name, node)
    return [frame, *content]


def _refer_to(frame: str, node: XmlNode) -> None:
    """Give a child of a merged model, and all that names the model's frame in it, in the frame that stands for it."""
    poses = [child for child in node.children if child.tag == "pose"]
    if node.tag in _WITH_POSE and not node.attributes.get("attached_to"):
        if not poses:
            poses = [XmlNode("pose", {}, node, node.file, node.line)]
            node.children.insert(0, poses[0])
        poses[0].attributes.setdefault("relative_to", frame)
    if node.attributes.get("attached_to") == words.MODEL_FRAME:
        node.attributes["attached_to"] = frame
    inside = [node] if node.tag == "model" else list(node.walk())
    for member in (*inside, *poses):
        for tag, attribute in _REFERENCES:
            if member.tag == tag and member.attributes.get(attribute) == words.MODEL_FRAME:
                member.attributes[attribute] = frame
        if member.tag in ("parent", "child") and (member.text or "").strip() == words.MODEL_FRAME:
            member.text = frame
