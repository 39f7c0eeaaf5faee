"""Mesh files and images that MuJoCo refuses: named by `check`, and written as files that it reads."""

from __future__ import annotations

import io
import struct
import zlib
from typing import TYPE_CHECKING

import mujoco
import numpy as np
import pytest
import trimesh
from PIL import Image

import hymeko_x as hx
from hymeko_x.cli import main
from hymeko_x.meshes.images import png_bytes
from hymeko_x.meshes.png import png_fault

if TYPE_CHECKING:
    from pathlib import Path

PIXELS = np.random.default_rng(0).integers(0, 255, (8, 8, 4), dtype=np.uint8)
MJCF = """<mujoco><asset><texture name="t" type="2d" file="t.png"/><material name="m" texture="t"/><mesh name="a" file="a.stl"/></asset>
<worldbody><body><geom type="mesh" mesh="a" material="m"/></body></worldbody></mujoco>"""
URDF = """<robot name="r"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="a.stl"/></geometry><material name="m"><texture filename="t.png"/></material></visual></link></robot>"""


def png(mode: str = "RGBA") -> bytes:
    out = io.BytesIO()
    Image.fromarray(PIXELS).convert(mode).save(out, "PNG")
    return out.getvalue()


def with_chunk(data: bytes, kind: bytes, content: bytes) -> bytes:
    place = data.index(b"PLTE" if kind == b"sBIT" and b"PLTE" in data else b"IDAT") - 4
    chunk = struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    return data[:place] + chunk + data[place:]


def decoded(data: bytes) -> list[int] | None:
    """The pixels that MuJoCo reads; None where it refuses the file."""
    text = '<mujoco><asset><texture name="t" type="2d" file="t.png"/></asset><worldbody/></mujoco>'
    try:
        return list(mujoco.MjModel.from_xml_string(text, {"t.png": data}).tex_data)
    except ValueError:
        return None


CHUNKS = [
    *((b"sBIT", b"\x08" * size) for size in range(6)),
    *((b"sBIT", bytes(values)) for values in ([0, 8, 8, 8], [9, 9, 9, 9])),
    *(
        (kind, b"\0" * size)
        for kind in (b"sRGB", b"gAMA", b"cHRM", b"pHYs", b"tIME", b"bKGD", b"cICP", b"mDCV", b"cLLI")
        for size in (1, 4)
    ),
    *((b"tEXt", text) for text in (b"a\0b", b"ab", b"\0b", b"a" * 80 + b"\0b")),
    *((kind, b"a\0\0" + text) for kind in (b"zTXt", b"iCCP") for text in (zlib.compress(b"x" * 200), b"junk", b"")),
    *((b"iTXt", text) for text in (b"a\0\0\0\0\0x", b"a\0\1\0\0\0junk", b"a\0\1\0\0\0" + zlib.compress(b"x"), b"bad")),
    *((kind, b"x") for kind in (b"eXIf", b"hIST", b"vpAg", b"sPLT", b"QQQQ")),
]


@pytest.mark.parametrize(("kind", "content"), CHUNKS)
def test_a_png_is_faulty_where_mujoco_refuses_it_and_mended_for_the_same_pixels(kind: bytes, content: bytes) -> None:
    for mode in ("RGBA", "RGB", "L", "LA", "P"):
        whole = png(mode)
        data = with_chunk(whole, kind, content)
        assert (png_fault(data) is None) == (decoded(data) is not None), (mode, png_fault(data))
        if png_fault(data) is not None and not kind[0] & 32:
            continue
        try:
            mended = png_bytes(data)
        except Exception as error:
            raise AssertionError(mode) from error
        assert decoded(mended) == decoded(whole), mode


def robot(folder: Path, name: str, text: str) -> Path:
    """A robot whose image has a chunk sBIT of 3 bytes for 4 samples, and whose mesh is STL as text."""
    folder.mkdir()
    (folder / name).write_text(text)
    (folder / "t.png").write_bytes(with_chunk(png(), b"sBIT", b"\x08" * 3))
    (folder / "a.stl").write_text(trimesh.creation.box((0.1, 0.2, 0.3)).export(file_type="stl_ascii"))
    return folder / name


@pytest.mark.parametrize(("name", "text"), [("r.xml", MJCF), ("r.urdf", URDF)])
@pytest.mark.parametrize("assets", ["copy", "reference"])
def test_what_mujoco_would_refuse_is_written_so_that_it_loads(name: str, text: str, assets: str, tmp_path: Path) -> None:
    source = robot(tmp_path / "home", name, text)
    (tmp_path / "away").mkdir()
    hx.convert(source, tmp_path / "away" / "r.xml", assets=assets)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "away" / "r.xml"))
    assert model.mesh_facenum.tolist() == [12]
    assert list(model.tex_data) == decoded(png())
    assert (tmp_path / "home" / "t.png").read_bytes() == with_chunk(png(), b"sBIT", b"\x08" * 3)


def test_check_names_files_that_mujoco_refuses(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(robot(tmp_path / "home", "r.xml", MJCF))]) != 0
    found = capsys.readouterr()
    reported = [line for line in (found.out + found.err).splitlines() if "HX203" in line]
    assert [line.partition("error[HX203]: ")[2] for line in reported] == [
        "the file 'a.stl' is STL as text or with a wrong length; MuJoCo reads only exact binary STL",
        "the file 't.png' is a PNG image that MuJoCo does not read: its chunk sBIT has 3 bytes, and an image of its type needs 4",
    ]
