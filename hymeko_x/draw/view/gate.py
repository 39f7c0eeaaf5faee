"""The gate before a page that other machines can reach: a browser is let in that has the token, once in the address and then in a cookie.

Every connection is one request: its head is looked at, and then all bytes go both ways, so that web sockets pass as they are.
"""

from __future__ import annotations

import asyncio
import hmac
import re
from contextlib import suppress
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlsplit

COOKIE = "hymeko_x_token"
_LONGEST_HEAD = 65536
_SECONDS = 10.0
"""So long a head may take."""
_WORDS = b"the address is not complete: no token"
_REFUSED = b"HTTP/1.1 403 Forbidden\r\nContent-Type: text/plain\r\nContent-Length: %d\r\nConnection: close\r\n\r\n%s" % (
    len(_WORDS),
    _WORDS,
)


class Gate:
    """Listens at an address and passes requests with the token on to a server on this machine."""

    def __init__(self, host: str, port: int, behind: int, token: str) -> None:
        self._host, self._port, self._behind, self._token = host, port, behind, token
        self._server: asyncio.Server | None = None

    @property
    def port(self) -> int:
        """The port at which it listens."""
        assert self._server is not None, "the gate was not opened"
        return int(self._server.sockets[0].getsockname()[1])

    async def open(self) -> None:
        """Begin to listen. Raises: OSError where the address cannot be had."""
        self._server = await asyncio.start_server(self._pass, self._host, self._port, limit=_LONGEST_HEAD)

    async def close(self) -> None:
        """Listen no more."""
        if self._server is not None:
            self._server.close()

    async def _pass(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            head = await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), _SECONDS)
            if not self.lets_in(head):
                writer.write(_REFUSED)
                await writer.drain()
                return
            if self._brings_token(head):
                writer.write(self._welcome())
                await writer.drain()
                return
            from_server, to_server = await asyncio.open_connection("127.0.0.1", self._behind)
            to_server.write(_one_request(head))
            await asyncio.gather(_copied(reader, to_server), _copied(from_server, writer))
        except (OSError, asyncio.IncompleteReadError, asyncio.LimitOverrunError, TimeoutError):
            return
        finally:
            writer.close()

    def lets_in(self, head: bytes) -> bool:
        """Whether the head of a request has the token, in its address or in a cookie."""
        return any(hmac.compare_digest(given.encode(), self._token.encode()) for given in (*_in_address(head), *_in_cookies(head)))

    def _brings_token(self, head: bytes) -> bool:
        """Whether the token is in the address of a page that a browser opens."""
        return bool(_in_address(head)) and b"upgrade: websocket" not in head.lower()

    def _welcome(self) -> bytes:
        """The answer to the token: a cookie with it, and the way to the page without it in the address."""
        cookie = f"{COOKIE}={self._token}; Path=/; HttpOnly; SameSite=Strict"
        return f"HTTP/1.1 303 See Other\r\nLocation: /\r\nSet-Cookie: {cookie}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n".encode()


def _in_address(head: bytes) -> list[str]:
    words = head.split(b"\r\n", 1)[0].decode("latin-1").split(" ")
    with suppress(ValueError):
        return parse_qs(urlsplit(words[1]).query).get("token", []) if len(words) == 3 else []
    return []


def _in_cookies(head: bytes) -> list[str]:
    found = re.findall(rb"\r\ncookie:([^\r]*)", head, re.IGNORECASE)
    tokens = []
    for line in found:
        with suppress(CookieError):
            cookie = SimpleCookie(line.decode("latin-1")).get(COOKIE)
            tokens += [] if cookie is None else [cookie.value]
    return tokens


def _one_request(head: bytes) -> bytes:
    """The head of a request after which the connection ends, unless it becomes a web socket."""
    if b"upgrade: websocket" in head.lower():
        return head
    return re.sub(rb"\r\nconnection:[^\r]*", b"", head, flags=re.IGNORECASE)[:-2] + b"Connection: close\r\n\r\n"


async def _copied(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """All bytes from one end to the other."""
    with suppress(OSError):
        while data := await reader.read(65536):
            writer.write(data)
            await writer.drain()
    writer.close()
