"""JSON to mechanism: the text, the types of the documents, then what no type tells: references, names, places."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

from msgspec import ValidationError, convert

from hymeko_x import codes, formats
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.formats.json import ENDLESS, MARK, NUMBERS, VERSION
from hymeko_x.formats.json.document import PARTS, Document
from hymeko_x.frontends.json.data import settle
from hymeko_x.frontends.json.sound import check
from hymeko_x.ir.fields import layout_of
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import ROOT, Id, Mechanism, Provenance
from hymeko_x.ir.provenance import take_provenance
from hymeko_x.source import Reading

if TYPE_CHECKING:
    from msgspec import Struct

    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source

MAX_BYTES = 2**28

_PLACE = re.compile(r"(?P<what>.*?)(?: - at `(?P<path>[^`]*)`)?", re.DOTALL)
_ELEMENT = re.compile(r"\$\.(vertices|edges)\[(\d+)\]")


def read(source: Source, report: Report) -> Reading:
    """The mechanism that a document describes.

    Raises: Refusal with the path in the document: HX013 no JSON, HX066 another form than the schema's, HX023 duplicate names, HX040
    references, HX045 edges without their ends, HX062 values; HX007 for a text that is too large.
    """
    if len(source.data) > MAX_BYTES:
        raise refuse(codes.TOO_LARGE, f"the text has {len(source.data)} bytes, at most {MAX_BYTES} are read", Origin(source.name))
    root = _parsed(source)
    found = _converted(root, source.name)
    settle(found, source.name)
    check(found, source.name)
    return Reading(_mechanism(found, source.name))


def _parsed(source: Source) -> Any:
    """The values of the text. Raises: Refusal HX013, HX007."""
    origin = Origin(source.name)
    try:
        return json.loads(source.data.decode("utf-8-sig"), object_pairs_hook=_object, parse_constant=_constant)
    except UnicodeDecodeError as error:
        raise refuse(codes.NOT_JSON, f"byte {error.start} is not UTF-8", origin) from error
    except json.JSONDecodeError as error:
        raise refuse(codes.NOT_JSON, f"{error.msg[0].lower()}{error.msg[1:]}", Origin(source.name, error.lineno, error.colno)) from error
    except _Repeated as error:
        raise refuse(codes.NOT_JSON, f"the key '{error}' stands twice in one object", origin) from error
    except RecursionError as error:
        raise refuse(codes.TOO_LARGE, "the values are nested too deep", origin) from error
    except ValueError as error:  # a whole number of thousands of digits, or a word for a number that JSON does not have
        raise refuse(codes.NOT_JSON, str(error), origin) from error


class _Repeated(Exception):
    """A key that stands twice in one object."""


def _object(pairs: list[tuple[str, Any]]) -> object:
    """An object, or the number that it stands for."""
    found = dict(pairs)
    if len(found) != len(pairs):
        names = [name for name, _ in pairs]
        raise _Repeated(next(name for name in names if names.count(name) > 1))
    word = found.get(ENDLESS)
    return NUMBERS[word] if len(found) == 1 and isinstance(word, str) and word in NUMBERS else found


def _constant(word: str) -> object:
    name = {"Infinity": "inf", "-Infinity": "-inf", "NaN": "nan"}[word]
    raise ValueError(f'{word} is no JSON; write {{"{ENDLESS}": "{name}"}}')


def _converted(root: Any, name: str) -> Document:
    """The values as a document. Raises: Refusal HX066."""
    hint = "`hymeko-x schema` prints the form"
    if not isinstance(root, dict) or MARK not in root:
        message = f"$: the root has no key '{MARK}' with the version of the form, so that this is no robot"
        raise refuse(codes.BAD_DOCUMENT, message, Origin(name), hint=hint)
    if root[MARK] != VERSION or isinstance(root[MARK], bool):
        raise refuse(codes.BAD_DOCUMENT, f"$.{MARK}: expected version {VERSION}, found {str(root[MARK])[:80]}", Origin(name), hint=hint)
    try:
        return convert(root, Document)
    except ValidationError as error:
        found = _PLACE.fullmatch(str(error))
        assert found is not None
        path = found["path"] or "$"
        what = f"{found['what'][0].lower()}{found['what'][1:]}"
        raise refuse(codes.BAD_DOCUMENT, f"{path}: {what}", Origin(name), element=_label(root, path), hint=hint) from error


def _label(root: Any, path: str) -> str:
    """The element that a path leads into: ``joint 'elbow'``; empty where it leads into none, or into one without an id."""
    found = _ELEMENT.match(path)
    element = root[found[1]][int(found[2])] if found else None
    if not isinstance(element, dict) or not isinstance(element.get("id"), str):
        return ""
    return f"{str(element.get('type', 'element'))[:40]} '{element['id'][:80]}'"


def _mechanism(found: Document, name: str) -> Mechanism:
    """The mechanism of a document that was checked."""
    vertices = {_id(item): _part(item) for item in found.vertices}
    edges = {_id(item): Edge(_part(item), tuple(Arc(arc.to, arc.sign, arc.weight, arc.role) for arc in item.arcs)) for item in found.edges}
    about = {ROOT: found} | {_id(item): item for item in (*found.vertices, *found.edges)}
    notations = {key: dict(item.notations) for key, item in about.items() if item.notations}
    source = take_provenance(notations, {row.family for row in formats.FORMATS}, Provenance(formats.OWN.name, file=name))
    return Mechanism(
        name=found.name,
        graph=Hypergraph(vertices, edges),
        extras={key: item.extras for key, item in about.items() if item.extras},
        origins={key: Origin(name) for key in about if key != ROOT},
        notations={key: own for key, own in notations.items() if own},
        stereotypes={key: item.classes for key, item in about.items() if item.classes},
        layout=found.layout,
        source=source,
    )


def _id(item: Any) -> Id:
    return Id(KINDS[PARTS[type(item)]], item.id)


def _part(item: Struct) -> Any:
    """The part of an element."""
    part = PARTS[type(item)]
    layout = layout_of(part)
    assert layout is not None
    return part(*layout.values(item))
