"""The command line: a table of verbs, with the modules that are loaded when they are used.

Data goes to standard output, words to standard error. Exit codes are in :mod:`hymeko_x.cli.exits`.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.cli import exits
from hymeko_x.version import __version__

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Mapping, Sequence
    from types import ModuleType

    from hymeko_x.cli.parser import Parser


class Verb(NamedTuple):
    """The module with ``VERB_arguments(parser)`` and ``run_VERB(arguments) -> exit code``, and what the verb does in a few words."""

    module: str
    summary: str


GROUPS: Mapping[str, Mapping[str, Verb]] = {
    "convert": {
        "convert": Verb("convert", "convert a file, with its meshes, and measure what got lost"),
        "import": Verb("convert", "read any format, print HyMeKo"),
        "export": Verb("convert", "read HyMeKo (standard input by default), write another format"),
        "update": Verb("update", "bring the edits of a converted file home into the text of its original"),
        "attach": Verb("attach", "one robot on another: a hand on an arm, whatever formats they have"),
    },
    "compare": {
        "verify": Verb("verdicts", "whether two files are the same robot, by the formats' own engines"),
        "agree": Verb("agree", "whether the files that are one robot in several formats agree, for CI"),
        "diff": Verb("compare", "what differs between two robots, element by element"),
        "report": Verb("comparison", "two robots on one page: verdict, pictures and their difference, losses"),
        "roundtrip": Verb("compare", "through other formats and back, every leg verified"),
    },
    "look": {
        "info": Verb("info", "what is in a file"),
        "check": Verb("check", "is a robot complete and sane? for people and for repair loops; --fix repairs it"),
        "graph": Verb("graph", "draw the hypergraph: kinematic tree, or vertices, edges and arcs"),
        "view": Verb("view", "robots in the browser: sliders, two side by side, what verify finds in red"),
        "render": Verb("render", "draw a robot, or a film of its joints, without a screen"),
    },
    "compute": {
        "dh": Verb("dh", "Denavit-Hartenberg tables: standard, modified, Hayati-Roberts"),
        "dynamics": Verb("dynamics", "the equations of motion: state space, transfer functions, energies"),
        "simulate": Verb("dynamics", "the response over time to steps, pulses, sines, noise or a table"),
    },
    "write": {
        "fmt": Verb("fmt", "HyMeKo text in its usual layout; comments and order stay"),
        "lsp": Verb("servers", "the language server for editors"),
        "mcp": Verb("servers", "tools for language models (Model Context Protocol), confined to one folder"),
    },
    "more": {
        "formats": Verb("info", "the formats that can be read and written"),
        "explain": Verb("info", "what a code such as HX044 means"),
        "generate": Verb("generate", "let a language model convert a robot, check and verify its answers, and let it repair them"),
        "grammar": Verb("published", "the grammar of HyMeKo text for programs that hold language models to one"),
        "skill": Verb("published", "what a language model has to know: of this program, or of the language (--card)"),
        "schema": Verb("published", "the JSON Schema of robots in JSON"),
        "completion": Verb("completion", "what makes a shell complete verbs, options and files"),
        "corpus": Verb("corpus", "real robots from published packages: fetch, list, run, stats"),
    },
}
"""The verbs as `--help` groups them."""

VERBS: Mapping[str, Verb] = {name: verb for verbs in GROUPS.values() for name, verb in verbs.items()}


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; return its exit code. The console script passes it to the shell."""
    if "_ARGCOMPLETE" in os.environ:
        return _complete()
    words = list(sys.argv[1:] if argv is None else argv)
    if words[:1] in (["--version"], ["-V"]):
        return _print_version()
    if not words or words[0] in ("-h", "--help", "help"):
        print(overview(), file=sys.stdout if words else sys.stderr)
        return exits.DONE if words else exits.USAGE
    if words[0] not in VERBS:
        return _unknown_verb(words[0])
    return exits.guarded(words[0], lambda: _run_verb(words[0], words[1:]))


def _run_verb(verb: str, words: list[str]) -> int:
    import gc

    from hymeko_x.cli.parser import choose_colors

    gc.set_threshold(100_000, 50, 50)  # a robot is many objects of which nearly all stay to the end: looking for garbage finds none
    chosen = parser_of(verb).parse_args(words)
    choose_colors(chosen.color)
    run: Callable[[argparse.Namespace], int] = getattr(_module(verb), f"run_{verb}")
    if getattr(chosen, "printed_to", None):
        return _printed_into(chosen.printed_to, lambda: run(chosen))
    code = run(chosen)
    sys.stdout.flush()
    return code


def _complete() -> int:
    """Answer a shell that asks how the words go on."""
    from hymeko_x.cli.completion import complete

    complete({name: verb.summary for name, verb in VERBS.items()}, parser_of)
    return exits.DONE


def parser_of(verb: str) -> Parser:
    """The parser of a verb's words."""
    from hymeko_x.cli.parser import Parser, shared_arguments

    summary = VERBS[verb].summary
    parser = Parser(f"hymeko-x {verb}", description=f"{summary[0].upper()}{summary[1:]}.", allow_abbrev=False)
    getattr(_module(verb), f"{verb}_arguments")(parser)
    shared_arguments(parser)
    return parser


def _module(verb: str) -> ModuleType:
    return import_module(f"hymeko_x.cli.{VERBS[verb].module}")


def _printed_into(path: str, run: Callable[[], int]) -> int:
    """Run a verb; write what it prints to a file, whole or not at all."""
    from contextlib import redirect_stdout
    from io import StringIO

    from hymeko_x.disk import check_outputs, write_files

    check_outputs(path, makes_folders=True)
    with redirect_stdout(StringIO()) as printed:
        code = run()
    write_files({path: printed.getvalue().encode()})
    return code


def overview() -> str:
    """The text of `hymeko-x --help`."""
    groups = (
        "\n".join((f"{group}:", *(f"  {name:<10} {verb.summary}" for name, verb in verbs.items()))) for group, verbs in GROUPS.items()
    )
    return "\n\n".join(("usage: hymeko-x VERB ...   (hymeko-x VERB --help says more)", *groups, exits.TABLE))


def _unknown_verb(word: str) -> int:
    from difflib import get_close_matches

    near = get_close_matches(word, [*VERBS], 1)
    meant = f"did you mean '{near[0]}'?" if near else f"verbs: {', '.join(VERBS)}"
    if os.path.exists(word):
        meant = f"it is a file: 'hymeko-x info {word}' shows what is in it, 'hymeko-x convert {word} OUT' writes another format"
    print(f"hymeko-x: there is no verb '{word}'; {meant}", file=sys.stderr)
    return exits.USAGE


def _print_version() -> int:
    print(f"hymeko-x {__version__}")
    return exits.DONE
