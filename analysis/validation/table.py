"""validation.csv: real and simulated values side by side, one row for each quantity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.tables.cells import Row, plain
from analysis.tables.column import Table, at_least_0, count, number, row_of, text
from analysis.validation.comparison import Comparison, compare, in_words
from analysis.validation.observed import Observed
from analysis.validation.quantities import QUANTITIES, Quantity


@dataclass(frozen=True, slots=True)
class Compared:
    """The comparison of one quantity, from which a row is made."""

    quantity: Quantity
    found: Comparison

    @property
    def sentence(self) -> str:
        """The verdict in words."""
        return in_words(self.found, self.quantity.unit)


_INTERVAL = "95 % interval, bootstrap over road users, each with all its runs"

VALIDATION = Table(
    "validation",
    "One row for each quantity: real road users beside simulated ones",
    (
        text("quantity", "what is compared", source="quantity.name", required=True),
        text("unit", "of the values", source="quantity.unit", required=True),
        text("meaning", "the value of one road user", source="quantity.meaning", required=True),
        count("n_real", "real road users with a value", source="found.n_real", required=True),
        count("n_simulated", "simulated ones, over all seeds", source="found.n_simulated", required=True),
        number("real_mean", "1", "mean over real road users, in the unit of the row", source="found.real"),
        number("simulated_mean", "1", "mean over simulated ones", source="found.simulated"),
        number("real_sd", "1", "standard deviation of the real ones", source="found.real_sd"),
        number("simulated_sd", "1", "standard deviation of the simulated ones", source="found.simulated_sd"),
        number("difference", "1", "simulated minus real mean", source="found.difference"),
        number("difference_lo", "1", _INTERVAL, source="found.low"),
        number("difference_hi", "1", _INTERVAL, source="found.high"),
        number("effect", "1", "difference in pooled standard deviations", source="found.effect"),
        at_least_0("ks_distance", "1", "distance of the distributions, 0 to 1", source="found.distance"),
        at_least_0(
            "detectable", "1", "difference that is shown with a power of 80 %", source="found.detectable"
        ),
        text(
            "verdict",
            "what follows",
            "different",
            "indistinguishable",
            "too few",
            source="found.verdict",
            required=True,
        ),
    ),
    ("quantity",),
)


def compared(real: Observed, simulated: Sequence[Observed]) -> list[Compared]:
    """Compare every quantity of a recording with those of several runs, whose road users are pooled."""
    found = []
    for quantity in QUANTITIES:
        ours = pd.concat([pd.Series(dtype=np.float64), *(quantity.values(run) for run in simulated)])
        theirs = quantity.values(real).to_numpy(np.float64)
        names = ours.index.astype(str).tolist()
        found.append(Compared(quantity, compare(theirs, ours.to_numpy(np.float64), names)))
    return found


def rows(found: Sequence[Compared]) -> list[Row]:
    """Return the rows of validation.csv."""
    return [plain(VALIDATION, row_of(VALIDATION.columns, one)) for one in found]


def values_of(seen: Observed) -> pd.DataFrame:
    """Return the values of all road users: ``quantity``, ``id``, ``value``."""
    parts = [
        pd.DataFrame({"quantity": one.name, "id": values.index.astype(str), "value": values.to_numpy()})
        for one in QUANTITIES
        if len(values := one.values(seen))
    ]
    return pd.concat(parts, ignore_index=True)
