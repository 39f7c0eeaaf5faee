"""One change at a time to a source: another value of an attribute, or an element less, in XML, HyMeKo and USD."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

from lxml import etree
from pxr import Gf, Sdf

from hymeko_x.language.parser import parse
from hymeko_x.language.printer import print_document
from hymeko_x.language.syntax import ArcItem, Field, Node, Quantity, Ref, is_list

_NUMBER = re.compile(r"-?\d+\.?\d*(?:[eE][-+]?\d+)?")


class Change(NamedTuple):
    """What was changed, in words, and the whole text with it."""

    what: str
    data: bytes


def changes(data: bytes, format: str) -> Iterator[Change]:
    """Every change of a source in a format, one after the other; the first is none at all."""
    return {"hymeko": _hymeko, "usd": _usd}.get(format, _xml)(data)


# ---- XML -------------------------------------------------------------------------------------------------------------------


def _xml(data: bytes) -> Iterator[Change]:
    root = etree.fromstring(data, etree.XMLParser(remove_comments=True, remove_pis=True, huge_tree=True, recover=True))
    yield Change("nothing", etree.tostring(root))
    tree = root.getroottree()
    for element in list(root.iter()):
        path = tree.getpath(element)
        for name, old in list(element.attrib.items()):
            element.set(name, other_text(old))
            yield Change(f"{path}/@{name}: {old} -> {element.get(name)}", etree.tostring(root))
            element.set(name, old)
        if element is not root and not _says_nothing(element) and not _is_repeated(element):
            parent, place = element.getparent(), element.getparent().index(element)
            parent.remove(element)
            yield Change(f"without {path}", etree.tostring(root))
            parent.insert(place, element)


def _says_nothing(element: Any) -> bool:
    """Whether an element only says zeros, or the axis that joints have anyway, which mean the same as leaving it out."""
    if element.tag == "axis" and [float(number) for number in _NUMBER.findall(element.get("xyz", ""))] == [1.0, 0.0, 0.0]:
        return True
    return len(element) == 0 and bool(element.attrib) and all(re.fullmatch(r"[-+0.\s]+", text) for text in element.attrib.values())


def _is_repeated(element: Any) -> bool:
    """Whether an element is the colour of a material that has the same colour in another shape as well."""
    material = element.getparent()
    if element.tag != "color" or material.get("name") is None:
        return False
    named = [other for other in element.getroottree().iter("material") if other.get("name") == material.get("name")]
    return sum(color.get("rgba") == element.get("rgba") for other in named for color in other.iter("color")) > 1


def other_text(text: str) -> str:
    """Another number, another truth, or another word."""
    opposite = {"true": "false", "false": "true"}.get(text)
    if opposite:
        return opposite
    numbers = list(_NUMBER.finditer(text))
    # a direction of another length is the same: the second number of most, and the angle of an axis and an angle
    found = numbers[-1 if len(numbers) == 4 else min(1, len(numbers) - 1)] if numbers else None
    if found is None or not re.fullmatch(r"[-+.\deE\s]+", text):
        return f"{text}_other"
    value = float(found[0])
    is_whole = "." not in found[0] and value and value == int(value) and value + 1.0 != value
    return f"{text[: found.start()]}{int(value) + 1 if is_whole else _other_number(value)}{text[found.end() :]}"


def _other_number(value: float) -> float:
    if math.isinf(value):
        return math.copysign(1.0, value)
    return value * 1.25 if value else 0.125


# ---- HyMeKo ----------------------------------------------------------------------------------------------------------------


def _hymeko(data: bytes) -> Iterator[Change]:
    document = parse(data.decode())
    yield Change("nothing", print_document(document).encode())
    for place, item in enumerate(document.items):
        for what, others in _around(item):
            items = (*document.items[:place], *others, *document.items[place + 1 :])
            yield Change(what, print_document(document._replace(items=items)).encode())


_ANYWAY = (("moves", Ref(("hinge",))), ("axis", Ref(("Z",))))
"""Fields that say what a dof does without them."""


def _around(item: Any) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """What may stand instead of an item: nothing, or the item with one change in it. Depth is that of the text."""
    if isinstance(item, Node):
        bodies = (item.name, item.name.replace("joint", "link"), item.name.removesuffix("_joint"))
        own = {f"without {body}" for body in bodies}  # a joint moves the body that bears its name anyway
        yield from ((f"{item.name}: {what}", (item._replace(items=items),)) for what, items in _inside(item.items) if what not in own)
    elif isinstance(item, Field):
        if (item.name, item.value) not in _ANYWAY:
            yield f"without {item.name}", ()
        yield from ((f"{item.name}: {item.value} -> {value}", (item._replace(value=value),)) for value in _other_values(item.value))
    elif isinstance(item, ArcItem):
        weights = () if item.weight is None else _other_values(item.weight)
        yield from ((f"{item.ref.dotted}: {item.weight} -> {weight}", (item._replace(weight=weight),)) for weight in weights)
        yield from ((f"{item.ref.dotted}: {what}", (item._replace(items=items),)) for what, items in _inside(item.items))
        yield f"without {item.ref.dotted}", ()


def _inside(items: tuple[Any, ...]) -> Iterator[tuple[str, tuple[Any, ...]]]:
    for place, item in enumerate(items):
        for what, others in _around(item):
            yield what, (*items[:place], *others, *items[place + 1 :])
        if isinstance(item, Node) and (item.name, item.items) != ("world", ()):  # which is there anyway
            yield f"without {item.name}", (*items[:place], *items[place + 1 :])


def _other_values(value: Any) -> Iterator[Any]:
    """Values with one number or text in them changed."""
    if isinstance(value, float):
        yield _other_number(value)
    elif isinstance(value, Quantity):
        yield value._replace(number=_other_number(value.number))
    elif isinstance(value, str):
        yield other_text(value)
    elif isinstance(value, Ref) and value.path in (("true",), ("false",)):
        yield Ref(("false" if value.path == ("true",) else "true",))
    elif is_list(value):
        for place, item in enumerate(value):
            yield from ((*value[:place], other, *value[place + 1 :]) for other in _other_values(item))


# ---- USD -------------------------------------------------------------------------------------------------------------------


_AS_IF_NOT_THERE = frozenset({"0", "inf", "-inf", "0.0", "(0, 0, 0)", "X", "Vt.Vec3fArray(0)"})
"""Values that mean the same as no value: no translation, no rotation, the first axis."""


_MOST = 2**31 - 1
"""The greatest whole number that every type of USD has."""


def _usd(data: bytes) -> Iterator[Change]:
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(data.decode())
    yield Change("nothing", layer.ExportToString().encode())
    paths: list[Sdf.Path] = []
    layer.Traverse("/", paths.append)
    for path in paths:
        if path.IsPrimPath():
            if not _is_empty(layer.GetPrimAtPath(path)):
                yield _without(layer, path)
        elif path.IsPropertyPath() and not _is_void(layer.GetObjectAtPath(path)):
            yield from _other_property(layer, path)


def _says_no_more(layer: Any, spec: Any) -> bool:
    """Whether a stage without it means the same: a default, an order of operations that do nothing."""
    if spec.name == "xformOpOrder":
        operations = (layer.GetAttributeAtPath(spec.owner.path.AppendProperty(name)) for name in spec.default)
        return all(operation is None or _says_no_more(layer, operation) for operation in operations)
    if spec.name == "xformOp:scale":
        return bool(spec.default == Gf.Vec3d(1))
    if isinstance(spec.default, Gf.Quatf | Gf.Quatd):
        return not any(spec.default.imaginary)
    return str(spec.default) in _AS_IF_NOT_THERE


def _is_void(spec: Any) -> bool:
    """Whether a property has no value, or one that is not of the robot: the box around a geometry, how a closed ball joint is turned."""
    if isinstance(spec, Sdf.AttributeSpec) and isinstance(spec.default, Sdf.ValueBlock):
        return True
    closes = spec.owner.properties.get("physics:excludeFromArticulation")
    is_closed_ball = spec.owner.typeName == "PhysicsSphericalJoint" and closes is not None and closes.default
    return spec.name == "extent" or (is_closed_ball and spec.name.startswith("physics:localRot"))


def _is_empty(prim: Any) -> bool:
    """Whether a prim has nothing but its name and its place."""
    is_plain = prim.typeName in ("", "Xform", "Scope") and {*prim.ListInfoKeys()} <= {"specifier", "typeName"}
    return is_plain and not (prim.nameChildren or prim.properties)


def _copy(layer: Any) -> Any:
    copy = Sdf.Layer.CreateAnonymous(".usda")
    copy.TransferContent(layer)
    return copy


def _without(layer: Any, path: Any) -> Change:
    copy = _copy(layer)
    spec = copy.GetObjectAtPath(path)
    if path.IsPrimPath():
        del (spec.nameParent or copy.pseudoRoot).nameChildren[spec.name]
    else:
        copy.GetPrimAtPath(path.GetPrimPath()).RemoveProperty(spec)
    return Change(f"without {path}", copy.ExportToString().encode())


def _other_property(layer: Any, path: Any) -> Iterator[Change]:
    copy = _copy(layer)
    spec = copy.GetObjectAtPath(path)
    if not (isinstance(spec, Sdf.AttributeSpec) and _says_no_more(copy, spec)):
        yield _without(layer, path)
    if isinstance(spec, Sdf.AttributeSpec) and spec.default is not None:
        old, spec.default = spec.default, _other_default(spec.default)
        yield Change(f"{path}: {str(old)[:60]} -> {str(spec.default)[:60]}", copy.ExportToString().encode())


def _other_default(value: Any) -> Any:
    if isinstance(value, bool):
        return not value
    if isinstance(value, float):
        return _other_number(value)
    if isinstance(value, int):
        return value + 1 if value < _MOST else value - 1
    if isinstance(value, str):
        return other_text(value)
    if isinstance(value, Sdf.AssetPath):
        return Sdf.AssetPath(f"{value.path}_other")
    if isinstance(value, Gf.Quatf | Gf.Quatd):
        return (value + type(value)(0.0, 0.1, 0.125, 0.07)).GetNormalized()
    if isinstance(value, Gf.Matrix4d):
        return value * Gf.Matrix4d(1.0).SetTranslate((0.0, 0.125, 0.0))
    items = list(value)
    if not items:
        return value
    place = min(1, len(items) - 1)
    items[place] = _other_default(items[place])
    return type(value)(items) if type(value).__module__.startswith("pxr.Vt") else type(value)(*items)
