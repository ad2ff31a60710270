"""What kind of contact it was: where, who moved into whom, and what class of contact.

By geometry and recorded motion alone (contact_classes.py and contact_places.py in analysis/encounters); the
total of collisions keeps all of them. The place is that of the pedestrian's middle. contact_moved_by says
whose motion closed the last gap: a party that closed less than a tenth of the gap did not move into the
other; somebody who walks into the side of a moving car moved into it, though the class is ego. The classes:

- touching_at_start: they touch in the first sample that holds both;
- walked_in: the ego had stood for 0.5 s, and did not move while they touched (never a collision);
- rolled_off: the ego had stood for 0.5 s, and then began to move while they touched;
- appeared: the careful driver of preventable_r157 does not prevent it, and the first sample that holds both
  has the pedestrian in view and nearer than that driver's stopping distance;
- ego: any other.

contact_risk_seen_s is the time from when the careful driver could see the risk to the contact. As for
preventable_r157 the first collision counts, without one the first contact with the standing ego; runs.csv
counts every collision.

Undefined: empty without a contact; contact_moved_by also where they touch at the first sample,
contact_risk_seen_s where the risk could not be seen before.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.case import Case, Values
from analysis.encounters.contact_classes import CLASSES, MOVERS, Circumstances, contact_class, moved_by
from analysis.encounters.contact_places import PLACES, Places, place_of, places_of
from analysis.encounters.contacts import Contact
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "neither"
SOURCE = "own definition"
_KINDS = ("contact_place", "contact_moved_by", "contact_class")
COLUMNS = (
    column.text("contact_place", "where the pedestrian was touched; empty without a contact", *PLACES),
    column.text(
        "contact_moved_by",
        "whose motion closed the last gap; empty without a contact, or without a gap before it",
        *MOVERS,
    ),
    column.text("contact_class", "kind of contact; empty without one", *CLASSES),
    column.at_least_0(
        "contact_risk_seen_s",
        "s",
        "time from when a careful driver could see the risk to the contact; empty where they could not",
    ),
)
COUNTED = {
    **{f"n_collisions_{place}": ("contact_place", place) for place in PLACES},
    **{f"n_collisions_moved_by_{mover}": ("contact_moved_by", mover) for mover in MOVERS},
    **{f"n_collisions_class_{name}": ("contact_class", name) for name in CLASSES if name != "walked_in"},
}
"""Column of runs.csv -> column of encounters.csv, and the text there of the contacts that it counts."""
_TEXTS = {
    "n_collisions_crossing": "those on a crossing",
    "n_collisions_carriageway": "those on the carriageway",
    "n_collisions_walking_area_or_kerb": "those on a walking area or at the kerb",
    "n_collisions_moved_by_ego": "those in which the ego closed the last gap",
    "n_collisions_moved_by_pedestrian": "those in which the pedestrian closed it",
    "n_collisions_moved_by_both": "those in which both closed it",
    "n_collisions_class_ego": "collisions of no other class",
    "n_collisions_class_rolled_off": "those in which the ego began to move while a pedestrian touched it",
    "n_collisions_class_appeared": (
        "those with a pedestrian who appeared in view inside the stopping distance"
    ),
    "n_collisions_class_touching_at_start": "those there from the first sample on",
}
RUN_COLUMNS = tuple(column.count(name, _TEXTS[name], required=True, worse="higher") for name in COUNTED)


def compute(case: Case) -> Values:
    """Return place, mover, class and time of each encounter's contact."""
    found: dict[str, list[str | None]] = {name: [None] * len(case) for name in _KINDS}
    seen = np.full(len(case), np.nan)
    areas = places_of(case.run)
    for i, contact in enumerate(case.first_contact()):
        if contact is None:
            continue
        for name, value in zip(_KINDS, _kind(case, contact, areas), strict=True):
            found[name][i] = value
        seen[i] = contact.time - case.replays[contact].onset
    return {**found, "contact_risk_seen_s": seen}


def _kind(case: Case, contact: Contact, areas: Places) -> tuple[str, str | None, str]:
    encounter = case.encounters[contact.encounter]
    one = Circumstances(
        encounter.ego, encounter.person, contact, case.replays[contact], case.grid, case.thresholds
    )
    return (
        place_of(encounter.person, contact.time, case.run, case.grid, areas),
        moved_by(one),
        contact_class(one, case.bodies),
    )


def collect_encounters(case: Case) -> Values:
    """Return place, mover and class of every collision."""
    areas = places_of(case.run)
    return {"kinds": [_kind(case, contact, areas) for contact in case.collisions()]}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Count the collisions of each kind."""
    found = [dict(zip(_KINDS, kind, strict=True)) for kind in columns["kinds"]]
    return {name: sum(one[told_by] == text for one in found) for name, (told_by, text) in COUNTED.items()}
