"""The command line: a table of verbs, with the modules that are loaded when they are used.

Data goes to standard output, words to standard error. Exit codes are in :mod:`hymeko_x.cli.exits`.
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING

from hymeko_x.cli import exits

if TYPE_CHECKING:
    from collections.abc import Sequence

VERBS = {
    "import": ("hymeko_x.cli.convert", "read any format, print HyMeKo"),
    "export": ("hymeko_x.cli.convert", "read HyMeKo (standard input by default), write another format"),
    "convert": ("hymeko_x.cli.convert", "convert a file, with its meshes, and measure what got lost"),
    "update": ("hymeko_x.cli.update", "bring the edits of a converted file home into the text of its original"),
    "attach": ("hymeko_x.cli.attach", "one robot on another: a hand on an arm, whatever formats they have"),
    "diff": ("hymeko_x.cli.compare", "what differs between two robots, element by element"),
    "verify": ("hymeko_x.cli.verdicts", "whether two files are the same robot, by the formats' own engines"),
    "roundtrip": ("hymeko_x.cli.compare", "through other formats and back, every leg verified"),
    "render": ("hymeko_x.cli.render", "draw a robot, or a film of its joints, without a screen"),
    "check": ("hymeko_x.cli.info", "is a robot complete and sane? for people and for repair loops"),
    "dh": ("hymeko_x.cli.dh", "Denavit-Hartenberg tables: standard, modified, Hayati-Roberts"),
    "dynamics": ("hymeko_x.cli.dynamics", "the equations of motion: state space, transfer functions, energies"),
    "simulate": ("hymeko_x.cli.dynamics", "the response over time to steps, pulses, sines, noise or a table"),
    "info": ("hymeko_x.cli.info", "what is in a file"),
    "formats": ("hymeko_x.cli.info", "the formats that can be read and written"),
    "explain": ("hymeko_x.cli.info", "what a code such as HX044 means"),
    "corpus": ("hymeko_x.cli.corpus", "real robots from published packages: fetch, list, run, stats"),
}
"""Verb -> module with ``VERB_arguments(parser)`` and ``run_VERB(arguments) -> exit code``, and what the verb does in a few words."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; return its exit code. The console script passes it to the shell."""
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
    import argparse
    import gc

    gc.set_threshold(100_000, 50, 50)  # a robot is many objects of which nearly all stay to the end: looking for garbage finds none
    module_name, summary = VERBS[verb]
    module = import_module(module_name)
    parser = argparse.ArgumentParser(f"hymeko-x {verb}", description=f"{summary[0].upper()}{summary[1:]}.", allow_abbrev=False)
    getattr(module, f"{verb}_arguments")(parser)
    code: int = getattr(module, f"run_{verb}")(parser.parse_args(words))
    sys.stdout.flush()
    return code


def overview() -> str:
    """The text of `hymeko-x --help`."""
    verbs = "\n".join(f"  {verb:<10} {summary}" for verb, (_, summary) in VERBS.items())
    return f"usage: hymeko-x VERB ...   (hymeko-x VERB --help says more)\n\n{verbs}\n\n{exits.TABLE}"


def _unknown_verb(word: str) -> int:
    from difflib import get_close_matches

    near = get_close_matches(word, VERBS, 1)
    meant = f"did you mean '{near[0]}'?" if near else f"verbs: {', '.join(VERBS)}"
    print(f"hymeko-x: there is no verb '{word}'; {meant}", file=sys.stderr)
    return exits.USAGE


def _print_version() -> int:
    from importlib.metadata import PackageNotFoundError, version

    try:
        print(f"hymeko-x {version('hymeko-x')}")
    except PackageNotFoundError:
        print("hymeko-x (running from a checkout that is not installed)")
    return exits.DONE
