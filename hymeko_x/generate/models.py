"""Models: an endpoint that speaks as OpenAI's chat does, recorded answers, and a stand-in that makes the faults of the paper."""

from __future__ import annotations

import json
import random
import urllib.error
import urllib.request
from typing import TYPE_CHECKING, Protocol

from msgspec import Struct, field

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.generate.faults import damaged

if TYPE_CHECKING:
    from pathlib import Path

    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism

Messages = list[dict[str, str]]
MOST_BYTES = 2**24
_SECONDS = 300.0


class LanguageModel(Protocol):
    """Answers the messages of a conversation."""

    def __call__(self, messages: Messages) -> str:
        """The next message. Raises: Refusal HX001."""
        ...


class Endpoint(Struct, frozen=True):
    """A chat at a URL, as OpenAI's: ``POST {model, messages}``."""

    url: str
    name: str
    key: str = ""
    temperature: float = 0.0

    def __call__(self, messages: Messages) -> str:
        """The content of the first choice. Raises: Refusal HX001 when the endpoint gives none."""
        body = json.dumps({"model": self.name, "messages": messages, "temperature": self.temperature}).encode()
        headers = {"Content-Type": "application/json", **({"Authorization": f"Bearer {self.key}"} if self.key else {})}
        request = urllib.request.Request(self.url, body, headers)
        try:
            with urllib.request.urlopen(request, timeout=_SECONDS) as answer:
                found = json.loads(answer.read(MOST_BYTES))["choices"][0]["message"]["content"]
        except (OSError, urllib.error.HTTPError, ValueError, KeyError, IndexError, TypeError) as error:
            raise refuse(codes.CANNOT_READ, f"the model at '{self.url}' gave no answer: {error}") from error
        if not isinstance(found, str):
            raise refuse(codes.CANNOT_READ, f"the model at '{self.url}' gave no text")
        return found


class Replay(Struct):
    """Answers from the files of a folder, in the order of their names."""

    folder: Path
    given: int = 0

    def __call__(self, messages: Messages) -> str:
        """The next file's text. Raises: Refusal HX001 when there is none."""
        paths = sorted(path for path in self.folder.iterdir() if path.is_file()) if self.folder.is_dir() else []
        if self.given >= len(paths):
            raise refuse(codes.CANNOT_READ, f"'{self.folder}' has no answer number {self.given + 1}")
        self.given += 1
        return paths[self.given - 1].read_text("utf-8", "replace")


class Faulty(Struct):
    """Converts with this program, and makes faults as often as the paper's model did."""

    robot: Mechanism
    format: Format
    rate: float
    chance: random.Random = field(default_factory=random.Random)

    def __call__(self, messages: Messages) -> str:
        """The robot in the format, damaged by chance."""
        return damaged(self.robot, self.format, self.rate, self.chance)
