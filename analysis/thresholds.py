"""All thresholds, radii and curves of an analysis, in one frozen object that is written to config.json."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields

from analysis.errors import ThresholdError

# Limits that are part of a column's name: fixed, whatever the thresholds below are set to.
TTC_LIMITS_S = (1.0, 1.5, 3.0)
PET_LIMITS_S = (1.0, 1.5, 3.0, 5.0)
LOW_TTC_S = 1.5
"""A TTC below this is called low, and is compared over many runs [s]."""
LOW_PET_S = 1.5
TTC_EXPOSURE_LIMITS_S = (1.5, 3.0)
"""TET and TIT are computed for TTCs below these limits [s]."""
DRAC_LIMIT_MPS2 = 3.4


def in_name(limit: float) -> str:
    """Return a limit as it is written in the name of a column.

    >>> in_name(1.5)
    '1p5'
    """
    return f"{limit:.1f}".replace(".", "p")


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Settings of the analysis; a report's numbers depend only on them and on the recording."""

    encounter_range_m: float = 45.0
    """In an encounter, both users are within this distance of their conflict area, or of each other [m]."""
    visit_pairing_s: float = 60.0
    """Two users' visits to a conflict area farther apart in time than this are no encounter [s]."""
    traffic_pairing_s: float = 10.0
    """The same limit if everybody is judged, because road users are then many [s]."""
    substep_s: float = 0.05
    """Motion is resampled to at most this step before the exact check between samples [s]."""
    ego_rear_overhang_m: float = 0.95
    """From rear bumper to rear axle, whose path is interpolated because the axle does not slip [m]."""
    longitudinal_angle_deg: float = 30.0
    """A conflict is longitudinal if directions are nearer than this to equal or opposite ones [deg]."""
    turning_angle_deg: float = 30.0
    """An ego counts as turning if it turns by more than this before or inside the conflict area [deg]."""
    standing_speed_mps: float = 0.1
    """At or below this speed, an ego stands: it is no hazard, and a touch is not a collision [m/s]."""
    moving_speed_mps: float = 0.5
    """Clearance and k are computed only while the ego is faster than this [m/s]."""
    close_pass_m: float = 0.5
    close_pass_speed_mps: float = 3.0
    """An ego passes too close if it is faster than this [m/s] and nearer than ``close_pass_m`` [m]."""
    pedestrian_standing_speed_mps: float = 0.3
    contact_separation_s: float = 2.0
    """Contacts of one pair closer in time than this are one collision [s]."""
    severity_ttc_severe_s: float = 1.0
    severity_ttc_serious_s: float = 1.5
    severity_ttc_slight_s: float = 3.0
    severity_pet_severe_s: float = 1.0
    severity_pet_serious_s: float = 1.5
    severity_pet_slight_s: float = 3.0
    max_speed_ttc_s: float = 1.5
    """max_speed_mps is computed while TTC is at most this [s]."""
    mdrac_reaction_s: float = 1.0
    evasive_deceleration_mps2: float = 1.0
    """The ego's evasive action begins when it brakes harder than this [m/s^2]."""
    hard_brake_mps2: float = 4.0
    comfort_deceleration_mps2: float = 3.0
    jerk_window_s: float = 0.2
    yield_reaction_s: float = 1.0
    yield_deceleration_mps2: float = 3.05
    slack_m: float = 0.05
    lane_change_hold_s: float = 2.0
    """A lane change is completed when the new lane is kept for this long [s]."""
    stopped_on_crossing_s: float = 1.0
    deadlock_s: float = 60.0
    deadlock_signal_s: float = 180.0
    """The same limit near a crossing with signals, where a red phase may be long [s]."""
    deadlock_free_gap_m: float = 15.0
    deadlock_signal_range_m: float = 40.0
    r157_reaction_s: float = 0.75
    r157_deceleration_mps2: float = 7.59
    r157_ramp_s: float = 0.6
    r157_wander_m: float = 0.375
    """Pedestrians nearer to the ego's corridor than this are a risk [m]."""
    r157_foresight_s: float = 2.0
    """Pedestrians who would be there within this time are a risk, too [s]."""
    r157_view_m: float = 100.0
    """The careful driver sees no farther than this [m]."""
    r157_eye_m: float = 2.0
    """Distance from the front bumper to the careful driver's eye [m]."""
    r157_after_s: float = 5.0
    """The careful driver must not touch anybody until this long after the recorded contact [s]."""
    ego_mass_kg: float = 1500.0
    pedestrian_mass_kg: float = 75.0
    hood_leading_edge_cm: float = 75.0
    free_walking_percentile: float = 95.0
    """A person's free speed is this percentile of their recorded speeds while walking."""

    def as_dict(self) -> dict[str, float]:
        """Return the values by name, in the order of declaration."""
        return asdict(self)


def names() -> tuple[str, ...]:
    """Return the names that ``--set`` accepts."""
    return tuple(field.name for field in fields(Thresholds))


def with_settings(settings: Mapping[str, str]) -> Thresholds:
    """Return the thresholds, some of them with other values than the defaults.

    Parameters
    ----------
    settings
        Texts of the numbers, by name.

    Raises
    ------
    ThresholdError
        For an unknown name, or a value that is not a non-negative finite number.

    Examples
    --------
    >>> with_settings({"severity_ttc_serious_s": "1.2"}).severity_ttc_serious_s
    1.2
    """
    changes: dict[str, float] = {}
    for name, value in settings.items():
        if name not in names():
            near = difflib.get_close_matches(name, names(), n=3) or list(names())
            raise ThresholdError(f"no threshold is called {name!r}; there are {', '.join(near)}")
        changes[name] = _number(name, value)
    changed = Thresholds(**changes)
    if changed.substep_s <= 0.0:
        raise ThresholdError("threshold substep_s must be above 0")
    return changed


def _number(name: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        raise ThresholdError(f"threshold {name}: expected a number, got {text!r}") from None
    if not math.isfinite(number) or number < 0.0:
        raise ThresholdError(f"threshold {name}: expected a finite number of at least 0, got {text!r}")
    return number
