"""The table of formats: one row holds everything particular to a format that anything outside its own rooms asks for.

The columns are explained in :mod:`hymeko_x.formats.format`. Adding a format means its words, its reader, its writer, and one row here.
"""

from __future__ import annotations

import re
from os.path import splitext
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.formats.format import ZIP
from hymeko_x.formats.format import Assets as Assets
from hymeko_x.formats.format import Format as Format
from hymeko_x.formats.format import loaded as loaded
from hymeko_x.formats.roots import xml_root as xml_root

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.ir.mechanism import Extra, Mechanism
    from hymeko_x.meshes.submesh import Submesh

    MeshReader = Callable[[bytes, str], Submesh | None]

_XML_TOKENS = "hymeko_x.corpus.lengths:xml_tokens"
_XML_COMMENT = (rb"(?:<\?xml[^>]*\?>\n)?", "<!-- {} -->")

HYMEKO = Format(
    "hymeko",
    "HyMeKo hypergraph text",
    (".hymeko", ".himeko"),
    "hymeko_x.frontends.hymeko",
    "hymeko_x.backends.hymeko",
    outline="hymeko_x.frontends.hymeko.outline:outline",
    vocabulary="hymeko_x.formats.hymeko.vocabulary",
    imports="hymeko_x.importing:with_imports",
    flat="hymeko_x.backends.hymeko:write_flat",
    is_exact=True,
    beginning=rb"(?:\s|//[^\n]*\n|#[^\n]*\n|/\*.*?\*/)*+(?:[^\W\d]|[`\"@\[\x80-\xff])[^{}=;$]{0,1000}\{",
    assets="reference",
    reference="hymeko_x.verify.readers.hymeko",
    missing_shapes=frozenset({"hfield"}),
    tokens="hymeko_x.language.grammar:tokens",
    includes=rb"(?m)^\s*(?:@?import|#include)\b|^\s*\w+\s*:\s*import\b",
    colour="#ff7f0e",
    comment=(rb"", "// {}"),
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
    layout_options=frozenset({"sites", "mesh_prefix"}),
    has_fragments=True,
    one_namespace=True,
    companions=(".srdf",),
    companion="hymeko_x.backends.urdf.srdf:srdf_text",
    reference="hymeko_x.verify.readers.urdf",
    libraries=MappingProxyType({"pinocchio": "verify", "yourdfpy": "verify", "pydrake": "sdf"}),
    memory=MappingProxyType({"pinocchio": "hymeko_x.verify.readers.urdf.memory:load"}),
    tokens=_XML_TOKENS,
    has_single_dof_joints=True,
    missing_shapes=frozenset({"plane", "hfield", "ellipsoid"}),
    claimed_reduction=50.0,
    prompt="You are an expert in robotics. Convert the following HyMeKo robot description into a valid URDF file. "
    "Don't forget to include all required elements. Only output the URDF XML, nothing else:\n",
    error_rates=(0.05, 0.18),
    colour="#1f77b4",
    comment=_XML_COMMENT,
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
    layout_options=frozenset({"split", "sites", "mesh_prefix"}),
    keeps_package_uris=True,
    boilerplate=frozenset({"urdf @xmlns:xacro"}),  # each file declares its own prefix, and no expansion does
    reference="hymeko_x.verify.readers.xacro",
    libraries=MappingProxyType({**URDF.libraries, "xacro": "xacro", "yaml": "xacro"}),
    tokens=_XML_TOKENS,
    has_single_dof_joints=True,
    missing_shapes=URDF.missing_shapes,
    includes=rb"<xacro:include\b",
    colour="#9467bd",
    comment=_XML_COMMENT,
)
MJCF = Format(
    "mjcf",
    "MuJoCo XML",
    (".xml", ".mjcf"),
    "hymeko_x.frontends.mjcf",
    "hymeko_x.backends.mjcf",
    "hymeko_x.backends.mjcf.rules",
    roots=("mujoco", "mujocoinclude"),
    shared_suffixes=frozenset({".xml"}),
    archive=".mjz",
    outline="hymeko_x.frontends.mjcf.outline:outline",
    completes="hymeko_x.frontends.mjcf.complete:complete",
    flattens="hymeko_x.frontends.mjcf.flat:flatten",
    names_in="hymeko_x.formats.mjcf.prefixes:renamed",
    couplings="hymeko_x.formats.mjcf.couplings:couplings",
    poses="hymeko_x.formats.mjcf.keyframes:poses",
    misfits="hymeko_x.formats.mjcf.lengths:misfits",
    joins="hymeko_x.formats.mjcf.keyframes:joined",
    restates="hymeko_x.formats.mjcf.keyframes:restated",
    inlines="hymeko_x.backends.mjcf.skins:with_skins_as_elements",
    resizes="hymeko_x.formats.mjcf.sizes:resized",
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
    classes="hymeko_x.formats.mjcf.stereotypes:fields_of_classes",
    class_elements=("<default", "<compiler"),
    main_class="main",
    leading=("kp", "kv", "ctrlrange", "forcerange"),
    shapes_have_weight="hymeko_x.formats.mjcf.words:shapes_have_weight",
    has_compact_extras=True,
    reference="hymeko_x.verify.readers.mjcf",
    libraries=MappingProxyType({"mujoco": "mujoco"}),
    memory=MappingProxyType({"mujoco": "hymeko_x.verify.readers.mjcf.memory:load"}),
    tokens=_XML_TOKENS,
    requires_mass=True,
    includes=rb"<include\b",
    claimed_reduction=20.0,
    prompt="You are an expert in robotics. Convert the following HyMeKo robot description into a valid MuJoCo file. Compiler should "
    "use local coordinates. Don't forget to include all required elements. Include mass in geometry. Include color definition directly "
    "to links, don't include visual elements in the beginning. Only output the MuJoCo XML, nothing else:\n",
    error_rates=(0.252, 0.093),
    colour="#d62728",
    comment=_XML_COMMENT,
)
USD = Format(
    "usd",
    "Universal Scene Description, text",
    (".usda", ".usd"),
    "hymeko_x.frontends.usd",
    "hymeko_x.backends.usd",
    "hymeko_x.backends.usd.rules",
    magic=(b"#usda", b"PXR-USDC"),
    suffix_magic=MappingProxyType({".usda": b"#usda"}),
    outline="hymeko_x.frontends.usd.outline:outline",
    has_variants=True,
    layout_options=frozenset({"layout", "nested"}),
    fast_container="usdc",
    pack="hymeko_x.backends.usd.files:pack_for_usd",
    refits="hymeko_x.formats.usd.articulations:fit_articulation",
    reference="hymeko_x.verify.readers.usd",
    libraries=MappingProxyType({"pxr": "usd"}),
    memory=MappingProxyType({"pxr": "hymeko_x.verify.readers.usd.memory:load"}),
    stated_notations=MappingProxyType({"pose on the stage": "usd.pose"}),
    places="hymeko_x.formats.usd.places:places",
    names_are_identifiers=True,
    idle_extras=(
        r'(?:over|def(?: Scope| Xform)?) "[^"\n]*"\s*(?:\(\s*(?:prepend apiSchemas = \["PhysicsArticulationRootAPI"\]\s*)?'
        r'(?:kind = "[^"\n]*"\s*)?\)\s*)?\{\s*(?:float3\[\] extent = \[[^\]]*\]\s*)?\}'
    ),
    settings="hymeko_x.formats.usd.settings:settings",
    precision=1e-6,  # eight roundings of single precision: numbers are converted between units and frames on the way
    missing_shapes=frozenset({"hfield"}),
    tokens="hymeko_x.formats.usd.tokens:tokens",
    includes=rb"@[^@\n]+\.usd[acz]?@",
    holds_points=True,
    colour="#2ca02c",
    comment=(rb"#usda 1.0\n", "# {}"),
)
USDC = replace(
    USD,
    name="usdc",
    title="Universal Scene Description, binary",
    suffixes=(".usdc",),
    backend="hymeko_x.backends.usd.crate",
    magic=(),
    container_of="usd",
    comment=None,
)
USDZ = replace(
    USD,
    name="usdz",
    title="Universal Scene Description, package",
    suffixes=(".usdz",),
    holds_files=True,
    backend="hymeko_x.backends.usd.bundle",
    magic=(),
    container_of="usd",
    comment=None,
)
SDF = Format(
    "sdf",
    "Simulation Description Format (Gazebo)",
    (".sdf", ".world"),
    "hymeko_x.frontends.sdf",
    "hymeko_x.backends.sdf",
    "hymeko_x.backends.sdf.rules",
    roots=("sdf",),
    layout_options=frozenset({"package_layout"}),
    has_fragments=True,
    one_namespace=True,
    fragments="hymeko_x.backends.sdf.fragments:fragments_of",
    held="hymeko_x.backends.sdf.held:held",
    fragment_sensors="hymeko_x.formats.sdf.fragments:sensor_names",
    fragment_mounts="hymeko_x.formats.sdf.mounted:mounted_in",
    fragment_of="hymeko_x.formats.sdf.mounted:fragment_of",
    completes="hymeko_x.frontends.sdf.static:complete",
    in_models="hymeko_x.backends.sdf.scopes:in_models",
    outline="hymeko_x.xml.outline:outline",
    references="hymeko_x.formats.sdf.references:renamed",
    keeps_package_uris=True,
    has_models=True,
    joints_share_names=True,
    has_single_dof_joints=True,
    requires_mass=True,
    includes=rb"<include\b",
    colour="#17becf",
    tokens=_XML_TOKENS,
    reference="hymeko_x.verify.readers.sdf",
    crashing_engine="pydrake",
    libraries=MappingProxyType({"pydrake": "sdf"}),
    comment=_XML_COMMENT,
)

JSON = Format(
    "json",
    "the hypergraph in JSON, with a schema",
    (".json",),
    "hymeko_x.frontends.json",
    "hymeko_x.backends.json",
    container_of="hymeko",
    schema="hymeko_x.formats.json.schema:json_schema",
    is_exact=True,
    shared_suffixes=frozenset({".json"}),
    beginning=rb'\s*+\{[^{}\[\]]{0,1000}"hymeko-x"\s*:',
    assets="reference",
    reference="hymeko_x.verify.readers.hymeko",
)

FORMATS: tuple[Format, ...] = (HYMEKO, URDF, XACRO, MJCF, USD, USDC, USDZ, SDF, JSON)
"""Every format that can be read, written or verified. Where two claim a suffix, the content decides, and then the first one."""

FOREIGN = frozenset({*(format.family for format in FORMATS), "srdf"})
"""Blocks and fields of these names hold extras of a format in HyMeKo text."""

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
    return completing_format(mechanism.source.format)


def completing_format(name: str) -> Format | None:
    """The format of this name if its engine gives a mechanism more than its parts hold, such as masses of bodies that have shapes alone."""
    return next((format for format in FORMATS if format.completes and format.name == name), None)


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

    XML is recognised by its root element, other formats by their first bytes, and texts by the pattern with which they begin.

    Raises: Refusal HX003.
    """
    suffix = splitext(name.lower())[1]
    owners = [format for format in FORMATS if suffix in format.suffixes]
    if len(owners) == 1 and suffix not in owners[0].shared_suffixes:
        return owners[0]
    root = xml_root(data)
    found = of_root(root) or next((format for format in FORMATS if format.magic and data.startswith(format.magic)), None)
    if found is not None:
        return found
    if root is not None:
        raise refuse(codes.UNKNOWN_FORMAT, f"the root element <{root}> belongs to no format", Origin(name), hint=_root_hint())
    if owners and owners[0].beginning is None:
        return owners[0]
    text = data.removeprefix(b"\xef\xbb\xbf")
    found = next((format for format in FORMATS if format.beginning and re.match(format.beginning, text, re.DOTALL)), None)
    if found is None or suffix not in ("", ".txt", *found.shared_suffixes) or b"\0" in data[:4096]:
        message = f"neither suffix nor content of '{name}' belongs to a format"
        raise refuse(codes.UNKNOWN_FORMAT, message, Origin(name), hint=_suffix_hint("--from"))
    return found


def of_file(name: str) -> Format | None:
    """The format to which the suffix of a file, or of an archive, belongs, first of all; None where there is none.

    A ``.zip`` may have the suffix of its robot before its own: ``robot.urdf.zip``.
    """
    plain = name.lower().removesuffix(ZIP)
    return next((format for format in FORMATS if plain.endswith((*format.suffixes, format.archive))), None)


def archive_suffixes() -> tuple[str, ...]:
    """The suffixes of archives."""
    return tuple(dict.fromkeys(format.archive for format in FORMATS))


def of_root(root: str | None) -> Format | None:
    """The format whose XML files have this root element, or None."""
    return next((format for format in FORMATS if root in format.roots), None)


def root_hint(root: str) -> str:
    """How to read an XML file with this root element, for a message about another format; empty where no format has it."""
    format = of_root(root)
    if format is None:
        return ""
    return f"it looks like {format.title}: " + (f"read it with --from {format.name}" if format.frontend else "that format cannot be read")


def _suffix_hint(option: str) -> str:
    usable = (format for format in FORMATS if (format.frontend if option == "--from" else format.backend))
    return f"name it with {option}; known suffixes: {', '.join(suffix for format in usable for suffix in format.suffixes)}"


def _root_hint() -> str:
    return f"known: {', '.join(f'<{root}> ({format.name})' for format in FORMATS for root in format.roots)}"
