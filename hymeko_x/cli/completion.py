"""`hymeko-x completion SHELL`: what makes a shell complete the words of this program, which it asks by running it.

Source: argcomplete, whose protocol bash, zsh and fish follow: the line in COMP_LINE, the answers on another stream.
"""

from __future__ import annotations

import argparse
import os
from typing import TYPE_CHECKING

from hymeko_x.cli import exits

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

SHELLS = ("bash", "zsh", "fish")
_USE = {
    "bash": 'eval "$(hymeko-x completion bash)"                                  in ~/.bashrc',
    "zsh": 'eval "$(hymeko-x completion zsh)"                                   in ~/.zshrc, after compinit',
    "fish": "hymeko-x completion fish > ~/.config/fish/completions/hymeko-x.fish   once",
}


def completion_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `completion`."""
    parser.add_argument("shell", choices=SHELLS, help="for which shell")
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.epilog = "how to use it:\n" + "\n".join(f"  {line}" for line in _USE.values())


def run_completion(chosen: argparse.Namespace) -> int:
    """Print the shell's text."""
    from argcomplete.shell_integration import shellcode

    print(shellcode(["hymeko-x"], shell=chosen.shell))
    return exits.DONE


def complete(summaries: Mapping[str, str], parser_of: Callable[[str], argparse.ArgumentParser]) -> None:
    """Answer a shell and end the process: the verbs, or the options, choices and files of the verb on the line."""
    from argcomplete import autocomplete

    words = os.environ.get("COMP_LINE", "").split()
    verb = words[1] if len(words) > 1 else ""
    parser = argparse.ArgumentParser("hymeko-x", allow_abbrev=False)
    verbs = parser.add_subparsers(metavar="VERB")
    for name, summary in summaries.items():
        known = [_with_choices(parser_of(name))] if name == verb else []
        verbs.add_parser(name, help=summary, parents=known, add_help=False, allow_abbrev=False)
    autocomplete(parser, always_complete_options="long")


def _with_choices(parser: argparse.ArgumentParser) -> argparse.ArgumentParser:
    """The parser, with the names of formats, targets and codes for each argument that takes one."""
    from argcomplete.completers import ChoicesCompleter

    from hymeko_x.codes import CODES
    from hymeko_x.formats import FORMATS
    from hymeko_x.targets import TARGETS

    choices = {
        "FORMAT": {row.name: row.title for row in FORMATS},
        "TARGET": {target.name: target.title for target in TARGETS},
        "CODE": {code.id: code.title for code in CODES.values()},
    }
    for action in parser._actions:
        if isinstance(action.metavar, str) and action.metavar in choices:
            action.completer = ChoicesCompleter(choices[action.metavar])  # type: ignore[attr-defined]
    return parser
