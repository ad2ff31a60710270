"""Parameters of sensing models: types, ranges and units, once."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Probability = Annotated[float, Field(ge=0.0, le=1.0)]
FullAngle = Annotated[float, Field(gt=0.0, le=360.0)]
Count = Annotated[int, Field(ge=1, le=64)]


class Settings(BaseModel):
    """Named values, all of them known; texts are taken as ``--set`` gives them."""

    model_config = ConfigDict(extra="forbid", frozen=True)
