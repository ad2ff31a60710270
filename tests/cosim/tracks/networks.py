"""The network of a straight street with a zebra crossing, for tracks that tests make."""

from __future__ import annotations

import subprocess
from pathlib import Path

import sumo

NODES = """<nodes>
 <node id="west" x="0" y="0"/><node id="middle" x="100" y="0"/><node id="east" x="200" y="0"/>
</nodes>"""
EDGES = """<edges>
 <edge id="e1" from="west" to="middle" numLanes="1" speed="13.89" sidewalkWidth="2"/>
 <edge id="e2" from="middle" to="east" numLanes="1" speed="13.89" sidewalkWidth="2"/>
 <edge id="w1" from="east" to="middle" numLanes="1" speed="13.89" sidewalkWidth="2"/>
 <edge id="w2" from="middle" to="west" numLanes="1" speed="13.89" sidewalkWidth="2"/>
</edges>"""
CROSSING = '<connections><crossing node="middle" edges="e1 w2" priority="true"/></connections>'


def street(folder: Path, *options: str, crossing: str = CROSSING, edges: str = EDGES) -> Path:
    """Build the street: lanes along y = −1.6 m east and y = 1.6 m west, sidewalks, a crossing at x = 100 m.

    Parameters
    ----------
    folder : existing
    options : of netconvert
    crossing, edges : plain sources
    """
    for name, text in (("n.nod.xml", NODES), ("e.edg.xml", edges), ("c.con.xml", crossing)):
        (folder / name).write_text(text)
    program = Path(sumo.SUMO_HOME) / "bin" / "netconvert"
    files = ("-n", "n.nod.xml", "-e", "e.edg.xml", "-x", "c.con.xml", "-o", "street.net.xml")
    subprocess.run(
        [str(program), *files, "--no-internal-links", "false", *options],
        cwd=folder,
        check=True,
        capture_output=True,
    )
    return folder / "street.net.xml"


CONFIGURATION = """<configuration><input><net-file value="street.net.xml"/></input>
<time><begin value="0"/><end value="200"/><step-length value="0.1"/></time></configuration>"""


def configure(folder: Path) -> Path:
    """Write street.sumocfg, which has the street and no demand."""
    path = folder / "street.sumocfg"
    path.write_text(CONFIGURATION)
    return path
