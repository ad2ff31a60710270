"""The simplest other end of the protocol, in Python: messages over a socket, without a time limit."""

from __future__ import annotations

import json
import os
import socket
from dataclasses import dataclass
from typing import Any


@dataclass(slots=True)
class Wire:
    """A connected socket."""

    socket: socket.socket

    @classmethod
    def to_parent(cls) -> Wire:
        """Connect to the address in the environment variable COSIM_ADDRESS."""
        host, port = os.environ["COSIM_ADDRESS"].split(":")
        link = socket.create_connection((host, int(port)))
        link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return cls(link)

    def send(self, message: dict[str, Any]) -> None:
        """Send a message."""
        content = json.dumps(message).encode()
        self.socket.sendall(len(content).to_bytes(4, "big") + content)

    def receive(self) -> dict[str, Any]:
        """Return the next message, or an end message once the connection is closed."""
        content = self._exactly(int.from_bytes(self._exactly(4), "big"))
        found: dict[str, Any] = json.loads(content) if content else {"type": "end"}
        return found

    def _exactly(self, count: int) -> bytes:
        content = b""
        while len(content) < count:
            part = self.socket.recv(count - len(content))
            if not part:
                return b""
            content += part
        return content
