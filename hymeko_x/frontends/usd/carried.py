"""What ``hymeko:`` attributes say exactly, wherever the native values beside them are still those that were written.

Source: the law that an edit in the target format wins: each prim with carried elements has a digest of its native values.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.formats import usd as words
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import ROOT, WORLD, Extra, Id
from hymeko_x.ir.parts import EdgePart, Mesh, World
from hymeko_x.ir.values import Pose

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.formats.usd import Value
    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.ir.mechanism import RobotArc

_TABLES = ("id", "extras", "notations", "stereotypes")


def is_unchanged(prim: Any) -> bool:
    """Whether the native values of a prim are those from which its ``hymeko:`` attributes were written."""
    said = prim.GetAttribute(words.DIGEST)
    return bool(said) and said.Get() == words.digest(native_pairs(prim))


def native_pairs(prim: Any) -> Iterator[tuple[str, bytes]]:
    """Every property of a prim that is not ours, with its value as bytes, its type and its API schemas."""
    yield "@type", str(prim.GetTypeName()).encode()
    listed = prim.GetMetadata("apiSchemas")
    yield "@apiSchemas", " ".join(sorted(listed.GetAppliedItems() if listed is not None else [])).encode()
    for item in prim.GetAuthoredProperties():
        name = str(item.GetName())
        if name.startswith(words.PREFIX):
            continue
        targets = getattr(item, "GetTargets", None)
        yield name, " ".join(map(str, targets())).encode() if targets else words.value_bytes(item.Get())


def put_carried(draft: Draft) -> str | None:
    """Exchange what was read natively of each unchanged prim for what it carries; returns the mechanism's carried name."""
    name = None
    replaced: list[Id] = []
    carried: list[tuple[str, str, dict[str, Value]]] = []
    prims = [prim for prim in draft.scene.stage.Traverse() if prim.GetAuthoredPropertiesInNamespace("hymeko")]
    changed = {str(prim.GetPath()) for prim in prims if prim.HasAttribute(words.DIGEST) and not is_unchanged(prim)}
    edited = {key for path in changed for key in draft.elements.get(path, ())}
    for prim in prims:
        groups = _groups(prim, draft)
        path = str(prim.GetPath())
        if path in changed:
            continue
        replaced += [key for key in draft.elements.get(path, ()) if key not in edited]
        draft.take(prim, *(prim.GetAttribute(f"{words.PREFIX}made").Get() or ()))
        whole = groups.pop("mechanism", None)
        if whole is not None:
            name = str(whole.get("id", ""))
            draft.vertices.pop(WORLD, None)
            _put_tables(ROOT, whole, draft)
            _put_tables(WORLD, {key.removeprefix("world_"): value for key, value in whole.items() if key.startswith("world_")}, draft)
        carried += [(path, kind, pairs) for kind, pairs in groups.items() if Id(kind, str(pairs.get("id"))) not in edited]
    _forget(replaced, draft)
    for path, kind, pairs in carried:
        _put_element(path, kind, pairs, draft)
    _drop_dangling(draft)
    return name


def _groups(prim: Any, draft: Draft) -> dict[str, dict[str, Value]]:
    """The carried values of a prim by the kind of element that they belong to: a text each, and long arrays beside it."""
    groups: dict[str, dict[str, Value]] = {}
    for attribute in prim.GetAuthoredPropertiesInNamespace("hymeko"):
        _, kind, *rest = str(attribute.GetName()).split(":", 2)
        if kind not in words.PART_OF and kind != "mechanism":
            continue
        value = attribute.Get()
        if rest:
            groups.setdefault(kind, {})[rest[0]] = tuple(value) if value is not None else ()
            continue
        try:
            groups.setdefault(kind, {}).update(words.pairs_of(value))
        except (ValueError, TypeError, RecursionError):
            _say_unreadable(str(prim.GetPath()), Id(kind, ""), draft)
    return groups


def _say_unreadable(path: str, key: Id, draft: Draft) -> None:
    said = f"what '{path}' carries in hymeko: attributes cannot be read; it is left out"
    draft.report.error(codes.BAD_VALUE, said, draft.origin, element=str(key))


def _forget(keys: list[Id], draft: Draft) -> None:
    for key in keys:
        draft.vertices.pop(key, None)
        draft.edges.pop(key, None)
        draft.notations.pop(key, None)


def _put_element(path: str, kind: str, pairs: dict[str, Value], draft: Draft) -> None:
    key = Id(kind, str(pairs.get("id", "")))
    try:
        part, arcs = _element(kind, pairs)
    except (ValueError, TypeError, KeyError, AttributeError):
        _say_unreadable(path, key, draft)
        return
    if isinstance(part, EdgePart):
        draft.edges[key] = Edge(part, arcs)
    else:
        draft.vertices[key] = _with_geometry(part, pairs, path, draft) if isinstance(part, Mesh) else part
    draft.origins[key] = draft.origin
    draft.elements.setdefault(path, []).append(key)
    _put_tables(key, pairs, draft)


def _element(kind: str, pairs: dict[str, Value]) -> tuple[Any, tuple[RobotArc, ...]]:
    own = {name: value for name, value in pairs.items() if name.split(":")[0] not in (*_TABLES, "arcs", "native")}
    count = pairs.get("arcs:count", 0)
    arcs = tuple(_arc(f"arcs:{number}:", pairs) for number in range(count if isinstance(count, int) else 0))
    return words.part_of(words.PART_OF[kind], own), arcs


def _arc(prefix: str, pairs: dict[str, Value]) -> RobotArc:
    own = {name.removeprefix(prefix): value for name, value in pairs.items() if name.startswith(prefix)}
    kind, _, name = str(own["to"]).partition(" ")
    weight: Pose | tuple[float, ...] | None = None
    pose = {name.removeprefix("pose:"): value for name, value in own.items() if name.startswith("pose:")}
    if pose:
        weight = words.part_of(Pose, {name: value for name, value in pose.items() if name != "is"})
    elif "numbers" in own:
        weight = own["numbers"]  # type: ignore[assignment]
    sign = own.get("sign", 0)
    return Arc(Id(kind, name), sign if isinstance(sign, int) else 0, weight, str(own.get("role", "")))


def _with_geometry(mesh: Mesh, pairs: dict[str, Value], path: str, draft: Draft) -> Mesh:
    """A carried mesh whose points are those of the prim, or those of a file that is still there."""
    from dataclasses import replace

    native = draft.native_meshes.get(path)
    is_missing = mesh.uri is not None and draft.source.files.find(mesh.uri) is None
    if native is None or not (pairs.get("native") or is_missing):
        return mesh
    uri = None if is_missing else mesh.uri
    return replace(mesh, uri=uri, vertices=mesh.vertices or native.vertices, faces=mesh.faces or native.faces)


# ---- side tables -------------------------------------------------------------------------------------------------------------


def _put_tables(key: Id, pairs: dict[str, Value], draft: Draft) -> None:
    extras = _texts(pairs.get("extras"))
    found = [Extra(extras[at], extras[at + 1], extras[at + 2], _number(extras[at + 3])) for at in range(0, len(extras) - 3, 4)]
    if found:
        draft.extras.setdefault(key, []).extend(found)
    notations = _texts(pairs.get("notations"))
    for start in range(0, len(notations) - 1, 2):
        draft.note(key, notations[start], notations[start + 1])
    if key == ROOT:
        layout = _texts(pairs.get("layout"))
        draft.layout = [Id(layout[start], layout[start + 1]) for start in range(0, len(layout) - 1, 2)]
        if pairs.get("world"):
            draft.vertices.setdefault(WORLD, World())
    elif stereotypes := _texts(pairs.get("stereotypes")):
        draft.stereotypes[key] = tuple(stereotypes)


def _number(text: str) -> int:
    return int(text) if text.removeprefix("-").isdecimal() else 0


def _texts(value: Value | None) -> list[str]:
    return [str(item) for item in value] if isinstance(value, tuple) else []


def _drop_dangling(draft: Draft) -> None:
    """Edges whose ends were deleted with their prims, and a world that nothing needs."""
    known = {*draft.vertices, *draft.edges}
    for key, edge in list(draft.edges.items()):
        lost = [arc.target for arc in edge.arcs if arc.target not in known and arc.target != WORLD]
        if lost:
            del draft.edges[key]
            said = f"{key} refers to {lost[0]}, whose prim is not there any more; it is left out"
            draft.report.warn(codes.UNDEFINED_REFERENCE, said, draft.origin, element=str(key))
    if any(arc.target == WORLD for edge in draft.edges.values() for arc in edge.arcs):
        draft.vertices.setdefault(WORLD, World())
