"""The losses of a conversion in a few lines: one for each kind of loss, the physical first, and one for everything else."""

from __future__ import annotations

import re
from itertools import chain
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import diagnostics, formats
from hymeko_x.compare.extras import format_of
from hymeko_x.ir.digits import number_text
from hymeko_x.reporting.aspects import Aspect, aspect_of, kind_of
from hymeko_x.reporting.values import error_of, size_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from hymeko_x.compare.ledger import Loss

_EXAMPLES = 2
_SHORT = 3
"""So many digits a number has in a summary."""

_KINDS = ("body", "joint", "loop", "coupling", "tendon", "actuator", "sensor", "shape", "mesh", "contact", "frame", "camera", "pose")
"""The kinds of elements in the order of the summary; all others come after them."""

_PLURALS = {
    "body": "bodies",
    "pose": "named poses",
    "mesh": "meshes",
    "loss": "losses",
    "comment or declaration": "comments and declarations",
    "field or element": "fields and elements",
}
_SATELLITES = {"drive": "actuator", "sense": "sensor", "layer": "texture", "stance": "pose", "subset": "material"}
"""Edges that go with the element that they place or connect: they are not listed beside it."""

_WORDS = {
    "dofs.limits.lower": "position limits",
    "dofs.limits.upper": "position limits",
    "dofs.limits.velocity": "velocity limit",
    "dofs.limits.effort": "effort limit",
    "dofs.spring_ref": "spring reference",
    "dofs.ref": "coordinate reference",
    "dofs.safety": "safety controller",
    "inertial": "mass and inertia",
    "inertial.com": "centre of mass",
    "inertial.tensor": "inertia tensor",
    "content.distance": "surface",
    "weight": "pose",
    "weight.xyz": "position",
    "weight.rotation": "orientation",
    "target": "connection",
}
"""Fields of several kinds of elements in a roboticist's words; all others by the last of their names."""

_PLACE = re.compile(r"\[\d+\]")
_TAG = re.compile(r"<([\w:.-]+)")
_ON = re.compile(r"\+ ((?:body|world) '[^']*')")
_NUMBERS = re.compile(r"\[[^\]]{0,24}\]")
_WORD = re.compile(r"([a-z]+)(?:\(|$)")


class LossGroup(NamedTuple):
    """Losses of which the same became: of one kind of element, and of one field or of the whole element."""

    verb: str
    """``dropped``, ``approximated`` or ``added``."""
    kind: str
    field: str
    losses: tuple[Loss, ...]


def summary_lines(losses: Sequence[Loss]) -> list[str]:
    """A line for every kind of physical loss, then one for settings; the most important first."""
    gone = [loss for loss in losses if loss.fate != "kept"]
    lines = [_line(group) for group in groups(loss for loss in gone if aspect_of(loss) is Aspect.PHYSICS)]
    settings = [loss for loss in gone if aspect_of(loss) is Aspect.SETTINGS]
    return [*lines, *_settings(settings)]


def minor_line(losses: Sequence[Loss]) -> str:
    """What is only called, shown or described otherwise, in one line; empty where there is nothing."""
    gone = [loss for loss in losses if loss.fate != "kept"]
    found = {aspect: [loss for loss in gone if aspect_of(loss) is aspect] for aspect in Aspect}
    parts = []
    if found[Aspect.NAME]:
        first = found[Aspect.NAME][0]
        parts.append(f"{_counts(found[Aspect.NAME])} renamed ({_short(first.before)} -> {_short(first.after)})")
    if found[Aspect.FORM]:
        parts.append(f"{_counts(found[Aspect.FORM])} described in another form")
    if found[Aspect.APPEARANCE]:
        parts.append(f"appearance of {_counts(found[Aspect.APPEARANCE])}")
    if found[Aspect.TEXT]:
        parts.append(counted(len(found[Aspect.TEXT]), "comment or declaration"))
    return f"no physics: {'; '.join(parts)}" if parts else ""


def kept_line(losses: Sequence[Loss]) -> str:
    """What the output does not represent and yet keeps, in one line; empty where there is nothing."""
    kept = [loss for loss in losses if loss.fate == "kept"]
    if not kept:
        return ""
    named = [_what(group) for group in groups(loss for loss in kept if aspect_of(loss) is Aspect.PHYSICS)][:_SHORT]
    total = counted(len(kept), "field or element")
    return f"kept: {', '.join([*named, f'{total} in all'] if named else [total])}"


# ---- groups ------------------------------------------------------------------------------------------------------------


def groups(losses: Iterable[Loss]) -> list[LossGroup]:
    """Losses of one fate, kind and field together.

    Left out are edges that go with an element that is lost as well, and the other fields of elements that are of another kind now.
    """
    found: dict[tuple[str, str, str], list[Loss]] = {}
    losses = list(losses)
    changed = {loss.element for loss in losses if loss.field == "kind" and loss.fate == "approximated"}
    for loss in losses:
        if loss.element in changed and loss.field != "kind":
            continue
        verb = "added" if loss.before is None and not loss.field else loss.fate
        found.setdefault((verb, kind_of(loss), word_of(loss.field)), []).append(loss)
    _replace_shapes(found)
    _replace_capsules(found)
    if ("approximated", "actuator", "kind") in found:  # what drives a joint is another element then
        for verb in ("dropped", "added"):
            found.pop((verb, "drive", ""), None)
    whole = {(verb, kind) for verb, kind, field in found if not field}
    kept = [LossGroup(*key, tuple(losses)) for key, losses in found.items() if not _goes_with_another(*key, whole)]
    return sorted(kept, key=_rank)


def _replace_shapes(found: dict[tuple[str, str, str], list[Loss]]) -> None:
    """A shape that is gone from a body on which there are new ones is approximated by these: a capsule by a cylinder and spheres."""
    gone, new = found.get(("dropped", "shape", ""), []), found.get(("added", "shape", ""), [])
    bodies = {_body(loss.before) for loss in gone} & {_body(loss.after) for loss in new}
    if not bodies:
        return
    found["approximated", "shape", ""] = [loss for loss in gone if _body(loss.before) in bodies]
    for key, text in (("dropped", "before"), ("added", "after")):
        rest = [loss for loss in found.pop((key, "shape", "")) if _body(getattr(loss, text)) not in bodies]
        if rest:
            found[key, "shape", ""] = rest


def _replace_capsules(found: dict[tuple[str, str, str], list[Loss]]) -> None:
    """A capsule that is a cylinder now is approximated by it and by two spheres, which are new."""
    changed: list[Loss] = []
    capsules: list[Loss] = []
    for loss in found.pop(("approximated", "shape", "geometry"), []):
        is_capsule = (loss.before or "").startswith("capsule(") and (loss.after or "").startswith("cylinder(")
        (capsules if is_capsule else changed).append(loss)
    rest, ends = [], 2 * len(capsules)
    for loss in found.pop(("added", "shape", ""), []):
        is_end = ends > 0 and (loss.after or "").startswith("shape(geometry sphere(")
        ends -= is_end
        if not is_end:
            rest.append(loss)
    by_others = [*found.pop(("approximated", "shape", ""), []), *capsules]
    for verb, field, losses in (("approximated", "geometry", changed), ("approximated", "", by_others), ("added", "", rest)):
        if losses:
            found[verb, "shape", field] = losses


def _body(text: str | None) -> str:
    """The body that a shape is on, from how a difference shows the shape."""
    match = _ON.search(text or "")
    return match[1] if match else ""


def _goes_with_another(verb: str, kind: str, field: str, whole: set[tuple[str, str]]) -> bool:
    if kind == "mount":
        return any((verb, placed) in whole for placed in ("frame", "camera", "light", "sensor")) or not field
    return (verb, _SATELLITES.get(kind, "")) in whole


_VERBS = ("dropped", "kept", "approximated", "added")


def _rank(group: LossGroup) -> tuple[int, bool, int]:
    """What is gone first, and of that whole elements before fields."""
    kind = _KINDS.index(group.kind) if group.kind in _KINDS else len(_KINDS)
    return _VERBS.index(group.verb), bool(group.field), kind


def word_of(field: str) -> str:
    """A field in a roboticist's words, the same for all places of a list."""
    path = _PLACE.sub("", field).strip(".")
    return _WORDS.get(path) or path.rpartition(".")[2].replace("_", " ") or ("connection" if field else "")


# ---- lines -------------------------------------------------------------------------------------------------------------


def _line(group: LossGroup) -> str:
    return f"{group.verb}: {_what(group)}{_amount(group)}: {_names(group)}"


def _what(group: LossGroup) -> str:
    count = counted(len({loss.element for loss in group.losses}), group.kind)
    return f"{group.field} of {count}" if group.field else count


def counted(count: int, kind: str) -> str:
    """A number of elements or things: ``1 body``, ``2 bodies``."""
    return diagnostics.counted(count, kind, _PLURALS.get(kind, ""))


def _counts(losses: Sequence[Loss]) -> str:
    """How many elements of each kind."""
    elements: dict[str, set[str]] = {}
    for loss in losses:
        elements.setdefault(kind_of(loss), set()).add(loss.element)
    counts = sorted(((len(found), kind) for kind, found in elements.items() if kind != "mechanism"), reverse=True)
    shown = [counted(count, kind) for count, kind in counts[:_SHORT]]
    if len(counts) > _SHORT:
        shown.append(f"{sum(count for count, _ in counts[_SHORT:])} more")
    return ", ".join(shown) or "the robot"


def _amount(group: LossGroup) -> str:
    """The size of the numbers that are gone, or the largest error of those that are others."""
    if not group.field:
        return " by other shapes" if group.verb == "approximated" else ""
    if group.verb == "approximated":
        errors = [error for loss in group.losses if (error := error_of(loss)) is not None]
        return f", off by up to {_number(max(errors))}{_unit(group)}" if errors else _change(group)
    sizes = [size for loss in group.losses if (size := size_of(loss)) is not None]
    if not sizes:
        return ""
    least = "" if min(sizes) == max(sizes) else "up to "
    return f", {least}{_number(max(sizes))}{_unit(group)}"


def _change(group: LossGroup) -> str:
    """What the first of them was, and what it became, where both are a word or a few numbers."""
    texts = group.losses[0].before or "", group.losses[0].after or ""
    if all(map(_NUMBERS.fullmatch, texts)):
        return f" ({texts[0]} -> {texts[1]})"
    before, after = (_WORD.match(text.strip("'")) for text in texts)
    return f" ({_bare(before[1])} -> {_bare(after[1])})" if before and after and before[1] != after[1] else ""


def _bare(word: str) -> str:
    """The name of a geometry: ``mesh`` of a mesh shape."""
    return word.removesuffix("shape")


def _unit(group: LossGroup) -> str:
    units = sorted({loss.unit for loss in group.losses if loss.unit})
    return f" {' or '.join(units)}" if units else ""


def _number(value: float) -> str:
    return number_text(float(f"{value:.{_SHORT}g}"))


def _names(group: LossGroup) -> str:
    names = list(dict.fromkeys(loss.element.partition(" ")[2] or loss.element for loss in group.losses))
    return ", ".join([*names[:_EXAMPLES], *(["..."] if len(names) > _EXAMPLES else [])])


def _short(text: str | None) -> str:
    return "no name" if text is None or text == "none" else text


def _settings(losses: Sequence[Loss]) -> Iterator[str]:
    """What only one format or its engine understands: how much of it, and the first few by name."""
    by_format: dict[str, list[Loss]] = {}
    for loss in losses:
        by_format.setdefault(loss.field.partition(" ")[0], []).append(loss)
    for format, found in by_format.items():
        named = list(dict.fromkeys(chain.from_iterable(map(_names_of_setting, found))))
        shown = ", ".join([*named[: 2 * _EXAMPLES], *(["..."] if len(named) > 2 * _EXAMPLES else [])])
        yield f"dropped: {counted(len(found), 'setting')} that only {format} has: {shown}"


def _names_of_setting(loss: Loss) -> list[str]:
    """The name of an attribute, the tag of an element, or what the format calls it."""
    _, is_attribute, name = loss.field.rpartition("@")
    if is_attribute:
        return [name]
    text, row = loss.before or "", format_of(loss.field)
    named: list[str] = formats.loaded(row.settings)(text) if row is not None and row.settings else []
    tag = _TAG.match(text)
    return named or [f"<{tag[1]}>" if tag else loss.field.partition(" ")[2]]
