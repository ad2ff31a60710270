"""A city to measure in: a grid with signals, sidewalks and crossings, its traffic as dense as asked for.

Nobody leaves before the end, so that the number of road users stays what it is.
"""

from __future__ import annotations

import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import sumo
import sumolib

BLOCKS, BLOCK_M = 8, 200.0
FILLED_S = 10.0
"""All are on the road by then [s]."""
EDGES_OF_A_WAY = 40
PLACES_OF_A_WALK = 12


@dataclass(frozen=True, slots=True)
class City:
    """What the city holds."""

    vehicles: int
    persons: int
    duration_s: float = 90.0
    step_s: float = 0.1
    seed: int = 1
    blocks: int = BLOCKS
    """Junctions along each side."""
    filled_s: float = FILLED_S
    """All set out until then [s]."""

    def write(self, folder: Path) -> Path:
        """Write network, demand and configuration; return the configuration."""
        net = folder / "city.net.xml"
        size = ["--grid", "--grid.number", str(self.blocks), "--grid.length", str(BLOCK_M), "-L", "2"]
        walks = ["--sidewalks.guess", "--sidewalks.guess.max-speed", "20", "--crossings.guess"]
        rest = ["--default.speed", "13.89", "--no-turnarounds", "--tls.guess", "-o", str(net)]
        netgenerate = Path(sumo.SUMO_HOME) / "bin" / "netgenerate"
        subprocess.run([str(netgenerate), *size, *walks, *rest], check=True, capture_output=True)
        (folder / "city.rou.xml").write_text("\n".join(self._demand(net)))
        configuration = folder / "city.sumocfg"
        configuration.write_text(
            '<configuration><input><net-file value="city.net.xml"/>'
            '<route-files value="city.rou.xml"/></input>'
            f'<time><end value="{self.duration_s:g}"/><step-length value="{self.step_s:g}"/></time>'
            "</configuration>"
        )
        return configuration

    def _demand(self, net: Path) -> list[str]:
        rng = np.random.default_rng(self.seed)
        edges = sorted(sumolib.net.readNet(str(net)).getEdges(), key=lambda edge: str(edge.getID()))
        users: list[tuple[float, str]] = []
        for number, depart in enumerate(np.linspace(0.0, self.filled_s, self.vehicles)):
            way = self._way(edges, rng, EDGES_OF_A_WAY)
            place = 'departLane="best" departPos="random_free" departSpeed="0"'
            users.append(
                (
                    depart,
                    f'<vehicle id="car.{number}" type="car" depart="{depart:.1f}" {place}>'
                    f'<route edges="{way}"/></vehicle>',
                )
            )
        for number, depart in enumerate(np.linspace(0.0, self.filled_s, self.persons)):
            way = self._way(edges, rng, PLACES_OF_A_WALK)
            users.append(
                (
                    depart,
                    f'<person id="walker.{number}" depart="{depart:.1f}" departPos="random">'
                    f'<walk edges="{way}"/></person>',
                )
            )
        # SUMO leaves out who departs before the one above.
        ordered = [text for _, text in sorted(users, key=lambda user: user[0])]
        return ["<routes>", '<vType id="car" vClass="passenger"/>', *ordered, "</routes>"]

    @staticmethod
    def _way(edges: list, rng: np.random.Generator, length: int) -> str:  # type: ignore[type-arg]
        here = edges[int(rng.integers(len(edges)))]
        names = [here.getID()]
        while len(names) < length:
            onward = [edge for edge in here.getOutgoing() if edge.getToNode() != here.getFromNode()]
            onward.sort(key=lambda edge: str(edge.getID()))
            here = onward[int(rng.integers(len(onward)))]
            names.append(here.getID())
        return " ".join(names)
