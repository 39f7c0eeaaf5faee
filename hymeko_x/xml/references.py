"""References to joints and links in fragments of XML that the IR cannot represent, such as plugins."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from msgspec.structs import replace

if TYPE_CHECKING:
    from collections.abc import Container, Mapping

    from hymeko_x.ir.mechanism import Extra, Id, Mechanism

_ELEMENT = re.compile(
    r"(<(?P<tag>[\w:.-]*(?P<kind>joint|link|body)(?:_?names?)?)(?:\s[^<>]*)?>\s*)(?P<name>[^<>]*?)(?=\s*</(?P=tag)\s*>)", re.I
)
_OF_JOINT = re.compile(
    r"<(provideFeedback|implicitSpringDamper|cfmDamping|fudgeFactor|stop(Cfm|Erp|Kp|Kd)|spring(Reference|Stiffness)"
    r"|preserveFixedJoint|disableFixedJointLumping)\b"
)
"""What a fragment only has when it refers to a joint."""
_REFERENCE = re.compile(r"(\sreference\s*=\s*(?P<quote>[\"']))(?P<name>[^\"'<>]*)(?=(?P=quote))")


def with_new_references(text: str, joints: Mapping[str, str], links: Mapping[str, str], kept: Container[str] = ()) -> str:
    """The fragment with new names of joints and links, by the old ones, where an element such as <joint_name> is one of them.

    So is an attribute ``reference`` (of <gazebo>), which means a link of a ``kept`` name unless the fragment is about a joint; every
    other letter stays.
    """
    is_of_joint = _OF_JOINT.search(text) is not None
    either = {**{old: new for old, new in joints.items() if is_of_joint or old not in kept}, **links}

    def of_element(found: re.Match[str]) -> str:
        known = joints if found["kind"].lower() == "joint" else links
        return found[1] + known.get(found["name"], found["name"])

    return _REFERENCE.sub(lambda found: found[1] + either.get(found["name"], found["name"]), _ELEMENT.sub(of_element, text))


def with_new_names_in_fragments(mechanism: Mechanism, names: Mapping[Id, Id], formats: Container[str]) -> Mechanism:
    """The mechanism with the new ids of joints and bodies, by the old ones, in the fragments that it keeps of some formats."""
    joints, links = ({old.name: new.name for old, new in names.items() if old.kind == kind} for kind in ("joint", "body"))
    kept = {key.name for key in mechanism.graph.vertices if key.kind == "body"}

    def changed(extra: Extra) -> Extra:
        is_fragment = extra.format in formats and extra.text.startswith("<")
        return replace(extra, text=with_new_references(extra.text, joints, links, kept)) if is_fragment else extra

    return replace(mechanism, extras={key: tuple(map(changed, extras)) for key, extras in mechanism.extras.items()})
