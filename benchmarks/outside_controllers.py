"""What a step costs with a controller outside: a program (JSON, MessagePack) and a functional mock-up unit.

``python benchmarks/outside_controllers.py``; exit code 1 if a program adds more than a millisecond on the
median to the same controller inside the process. Needs the extras ``process`` and ``fmu`` and pythonfmu.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from statistics import median, quantiles
from tempfile import TemporaryDirectory
from time import perf_counter

from controllers import catalog
from controllers.interface import Perception
from controllers.outside.functions import FromFunction
from controllers.outside.given import Given
from cosim.step.drivers import release
from cosim.step.toy_road import ToyCrossing, ToyPedestrian, ToyRoad, ToyVehicle, walk
from cosim.step.toy_world import ToyWorld

BAR_MS = 1.0
STEPS, ROUNDS = 400, 3
PROGRAM = """
import json, os, socket, sys
packed = sys.argv[1] == "packed"
if packed:
    import msgpack
host, port = os.environ["COSIM_ADDRESS"].split(":")
link = socket.create_connection((host, int(port)))
link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
incoming = link.makefile("rb")
def send(message):
    content = msgpack.packb(message) if packed else json.dumps(message).encode()
    link.sendall(len(content).to_bytes(4, "big") + content)
send({"type": "hello", "protocol": 1, "token": os.environ["COSIM_TOKEN"]})
while len(head := incoming.read(4)) == 4:
    content = incoming.read(int.from_bytes(head, "big"))
    message = msgpack.unpackb(content) if packed else json.loads(content)
    if message["type"] == "end":
        break
    if message["type"] == "perception":
        wanted = 8.0 - message["ego"]["speed_mps"]
        send({"type": "command", "step": message["step"], "acceleration_mps2": min(max(wanted, -3.0), 2.0)})
"""
UNIT = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real
class Towards(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.speed = self.wanted = 0.0
        self.register_variable(Real("speed", causality=Fmi2Causality.input))
        self.register_variable(Real("wanted", causality=Fmi2Causality.output))
    def do_step(self, current_time, step_size):
        self.wanted = min(max(8.0 - self.speed, -3.0), 2.0)
        return True
"""
MAPPING = '[inputs]\nspeed = "speed_mps"\n[outputs]\nacceleration_mps2 = "wanted"\n'


def inside(perception: Perception) -> float:
    """Return what all of them answer."""
    return min(max(8.0 - perception.ego.speed, -3.0), 2.0)


def step_times_ms(name: str | Given, settings: Mapping[str, object]) -> list[float]:
    """Return the wall-clock time of each step: ten pedestrians and four vehicles near [ms]."""
    world = ToyWorld(
        road=ToyRoad(lanes=3, crossings=(ToyCrossing(60.0),)),
        pedestrians=[ToyPedestrian(f"p{i}", walk(62.0, -6.0 - i, 0.0, 0.2)) for i in range(10)],
        vehicles=[ToyVehicle(f"v{i}", walk(40.0 + 30.0 * i, 3.5 * (i % 3), 8.0, 0.0)) for i in range(4)],
        duration=0.1 * STEPS,
    )
    controller = catalog.build(name, **settings)
    found = []
    try:
        while (perceptions := world.sense()) is not None:
            for perception in perceptions:
                begun = perf_counter()
                plan = controller.plan(perception, controller.decide(perception))
                found.append(1e3 * (perf_counter() - begun))
                world.act(perception.ego.name, plan.command)
            world.advance()
    finally:
        release(controller)
    return found[10:]


def main() -> int:
    """Measure, print, and return the exit code."""
    from pythonfmu import FmuBuilder

    patient = {"deadline_ms": 60000.0, "patience_s": 600.0}
    with TemporaryDirectory() as text:
        folder = Path(text)
        (folder / "program.py").write_text(PROGRAM)
        (folder / "towards.py").write_text(UNIT)
        unit = FmuBuilder.build_FMU(folder / "towards.py", dest=folder)
        Path(unit).with_suffix(".toml").write_text(MAPPING)
        program = f"process:{sys.executable} {folder / 'program.py'}"
        subjects: dict[str, tuple[str | Given, Mapping[str, object]]] = {
            "inside": (Given("inside", lambda: FromFunction(inside)), {}),
            "program, JSON": (f"{program} json", patient),
            "program, MessagePack": (f"{program} packed", patient),
            "unit (FMI 2.0)": (f"fmu:{unit}", {}),
        }
        times: dict[str, list[float]] = {name: [] for name in subjects}
        for _ in range(ROUNDS):
            for name, (address, settings) in subjects.items():
                times[name] += step_times_ms(address, settings)
    base = median(times["inside"])
    for name, values in times.items():
        p99 = quantiles(values, n=100)[98]
        print(f"{name:22} median {median(values):.3f} ms, 99th percentile {p99:.2f} ms")
    worst = max(median(times[name]) - base for name in times if name.startswith("program"))
    print(f"a program adds at most {worst:.3f} ms on the median; bar {BAR_MS:g} ms")
    return int(worst > BAR_MS)


if __name__ == "__main__":
    sys.exit(main())
