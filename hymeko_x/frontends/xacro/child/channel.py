"""Messages between the child and its parent, and the one exception that ends an expansion.

A message in either direction is one line of JSON, followed by as many bytes as its ``bytes`` says. The parent's first
message is the job; the child's last one is ``done`` or ``failed``.
"""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from typing import BinaryIO


class Trouble(BaseException):
    """What ends an expansion, with the facts that the parent needs for its message. No Exception: xacro must not wrap or swallow it."""

    def __init__(self, kind: str, **facts: object) -> None:
        super().__init__(kind)
        self.facts: dict[str, object] = {"kind": kind, **facts}


class Parent:
    """The process that started this one, over standard input and output."""

    def __init__(self, incoming: BinaryIO, outgoing: BinaryIO) -> None:
        self._incoming = incoming
        self._outgoing = outgoing

    def receive(self) -> tuple[dict[str, Any], bytes]:
        """The next message. Ends this process when the parent is gone."""
        line = self._incoming.readline()
        if not line:
            sys.exit(1)
        message: dict[str, Any] = json.loads(line)
        return message, self._incoming.read(message["bytes"])

    def send(self, data: bytes = b"", **message: object) -> None:
        """Send a message."""
        self._outgoing.write(json.dumps({**message, "bytes": len(data)}).encode() + b"\n" + data)
        self._outgoing.flush()

    def ask(self, question: str, **facts: object) -> tuple[dict[str, Any], bytes]:
        """Send a question and wait for the answer."""
        self.send(b"", ask=question, **facts)
        return self.receive()
