"""What all tables of a scenario file share."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Until = Annotated[float, Field(allow_inf_nan=True)]


class Table(BaseModel):
    """What all tables share: no unknown keys, no silent conversions, no infinite numbers."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True, regex_engine="python-re")
