"""The columns of the table of formats: everything that anything outside a format's own rooms asks about it.

Modules and functions are named, as ``module`` or ``module:function``, and loaded when they are used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal

from msgspec import Struct, field

if TYPE_CHECKING:
    from collections.abc import Mapping


Assets = Literal["copy", "reference", "pack"]
"""Meshes and images are put beside the output, referred to where they are, or put with it into an archive."""

ZIP = ".zip"


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
    suffix_magic: Mapping[str, bytes] = field(default_factory=dict)
    """How files with a suffix have to begin, where others of the format need not: a ``.usda`` is text, and a ``.usd`` may be binary."""
    beginning: bytes | None = None
    """The pattern with which its texts begin, where they have neither a root element nor first bytes of their own (HyMeKo, JSON)."""
    shared_suffixes: frozenset[str] = frozenset()
    """Those of its suffixes that other files have as well, so that the content decides."""
    layout_options: frozenset[str] = frozenset()
    """Those of the options ``layout``, ``nested``, ``split``, ``sites``, ``mesh_prefix`` and ``package_layout`` that it takes."""
    comment: tuple[bytes, str] | None = None
    """The pattern of what stands before a first comment, and a line of comment with ``{}`` for its text; None where there are none."""
    is_exact: bool = False
    """Whether it represents every mechanism exactly, so that it contains no residue and keeps what only another format understands."""
    container_of: str = ""
    """The name of the format of which it is another container, with the same content and the same extras (usdc, usdz; json)."""
    fast_container: str = ""
    """The name of its container that is written and read fastest, for conversions that are only compared (usdc); empty: itself."""
    expands_to: str = ""
    """The name of the format that its files expand to (xacro)."""
    vocabulary: str | None = None
    """The module with ``fields_of(kind)``, ``units()`` and ``si_of(unit)`` for editors."""
    schema: str | None = None
    """The function that makes the JSON Schema of its texts."""
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
    """The function ``(extra, change, is_of_whole) -> extra or None`` that changes the names in an extra by ``change(kind, name)``; None for
    what a robot has once, in a part that becomes one of a robot (``is_of_whole``)."""
    references: str | None = None
    """The function ``(notations, names) -> notations`` by which references in the notations follow elements that got other names."""
    one_namespace: bool = False
    """Whether programs that read it look links and joints up by name in one table, and joints behind those that they follow."""
    couplings: str | None = None
    """The function ``mechanism -> pairs of an id and an edge``: the couplings that only its extras hold (MJCF: those of tendons)."""
    has_fragments: bool = False
    """Whether its extras are elements of XML in which <joint_name>, <link_name> and their like name elements of the robot."""
    poses: str | None = None
    """The function ``mechanism -> list of (name, {joint: coordinates})`` that reads the named configurations that it keeps as texts."""
    misfits: str | None = None
    """The function ``mechanism -> list of (message, is_refused)``: the named configurations that it keeps as texts and that do not fit the
    robot, and whether its engine refuses them."""
    joins: str | None = None
    """The function ``(whole, host, part, change) -> whole`` that gives a composed mechanism what depends on all of its elements."""

    restates: str | None = None
    """The function ``(changed, source, change, called) -> changed`` by which the named configurations that it keeps as texts fit a
    changed mechanism; ``change(word, element, numbers)`` gives the present id of a joint or an actuator, and its numbers,
    ``called(name)`` the present name of a configuration, None for one that goes."""
    inlines: str | None = None
    """The function ``(mechanism, files) -> mechanism`` that takes files which name elements (skins of MJCF) into its text."""
    refits: str | None = None
    """The function ``(changed, source) -> changed`` by which what it holds of the whole fits a robot whose joints are others (USD: the
    root of an articulation)."""
    resizes: str | None = None
    """The function ``(mechanism, s, factor) -> mechanism or None`` by which its extras fit lengths times ``s``; ``factor(element, dof)``
    is that on what a joint or a coupling measures. None where the elements have to be flattened first."""

    fragments: str | None = None
    """The function ``mechanism -> texts``: the elements in which other formats hold what only it represents of its robots."""
    held: str | None = None
    """The function ``(mechanism, image) -> difference -> bool``: whether it is in such elements of one of both."""
    fragment_sensors: str | None = None
    """The function ``texts -> names``: the sensors and cameras that such elements describe."""
    fragment_mounts: str | None = None
    """The function ``text -> (link, name, pose in the link, camera or frame of an IMU) ...`` of such an element."""
    fragment_of: str | None = None
    """The function ``(link, name, pose, part) -> text`` that writes such an element of one of these."""
    companions: tuple[str, ...] = ()
    """The suffixes of files of the same name beside one of its files that are read with it (SRDF)."""
    companion: str | None = None
    """The function ``(mechanism, names) -> bytes`` that prints such a file; ``names`` are new ids of elements by those in its extras."""

    # ---- its files
    archive: str = ZIP
    """The suffix of archives that hold one of its files with all that it refers to."""
    holds_files: bool = False
    """Whether its own files hold all that they refer to (usdz)."""
    assets: Assets = "copy"
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
    has_models: bool = False
    """Whether these programs find ``model://NAME`` as well; others that take such a robot get its files beside the output."""

    # ---- what the ledger and HyMeKo text ask
    stated_notations: Mapping[str, str] = field(default_factory=dict)
    """Notations that hold more than how a value was written, by the name of the field as which the ledger lists them."""
    places: str | None = None
    """The function ``mechanism -> poses by body`` of bodies that its files put elsewhere than their joints do, which overrule it."""
    in_models: str | None = None
    """The function ``(mechanism, original) -> {id: new id}``: the names of elements that have to be in one of a file's models (SDF)."""
    inherited: str | None = None
    """The function ``text -> text`` that leaves out of an extra what the elements have in fields of their own (classes of MJCF)."""
    classes: str | None = None
    """The function ``texts -> {class: {kind of element: fields}}``: what its default classes give, from the elements of the whole."""
    class_elements: tuple[str, ...] = ()
    """How the texts of these elements begin: those of the classes first, then what is needed to understand them."""
    leading: tuple[str, ...] = ()
    """The parameters of an actuator that come first, whatever its class gives."""
    main_class: str = ""
    """The name of the class that is in force where no other one is."""
    shapes_have_weight: str | None = None
    """The function ``mechanism -> bool``: whether masses of shapes may count although their bodies have inertials."""
    numbers_constraints: bool = False
    """Whether its engine numbers closures and couplings in their common order, so that this order is content (MJCF)."""
    boilerplate: frozenset[str] = frozenset()
    """Fields of the whole that every file of the format has, and no other."""
    idle_extras: str = ""
    """The pattern of the texts of extras that hold nothing of a robot: groups of nothing, and values that follow from others."""
    settings: str | None = None
    """The function ``text -> names``: what a report calls the content of an extra; None: the tag of an element, or the attribute."""
    precision: float = 0.0
    """How far a number that it stores may be off, as a part of the number, where it stores less than doubles: no loss in the ledger."""
    has_compact_extras: bool = False
    """Whether no white space stands between the tags of its extras."""

    # ---- what the verifier asks
    reference: str | None = None
    """The module with ``read(path, places)`` that loads a file with the engine whose reading is authoritative."""
    crashing_engine: str | None = None
    """The library of that engine, where some files make it crash: it runs in a process of its own."""
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
    """The kinds of shapes that it cannot represent, or only holds as the text of another format."""

    # ---- what the statistics of the corpus ask
    tokens: str | None = None
    """The function ``text -> list of tokens`` by which its length is counted; None: words between white space."""
    includes: bytes | None = None
    """The pattern by which a file refers to others of its format, so that its length is not that of the robot."""
    holds_points: bool = False
    """Whether its text holds the points of meshes, so that its length is no measure of the language."""
    claimed_reduction: float | None = None
    """By how many percent HyMeKo is shorter, as the paper reports it."""
    prompt: str | None = None
    """The prompt with which the paper asks a language model for a file of it."""
    error_rates: tuple[float, float] | None = None
    """Which part of the paper's generated files was not valid: of the robot with one joint, and of the SCARA robot."""
    colour: str = "#7f7f7f"
    """Its colour in figures."""

    @property
    def family(self) -> str:
        """The name that extras of this format bear: its own, or that of the format of which it is another container."""
        return self.container_of or self.name


def loaded(name: str) -> Any:
    """The module, or the function of a module, that a row names as ``module`` or ``module:function``."""
    module, _, function = name.partition(":")
    found = import_module(module)
    return getattr(found, function) if function else found
