"""The connection to a controller's program: starts it, exchanges messages over a socket, and ends it.

A message consists of its length in four bytes, the highest first, and its content. The content is JSON, or
MessagePack if the program's first message is in MessagePack.
"""

from __future__ import annotations

import contextlib
import json
import os
import secrets
import socket
import subprocess
import time
import weakref
from collections.abc import Sequence
from typing import Any

LARGEST = 1 << 24
"""Longest message that is read [bytes]; a longer one does not belong to this protocol."""
SAFE_END_S = 1.0
"""A program has this long to end by itself, and the same time again after it was asked to end [s]."""
_POLL_S = 0.1


class LinkError(RuntimeError):
    """The program ended, or sent something that is no message; the error is one line for the user."""


class Late(Exception):
    """No answer came in time; the connection still works."""


class Link:
    """A running program and the socket to it.

    Parameters
    ----------
    command
        Program and arguments.
    within_s
        The program has to connect within this time [s].
    **variables
        Environment variables of the program, in addition to those of this process.

    Raises
    ------
    LinkError
        If it cannot be started, ends, or does not connect in time.
    """

    def __init__(self, command: Sequence[str], within_s: float, **variables: str) -> None:
        self._name = command[0]
        self._token = secrets.token_hex(16)
        self._packed = False
        self._received = bytearray()
        with socket.create_server(("127.0.0.1", 0)) as server:
            host, port = server.getsockname()[:2]
            environment = {
                **os.environ,
                **variables,
                "COSIM_ADDRESS": f"{host}:{port}",
                "COSIM_TOKEN": self._token,
            }
            try:
                self._process = subprocess.Popen([*command], env=environment, stdin=subprocess.DEVNULL)
            except OSError as error:
                raise LinkError(f"{self._name} cannot be started: {error.strerror}") from error
            try:
                self._socket = self._accept(server, within_s)
            except BaseException:
                _end(self._process)
                raise
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._closed = weakref.finalize(self, _close, self._socket, self._process)

    def hello(self, within_s: float) -> dict[str, Any]:
        """Return the program's first message, which shows its encoding.

        Raises
        ------
        LinkError
            If it is no message, comes too late, or lacks the token.
        """
        try:
            message = self.receive(within_s)
        except Late:
            raise LinkError(f"{self._name} said nothing within {within_s:g} s") from None
        if message.get("token") != self._token:
            raise LinkError(f"{self._name} did not send the token of COSIM_TOKEN in its first message")
        return message

    def send(self, message: dict[str, Any]) -> None:
        """Send a message.

        Raises
        ------
        LinkError
            If the program has ended.
        """
        content = _msgpack().packb(message) if self._packed else _json(message)
        try:
            self._socket.settimeout(SAFE_END_S)
            self._socket.sendall(len(content).to_bytes(4, "big") + content)
        except OSError as error:
            raise self._gone("does not read") from error

    def receive(self, within_s: float) -> dict[str, Any]:
        """Return the next message.

        Raises
        ------
        Late
            If no message is complete in time; the part that has arrived is kept.
        LinkError
            If the program has ended, or what it sent is no message.
        """
        until = time.monotonic() + within_s
        while True:
            message = self._complete()
            if message is not None:
                return message
            left = until - time.monotonic()
            if left <= 0.0:
                raise Late
            self._socket.settimeout(left)
            try:
                part = self._socket.recv(1 << 16)
            except TimeoutError:
                raise Late from None
            except OSError as error:
                raise self._gone("broke off the connection") from error
            if not part:
                raise self._gone("closed the connection")
            self._received += part

    def close(self) -> None:
        """Tell the program to end, and make sure that it ends; a second call does nothing."""
        if self._closed.alive:
            with contextlib.suppress(LinkError):
                self.send({"type": "end"})
        self._closed()

    def _accept(self, server: socket.socket, within_s: float) -> socket.socket:
        until = time.monotonic() + within_s
        server.settimeout(_POLL_S)
        while time.monotonic() < until:
            with contextlib.suppress(TimeoutError):
                return server.accept()[0]
            if self._process.poll() is not None:
                raise self._gone("did not connect")
        raise LinkError(f"{self._name} did not connect to COSIM_ADDRESS within {within_s:g} s")

    def _complete(self) -> dict[str, Any] | None:
        """Return the first received message once it is complete, and ``None`` until then."""
        if len(self._received) < 4:
            return None
        length = int.from_bytes(self._received[:4], "big")
        if not 0 < length <= LARGEST:
            raise LinkError(
                f"{self._name} sent {bytes(self._received[:20])!r}, which is no message: expected four bytes "
                "with the length of what follows"
            )
        if len(self._received) < 4 + length:
            return None
        content = bytes(self._received[4 : 4 + length])
        del self._received[: 4 + length]
        return self._read(content)

    def _read(self, content: bytes) -> dict[str, Any]:
        self._packed = content[:1] != b"{"
        try:
            message = _msgpack().unpackb(content) if self._packed else json.loads(content)
        except LinkError:
            raise
        except (ValueError, UnicodeDecodeError, RecursionError) as error:
            raise LinkError(f"{self._name} sent {content[:40]!r}, which is no message ({error})") from error
        if not isinstance(message, dict):
            raise LinkError(f"{self._name} sent {content[:40]!r}: expected an object")
        return message

    def _gone(self, what: str) -> LinkError:
        with contextlib.suppress(subprocess.TimeoutExpired):
            code = self._process.wait(SAFE_END_S)  # the connection may end before the program does
            how = f"was ended by signal {-code}" if code < 0 else f"ended with exit code {code}"
            return LinkError(f"{self._name} {how}")
        return LinkError(f"{self._name} {what}")


def _json(message: dict[str, Any]) -> bytes:
    return json.dumps(message, separators=(",", ":"), allow_nan=False).encode()


def _msgpack() -> Any:
    try:
        import msgpack
    except ImportError as error:
        raise LinkError("the program speaks MessagePack: pip install msgpack") from error
    return msgpack


def _close(connection: socket.socket, process: subprocess.Popen[bytes]) -> None:
    connection.close()
    _end(process)


def _end(process: subprocess.Popen[bytes]) -> None:
    """Wait for a program to end by itself; terminate it if it does not."""
    for insist in (process.terminate, process.kill):
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(SAFE_END_S)
            return
        insist()
    process.wait()
