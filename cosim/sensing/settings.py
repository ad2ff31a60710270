"""Parameters of sensing models: ranges that several of them share."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from controllers.settings import SettingsModel

Probability = Annotated[float, Field(ge=0.0, le=1.0)]
FullAngle = Annotated[float, Field(gt=0.0, le=360.0)]
Count = Annotated[int, Field(ge=1, le=64)]


class Settings(SettingsModel):
    """Base class of the parameters of a sensing model."""
