"""Which solver, and how exactly it solves."""

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
    """Absolute and relative tolerance that OSQP is asked for first, and more where that is not enough; the
    other solvers keep their own. What a solution has to meet is the same for all, see
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
    """Return the solvers that qpsolvers can have installed by pip, each an extra of its own."""
    extras = metadata.metadata("qpsolvers").get_all("Provides-Extra") or []
    return set(extras) - {"open-source-solvers", "wheels-only"}
