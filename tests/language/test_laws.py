"""Laws of parser, printer, reader and writer, over generated syntax trees and generated mechanisms."""

from __future__ import annotations

from hypothesis import HealthCheck, given, settings

from hymeko_x.ir import parts
from hymeko_x.ir.fields import identical
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.language.parser import parse
from hymeko_x.language.printer import print_document
from hymeko_x.language.syntax import ArcItem, Document, Field, Import, Item, Node
from hymeko_x.testing import DOCUMENTS, mechanisms
from tests.language.printed import read_text, text_of

FEW = settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


@FEW
@given(mechanisms())
def test_what_is_written_reads_back_equal(mechanism: Mechanism) -> None:
    assert read_text(text_of(mechanism)) == mechanism


@FEW
@given(mechanisms())
def test_notations_survive(mechanism: Mechanism) -> None:
    back = read_text(text_of(mechanism))
    assert {key: dict(notation) for key, notation in back.notations.items()} == {
        key: dict(notation) for key, notation in mechanism.notations.items()
    }
    written = [(key, *_written(part)) for key, part in _parts(mechanism)]
    assert written == [(key, *_written(part)) for key, part in _parts(back)]


def test_the_sign_of_zero_survives() -> None:
    inertial = parts.Inertial(1.0, (-0.0, 0.0, 0.0), (1.0, 1.0, 1.0, -0.0, -0.0, 0.0))
    body = Id("body", "a")
    back = read_text(text_of(Mechanism("r", Hypergraph({body: parts.Body(inertial)}))))
    assert identical(back.vertex(body, parts.Body).inertial, inertial)


@FEW
@given(mechanisms())
def test_order_is_kept(mechanism: Mechanism) -> None:
    back = read_text(text_of(mechanism))
    for kind in ("body", "joint"):
        keys = [key for key in (*mechanism.graph.vertices, *mechanism.graph.edges) if key.kind == kind]
        first = [key for key in mechanism.layout if key.kind == kind]
        expected = [*first, *(key for key in keys if key not in first)]
        assert [key for key in (*back.graph.vertices, *back.graph.edges) if key.kind == kind] == expected
    assert back.layout[: len(mechanism.layout)] == mechanism.layout
    for body, views in mechanism.shapes.items():
        assert [view.id for view in back.shapes[body]] == [view.id for view in views]


@FEW
@given(mechanisms())
def test_the_text_of_a_mechanism_is_canonical(mechanism: Mechanism) -> None:
    text = text_of(mechanism)
    assert text_of(read_text(text)) == text
    assert print_document(parse(text)) == text


@FEW
@given(DOCUMENTS)
def test_a_printed_tree_parses_to_the_same_tree(document: Document) -> None:
    text = print_document(document)
    parsed = parse(text)
    assert repr(_placeless(parsed)) == repr(_placeless(_header_as_field(document)))
    assert print_document(parsed) == text


def _parts(mechanism: Mechanism) -> list[tuple[object, object]]:
    vertices = [(key, part) for key, part in mechanism.graph.vertices.items()]
    found = [*vertices, *((key, edge) for key, edge in mechanism.graph.edges.items())]
    return sorted(found, key=lambda pair: pair[0])


def _written(part: object) -> tuple[object, ...]:
    """Everything in a part that tells how a value was written."""
    match part:
        case parts.Body(inertial) if inertial is not None:
            return (repr(inertial.written),)
        case parts.Body() | parts.World():
            return ()
        case _:
            return tuple(repr(getattr(arc.weight, "written", None)) for arc in getattr(part, "arcs", ()))


def _header_as_field(document: Document) -> Document:
    """A header is printed as the bare name that it is read from."""
    return Document((Field(document.header), *document.items)) if document.header else document


def _placeless(tree: Document) -> Document:
    return Document(tuple(map(_item, tree.items)), tree.header)


def _item(item: Item) -> Item:
    match item:
        case Node() | ArcItem():
            return item._replace(items=tuple(map(_item, item.items)), line=0, column=0)
        case Import():
            return item._replace(line=0, column=0)
        case _:
            return item._replace(line=0, column=0)
