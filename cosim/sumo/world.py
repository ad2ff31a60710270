"""SUMO as a world that egos drive in."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from controllers.interface import Command, Drive, Perception
from cosim.arrays import FloatArray
from cosim.errors import InputError, SimulationError
from cosim.sensing.interface import Sensing
from cosim.sensing.models.perfect import Model as Perfect
from cosim.step.frames import heading_of
from cosim.step.plant import CAR_DRIVE
from cosim.step.world import MapArea, Mishaps, Snapshot, Traffic
from cosim.sumo.changed_limits import ChangedLimits
from cosim.sumo.connection import start
from cosim.sumo.driven_ego import DrivenEgo, is_on_lane, let_go
from cosim.sumo.egos import EgoSources
from cosim.sumo.everybody import Everybody
from cosim.sumo.intervention import cause_of
from cosim.sumo.knowledge import Knowledge
from cosim.sumo.levels import Levels
from cosim.sumo.lights import Lights
from cosim.sumo.map_areas import CELL, areas_near, cells_of_crossings
from cosim.sumo.network import Network
from cosim.sumo.network_file import read_network
from cosim.sumo.placement import Method, Placement
from cosim.sumo.present import Departed, Departures, Present, everybody_present
from cosim.sumo.recorded_vehicles import RecordedVehicles
from cosim.sumo.road_users import KnownState
from cosim.sumo.scripted_persons import ScriptedPersons, road_user
from cosim.sumo.sensing import Perceiver
from cosim.sumo.stranded import Stranded
from cosim.sumo.surroundings import Observer, Surroundings
from cosim.sumo.takeover import Takeover, seen
from cosim.sumo.truth import persons_truth, vehicles_truth, with_signals
from cosim.sumo.window import Window
from sumo_scenarios.model import Scenario
from sumo_scenarios.preparation import Prepared
from sumo_scenarios.recorded_vehicles import read_recorded_vehicles, vehicles_file

PLAN_INTERVAL = 0.1
"""Shortest time between two plans of a controller [s]."""


class SumoWorld:
    """A SUMO simulation with egos in it.

    Parameters
    ----------
    scenario, prepared : the scenario to run
    seed : seed by which a share of egos is drawn; SUMO's own seed is among the prepared options
    drive : actuators of every ego
    gui : whether to show SUMO's window
    sensing : how egos get to know of pedestrians; by default they know the truth
    everybody : whether all road users near crossings are observed, so that no ego is needed

    Raises
    ------
    InputError
        If SUMO cannot start, or an ego's route, type or sensing is not possible.
    """

    def __init__(
        self,
        scenario: Scenario,
        prepared: Prepared,
        seed: int,
        drive: Drive = CAR_DRIVE,
        gui: bool = False,
        sensing: Sensing | None = None,
        everybody: bool = False,
    ) -> None:
        self._network = read_network(prepared.net_file)
        self._begin = prepared.begin_s
        self._first = prepared.begin_s + scenario.warmup_s
        self._end = prepared.begin_s + scenario.duration_s
        self._sources = EgoSources(scenario.egos, self._network, seed, self._first, not everybody)
        self._scripted = ScriptedPersons(scenario.pedestrians, self._network, seed, self._first, self._end)
        recorded = vehicles_file(scenario)
        self._recorded = RecordedVehicles(
            {} if recorded is None else read_recorded_vehicles(recorded), self._first
        )
        self._takeover = Takeover(self._network, drive)
        self._egos: dict[str, DrivenEgo] = {}
        self._visited: set[tuple[int, int]] = set()
        self._teleports = 0
        self._others_teleported = 0
        self._off_the_way = 0
        self._tight_bends: dict[str, float] = {}
        self._not_taken: list[str] = []
        self._to_take: list[str] = []
        """Vehicles that were chosen as egos but are not on a lane yet."""
        self._present = Present()
        self._departed = Departed()
        self._traffic: Traffic | None = None
        self._any_ego = False
        self._warm = False
        self._connection = start(prepared.options, gui)
        try:
            self._sumo = self._connection.sumo
            with self._connection.reporting("starting"):
                self.step: float = self._sumo.simulation.getDeltaT()
                self._time: float = self._sumo.simulation.getTime()
                if self._time > self._begin + self.step:
                    raise InputError(
                        f"the state of load-state is of {self._time:g} s; expected that time as begin, "
                        f"got {self._begin:g} s"
                    )
                self._sources.check(self._sumo, prepared.demand)
                self._calibrated = self._sumo.calibrator.getIDCount() > 0
                self._limits = ChangedLimits(self._sumo, self._network)
                self._departures = Departures(self._sumo)
            self._plan_every = max(1, math.ceil(PLAN_INTERVAL / self.step - 1e-9))
            self._steps = 0
            self._placement = Placement(self._sumo, self.step, Method(scenario.actuation))
            self._stranded = Stranded(self._sumo, self._network, self._placement, self._takeover)
            self._levels = Levels(self._network)
            self._observer = Observer(self._sumo, self._network, self.step)
            self._everybody = Everybody(self._sumo, self._network, self.step) if everybody else None
            self._scripted.join(self._sumo, self.step)
            self._knowledge = self._known_by(sensing or Perfect(), seed)
            self._perceiver = Perceiver(
                self._sumo,
                self._network,
                self._plan_every * self.step,
                self._knowledge.eyesight,
                self._limits,
            )
            self._surroundings: Surroundings = self._observer.read((), {}, Present())
        except BaseException:
            self._connection.close()
            raise

    # The world's protocol -----------------------------------------------------------------------------

    def sense(self) -> Sequence[Perception] | None:
        """Return one perception for each ego that has to plan now; ``None`` when the run is over."""
        if not self._warm:
            self._warm_up()
        if self._over():
            self._sources.check_seen(self._any_ego, self._time)
            return None
        self._knowledge.begin()
        if self._steps % self._plan_every:
            return ()
        with self._connection.reporting(f"sensing at {self._time:.2f} s"):
            egos = [ego for ego in self._egos.values() if not ego.given_up]
            met = self._levels.met(self._surroundings, egos)
            known = self._knowledge.believed({ego.name: ego.plant for ego in egos}, self._time, met)
            return self._perceiver.perceive(egos, self._time, known)

    def act(self, name: str, command: Command) -> None:
        """Set what the ego tries to do from now on."""
        ego = self._egos[name]
        ego.command, ego.elapsed = command, 0.0
        if ego.given_up or command.hand_back == ego.handed_back:
            return
        with self._connection.reporting(f"changing the driver of {name} at {self._time:.2f} s"):
            if command.hand_back:
                self._placement.release(name)
            else:
                self._scripted.forget_vehicle(name)
                self._placement.take_over(name)
        ego.handed_back = command.hand_back

    def advance(self) -> None:
        """Move everything by one step."""
        with self._connection.reporting(f"stepping from {self._time:.2f} s"):
            self._sources.insert(self._sumo, self._time)
            self._walk()
            for ego in self._egos.values():
                if not ego.handed_back:
                    plant = ego.plant
                    plant.follow(ego.command, ego.elapsed, self.step)
                    ego.track.update(*plant.front)
                    lane = ego.track.lane_in_bend()
                    self._placement.drive(ego.name, *plant.front, plant.heading, plant.speed, lane)
                    self._connection.pending = True
                    self._stranded.look_where_put(ego)
                ego.elapsed += self.step
            self._step()
            self._drop_gone()
            for ego in self._egos.values():
                self._follow_up(ego)
            self._remove_arrived()
            self._take_over_departed()
            self._observe()
        self._steps += 1

    def snapshot(self) -> Snapshot:
        """Return the truth after the last step."""
        persons, cars = self._surroundings.persons, self._surroundings.cars
        others = [row for row, name in enumerate(cars.names) if name not in self._egos]
        return Snapshot(
            self._time,
            tuple(ego.truth(self.step, self._limits.now) for ego in self._egos.values()),
            with_signals(
                persons_truth(persons, np.arange(len(persons.names))),
                Lights(self._sumo),
                self._network.crossings,
            ),
            vehicles_truth(cars, np.array(others, dtype=np.int64)),
            self._teleports,
            self._knowledge.now,
            Mishaps(
                self._placement.routes_restored_of_all,
                self._off_the_way,
                tuple(self._stranded.given_up),
                tuple(self._not_taken),
                tuple(self._stranded.on_detours),
                self._others_teleported,
                dict(self._tight_bends),
            ),
            self._traffic,
        )

    def to_world(self, name: str, along: FloatArray, across: FloatArray) -> FloatArray:
        """Convert points of that ego's route frame, as last sensed, to world coordinates."""
        frame = self._egos[name].frame
        if frame is None:
            raise InputError(f'ego "{name}" has sensed nothing yet')
        return frame.to_world(along, across)

    def map_areas(self) -> Sequence[MapArea]:
        """Return lanes, crossings and walking areas near the places of egos, or of everybody observed."""
        seen = (
            self._visited if self._everybody is None else {*self._visited, *cells_of_crossings(self._network)}
        )
        return areas_near(self._network, seen, self._sumo.simulation.convertGeo, self._levels.crossed)

    def close(self) -> None:
        """End the simulation."""
        self._connection.close()

    @property
    def network(self) -> Network:
        """The network driven in."""
        return self._network

    def window(self) -> Window | None:
        """Return the display of egos and plans in SUMO's window; ``None`` without a window."""
        return Window(self._connection) if self._connection.with_window else None

    # Steps --------------------------------------------------------------------------------------------

    def _warm_up(self) -> None:
        """Let the demand fill the road before the first ego appears."""
        self._warm = True
        with self._connection.reporting("warming up"):
            while self._time < self._first - 1e-9:
                self._step()
                self._take_over_departed()
                if self._egos:
                    self._observe()
                    break

    def _walk(self) -> None:
        """Move scripted pedestrians to where they are after the step; they see the egos as before it."""
        if self._scripted.any:
            egos = [road_user(ego.name, ego.plant, ego.track) for ego in self._egos.values()]
            driven = [ego.name for ego in self._egos.values() if not ego.handed_back]
            driven += sorted(self._recorded.names)
            self._scripted.walk(self._time, egos, driven)

    def _step(self) -> None:
        self._recorded.move(self._sumo, self._time + self.step, self._remove)
        self._sumo.simulationStep()
        self._connection.pending = False
        self._time = self._sumo.simulation.getTime()
        self._present = everybody_present(self._sumo)
        self._departed = self._departures.read(self._present)
        self._limits.read()
        if self._everybody is not None:
            self._everybody.follow(self._departed)

    def _over(self) -> bool:
        if self._time >= self._end - 1e-9:
            return True
        if self._egos or self._sources.trips or self._to_take:
            return False
        ends = self._sources.ends and self._everybody is None
        # SUMO does not count vehicles that calibrators have yet to insert as expected.
        return ends or not (self._calibrated or self._sumo.simulation.getMinExpectedNumber())

    def _drop_gone(self) -> None:
        """Forget egos that SUMO has taken off the road because they arrived, teleported or were removed."""
        teleporting = set(self._sumo.simulation.getStartingTeleportIDList())
        self._others_teleported += len(teleporting - self._egos.keys())
        there = self._present.vehicles
        for name in [name for name in self._egos if name not in there or name in teleporting]:
            ego = self._egos[name]
            # An ego that SUMO drives may have passed its last edges and arrived in the same step.
            arrived = ego.handed_back or ego.track.on_last_edge
            if not ego.given_up and (name in teleporting or not arrived):
                self._teleports += 1
            if name in teleporting:
                self._remove(name)
            self._forget(name)

    def _forget(self, name: str) -> None:
        self._placement.forget(name)
        self._knowledge.forget(name)
        del self._egos[name]

    def _follow_up(self, ego: DrivenEgo) -> None:
        """Compare where SUMO has the ego after the step with the plant, and update its place on its route."""
        plant = ego.plant
        before = plant.front
        if ego.handed_back:
            ego.executed = seen(self._sumo, ego.name)
            speed = ego.executed.speed
            heading = heading_of(self._sumo.vehicle.getAngle(ego.name))
            before_speed = plant.speed
            plant.adopt(ego.executed.x, ego.executed.y, heading, speed, (speed - before_speed) / self.step)
            ego.travelled += speed * self.step
            ego.intervention = ""
        else:
            ego.executed = self._placement.executed(ego.name)
            bend = ego.track.bend(plant.body.front)
            ego.intervention = (
                cause_of(self._placement, ego.name, before, ego.executed, bend is not None) or ""
            )
            if bend is not None:
                self._tight_bends[bend.lane] = max(bend.off, self._tight_bends.get(bend.lane, 0.0))
            astray = self._placement.astray(ego.name)
            ego.astray_for = ego.astray_for + self.step if astray else 0.0
            self._off_the_way += self._placement.strayed(ego.name) > 0.0
            ego.travelled += plant.speed * self.step
        ego.front = plant.front if ego.handed_back else before
        if ego.handed_back:
            ego.track.update(*ego.front)
        if not ego.handed_back or ego.given_up:
            self._stranded.help_on(ego, self.step)
        self._visited.add((round(plant.x / CELL), round(plant.y / CELL)))

    def _remove_arrived(self) -> None:
        """Take egos off the road at the end of their routes, because a moved vehicle never arrives."""
        for name in [name for name, ego in self._egos.items() if ego.track.arrived]:
            self._remove(name)
            self._forget(name)

    def _remove(self, name: str) -> None:
        # A step fails if there is a subscription around a vehicle that has been removed.
        self._observer.leave(name)
        if self._everybody is not None:
            self._everybody.leave(name)
        self._sumo.vehicle.remove(name)
        self._present = self._present._replace(vehicles=self._present.vehicles - {name})
        self._connection.pending = True

    def _take_over_departed(self) -> None:
        there, departed = self._present.vehicles, self._departed.vehicles
        # In a long step, a vehicle may depart and leave again.
        chosen = [name for name in self._to_take if name in there]
        recorded = self._recorded.names  # they go where they went; nobody else can drive them
        if others := [name for name in departed if name not in recorded]:
            chosen += self._sources.choose(self._sumo, others, self._time)
        self._to_take = []
        for name in chosen:
            if is_on_lane(self._sumo, name):
                self._take_over(name)
            else:
                self._to_take.append(name)

    def _take_over(self, name: str) -> None:
        try:
            ego = self._takeover.ego_of(self._sumo, name)
        except InputError as error:
            if self._sources.is_of_share(name):
                self._not_taken.append(name)
                return
            raise SimulationError(f'vehicle "{name}" cannot be an ego: {error}') from error
        let_go(self._sumo, name)
        self._placement.take_over(name)
        self._observer.follow(name)
        self._egos[name] = ego
        self._any_ego = True

    def _observe(self) -> None:
        known = {
            ego.name: KnownState(*ego.front, ego.plant.heading, ego.plant.speed, ego.plant.acceleration)
            for ego in self._egos.values()
        }
        surroundings = self._observer.read(tuple(self._egos), known, self._present)
        if self._everybody is not None:
            self._traffic = self._everybody.read(known, self._present)
        places = {name: ego.front for name, ego in self._egos.items()}
        self._surroundings = self._scripted.among(surroundings, places, self._time)

    # Sensing ------------------------------------------------------------------------------------------

    def _known_by(self, sensing: Sensing, seed: int) -> Knowledge:
        try:
            return Knowledge(sensing, self._sumo, self._network, seed, self.step, self._plan_every)
        except ValueError as error:
            raise InputError(f"sensing: {error}") from error
