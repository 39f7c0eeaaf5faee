"""Fields with a value of another type: each is refused once, at its place."""

from __future__ import annotations

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.formats import hymeko as words

BODIES = "a { mass 1 } b { mass 1 } "
JOINT = f"r : robot {{ {BODIES}\n@j {{ + a - b FIELD }} }}"
PLACES = {
    "a body": f"r : robot {{ {BODIES}\nc {{ FIELD }} }}",
    "a shape": f"r : robot {{ {BODIES}\nc {{ visual {{ box [1 1 1] FIELD }} }} }}",
    "a geometry": f"r : robot {{ {BODIES}\nc {{ visual {{ FIELD }} }} }}",
    "a joint": JOINT,
    "a dof": JOINT.replace("FIELD", "dof { FIELD }"),
    "a limit": JOINT.replace("FIELD", "limit { FIELD }"),
    "a safety controller": JOINT.replace("FIELD", "safety { k_velocity 1 FIELD }"),
    "a calibration": JOINT.replace("FIELD", "calibration { FIELD }"),
}
NEEDED = {"spring": "stiffness 1", "damper": "damping 1", "mass": "mass 1", "mesh": 'file "a.obj"', "subset": "+ s - m"}
NO_TEXT = {"number", "vec3", "numbers", "rgba", "integers", "pixels"}


def fields() -> list[tuple[str, str]]:
    """Every text with a place for a field that takes no text, and the field."""
    motion = [word.word for word in (*words.LIMIT_WORDS, *words.DOF_WORDS) if word.form in NO_TEXT]
    found = [("a body", word) for word in ("mass", "com", "inertia", "translation", "rotation")]
    found += [("a body", "inertia [1 1 1] axes")]
    found += [("a shape", word) for word in ("at", "color", "rgba", "mass", "density", "friction", "rotation", "fromto")]
    found += [("a geometry", word) for word in words.SOLIDS]
    found += [("a joint", word) for word in (*motion, "axis", "limit", "origin", "rpy")]
    found += [("a dof", word) for word in motion]
    found += [("a limit", word.word) for word in words.LIMIT_WORDS]
    found += [("a safety controller", word.word) for word in words.SAFETY_WORDS[1:]]
    found += [("a calibration", word.word) for word in words.CALIBRATION_WORDS]
    found += [(kind, word.word) for kind, part in words.PARTS.items() for word in part.words if word.form in NO_TEXT]
    return found


def text_of(place: str, field: str) -> str:
    if place in PLACES:
        return PLACES[place].replace("FIELD", field)
    edge = "@" if place in words.TARGETS else ""
    needed = "" if NEEDED.get(place, "").split()[:1] == field.split()[:1] else NEEDED.get(place, "")
    return f"r : robot {{ {BODIES} m : material {{}} v {{ visual {{ id=s box [1 1 1] }} }}\n{edge}x : {place} {{ {needed} {field} }} }}"


@pytest.mark.parametrize(("place", "word"), fields())
def test_a_text_in_the_place_of_a_number_is_refused_at_its_line(place: str, word: str) -> None:
    text = text_of(place, f'{word} "word"')
    with pytest.raises(Refusal) as caught:
        hx.loads(text, "hymeko")
    place_of_field = text.splitlines()[1].index(word.split()[-1] + ' "word"') + 1
    assert str(caught.value).startswith(f"<text>:2:{place_of_field}: error[HX062]: ")


UNITS = {
    "effort 5kg": "'effort' takes a unit of effort, and 'kg' is one of mass",
    "effort 5kN": None,
    "effort 5Nm": None,
    "damping 5mm": "'damping' takes a unit of damping, and 'mm' is one of length",
    "damping 5N*s/m": None,
    "damping 5Nm*s/deg": None,
    "stiffness 5Nm": None,
    "stiffness 5Nm/s": "'stiffness' takes a unit of stiffness, and 'Nm/s' is none",
    "armature 5g": None,
    "velocity 5rpm": None,
    "velocity 5deg/s": None,
    "velocity 5V": "'velocity' takes a unit of angle, and 'V' is none",
    "lower 5N": "'lower' takes a unit of angle, and 'N' is none",
    "anchor [1mm 1s 1]": "'anchor' takes a unit of length, and 's' is one of time",
}


@pytest.mark.parametrize("field", UNITS)
def test_a_unit_of_another_quantity_is_refused(field: str) -> None:
    expected = UNITS[field]
    if expected is None:
        assert not list(read(JOINT.replace("FIELD", field)))
        return
    with pytest.raises(Refusal) as caught:
        read(JOINT.replace("FIELD", field))
    assert f"error[HX062]: {expected}\n" in str(caught.value)


def read(text: str) -> Report:
    report = Report()
    hx.loads(text, "hymeko", report=report)
    return report


def test_axes_without_an_inertia_are_refused() -> None:
    with pytest.raises(Refusal, match="'axes' are those of an 'inertia', and there is none"):
        read(text_of("a body", "mass 1 axes [0 0 45]"))


@pytest.mark.parametrize("shape", ["", "collision { sphere 1 }"])
def test_the_colour_of_a_body_that_shows_nothing_is_reported(shape: str) -> None:
    report = read(text_of("a body", f"color [1 0 0] {shape}"))
    assert [diagnostic.message for diagnostic in report] == ["body 'c' has no 'color'; it is kept as it is"]
