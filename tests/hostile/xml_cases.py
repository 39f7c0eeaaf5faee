"""XML that wants to grow, to hide what it is, or to break whoever reads it."""

from __future__ import annotations

import codecs

from tests.hostile.case import Case, reading

ROBOT = '<robot name="r"><link name="a"/>{}</robot>'
MODEL = '<mujoco><worldbody><body name="a"><geom size="1"/>{}</body></worldbody></mujoco>'
LAUGHS = "<!DOCTYPE r [<!ENTITY a0 'ha'>" + "".join(f"<!ENTITY a{n} '{f'&a{n - 1};' * 10}'>" for n in range(1, 12)) + "]>"
MANY = 1_000_000


def _attributes() -> bytes:
    return ROBOT.format("<link name='b' " + " ".join(f"a{n}='1'" for n in range(MANY // 5)) + "/>").encode()


def _model_attributes() -> bytes:
    return MODEL.format("<geom size='1' " + " ".join(f"a{n}='1'" for n in range(MANY)) + "/>").encode()


def _text(head: str, size: int, tail: str) -> bytes:
    return head.encode() + b" " * size + tail.encode()


def _encoded(encoding: str, declared: str | None = None, text: str = ROBOT.format("<link name='é'/>")) -> bytes:
    head = f'<?xml version="1.0" encoding="{declared or encoding}"?>'
    return (head + text).encode(encoding, "replace")


ENTITIES = (
    reading("a billion laughs in URDF: r.urdf", LAUGHS + ROBOT.format("<link name='&a11;'/>"), "HX008"),
    reading("a billion laughs in MJCF: m.xml", LAUGHS + MODEL.format("<geom name='&a11;'/>"), "HX008"),
    reading("a billion laughs in xacro: r.xacro", LAUGHS + ROBOT.format("&a11;"), "HX008"),
    reading("quadratic entities: r.urdf", f"<!DOCTYPE r [<!ENTITY a '{'a' * 50_000}'>]>" + ROBOT.format("&a;" * 50_000), "HX008"),
    reading("an external entity: r.urdf", "<!DOCTYPE r [<!ENTITY a SYSTEM 'file:///etc/passwd'>]>" + ROBOT.format("&a;"), "HX008"),
    reading("a parameter entity: r.urdf", "<!DOCTYPE r [<!ENTITY % a SYSTEM 'http://localhost/x'> %a;]>" + ROBOT.format(""), "HX008"),
    reading("an external document type: r.urdf", "<!DOCTYPE r SYSTEM 'http://localhost:1/x.dtd'>" + ROBOT.format(""), "HX005", code=0),
    reading("an undefined entity: r.urdf", ROBOT.format("<link name='&who;'/>"), "HX010", "HX022"),
    reading("references to no character: r.urdf", ROBOT.format("<link name='b&#0;&#xD800;&#1114112;'/>"), "HX005", code=0),
    reading(
        "entities in an included file: m.xml",
        '<mujoco><include file="b.xml"/></mujoco>',
        "HX008",
        **{"b.xml": LAUGHS + "<mujocoinclude><option a='&a11;'/></mujocoinclude>"},
    ),
    reading(
        "XInclude of a system file: r.urdf",
        ROBOT.format('<x:include xmlns:x="http://www.w3.org/2001/XInclude" href="/etc/passwd"/>'),
        code=0,
    ),
)

SIZES = (
    reading("two hundred thousand attributes in URDF: r.urdf", _attributes, code=0, seconds=60.0),
    reading("a million attributes in MJCF: m.xml", _model_attributes, "HX027", seconds=60.0),
    reading("two hundred thousand elements: r.urdf", lambda: ROBOT.format("<a/>" * (MANY // 5)).encode(), code=0, seconds=60.0),
    reading("a hundred thousand levels in URDF: r.urdf", ROBOT.format("<a>" * 100_000 + "</a>" * 100_000), "HX007"),
    reading("thirty thousand levels in MJCF: m.xml", MODEL.format("<body>" * 30_000 + "</body>" * 30_000), code=0, seconds=60.0),
    reading("a hundred thousand levels in xacro: r.xacro", ROBOT.format("<a>" * 100_000 + "</a>" * 100_000), "HX054"),
    reading("a hundred thousand open levels: r.urdf", "<robot>" + "<a>" * 100_000, "HX007"),
    reading("300 MB of URDF: r.urdf", lambda: _text('<robot name="r">', 300_000_000, "</robot>"), "HX007"),
    reading("300 MB of MJCF: m.xml", lambda: _text("<mujoco>", 300_000_000, "</mujoco>"), "HX007"),
    reading("300 MB of xacro: r.xacro", lambda: _text("<robot>", 300_000_000, "</robot>"), "HX007", seconds=60.0),
    reading("an attribute of 20 MB: r.urdf", lambda: ROBOT.format(f"<link name='{'x' * 20_000_000}'/>").encode(), code=0, seconds=60.0),
    reading("a tag of 10 MB: r.urdf", lambda: ROBOT.format(f"<{'x' * 10_000_000}/>").encode(), code=0, seconds=60.0),
    reading(
        "a number of a million digits: r.urdf",
        ROBOT.format(f"<link name='b'><inertial><mass value='{'9' * MANY}'/></inertial></link>"),
        "HX020",
    ),
    reading("a million numbers where three belong: m.xml", lambda: MODEL.format(f"<geom size='{'1 ' * MANY}'/>").encode(), "HX020"),
    reading(
        "two thousand million numbers of user data for each body: m.xml",
        f'<mujoco><size nuser_body="{2 * 10**9}"/><worldbody/></mujoco>',
        "HX007",
    ),
    reading("two thousand million keyframes: m.xml", f'<mujoco><size nkey="{2 * 10**9}"/><worldbody/></mujoco>', "HX007"),
    reading(
        "a mesh of ten thousand million points: m.xml",
        '<mujoco><asset><mesh name="a" builtin="wedge" params="100000 100000 1 1 0"/></asset><worldbody/></mujoco>',
        "HX007",
    ),
    reading(
        "a height field of a thousand million points: m.xml",
        '<mujoco><asset><hfield name="a" nrow="40000" ncol="40000" size="1 1 1 1"/></asset><worldbody/></mujoco>',
        "HX007",
    ),
    reading("many comments with hyphens: r.urdf", lambda: ROBOT.format("<!-- a -- b -->" * 50_000).encode(), "HX005", code=0, seconds=60.0),
    reading("many tags that never end: r.urdf", lambda: b"<robot>" + b"<a " * 200_000, "HX010", "HX022", "HX045", seconds=60.0),
    reading("many open comments: r.urdf", lambda: b"<robot>" + b"<!-- " * 100_000, "HX010", "HX022", "HX045", seconds=60.0),
    reading("many ampersands: r.urdf", lambda: ROBOT.format("& " * 200_000).encode(), "HX005", code=0, seconds=60.0),
)

ENCODINGS = (
    reading("UTF-16 with its mark: r.urdf", codecs.BOM_UTF16_LE + ROBOT.format("").encode("utf-16-le"), code=0),
    reading("UTF-16 without a mark: r.urdf", ROBOT.format("").encode("utf-16-le"), code=0),
    reading("UTF-32: r.urdf", ROBOT.format("").encode("utf-32"), "HX005", code=0),
    reading("an encoding of mainframes: r.urdf", _encoded("cp037"), "HX004"),
    reading("UTF-7: r.urdf", _encoded("utf-7"), code=0),
    reading("an encoding that does not exist: r.urdf", _encoded("utf-8", "klingon"), "HX005", code=0),
    reading("an encoding that is none of text: r.urdf", _encoded("utf-8", "zlib"), "HX005", code=0),
    reading("an encoding that refuses everything: r.urdf", _encoded("utf-8", "undefined"), "HX005", code=0),
    reading("an encoding of host names: r.urdf", _encoded("utf-8", "idna"), "HX005", code=0),
    reading("escapes as an encoding: r.urdf", _encoded("ascii", "unicode_escape"), code=0),
    reading("bytes that are not what they say: r.urdf", _encoded("latin-1", "utf-8"), "HX005", code=0),
    reading("two encodings in one file: r.urdf", ROBOT.format("<link name='é'/>").encode() + b"<!-- \xe9 -->", "HX005", code=0),
    reading("half a character at the end: r.urdf", ROBOT.format("").encode() + b"\xc3", "HX005", code=0),
    reading("overlong UTF-8: r.urdf", ROBOT.format("<link name='X'/>").encode().replace(b"X", b"\xc0\xaf"), "HX005", code=0),
    reading("NUL in the middle: r.urdf", ROBOT.format("<link name='b\0c'/>"), "HX005", code=0),
    reading("nothing but NUL: r.urdf", b"\0" * 100_000, "HX004"),
    reading("MJCF that is no UTF-8: m.xml", _encoded("latin-1", "utf-8", MODEL.format("<geom name='é' size='1'/>")), "HX005", code=0),
)

_NUMBERS = {
    "NaN": "nan",
    "an infinity": "inf",
    "more than a double holds": "1e999",
    "hexadecimal": "0x10",
    "a comma": "1,5",
    "an underscore": "1_0",
}
NUMBERS = (
    *(
        reading(
            f"{title} as a mass in URDF: r.urdf",
            ROBOT.format(f"<link name='b'><inertial><mass value='{text}'/></inertial></link>"),
            "HX020",
        )
        for title, text in _NUMBERS.items()
    ),
    *(
        reading(f"{title} as a size in MJCF: m.xml", MODEL.format(f"<geom size='{text}'/>"), "HX020")
        for title, text in _NUMBERS.items()
        if title != "hexadecimal"
    ),
    reading("hexadecimal as a size in MJCF, where it is a number: m.xml", MODEL.format("<geom size='0x10'/>"), code=0),
)

INCLUDES = (
    reading("MJCF that includes itself: m.xml", '<mujoco><include file="m.xml"/></mujoco>', "HX047"),
    reading(
        "two files that include each other: m.xml",
        '<mujoco><include file="b.xml"/></mujoco>',
        "HX047",
        **{"b.xml": '<mujocoinclude><include file="m.xml"/></mujocoinclude>'},
    ),
    reading(
        "xacro that includes itself: r.xacro", '<robot xmlns:xacro="x"><xacro:include filename="r.xacro"/></robot>', "HX054", seconds=60.0
    ),
    reading(
        "a model that attaches itself: m.xml",
        '<mujoco><asset><model name="m" file="m.xml"/></asset><worldbody><attach model="m" prefix="x"/></worldbody></mujoco>',
        "HX047",
        seconds=60.0,
    ),
)

COUNTS = (
    reading("a billion copies: m.xml", MODEL.format('<replicate count="1000000000"><geom size="1"/></replicate>'), "HX007"),
    reading("copies of copies: m.xml", MODEL.format('<replicate count="2">' * 40 + '<geom size="1"/>' + "</replicate>" * 40), "HX007"),
    reading("a count of many digits: m.xml", MODEL.format(f'<replicate count="{"9" * 5000}"><geom size="1"/></replicate>'), "HX020"),
    reading("a cloth of a billion points: m.xml", MODEL.format('<flexcomp name="f" count="30000 30000 1" spacing="1 1 1"/>'), "HX007"),
    Case(
        "a texture of a terabyte",
        {"m.xml": "<mujoco><asset><texture name='t' type='2d' builtin='flat' width='1000000' height='1000000'/></asset>"
         "<worldbody><body><geom size='1'/></body></worldbody></mujoco>"},
        ("convert", "m.xml", "../out/r.urdf"),
        0,
        (),
        60.0,
        ("r.urdf",),
    ),
)  # fmt: skip

CASES = (*ENTITIES, *SIZES, *ENCODINGS, *NUMBERS, *INCLUDES, *COUNTS)
