"""Macros as a person would leave them: none that only calls another one, and no numbers behind names that are free."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.factor.flat import every_form
from hymeko_x.factor.forms import Hole, Signed, joined

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.factor.flat import FactoringState, Form, OpenMacro
    from hymeko_x.factor.forms import Dialect, Piece, Text


def tidy(workspace: FactoringState, dialect: Dialect) -> None:
    """Calls of a macro that only calls another one become calls of that one; then names lose numbers that they do not need."""
    for name, draft in [*workspace.macros.items()]:
        inner = draft.body[0] if len(draft.body) == 1 else None
        if inner is not None and inner.is_call and not any(map(_has_sign, inner.texts)):
            del workspace.macros[name]
            for form in every_form(workspace.lists):
                if form.is_call and form.tag == name:
                    _call_directly(form, draft, inner)
    for name in [*workspace.macros]:
        plain = name.rstrip("0123456789")
        if plain and plain != name and plain not in workspace.macros and plain not in dialect.taken:
            _rename(name, plain, workspace)


def _has_sign(text: Text) -> bool:
    return not isinstance(text, str) and any(isinstance(piece, Signed) for piece in text)


def _call_directly(form: Form, draft: OpenMacro, inner: Form) -> None:
    values = dict(zip(draft.parameters, form.texts, strict=True))
    form.tag, form.leaves, form.texts = inner.tag, inner.leaves, tuple([_filled(text, values) for text in inner.texts])


def _filled(text: Text, values: Mapping[str, Text]) -> Text:
    """The text with those of the call in its holes."""
    pieces: list[Piece] = []
    for piece in (text,) if isinstance(text, str) else text:
        value = values[piece.name] if isinstance(piece, Hole) else piece
        pieces += value if isinstance(value, tuple) and not isinstance(value, Hole | Signed) else [value]
    return joined(pieces)


def _rename(old: str, new: str, workspace: FactoringState) -> None:
    draft = workspace.macros[old]
    draft.name = new
    workspace.macros = {new if name == old else name: macro for name, macro in workspace.macros.items()}
    for form in every_form(workspace.lists):
        if form.is_call and form.tag == old:
            form.tag = new
