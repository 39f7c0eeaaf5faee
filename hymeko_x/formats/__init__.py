"""The table of formats, and how a file's format is recognised. Readers and writers are named, and loaded only when used."""

from __future__ import annotations

import re
from os.path import splitext

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.frozen import frozen


@frozen
class Format:
    """One format: its word on the command line, title, file suffixes, and the modules that read and write it (None = not at all).

    ``roots`` are the XML root elements, and ``magic`` the first bytes, by which its content is recognised;
    ``has_arguments`` whether the user can set values in it (xacro), ``has_variants`` whether it leaves choices open (USD).
    """

    name: str
    title: str
    suffixes: tuple[str, ...]
    frontend: str | None
    backend: str | None
    roots: tuple[str, ...] = ()
    magic: tuple[bytes, ...] = ()
    has_arguments: bool = False
    has_variants: bool = False


HYMEKO = Format("hymeko", "HyMeKo hypergraph text", (".hymeko", ".himeko"), "hymeko_x.frontends.hymeko", "hymeko_x.backends.hymeko")
URDF = Format("urdf", "Unified Robot Description Format (ROS)", (".urdf",), "hymeko_x.frontends.urdf", "hymeko_x.backends.urdf", ("robot",))
XACRO = Format("xacro", "XML macros for URDF (ROS)", (".xacro",), "hymeko_x.frontends.xacro", "hymeko_x.backends.xacro", has_arguments=True)
MJCF = Format("mjcf", "MuJoCo XML", (".mjcf", ".xml"), "hymeko_x.frontends.mjcf", "hymeko_x.backends.mjcf", ("mujoco", "mujocoinclude"))
_USD_MAGIC = (b"#usda", b"PXR-USDC")
_READS_USD = "hymeko_x.frontends.usd"
USD = Format(
    "usd",
    "Universal Scene Description, text",
    (".usda", ".usd"),
    _READS_USD,
    "hymeko_x.backends.usd",
    magic=_USD_MAGIC,
    has_variants=True,
)
USDC = Format("usdc", "Universal Scene Description, binary", (".usdc",), _READS_USD, "hymeko_x.backends.usd.crate", has_variants=True)
USDZ = Format("usdz", "Universal Scene Description, package", (".usdz",), _READS_USD, "hymeko_x.backends.usd.bundle", has_variants=True)

FORMATS = (HYMEKO, URDF, XACRO, MJCF, USD, USDC, USDZ)
"""Every format that can be read or written. Where two claim a suffix, the content decides, and then the first one."""


def by_name(name: str) -> Format:
    """The format of this name.

    Raises: Refusal HX003.
    """
    for format in FORMATS:
        if format.name == name.lower():
            return format
    raise refuse(codes.UNKNOWN_FORMAT, f"there is no format '{name}'", hint=f"known: {', '.join(format.name for format in FORMATS)}")


def of_output(path: str, name: str | None = None) -> Format:
    """The format of a file to be written: the named one, or that of its suffix.

    Of the kinds of one format the suffix chooses, since readers go by it: ``usd`` in a ``.usdc`` is binary. A ``.usd`` may be any.

    Raises: Refusal HX003.
    """
    owner = next((format for format in FORMATS if path.lower().endswith(format.suffixes)), None)
    if name is not None:
        named = by_name(name)
        is_kin = owner is not None and owner.frontend == named.frontend and not path.lower().endswith(".usd")
        return owner if owner is not None and is_kin else named
    if owner is not None:
        return owner
    raise refuse(codes.UNKNOWN_FORMAT, f"the suffix of '{path}' belongs to no format", hint=_suffix_hint("--to"))


def of_input(name: str, data: bytes) -> Format:
    """The format of a file: by its suffix where that belongs to one format only, else by its content.

    XML is recognised by its root element, other formats by their first bytes; remaining text is HyMeKo.

    Raises: Refusal HX003.
    """
    suffix = splitext(name.lower())[1]
    owners = [format for format in FORMATS if suffix in format.suffixes]
    if len(owners) == 1 and suffix != ".xml":
        return owners[0]
    root = xml_root(data)
    found = [format for format in FORMATS if root in format.roots or (format.magic and data.startswith(format.magic))]
    if found:
        return found[0]
    if root is not None:
        raise refuse(codes.UNKNOWN_FORMAT, f"the root element <{root}> belongs to no format", Origin(name), hint=_root_hint())
    if owners:
        return owners[0]
    if suffix not in ("", ".txt") or b"\0" in data[:4096]:
        message = f"neither suffix nor content of '{name}' belongs to a format"
        raise refuse(codes.UNKNOWN_FORMAT, message, Origin(name), hint=_suffix_hint("--from"))
    return HYMEKO


_BEFORE_ROOT = re.compile(rb"\s+|<\?.*?\?>|<!--.*?-->|<!DOCTYPE[^>\[]*(?:\[.*?\]\s*)?>", re.DOTALL)
_ROOT = re.compile(rb"<([A-Za-z_][^\s/>]*)")


def xml_root(data: bytes) -> str | None:
    """The name of the root element without its prefix, or None when the data does not begin like XML."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        data = data.decode("utf-16", "replace").encode()
    position = 3 if data.startswith(b"\xef\xbb\xbf") else 0
    while skipped := _BEFORE_ROOT.match(data, position):
        position = skipped.end()
    root = _ROOT.match(data, position)
    return root[1].decode("utf-8", "replace").rpartition(":")[2] if root else None


def _suffix_hint(option: str) -> str:
    return f"name it with {option}; known suffixes: {', '.join(suffix for format in FORMATS for suffix in format.suffixes)}"


def _root_hint() -> str:
    return f"known: {', '.join(f'<{root}> ({format.name})' for format in FORMATS for root in format.roots)}"
