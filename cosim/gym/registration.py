"""Registration of the environments with Gymnasium."""

from __future__ import annotations

from cosim.errors import InputError
from sumo_scenarios import library

try:
    import gymnasium
except ImportError as error:
    raise InputError("cosim.gym needs Gymnasium: pip install gymnasium") from error

ANY = "cosim/scenario-v0"
"""Name of the environment that takes the scenario as its argument."""
NAMES = (*(f"cosim/{name}-v0" for name in library.names()), ANY)
_ENTRY = "cosim.gym.environment:CrossingEnv"


def register() -> None:
    """Register the environments; a second call changes nothing."""
    for name in NAMES:
        if name not in gymnasium.registry:
            scenario = name.removeprefix("cosim/").removesuffix("-v0")
            arguments = {} if name == ANY else {"scenario": scenario}
            gymnasium.register(name, entry_point=_ENTRY, kwargs=arguments)
