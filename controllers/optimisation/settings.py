"""The choice of a solver, and its tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import metadata

import qpsolvers


@dataclass(frozen=True, slots=True)
class SolverSettings:
    """A solver by its name in qpsolvers.

    Raises
    ------
    ValueError
        If the solver is not installed, with the command that installs it, or if qpsolvers does not know it.
    """

    name: str = "daqp"
    tolerance: float = 1e-4
    """Absolute and relative tolerance that OSQP tries first; where that is not enough, it tries smaller ones.
    The other solvers keep their own. The conditions for a solution are the same for all solvers, see
    :mod:`controllers.optimisation.solution`."""

    def __post_init__(self) -> None:
        installed = sorted(qpsolvers.available_solvers)
        if self.name in installed:
            return
        if self.name in _installable():
            raise ValueError(
                f"solver '{self.name}' is not installed: pip install 'qpsolvers[{self.name}]'; "
                f"installed are: {', '.join(installed)}"
            )
        raise ValueError(f"unknown solver '{self.name}'; installed are: {', '.join(installed)}")


def _installable() -> set[str]:
    """Return the solvers that pip can install with qpsolvers, each as an extra of its own."""
    extras = metadata.metadata("qpsolvers").get_all("Provides-Extra") or []
    return set(extras) - {"open-source-solvers", "wheels-only"}
