"""Strategies for syntax trees of the HyMeKo language."""

from __future__ import annotations

from hypothesis import strategies as st

from hymeko_x.language import syntax
from hymeko_x.testing.values import NAMES, NUMBERS, PLAIN_NAMES, TEXTS, maybe

_WORDS = ("@", "rel", "seq", "concurrent")
_SIGNS = ("+", "-", "~", "->", "<-", "<>")
_MODIFIERS = ("", "", "|>", "*|>", "-|>", "<<copy>>", "<<use>>", "<<extend>>")
REFS = st.lists(NAMES, min_size=1, max_size=3).map(lambda path: syntax.Ref(tuple(path)))
RELATIONS_TO = st.builds(
    syntax.Ref,
    st.lists(NAMES, min_size=1, max_size=2).map(tuple),
    st.sampled_from(_SIGNS),
    st.sampled_from(_MODIFIERS),
)
QUANTITIES = st.builds(syntax.Quantity, NUMBERS, st.sampled_from(["deg", "mm", "kg*m^2", "rad/s", "%", "°", "µm", "N-m"]))
EXPRESSIONS = st.sampled_from(["", "1", "a + 2*pi", "sqrt(x)"]).map(syntax.Expression)
SCALARS = st.one_of(NUMBERS, st.just(float("inf")), TEXTS, REFS, RELATIONS_TO, QUANTITIES, EXPRESSIONS, st.just(syntax.Query()))
_FLAT_LISTS = st.lists(SCALARS, max_size=3).map(tuple) | st.lists(NUMBERS, max_size=3).map(tuple)
LISTS = st.recursive(_FLAT_LISTS, lambda inner: st.lists(inner | SCALARS, max_size=3).map(tuple), max_leaves=5)
VALUES = SCALARS | LISTS
_PARAMETERS = st.lists(st.builds(syntax.Parameter, NAMES, maybe(VALUES)), max_size=2).map(tuple)
_ARGUMENTS = st.lists(st.tuples(NAMES, VALUES), max_size=2).map(tuple)
_STEREOTYPES = st.lists(st.builds(syntax.Stereotype, REFS | RELATIONS_TO, maybe(_ARGUMENTS)), max_size=2).map(tuple)
_FIELDS = st.builds(syntax.Field, NAMES, maybe(VALUES), st.just("") | PLAIN_NAMES, st.just(0), st.just(0))
_IMPORTS = st.builds(syntax.Import, TEXTS, st.just("") | NAMES.filter(bool), st.just(0), st.just(0))


def _blocks(inner: st.SearchStrategy[syntax.Item]) -> st.SearchStrategy[syntax.Item]:
    items = st.lists(inner, max_size=4).map(tuple)
    nowhere, plain = (st.just(0), st.just(0)), st.sampled_from(["", "", *_WORDS])
    uses = st.lists(REFS, max_size=1).map(tuple)
    signature = (NAMES, items, _STEREOTYPES, maybe(_PARAMETERS), uses)
    within = st.lists(NAMES, min_size=1, max_size=2).map(tuple)
    return st.one_of(
        st.builds(syntax.Node, *signature, plain | st.just("my edge"), *nowhere, st.just(()), st.none()),
        st.builds(syntax.Node, *signature, plain, *nowhere, within, st.none()),
        st.builds(syntax.Node, NAMES, items, _STEREOTYPES, st.none(), st.just(()), plain, *nowhere, st.just(()), LISTS),
        st.builds(syntax.ArcItem, RELATIONS_TO, st.just("") | NAMES.filter(bool), maybe(LISTS), items, st.just(0), st.just(0)),
    )


ITEMS = st.recursive(_FIELDS | _IMPORTS, _blocks, max_leaves=12)
DOCUMENTS = st.builds(syntax.Document, st.lists(ITEMS, max_size=4).map(tuple), st.just("") | NAMES.filter(bool)).filter(
    lambda document: bool(document.header) or not _begins_like_a_header(document)
)
"""Whole texts. A text that begins with ``[name]`` has a header in the published examples, and not an arc with that weight."""


def _begins_like_a_header(document: syntax.Document) -> bool:
    first = document.items[0] if document.items else None
    return isinstance(first, syntax.ArcItem) and first.weight is not None and len(first.weight) == 1
