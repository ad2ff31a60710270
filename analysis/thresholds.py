"""Every threshold, radius and curve of an analysis, in one frozen object that is echoed in config.json."""

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
"""Below it a TTC is called low, and compared over many runs."""
LOW_PET_S = 1.5
TTC_EXPOSURE_LIMITS_S = (1.5, 3.0)
"""TET and TIT are taken below these."""
DRAC_LIMIT_MPS2 = 3.4


def in_name(limit: float) -> str:
    """Return a limit as it stands in the name of a column.

    >>> in_name(1.5)
    '1p5'
    """
    return f"{limit:.1f}".replace(".", "p")


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Settings of the analysis: the numbers of a report depend on them and on the recording."""

    encounter_range_m: float = 45.0
    """Both users are within this distance of their conflict area, or of each other."""
    visit_pairing_s: float = 60.0
    """Visits to one conflict area further apart in time are not one encounter."""
    traffic_pairing_s: float = 10.0
    """The same where everybody is judged, who are many."""
    substep_s: float = 0.05
    """Motion is resampled to at most this step before the exact check between samples."""
    ego_rear_overhang_m: float = 0.95
    """Rear bumper to rear axle: the axle does not slip, so that its path is the one interpolated."""
    longitudinal_angle_deg: float = 30.0
    """Directions closer than this (or to opposite directions) are a longitudinal conflict."""
    turning_angle_deg: float = 30.0
    """An ego that turns by more than this before or inside the conflict area is turning."""
    standing_speed_mps: float = 0.1
    """An ego at or below it stands: it is no hazard, and a touch is not a collision."""
    moving_speed_mps: float = 0.5
    """Clearance and k are taken only while the ego is faster."""
    close_pass_m: float = 0.5
    close_pass_speed_mps: float = 3.0
    """Who is passed faster than this nearer than that is passed too close."""
    pedestrian_standing_speed_mps: float = 0.3
    contact_separation_s: float = 2.0
    """Contacts of one pair closer in time are one collision."""
    severity_ttc_severe_s: float = 1.0
    severity_ttc_serious_s: float = 1.5
    severity_ttc_slight_s: float = 3.0
    severity_pet_severe_s: float = 1.0
    severity_pet_serious_s: float = 1.5
    severity_pet_slight_s: float = 3.0
    max_speed_ttc_s: float = 1.5
    """max_speed_mps is taken while TTC is at most this."""
    mdrac_reaction_s: float = 1.0
    evasive_deceleration_mps2: float = 1.0
    """The ego's evasive action begins where it brakes harder."""
    hard_brake_mps2: float = 4.0
    comfort_deceleration_mps2: float = 3.0
    jerk_window_s: float = 0.2
    yield_reaction_s: float = 1.0
    yield_deceleration_mps2: float = 3.05
    slack_m: float = 0.05
    lane_change_hold_s: float = 2.0
    """A lane change is completed when the new lane is kept for this long."""
    stopped_on_crossing_s: float = 1.0
    deadlock_s: float = 60.0
    deadlock_signal_s: float = 180.0
    """The same near a crossing with signals, where a red phase may last."""
    deadlock_free_gap_m: float = 15.0
    deadlock_signal_range_m: float = 40.0
    r157_reaction_s: float = 0.75
    r157_deceleration_mps2: float = 7.59
    r157_ramp_s: float = 0.6
    r157_wander_m: float = 0.375
    """A pedestrian nearer to the ego's corridor than this is a risk."""
    r157_foresight_s: float = 2.0
    """Pedestrians who would be there within this time are a risk, too."""
    r157_view_m: float = 100.0
    """The careful driver sees no further."""
    r157_eye_m: float = 2.0
    """Front bumper to the careful driver's eye."""
    r157_after_s: float = 5.0
    """The careful driver must not touch anybody until so long after the recorded contact."""
    ego_mass_kg: float = 1500.0
    pedestrian_mass_kg: float = 75.0
    hood_leading_edge_cm: float = 75.0
    free_walking_percentile: float = 95.0
    """A person's free speed is this percentile of their recorded speeds while walking."""

    def as_dict(self) -> dict[str, float]:
        """Return name -> value in the order of declaration."""
        return asdict(self)


def names() -> tuple[str, ...]:
    """Return the names that ``--set`` accepts."""
    return tuple(field.name for field in fields(Thresholds))


def with_settings(settings: Mapping[str, str]) -> Thresholds:
    """Return the thresholds of which some have other values than usual.

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
