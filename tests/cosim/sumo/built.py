"""Networks that tests describe in a few lines."""

import subprocess
from pathlib import Path

from sumo_scenarios.sumo_installation import netconvert


def grid(folder: Path, junctions: str, *options: str) -> Path:
    """Return the file of a grid with nine junctions of one of SUMO's types, in which nobody turns round."""
    target = folder / "net.xml"
    kind = ["--grid", "--grid.number=3", "--no-turnarounds", f"--default-junction-type={junctions}"]
    netgenerate = netconvert().with_name("netgenerate")
    subprocess.run([netgenerate, *kind, *options, "-o", target], check=True, capture_output=True)
    return target


def network(folder: Path, nodes: str, edges: str, connections: str = "") -> Path:
    """Return the file of a network that netconvert makes from elements of its plain files."""
    parts = {"node": nodes, "edge": edges, "connection": connections}
    target = folder / "n.net.xml"
    inputs: list[str | Path] = ["-o", target]
    for kind, content in parts.items():
        (folder / f"n.{kind}.xml").write_text(f"<{kind}s>{content}</{kind}s>")
        inputs += [f"--{kind}-files", folder / f"n.{kind}.xml"]
    subprocess.run([netconvert(), *inputs], check=True, capture_output=True)
    return target
