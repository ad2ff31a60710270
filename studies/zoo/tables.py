"""The tables of the zoo in Markdown, and as CSV files beside the runs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from analysis.files import write_csv
from analysis.markdown import table
from studies.zoo.bars import Bar
from studies.zoo.results import Contact, Run
from studies.zoo.tally import Tally, of

HEADS = (
    "driver",
    "valid runs",
    "entered encounters",
    "contacts",
    "per entered encounter (95 %)",
    "preventable",
    "largest impact [km/h]",
    "touched while standing",
    "overlaps closed",
    "interventions",
    "stops on a crossing",
    "foreseeable",
    "deadlocks",
    "mean delay [s]",
)
CONTACTS = ("network", "controller", "seed", "ego", "person", "time_s", "impact_kmh", "preventable")
CLASSES = ("place", "moved_by", "class")


def cells(name: str, tally: Tally) -> list[str]:
    """Return one row with the columns `HEADS`."""
    return [
        name,
        f"{len(tally.valid)} of {len(tally.runs)}",
        str(tally.entered),
        _with_classes(tally),
        tally.share,
        str(tally.preventable),
        _decimal(tally.largest_impact_kmh),
        *(str(tally.total(column)) for column in _COUNTS),
        _decimal(tally.delay_s),
    ]


def pooled(runs: Sequence[Run], controllers: Iterable[str], network: str | None = None) -> str:
    """Return a table with one row per controller, for one network or for all."""
    return table(HEADS, [cells(name, of(runs, name, network)) for name in controllers])


def bars_table(bars: Sequence[Bar]) -> str:
    """Return a table of the bars with what was measured."""
    return table(("bar", "measured", "verdict"), [(bar.what, bar.measured, bar.verdict) for bar in bars])


def contact_cells(run: Run, contact: Contact) -> list[str]:
    """Return a contact as a row with the columns `CONTACTS` and `CLASSES`."""
    return [
        *(run.network, run.controller, str(run.seed), contact.ego, contact.person),
        *(_decimal(contact.time_s), _decimal(contact.impact_kmh), "yes" if contact.preventable else "no"),
        *(contact.place, contact.moved_by, contact.kind),
    ]


def write(folder: Path, runs: Sequence[Run]) -> None:
    """Write ``networks.csv``, ``contacts.csv`` and ``failures.csv``, including failed runs."""
    pairs = dict.fromkeys((run.network, run.controller) for run in runs)
    write_csv(
        folder / "networks.csv",
        ("network", *HEADS),
        ([network, *cells(controller, of(runs, controller, network))] for network, controller in pairs),
    )
    write_csv(
        folder / "contacts.csv",
        (*CONTACTS, *CLASSES, "command"),
        ([*contact_cells(run, one), run.command] for run in runs for one in run.contacts),
    )
    write_csv(
        folder / "failures.csv",
        ("network", "controller", "seed", "reason", "command"),
        ([run.network, run.controller, str(run.seed), run.reason, run.command] for run in runs if run.reason),
    )


_COUNTS = (
    "n_contacts_standing",
    "n_vehicle_overlaps_ego_closed",
    "n_interventions",
    "n_stopped_on_crossing",
    "n_stopped_on_crossing_foreseeable",
    "deadlock",
)


def _with_classes(tally: Tally) -> str:
    said = ", ".join(f"{count} {kind}" for kind, count in sorted(tally.classes.items()))
    return f"{len(tally.contacts)} ({said})" if said else str(len(tally.contacts))


def _decimal(value: float | None) -> str:
    return "" if value is None else f"{value:.1f}"
