"""Cases on how neighbours react to an ego that straddles two lanes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from cosim.conformance.case import Case, Values
from cosim.conformance.ride import ride
from cosim.conformance.stage import pose_of, scene, wait_for
from cosim.conformance.track import Shift, Track
from cosim.sumo.lane_shape import LaneShape
from cosim.sumo.placement import DITHER, Method, Placement

STEP = 0.1


@dataclass(frozen=True, slots=True)
class Meeting:
    """An ego and a faster neighbour that comes from behind and does not change lanes."""

    net: str = "straight"
    ego_lane: int = 1
    ego_position: float = 150.0
    ego_speed: float = 10.0
    shifts: tuple[Shift, ...] = ()
    brakes_at: float = math.inf
    neighbour_lane: int = 2
    behind: float = 60.0
    neighbour_speed: float = 15.0
    neighbour_width: float = 2.0
    duration: float = 25.0
    sublane: bool = True
    moved_steps: tuple[int, int] = (0, 0)
    """First step (included) and last step (excluded) between which hybrid is kept from driving natively."""
    dither: float = DITHER


class Hesitant(Placement):
    """The hybrid method, made to move the ego in some steps in which it could drive it natively."""

    def __init__(self, sumo: Any, meeting: Meeting) -> None:
        super().__init__(sumo, STEP, Method.HYBRID, meeting.dither)
        self._moved_steps = meeting.moved_steps
        self._count = 0

    def _native(self, name: str, ego: Any, here: LaneShape, aim: tuple[float, float], speed: float) -> bool:
        self._count += 1
        first, last = self._moved_steps
        return not first <= self._count < last and super()._native(name, ego, here, aim, speed)


def _meet(meeting: Meeting, method: Method) -> Values:
    traffic = f"""
        <vType id="fast" length="4.5" width="{meeting.neighbour_width}" minGap="2.5" sigma="0"
               speedFactor="1" maxSpeed="{meeting.neighbour_speed}"/>
        <route id="r" edges="ab bc"/>
        <vehicle id="ego" type="ego" route="r" depart="0" departLane="{meeting.ego_lane}"
                 departPos="{meeting.ego_position}" departSpeed="{meeting.ego_speed}"/>
        <vehicle id="neighbour" type="fast" route="r" depart="0" departLane="{meeting.neighbour_lane}"
                 departPos="{meeting.ego_position - meeting.behind}"
                 departSpeed="{meeting.neighbour_speed}"/>"""
    with scene(meeting.net, traffic, step=STEP, sublane=meeting.sublane) as sumo:
        wait_for(sumo, "ego")
        wait_for(sumo, "neighbour")
        sumo.vehicle.setLaneChangeMode("neighbour", 0)
        begin = pose_of(sumo, "ego")
        track = Track(begin.x, begin.y, begin.speed, meeting.shifts, meeting.brakes_at)
        driver = Hesitant(sumo, meeting) if method is Method.HYBRID else Placement(sumo, STEP, method)
        seen = ride(sumo, driver, track.at, meeting.duration, ["neighbour"])
    return {
        "clearance_m": seen.clearance,
        "overlap_steps": seen.overlaps,
        "reported_by_sumo": seen.reported,
        "neighbour_slowest_mps": seen.slowest["neighbour"],
        "error_m": seen.error,
    }


def _clear(least: float) -> Any:
    return lambda values: values["overlap_steps"] == 0 and values["clearance_m"] >= least


def _unseen(values: Values) -> bool:
    return float(values["overlap_steps"]) > 0 and values["reported_by_sumo"] == 0


def _overlapped(values: Values) -> bool:
    return float(values["overlap_steps"]) > 0


def _claim(meeting: Meeting) -> Any:
    return lambda: _meet(meeting, Method.HYBRID)


def _moved(meeting: Meeting) -> Any:
    return lambda: _meet(meeting, Method.MOVE)


STRADDLE = Meeting(net="narrow", shifts=(Shift(1.0, 3.0, 1.45),), neighbour_width=1.8)
HOLD = Meeting(shifts=(Shift(1.0, 3.0, 1.7),))
OLD_LANE = Meeting(shifts=(Shift(1.0, 3.0, 1.85),), neighbour_lane=1)
STANDING = Meeting(shifts=(Shift(1.0, 3.0, 1.7),), ego_speed=8.0, brakes_at=5.0, behind=80.0)
BOUNDARY = Meeting(
    net="joined", ego_position=200.0, shifts=(Shift(1.0, 3.0, 1.7),), behind=45.0, duration=30.0
)
BEGUN_MOVED = Meeting(shifts=(Shift(1.0, 3.0, 1.7),), moved_steps=(1, 60))
ENDED_MOVED = Meeting(
    shifts=(Shift(1.0, 3.0, 1.7), Shift(5.0, 3.0, -1.7)), moved_steps=(50, 90), behind=100.0, duration=35.0
)
MERGER = Meeting(
    net="merge",
    ego_lane=1,
    ego_position=200.0,
    ego_speed=8.0,
    shifts=(Shift(1.0, 3.0, -1.5), Shift(12.0, 3.0, -1.7)),
    neighbour_lane=0,
    behind=40.0,
    neighbour_speed=13.5,
)
JUNCTION = Meeting(
    net="long_junction",
    ego_position=250.0,
    ego_speed=5.0,
    shifts=(Shift(4.3, 2.0, 1.7),),
    behind=55.0,
    neighbour_speed=10.0,
    duration=15.0,
)


def _without_dither(meeting: Meeting) -> Any:
    return lambda: _meet(replace(meeting, dither=0.0), Method.HYBRID)


def _without_sublane() -> Values:
    return _meet(replace(OLD_LANE, sublane=False), Method.MOVE)


def _on_a_normal_lane() -> Values:
    return _meet(replace(JUNCTION, net="straight"), Method.HYBRID)


CASES = (
    Case(
        key="straddle",
        name="A neighbour from behind brakes for a hybrid ego 1.45 m off its lane's centre",
        shows="a moved ego is seen in one lane only, with or without the sublane model (#7496)",
        claim=_claim(STRADDLE),
        control=_moved(STRADDLE),
        expected="no overlap",
        control_expected="move: the bodies overlap and SUMO reports no collision",
        holds=_clear(0.0),
        control_fails=_unseen,
    ),
    Case(
        key="hold",
        name="A neighbour stays behind a hybrid ego that holds 1.7 m off centre",
        shows="the same on 3.5 m lanes with a 2 m wide neighbour, for as long as it lasts",
        claim=_claim(HOLD),
        control=_moved(HOLD),
        expected="no overlap, clearance > 5 m",
        control_expected="move: the bodies overlap and SUMO reports no collision",
        holds=_clear(5.0),
        control_fails=_unseen,
    ),
    Case(
        key="old_lane",
        name="The follower in the old lane waits until the ego has left it entirely",
        shows="the part of the body still in the old lane is seen",
        claim=_claim(OLD_LANE),
        control=_without_sublane,
        expected="clearance > 10 m",
        control_expected="move without the sublane model: the bodies overlap",
        holds=_clear(10.0),
        control_fails=_unseen,
    ),
    Case(
        key="standing",
        name="A neighbour stops behind an ego that stands between two lanes",
        shows="the same at standstill",
        claim=_claim(STANDING),
        control=_moved(STANDING),
        expected="clearance >= 2 m",
        control_expected="move: the bodies overlap",
        holds=_clear(2.0),
        control_fails=_overlapped,
    ),
    Case(
        key="dither",
        name="A straddle that began with moves is seen from the first native step on",
        shows="2 mm of lateral shift after a move registers the ego in its second lane",
        claim=_claim(BEGUN_MOVED),
        control=_without_dither(BEGUN_MOVED),
        expected="no overlap, clearance > 5 m",
        control_expected="without the dither: the bodies overlap",
        holds=_clear(5.0),
        control_fails=_unseen,
    ),
    Case(
        key="phantom",
        name="No vehicle brakes for the place where the ego was",
        shows="2 mm of lateral shift after a move also removes it from the lane that it has left",
        claim=_claim(ENDED_MOVED),
        control=_without_dither(ENDED_MOVED),
        expected="the neighbour keeps its 15 m/s beside an ego back in its lane",
        control_expected="without the dither: it brakes below 10 m/s",
        holds=lambda values: float(values["neighbour_slowest_mps"]) > 14.5,
        control_fails=lambda values: float(values["neighbour_slowest_mps"]) < 10.0,
    ),
    Case(
        key="boundary",
        name="A straddling ego is seen across an edge boundary",
        shows="the move over the boundary keeps the ego visible",
        claim=_claim(BOUNDARY),
        control=_moved(BOUNDARY),
        expected="clearance > 10 m",
        control_expected="move: the neighbour comes closer than 5 m or overlaps",
        holds=_clear(10.0),
        control_fails=lambda values: float(values["clearance_m"]) < 5.0,
    ),
    Case(
        key="merger",
        name="A neighbour in the continuing lane makes room for an ego that merges slowly",
        shows="two lanes become one: the usual place for a long straddle",
        claim=_claim(MERGER),
        control=_moved(MERGER),
        expected="no overlap",
        control_expected="move: the bodies overlap",
        holds=_clear(0.0),
        control_fails=_overlapped,
    ),
    Case(
        key="junction_straddle",
        name="A straddle that begins inside a junction is seen there",
        shows="it is not: inside junctions the ego is moved, and nothing registers it in the second lane",
        claim=_claim(JUNCTION),
        control=_on_a_normal_lane,
        expected="no overlap",
        control_expected="(reversed) the same meeting on a normal lane: no overlap",
        holds=_clear(0.0),
        control_fails=_clear(0.0),
        expected_failure=True,
    ),
)
