"""HyMeKo and USD texts, binaries and packages that are not what they claim."""

from __future__ import annotations

import io
import pickle
import struct
import tempfile
import zipfile
import zlib
from pathlib import Path

from tests.hostile.case import Case, reading

DEEP = 100_000
STAGE = '#usda 1.0\n(\n    defaultPrim = "r"\n)\ndef Xform "r" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])\n{{\n{}\n}}\n'
HEAD = b"PXR-USDC\0\x08\0\0\0\0\0\0"


class Evil:
    """Runs a command when it is unpickled."""

    def __reduce__(self) -> tuple[object, tuple[str]]:
        import os

        return os.system, ("touch pwned",)


SCRIPT = b"#!/bin/sh\ntouch pwned\n"
PICKLE = pickle.dumps(Evil())


def _zip(*entries: tuple[str, bytes], method: int = zipfile.ZIP_STORED) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", method) as file:
        for name, data in entries:
            file.writestr(name, data)
    return packed.getvalue()


def _nested_prims() -> bytes:
    return (STAGE.format('def "a" {\n' * DEEP + "}\n" * DEEP)).encode()


def _nested_crate() -> bytes:
    """USD writes no deeper one itself; what it composes recurses all the same."""
    from pxr import Sdf

    with tempfile.TemporaryDirectory() as folder:
        layer = Sdf.Layer.CreateNew(f"{folder}/deep.usdc")
        prim = Sdf.PrimSpec(layer, "a", Sdf.SpecifierDef)
        for _ in range(2_500):
            prim = Sdf.PrimSpec(prim, "a", Sdf.SpecifierDef)
        layer.Save()
        return Path(folder, "deep.usdc").read_bytes()


def _doubling_references() -> bytes:
    prims = "".join(
        f'def "p{n}" {{\n def "a" (references = </r/p{n + 1}>) {{}}\n def "b" (references = </r/p{n + 1}>) {{}}\n}}\n' for n in range(40)
    )
    return STAGE.format(prims + 'def "p40" {}').encode()


def _many_prims() -> bytes:
    return STAGE.format("\n".join(f'def "p{n}" {{}}' for n in range(5_000))).encode()


def _sizes_that_lie() -> bytes:
    """A crate whose table of contents starts beyond its end."""
    return HEAD + struct.pack("<q", 2**62) + b"\0" * 64


def _zip_bomb() -> bytes:
    return _zip(("a.usda", b"#usda 1.0\n" + b" " * 400_000_000), method=zipfile.ZIP_DEFLATED)


def _png(width: int, height: int) -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"\0" * 1000)) + chunk(b"IEND", b"")


HYMEKO = (
    reading("a hundred thousand levels: r.hymeko", "a {" * DEEP, "HX007"),
    reading("a hundred thousand lists: r.hymeko", "a { b " + "[" * DEEP + "]" * DEEP + "}", "HX007"),
    reading("300 MB of HyMeKo: r.hymeko", lambda: b"a { " + b" " * 300_000_000 + b"}", "HX007"),
    reading("a template that applies itself: r.hymeko", "r : robot { t() : t { } a : t {} }", "HX063"),
    reading("an expression that takes for ever: r.hymeko", "r : robot { a : link { mass ${9**9**9**9} } }", "HX064"),
    reading("an expression that leaves the fence: r.hymeko", "r : robot { a : link { mass ${().__class__} } }", "HX064"),
    reading("a text that imports itself: r.hymeko", 'r import "r.hymeko" as s\na : link {}', "HX063"),
    reading("NUL in HyMeKo: r.hymeko", "r : robot { a\0b : link {} }", "HX060"),
    reading("UTF-16 in HyMeKo: r.hymeko", "r : robot { a : link {} }".encode("utf-16"), "HX060"),
    reading("Latin-1 in HyMeKo: r.hymeko", "r : robot { é : link {} }".encode("latin-1"), "HX060"),
    reading("a string without an end: r.hymeko", 'r : robot { a : link { visual "' + "x" * 1_000_000, "HX060"),
    reading("a mass that is not a number: r.hymeko", "r : robot { a : link { mass nan } }", "HX062"),
    reading("a pickle as HyMeKo: r.hymeko", PICKLE, "HX060"),
)

STAGES = (
    reading("a hundred thousand prims in each other: s.usda", _nested_prims, "HX007", seconds=60.0),
    reading("thousands of prims in each other in a crate: s.usdc", _nested_crate, "HX007", seconds=60.0),
    reading("five thousand prims: s.usda", _many_prims, code=0, seconds=90.0),
    reading("references that double forty times: s.usda", _doubling_references, "HX007", seconds=90.0),
    reading("a stage that refers to itself: s.usda", STAGE.format('def "a" (references = @s.usda@) {}'), "HX040"),
    reading(
        "two stages that refer to each other: s.usda",
        STAGE.format('def "a" (references = @b.usda@) {}'),
        "HX040",
        **{"b.usda": STAGE.format('def "a" (references = @s.usda@) {}')},
    ),
    reading(
        "a stage below itself: s.usda",
        '#usda 1.0\n(\n subLayers = [@s.usda@]\n)\ndef Xform "r" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {}',
        "HX040",
    ),
    reading("half a stage: s.usda", STAGE.format("")[:-10], "HX001"),
    reading("a stage of NULs: s.usda", b"#usda 1.0\n" + b"\0" * 10_000, "HX001"),
    reading("a stage that is a script: s.usda", SCRIPT, "HX001"),
    reading("a stage that is a pickle: s.usda", PICKLE, "HX001"),
    reading("half a crate: s.usdc", HEAD, "HX001"),
    reading("a crate that is longer than it is: s.usdc", _sizes_that_lie, "HX001"),
    reading("a crate of noise: s.usdc", HEAD + bytes(range(256)) * 40, "HX001"),
    reading("an empty crate: s.usdc", b"", "HX001"),
    reading("half a package: s.usdz", _zip(("a.usda", b"#usda 1.0\n"))[:-10], "HX001"),
    reading("an empty package: s.usdz", _zip(), "HX001"),
    reading("a package of a zip bomb: s.usdz", _zip_bomb, "HX007", seconds=60.0),
    reading("a package with paths that lead out: s.usdz", _zip(("../../a.usda", b"#usda 1.0\n"), ("../pwned", b"x")), "HX001"),
    reading("a package of a pickle: s.usdz", _zip(("a.pickle", PICKLE)), "HX001"),
)

_TRIANGLE = (
    "<mujoco><asset><mesh name='m' file='{}'/></asset><worldbody><body name='a'><geom type='mesh' mesh='m'/></body></worldbody></mujoco>"
)
_VISUAL = '<robot name="r"><link name="a"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>'
_STL = b"solid" + b"\0" * 75


def _mesh(title: str, name: str, data: bytes, *codes: str, leaves: tuple[str, ...] = ("m.xml",), seconds: float = 20.0) -> Case:
    files = {"r.urdf": _VISUAL.format(name), name: data}
    return Case(title, files, ("convert", "r.urdf", "../out/m.xml"), 0, codes, seconds, leaves)


def _glb(document: bytes) -> bytes:
    padded = document + b" " * (-len(document) % 4)
    return b"glTF" + struct.pack("<II", 2, 20 + len(padded)) + struct.pack("<I", len(padded)) + b"JSON" + padded


_GLTF = b'{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],' \
        b'"accessors":[{"bufferView":0,"componentType":5126,"count":%d,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":12}],' \
        b'"buffers":[{"byteLength":12%s}]}'  # fmt: skip

MESHES = (
    _mesh("an STL of a billion triangles", "a.stl", _STL + struct.pack("<I", 10**9) + b"\0" * 50, "HX203"),
    _mesh("an STL of no triangles", "a.stl", _STL + struct.pack("<I", 0), "HX203"),
    _mesh("half an STL header", "a.stl", b"\0" * 40, "HX203"),
    _mesh("an STL of NaN", "a.stl", b"\0" * 80 + struct.pack("<I", 1) + struct.pack("<12f", *[float("nan")] * 12) + b"\0\0", "HX203"),
    _mesh("an STL of words", "a.stl", b"solid a\nfacet normal 0 0 1\nvertex a b c\n", "HX203"),
    _mesh("an OBJ whose corners do not exist", "a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 999999999\n", "HX203"),
    _mesh("an OBJ that is a script", "a.obj", SCRIPT, "HX203"),
    _mesh("an OBJ that is a pickle", "a.obj", PICKLE, "HX203"),
    _mesh("a PLY of a billion points", "a.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\n"
          b"property float z\nelement face 1000000000\nproperty list uchar int vertex_indices\nend_header\n" + b"\0" * 100, "HX203"),
    _mesh("an OFF of a billion points", "a.off", b"OFF\n1000000000 1000000000 0\n0 0 0\n", "HX203"),
    _mesh("a GLB that is shorter than it says", "a.glb", b"glTF" + struct.pack("<II", 2, 2**31) + b"\0" * 20, "HX203"),
    _mesh("a GLB of a billion points", "a.glb", _glb(_GLTF % (10**9, b"")), "HX203"),
    _mesh("a glTF that reads system files", "a.gltf", _GLTF % (1, b',"uri":"../../../../../../etc/passwd"'), "HX203"),
    _mesh("a COLLADA file of entities", "a.dae", b"<!DOCTYPE a [<!ENTITY a SYSTEM 'file:///etc/passwd'>]><COLLADA>&a;</COLLADA>", "HX203"),
    _mesh("a COLLADA file that is an archive", "a.dae", _zip(("a.dae", b"<COLLADA/>")), "HX203"),
    _mesh("a mesh that is an archive of arrays", "a.npz", _zip(("a.npy", PICKLE)), "HX203"),
    Case(
        "an image of a terabyte",
        {"m.xml": "<mujoco><asset><texture name='t' type='2d' file='t.png'/><material name='m' texture='t'/></asset>"
         "<worldbody><body><geom size='1' material='m'/></body></worldbody></mujoco>", "t.png": _png(500_000, 500_000)},
        ("convert", "m.xml", "../out/s.usda"), 0, (), 60.0, ("s.usda", "textures/t.png"),
    ),
)  # fmt: skip

PICKLES = (
    reading("a pickle as URDF: r.urdf", PICKLE, "HX004"),
    reading("a pickle as MJCF: m.mjcf", PICKLE, "HX004"),
    reading("a pickle under an unknown suffix: r.pkl", PICKLE, "HX003"),
    reading("a script as xacro: r.xacro", SCRIPT, "HX004"),
    reading("an archive as URDF: r.urdf", _zip(("r.urdf", b"<robot/>")), "HX004"),
    reading("code in a xacro file: r.xacro", "<robot xmlns:xacro=\"x\" name=\"${__import__('os').system('touch pwned')}\"/>", "HX058"),
    reading(
        "a yaml file that makes objects: r.xacro",
        '<robot xmlns:xacro="x" name="r"><xacro:property name="p" value="${xacro.load_yaml(\'p.yaml\')}"/><link name="${p}"/></robot>',
        "HX050",
        **{"p.yaml": "!!python/object/apply:os.system ['touch pwned']"},
    ),
)

CASES = (*HYMEKO, *STAGES, *MESHES, *PICKLES)
