"""The table of formats: one row holds everything particular to a format that anything outside its own rooms asks for.

Modules and functions are named, as ``module`` or ``module:function``, and loaded when they are used. Adding a format means its words,
its reader, its writer, and one row here.
"""

from __future__ import annotations

import re
from importlib import import_module
from os.path import splitext
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

from msgspec import Struct, field
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.mechanism import Extra, Mechanism
    from hymeko_x.meshes.submesh import Submesh

    MeshReader = Callable[[bytes, str], Submesh | None]

_XML_TOKENS = "hymeko_x.corpus.lengths:xml_tokens"


class Format(Struct, frozen=True):
    """One format. Only name, title and suffixes are needed; without ``frontend`` it cannot be read, without ``backend`` not written."""

    name: str
    """Its name on the command line, and of the extras and notations that it alone understands."""
    title: str
    suffixes: tuple[str, ...]
    """The suffixes of its files, first the one that is written."""

    # ---- how it is recognised, read and written
    frontend: str | None = None
    """The module with ``read(source, report)``."""
    backend: str | None = None
    """The module with ``write(mechanism, options, report)``."""
    rules: str | None = None
    """The module with the rewriting rules in order: ``RULES``, ``NATIVE`` for what came from this format, and ``ACTUATED`` for
    actuators that the user asks for."""
    roots: tuple[str, ...] = ()
    """The XML root elements of its files."""
    magic: tuple[bytes, ...] = ()
    """The first bytes of its files."""
    beginning: bytes | None = None
    """The pattern with which its texts begin, where they have neither a root element nor first bytes of their own (HyMeKo)."""
    layout_options: frozenset[str] = frozenset()
    """Those of the options ``layout``, ``nested`` and ``split`` that it takes when it is written."""
    is_exact: bool = False
    """Whether it represents every mechanism exactly, so that it carries no residue and keeps what only another format understands."""
    container_of: str = ""
    """The name of the format of which it is another container, with the same reader and the same extras (usdc, usdz)."""
    expands_to: str = ""
    """The name of the format that its files expand to (xacro)."""
    outline: str | None = None
    """The function ``(source, report) -> outline`` that finds where everything stands in its text."""
    imports: str | None = None
    """The function ``(source, report) -> source`` by which its files can import robots of other files."""
    flat: str | None = None
    """The function that writes as ``backend`` does, without what depends on several elements; None: ``write`` itself is like that."""
    has_arguments: bool = False
    """Whether the user can set values in it (xacro)."""
    has_variants: bool = False
    """Whether its files leave choices open (USD)."""
    completes: str | None = None
    """The function ``(mechanism, printed, files, report) -> mechanism`` that adds what only this format's engine computes, for a
    mechanism that came from this format and goes to another one; ``printed()`` gives it as this format has it."""
    flattens: str | None = None
    """The function ``(mechanism, text) -> mechanism`` by which each element has all that it inherits; ``text`` is it as printed."""
    names_in: str | None = None
    """The function ``(extra, change, is_of_whole) -> extra or None`` that changes the names in an extra of a part that becomes one of a
    robot; None for what a robot has once."""
    joins: str | None = None
    """The function ``(whole, host, part, change) -> whole`` that gives a composed mechanism what depends on all of its elements."""

    # ---- its files
    assets: Literal["copy", "reference"] = "copy"
    """Whether meshes and images are put beside the output when the user does not choose."""
    pack: str | None = None
    """The function ``(mechanism, shelf, files, report) -> mechanism`` that names its files; None: it refers to any file by its uri."""
    refused: str | None = None
    """The function ``(suffix, data) -> reason or None``: why its engine does not read a file of a type that it reads."""
    mesh_reader: str | None = None
    """The function ``(data, suffix) -> Submesh or None``: a mesh file as its engine reads it, where others read it in another way."""
    read_otherwise: str | None = None
    """The function ``(data, suffix) -> (Submesh, reason) or None``: such a file where other programs read another solid from it."""
    files_in_extras: str | None = None
    """The function ``mechanism -> pairs of an element and a reference`` for files that only extras of the format name."""
    place_extras: str | None = None
    """The function ``(mechanism, packed, shelf, files, report, keep) -> Mechanism`` that gives the extras the new paths of these files."""
    tells_places: str | None = None
    """The function ``extra -> bool``: whether an extra of the format names files, or the folders that they are in."""
    placing: frozenset[str] = frozenset()
    """The extras of a mesh by which its points are elsewhere than in its file, or are made."""
    keeps_package_uris: bool = False
    """Whether ``package://NAME`` is written as it is: programs that read the format find packages in their own ways."""

    # ---- what the ledger and HyMeKo text ask
    stated_notations: Mapping[str, str] = field(default_factory=dict)
    """Notations that hold more than how a value was written, by the name of the field as which the ledger lists them."""
    inherited: str | None = None
    """The function ``text -> text`` that leaves out of an extra what the elements have in fields of their own (classes of MJCF)."""
    shapes_have_weight: str | None = None
    """The function ``mechanism -> bool``: whether masses of shapes may count although their bodies have inertials."""
    numbers_constraints: bool = False
    """Whether its engine numbers closures and couplings in their common order, so that this order is content (MJCF)."""
    boilerplate: frozenset[str] = frozenset()
    """Fields of the whole that every file of the format has, and no other."""
    precision: float = 0.0
    """How far a number that it stores may be off, as a part of the number, where it stores less than doubles: no loss in the ledger."""
    has_compact_extras: bool = False
    """Whether no white space stands between the tags of its extras."""

    # ---- what the verifier asks
    reference: str | None = None
    """The module with ``read(path, places)`` that loads a file with the engine whose reading is authoritative."""
    libraries: Mapping[str, str] = field(default_factory=dict)
    """The libraries that its reader, its writer and its reference reader import, with the extra of the distribution that brings each."""
    memory: Mapping[str, str] = field(default_factory=dict)
    """By library, the function ``(main, contents) -> object`` that loads its files in memory: its text, and the files beside it by path."""
    names_are_identifiers: bool = False
    """Whether a name may hold letters, digits and underscores only, so that others are spelled differently (USD)."""
    has_single_dof_joints: bool = False
    """Whether a joint of several dofs becomes a chain of joints (URDF)."""
    joints_share_names: bool = False
    """Whether a joint cannot have the name of a body, and then has ``_joint`` behind its own (SDF)."""
    requires_mass: bool = False
    """Whether its engine refuses moving bodies without mass (MJCF)."""
    missing_shapes: frozenset[str] = frozenset()
    """The kinds of shapes that it cannot represent."""

    # ---- what the statistics of the corpus ask
    tokens: str | None = None
    """The function ``text -> list of tokens`` by which its length is counted; None: words between white space."""
    includes: bytes | None = None
    """The pattern by which a file refers to others of its format, so that its length is not that of the robot."""
    holds_points: bool = False
    """Whether its text holds the points of meshes, so that its length is no measure of the language."""
    claimed_reduction: float | None = None
    """By how many percent HyMeKo is shorter, as the paper reports it."""
    colour: str = "#7f7f7f"
    """Its colour in figures."""

    @property
    def family(self) -> str:
        """The name that extras of this format bear: its own, or that of the format of which it is another container."""
        return self.container_of or self.name


HYMEKO = Format(
    "hymeko",
    "HyMeKo hypergraph text",
    (".hymeko", ".himeko"),
    "hymeko_x.frontends.hymeko",
    "hymeko_x.backends.hymeko",
    outline="hymeko_x.frontends.hymeko.outline:outline",
    imports="hymeko_x.importing:with_imports",
    flat="hymeko_x.backends.hymeko:write_flat",
    is_exact=True,
    beginning=rb"(?:\s|//[^\n]*\n|#[^\n]*\n|/\*.*?\*/)*+(?:[^\W\d]|[`\"@\[\x80-\xff])[^{}=;$]{0,1000}\{",
    assets="reference",
    reference="hymeko_x.verify.readers.hymeko",
    tokens="hymeko_x.language.grammar:tokens",
    includes=rb"(?m)^\s*(?:@?import|#include)\b|^\s*\w+\s*:\s*import\b",
    colour="#ff7f0e",
)
URDF = Format(
    "urdf",
    "Unified Robot Description Format (ROS)",
    (".urdf",),
    "hymeko_x.frontends.urdf",
    "hymeko_x.backends.urdf",
    "hymeko_x.backends.urdf.rules",
    roots=("robot",),
    outline="hymeko_x.xml.outline:outline",
    keeps_package_uris=True,
    reference="hymeko_x.verify.readers.urdf",
    libraries=MappingProxyType({"pinocchio": "verify", "yourdfpy": "verify", "pydrake": "sdf"}),
    memory=MappingProxyType({"pinocchio": "hymeko_x.verify.readers.urdf.memory:load"}),
    tokens=_XML_TOKENS,
    has_single_dof_joints=True,
    missing_shapes=frozenset({"plane", "hfield", "ellipsoid"}),
    claimed_reduction=50.0,
    colour="#1f77b4",
)
XACRO = Format(
    "xacro",
    "XML macros for URDF (ROS)",
    (".xacro",),
    "hymeko_x.frontends.xacro",
    "hymeko_x.backends.xacro",
    "hymeko_x.backends.urdf.rules",
    outline="hymeko_x.frontends.xacro.outline:outline",
    expands_to="urdf",
    has_arguments=True,
    layout_options=frozenset({"split"}),
    keeps_package_uris=True,
    boilerplate=frozenset({"urdf @xmlns:xacro"}),  # each file declares its own prefix, and no expansion does
    reference="hymeko_x.verify.readers.xacro",
    libraries=MappingProxyType({**URDF.libraries, "xacro": "xacro", "yaml": "xacro"}),
    tokens=_XML_TOKENS,
    has_single_dof_joints=True,
    missing_shapes=URDF.missing_shapes,
    includes=rb"<xacro:include\b",
    colour="#9467bd",
)
MJCF = Format(
    "mjcf",
    "MuJoCo XML",
    (".xml", ".mjcf"),
    "hymeko_x.frontends.mjcf",
    "hymeko_x.backends.mjcf",
    "hymeko_x.backends.mjcf.rules",
    roots=("mujoco", "mujocoinclude"),
    outline="hymeko_x.frontends.mjcf.outline:outline",
    completes="hymeko_x.frontends.mjcf.complete:complete",
    flattens="hymeko_x.frontends.mjcf.flat:flatten",
    names_in="hymeko_x.formats.mjcf.prefixes:renamed",
    joins="hymeko_x.formats.mjcf.keyframes:joined",
    pack="hymeko_x.backends.mjcf.files:pack_for_mujoco",
    numbers_constraints=True,
    mesh_reader="hymeko_x.meshes.tables:read_mesh",
    read_otherwise="hymeko_x.meshes.tables:read_otherwise",
    refused="hymeko_x.formats.mjcf.files:refused",
    files_in_extras="hymeko_x.backends.mjcf.references:files_in_extras",
    place_extras="hymeko_x.backends.mjcf.references:place_extras",
    tells_places="hymeko_x.backends.mjcf.references:tells_places",
    placing=frozenset({"@refpos", "@refquat", "@builtin", "@params"}),
    inherited="hymeko_x.formats.mjcf.classes:without_inherited",
    shapes_have_weight="hymeko_x.formats.mjcf.words:shapes_have_weight",
    has_compact_extras=True,
    reference="hymeko_x.verify.readers.mjcf",
    libraries=MappingProxyType({"mujoco": "mujoco"}),
    memory=MappingProxyType({"mujoco": "hymeko_x.verify.readers.mjcf.memory:load"}),
    tokens=_XML_TOKENS,
    requires_mass=True,
    includes=rb"<include\b",
    claimed_reduction=20.0,
    colour="#d62728",
)
USD = Format(
    "usd",
    "Universal Scene Description, text",
    (".usda", ".usd"),
    "hymeko_x.frontends.usd",
    "hymeko_x.backends.usd",
    "hymeko_x.backends.usd.rules",
    magic=(b"#usda", b"PXR-USDC"),
    has_variants=True,
    layout_options=frozenset({"layout", "nested"}),
    pack="hymeko_x.backends.usd.files:pack_for_usd",
    reference="hymeko_x.verify.readers.usd",
    libraries=MappingProxyType({"pxr": "usd"}),
    memory=MappingProxyType({"pxr": "hymeko_x.verify.readers.usd.memory:load"}),
    stated_notations=MappingProxyType({"pose on the stage": "usd.pose"}),
    names_are_identifiers=True,
    precision=1e-6,  # eight roundings of single precision: numbers are converted between units and frames on the way
    tokens="hymeko_x.formats.usd.tokens:tokens",
    includes=rb"@[^@\n]+\.usd[acz]?@",
    holds_points=True,
    colour="#2ca02c",
)
USDC = replace(
    USD,
    name="usdc",
    title="Universal Scene Description, binary",
    suffixes=(".usdc",),
    backend="hymeko_x.backends.usd.crate",
    magic=(),
    container_of="usd",
)
USDZ = replace(
    USD,
    name="usdz",
    title="Universal Scene Description, package",
    suffixes=(".usdz",),
    backend="hymeko_x.backends.usd.bundle",
    magic=(),
    container_of="usd",
)
SDF = Format(
    "sdf",
    "Simulation Description Format (Gazebo)",
    (".sdf", ".world"),
    "hymeko_x.frontends.sdf",
    "hymeko_x.backends.sdf",
    "hymeko_x.backends.sdf.rules",
    roots=("sdf",),
    keeps_package_uris=True,
    joints_share_names=True,
    has_single_dof_joints=True,
    requires_mass=True,
    includes=rb"<include\b",
    colour="#17becf",
    tokens=_XML_TOKENS,
    reference="hymeko_x.verify.readers.sdf",
    libraries=MappingProxyType({"pydrake": "sdf"}),
)

FORMATS: tuple[Format, ...] = (HYMEKO, URDF, XACRO, MJCF, USD, USDC, USDZ, SDF)
"""Every format that can be read, written or verified. Where two claim a suffix, the content decides, and then the first one."""

OWN = HYMEKO
"""The project's own language: what text without suffix and root element is, and what `import` writes."""


def by_name(name: str) -> Format:
    """The format of this name.

    Raises: Refusal HX003.
    """
    for format in FORMATS:
        if format.name == name.lower():
            return format
    raise refuse(codes.UNKNOWN_FORMAT, f"there is no format '{name}'", hint=f"known: {', '.join(format.name for format in FORMATS)}")


def families() -> tuple[Format, ...]:
    """The formats without those that are another container of one of them."""
    return tuple(format for format in FORMATS if not format.container_of)


def native_format(mechanism: Mechanism) -> Format | None:
    """The format whose engine gives a mechanism more than its parts hold, if it came from there; see :attr:`Format.completes`."""
    return next((format for format in FORMATS if format.completes and format.name == mechanism.source.format), None)


def mesh_reader(mechanism: Mechanism) -> MeshReader | None:
    """How the engine of the format that a mechanism came from reads mesh files, where that is a way of its own."""
    row = of_source(mechanism)
    return None if row is None or row.mesh_reader is None else loaded(row.mesh_reader)


def of_source(mechanism: Mechanism) -> Format | None:
    """The format that a mechanism came from; None where a program made it."""
    return next((row for row in FORMATS if row.name == mechanism.source.format), None)


def is_placing(extra: Extra) -> bool:
    """Whether an extra of a mesh says that its points are elsewhere than in its file."""
    return extra.path[:1] == "@" and any(extra.format == row.name and extra.path in row.placing for row in FORMATS)


def loaded(name: str) -> Any:
    """The module, or the function of a module, that a row names as ``module`` or ``module:function``."""
    module, _, function = name.partition(":")
    found = import_module(module)
    return getattr(found, function) if function else found


def of_output(path: str, name: str | None = None) -> Format:
    """The format of a file to be written: the named one, or that of its suffix.

    Of the containers of one format the suffix chooses, since readers go by it: ``usd`` in a ``.usdc`` is binary. A ``.usd`` may be any.

    Raises: Refusal HX003.
    """
    owner = of_file(path)
    if name is not None:
        named = by_name(name)
        is_kin = owner is not None and owner.family == named.family and not path.lower().endswith(".usd")
        return owner if owner is not None and is_kin else named
    if owner is not None:
        return owner
    raise refuse(codes.UNKNOWN_FORMAT, f"the suffix of '{path}' belongs to no format", hint=_suffix_hint("--to"))


def of_input(name: str, data: bytes) -> Format:
    """The format of a file: by its suffix where that belongs to one format only, else by its content.

    XML is recognised by its root element, other formats by their first bytes, and HyMeKo by a name that stands before a brace.

    Raises: Refusal HX003.
    """
    suffix = splitext(name.lower())[1]
    owners = [format for format in FORMATS if suffix in format.suffixes]
    if len(owners) == 1 and suffix != ".xml":
        return owners[0]
    root = xml_root(data)
    found = of_root(root) or next((format for format in FORMATS if format.magic and data.startswith(format.magic)), None)
    if found is not None:
        return found
    if root is not None:
        raise refuse(codes.UNKNOWN_FORMAT, f"the root element <{root}> belongs to no format", Origin(name), hint=_root_hint())
    if owners:
        return owners[0]
    found = next((format for format in FORMATS if format.beginning and re.match(format.beginning, data, re.DOTALL)), None)
    if found is None or suffix not in ("", ".txt") or b"\0" in data[:4096]:
        message = f"neither suffix nor content of '{name}' belongs to a format"
        raise refuse(codes.UNKNOWN_FORMAT, message, Origin(name), hint=_suffix_hint("--from"))
    return found


def of_file(name: str) -> Format | None:
    """The format to which the suffix of a file belongs, first of all; None where there is none."""
    return next((format for format in FORMATS if name.lower().endswith(format.suffixes)), None)


def of_root(root: str | None) -> Format | None:
    """The format whose XML files have this root element, or None."""
    return next((format for format in FORMATS if root in format.roots), None)


def root_hint(root: str) -> str:
    """How to read an XML file with this root element, for a message about another format; empty where no format has it."""
    format = of_root(root)
    if format is None:
        return ""
    return f"it looks like {format.title}: " + (f"read it with --from {format.name}" if format.frontend else "that format cannot be read")


_BEFORE_ROOT = re.compile(rb"\s+|<\?.*?\?>|<!--.*?-->|<!DOCTYPE[^>\[]*(?:\[.*?\]\s*)?>", re.DOTALL)
_ROOT = re.compile(rb"<([A-Za-z_][\w.:-]*)")


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
    usable = (format for format in FORMATS if (format.frontend if option == "--from" else format.backend))
    return f"name it with {option}; known suffixes: {', '.join(suffix for format in usable for suffix in format.suffixes)}"


def _root_hint() -> str:
    return f"known: {', '.join(f'<{root}> ({format.name})' for format in FORMATS for root in format.roots)}"
