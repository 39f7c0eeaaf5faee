"""SDF that includes, nests and refers without end, and that leads elsewhere."""

from __future__ import annotations

from tests.hostile.case import Case, reading
from tests.hostile.path_cases import CONFINED

MANY = 5_000


def model(inside: str) -> str:
    """A file with a model that has a link."""
    return f'<sdf version="1.9"><model name="m"><link name="l"/>{inside}</model></sdf>'


def include(uri: str) -> str:
    """An <include>."""
    return f"<include><uri>{uri}</uri></include>"


def _numbered(text: str, count: int = MANY) -> str:
    """The text once for each number ``N``, after which comes ``O``, and 0 after the last one."""
    return "".join(text.replace("N", str(n)).replace("O", str((n + 1) % count)) for n in range(count))


def _world() -> bytes:
    inside = _numbered('<model name="mN"><link name="l"/></model>')
    return f'<sdf version="1.9"><world name="w">{inside}</world></sdf>'.encode()


def _confined(title: str, uri: str, *codes: str) -> Case:
    return Case(title, {"r.sdf": model(include(uri)), "../model.sdf": model("")}, ("info", "r.sdf", *CONFINED), 1, codes)


_SHAPE = '<link name="k"><collision name="c"><geometry>{}</geometry></collision></link>'
_HEIGHTS = "<heightmap><uri>file:///dev/zero</uri><size>1e308 1e308 1e308</size><sampling>4294967295</sampling></heightmap>"
_IMAGE = "<image><uri>/dev/zero</uri><scale>1e-308</scale><granularity>2147483647</granularity></image>"
_POINTS = f"<polyline>{'<point>0 0</point>' * MANY}<height>1</height></polyline>"
_AXIS = "<axis><xyz>0 1 0</xyz></axis>"
_JOINT = f'<link name="lN"/><joint name="jN" type="revolute"><parent>lN</parent><child>lO</child>{_AXIS}</joint>'

INCLUDES = (
    reading("SDF that includes itself: r.sdf", model(include("r.sdf")), "HX043"),
    reading("two models that include each other: r.sdf", model(include("b.sdf")), "HX043", **{"b.sdf": model(include("r.sdf"))}),
    reading("a model of the network: r.sdf", model(include("https://localhost:1/a")), "HX053"),
    reading("five thousand models that are not there: r.sdf", lambda: model(include("x") * MANY).encode(), "HX053", seconds=60.0),
    reading("a model that is no XML: r.sdf", model(include("b.sdf")), "HX053", **{"b.sdf": "\0" * 1000}),
    reading("a folder without a model: r.sdf", model(include("d")), "HX053", **{"model.config": "<model/>"}),
    _confined("a model outside", "../model.sdf", "HX053"),
    _confined("a model of the folders above", "model://../..", "HX053"),
    _confined("a model at a path of the system", "file:///etc/passwd", "HX053"),
)

SIZES = (
    reading("five thousand models in a world: r.sdf", _world, code=0, seconds=60.0),
    reading(
        "three thousand models in each other: r.sdf",
        '<sdf version="1.9">' + '<model name="m">' * 3000 + "</model>" * 3000 + "</sdf>",
        "HX007",
    ),
    reading(
        "five thousand frames in a circle: r.sdf",
        lambda: model(_numbered('<frame name="fN"><pose relative_to="fO">1 0 0 0 0 0</pose></frame>')).encode(),
        "HX043",
        seconds=60.0,
    ),
    reading(
        "five thousand frames that are attached in a circle: r.sdf",
        lambda: model(_numbered('<frame name="fN" attached_to="fO"/>')).encode(),
        "HX043",
        seconds=60.0,
    ),
    reading("two thousand joints in a circle: r.sdf", lambda: model(_numbered(_JOINT, 2_000)).encode(), code=0, seconds=60.0),
    reading("a gigantic height field: r.sdf", model(_SHAPE.format(_HEIGHTS)), code=0),
    reading("a gigantic image: r.sdf", model(_SHAPE.format(_IMAGE)), code=0),
    reading("five thousand corners: r.sdf", lambda: model(_SHAPE.format(_POINTS)).encode(), code=0, seconds=60.0),
    reading("a name of a megabyte: r.sdf", model(f'<link name="{"x" * 1_000_000}"/>'), code=0, seconds=60.0),
    reading("a name of many scopes: r.sdf", model(f'<frame name="f" attached_to="{"a::" * 10_000}b"/>'), "HX040"),
    reading(
        "a gearbox of itself: r.sdf",
        model('<joint name="g" type="gearbox"><parent>g</parent><child>g</child><axis/><axis2/></joint>'),
        "HX043",
        "HX045",
    ),
)

CASES = (*INCLUDES, *SIZES)
