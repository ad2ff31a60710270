"""Gymnasium environments: ``import cosim.gym; gymnasium.make("cosim/midblock_zebra-v0")``.

Importing this package registers one environment for each built-in scenario, and ``cosim/scenario-v0`` for any
other; ``docs/gymnasium.md`` explains them.
"""

from cosim.gym.registration import NAMES, register
from cosim.gym.several import parallel_env

__all__ = ["NAMES", "parallel_env"]

register()
