"""A program that speaks the step protocol, well or badly: ``python program.py BEHAVIOUR``."""

from __future__ import annotations

import json
import os
import socket
import sys
import time
from typing import Any

import msgpack

BEHAVIOUR = sys.argv[1]
PACKED = BEHAVIOUR == "packed"


def send(link: socket.socket, message: dict[str, Any]) -> None:
    content = msgpack.packb(message) if PACKED else json.dumps(message).encode()
    link.sendall(len(content).to_bytes(4, "big") + content)


def receive(link: socket.socket) -> dict[str, Any]:
    length = int.from_bytes(exactly(link, 4), "big")
    content = exactly(link, length)
    message: dict[str, Any] = msgpack.unpackb(content) if PACKED else json.loads(content)
    return message


def exactly(link: socket.socket, count: int) -> bytes:
    content = b""
    while len(content) < count:
        part = link.recv(count - len(content))
        if not part:
            sys.exit(0)
        content += part
    return content


def answer(link: socket.socket, message: dict[str, Any]) -> None:
    command: dict[str, Any] = {"type": "command", "step": message["step"], "acceleration_mps2": -1.0}
    later = message["step"] > 3  # the rehearsal of a run has two steps
    if BEHAVIOUR == "steers":
        command |= {"acceleration_mps2": [1.0, 0.0], "steering_rad": [0.1, 0.2], "times_s": [0.0, 0.05]}
    if BEHAVIOUR == "dies" and later:
        sys.exit(7)
    if BEHAVIOUR == "hangs" and later:
        time.sleep(60.0)
    if BEHAVIOUR == "late" and message["step"] == 2:
        time.sleep(0.4)
    if BEHAVIOUR == "trickles" and later:
        for step in range(1, 4):  # answers to earlier steps, each within the deadline of the one before
            time.sleep(0.15)
            send(link, command | {"step": step})
    if BEHAVIOUR == "rubbish" and later:
        link.sendall(b"acceleration = 3\n" * 4)
        return
    if BEHAVIOUR == "nan" and later:
        command["acceleration_mps2"] = float("nan")
    if BEHAVIOUR == "lists":
        command |= {"acceleration_mps2": [1.0, 2.0], "steering_rad": 0.0, "times_s": [0.0]}
    if BEHAVIOUR == "lane":
        command["target_lane"] = 9
    send(link, command)


def main() -> None:
    if BEHAVIOUR == "silent":
        time.sleep(60.0)
    if BEHAVIOUR == "ends":
        sys.exit(5)
    host, port = os.environ["COSIM_ADDRESS"].split(":")
    with socket.create_connection((host, int(port))) as link:
        token = "wrong" if BEHAVIOUR == "stranger" else os.environ["COSIM_TOKEN"]
        send(link, {"type": "hello", "protocol": 0 if BEHAVIOUR == "old" else 1, "token": token})
        while True:
            message = receive(link)
            if message["type"] == "end":
                if BEHAVIOUR == "stays":
                    time.sleep(60.0)
                return
            if message["type"] == "perception":
                answer(link, message)


if __name__ == "__main__":
    main()
