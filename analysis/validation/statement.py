"""The result of the validation in one sentence, for README.md and every report of a simulation."""

from __future__ import annotations

SENTENCE = (
    "Behaviour in the simulation was compared with real tracks of one signalised junction only: pedestrian "
    "behaviour is not validated for gap acceptance, yielding or waiting, and SUMO's own cars accelerate and "
    "brake harder and keep to the middle of their lane more strictly than real ones."
)
"""The findings of docs/validation.md."""
