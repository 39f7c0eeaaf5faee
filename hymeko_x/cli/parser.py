"""How the words of one verb are parsed: mistakes are one line with a suggestion, and some options belong to every verb."""

from __future__ import annotations

import argparse
import os
import re
from typing import TYPE_CHECKING, NoReturn

from hymeko_x.cli.exits import UsageError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

COLORS = ("auto", "always", "never")
_UNKNOWN = "unrecognized arguments: "
_INVALID = re.compile(r"argument (?P<of>.+): invalid choice: '(?P<word>.*)' \(choose from (?P<choices>.+)\)")


class Parser(argparse.ArgumentParser):
    """A parser that explains a mistake in one line."""

    def error(self, message: str) -> NoReturn:
        """Raises: UsageError, with the option or the word that was probably meant."""
        raise UsageError(f"{self._explained(message)} ({self.prog} --help lists the options)")

    def _explained(self, message: str) -> str:
        if message.startswith(_UNKNOWN):
            return self._unknown(message.removeprefix(_UNKNOWN).split())
        invalid = _INVALID.fullmatch(message)
        if invalid is None:
            return message.removeprefix("the following ")
        choices = re.findall(r"[\w.-]+", invalid["choices"])
        near = _nearest(invalid["word"], choices)
        meant = f"did you mean '{near}'?" if near else f"known: {', '.join(choices)}"
        return f"{invalid['of']}: there is no '{invalid['word']}'; {meant}"

    def _unknown(self, words: list[str]) -> str:
        option = next((word.partition("=")[0] for word in words if word.startswith("-")), None)
        if option is None:
            near = next((known for known in self._options() if known.partition("=")[2] in words), None)
            problem = f"there are more words than it takes: {' '.join(words)}"
        else:
            near = _nearest(option, self._options())
            problem = f"there is no option '{option}'"
        return problem + (f"; did you mean '{near}'?" if near else "")

    def _options(self) -> Iterator[str]:
        """Every option of this parser and of those of its actions."""
        for action in self._actions:
            yield from action.option_strings
            if isinstance(action, argparse._SubParsersAction):
                for parser in action.choices.values():
                    yield from parser._options()


def _nearest(word: str, known: Iterable[str]) -> str | None:
    """The known word that was probably meant."""
    from difflib import get_close_matches

    return next(iter(get_close_matches(word, list(known), 1)), None)


def count(text: str) -> int:
    """A number of at least 1. Raises: argparse.ArgumentTypeError."""
    if not text.isascii() or not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"expected a number of at least 1, found '{text}'")
    return int(text)


def shared_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of every verb; `-o` where the verb has none of its own."""
    parser.add_argument("--color", choices=COLORS, default="auto", help="colours on a terminal (auto), always or never")
    if "-o" not in parser._option_string_actions and not any(action.dest == "action" for action in parser._actions):
        parser.add_argument("-o", "--output", dest="printed_to", metavar="FILE", help="print into this file instead of standard output")


def choose_colors(word: str) -> None:
    """Let `--color` win over the environment, for this process and for those that it starts (https://no-color.org)."""
    if word == "auto":
        return
    for variable, is_set in (("FORCE_COLOR", word == "always"), ("NO_COLOR", word == "never")):
        if is_set:
            os.environ[variable] = "1"
        else:
            os.environ.pop(variable, None)
