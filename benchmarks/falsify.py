"""How soon a search finds planted faults, how often intervals of an estimate hold, and what a search costs.

``python benchmarks/falsify.py faults | toy | sumo FOLDER | estimate | extremes | time | agreement FOLDER``
prints a table each; ``toy 0.005`` only the rows of that volume, ``sumo FOLDER 200`` with so many runs,
``estimate 100 7`` with 100 repeats from seed 7, ``time 40 1`` with one search of 40 trials.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from measuring import planted_driver
from measuring.one_pedestrian import DISTRIBUTED, SPACE
from measuring.planted import AXES, TOY_AXES, Faults, toy_boxes, toy_hit, toy_margin
from scipy.stats import norm

from analysis.markdown import table_of
from analysis.search.axes import Axis, Point
from analysis.search.extremes import extrapolated
from analysis.search.objective import squashed
from analysis.search.probability import estimate
from cosim.search.proposals import GENERATION, propose

BUDGET = 500
REPEATS = 30
FAULTS = 3
Row = dict[str, Any]


def search(
    method: str, axes: Sequence[Axis], margin: Callable[[Point], float], seed: int, stop: bool
) -> list[tuple[Point, float]]:
    """Return the trials of a search, up to the generation with the first failure if wanted."""
    proposer = propose(method, axes, seed, BUDGET)
    tried: list[tuple[Point, float]] = []
    while len(tried) < BUDGET:
        points = proposer.ask(GENERATION)
        margins = [margin(one) for one in points]
        proposer.tell(points, margins)
        tried += zip(points, margins, strict=True)
        if stop and min(margins) < 0.0:
            break
    return tried


def first(tried: Sequence[tuple[Point, float]]) -> int:
    """Return the number of the first failing trial, one more than the budget without any."""
    return next((number for number, (_, margin) in enumerate(tried, 1) if margin < 0.0), BUDGET + 1)


def faults() -> None:
    """Print how soon planted faults are found on functions."""
    rows: list[Row] = []
    for slope, volumes in ((True, (0.02, 0.005, 0.001)), (False, (0.001,))):
        for volume in volumes:
            for method in ("cma-es", "tpe", "nsga-ii", "sobol", "random"):
                repeats = 5 if method == "tpe" else REPEATS
                firsts, distinct = [], []
                for seed in range(repeats):
                    planted = Faults(volume, FAULTS, seed, slope)
                    tried = search(method, AXES, planted.margin, seed, stop=False)
                    firsts.append(first(tried))
                    distinct.append(len({planted.hit(point) for point, _ in tried} - {None}))
                rows.append(_found(volume, "" if slope else ", no slope", method, firsts, distinct))
    print(table_of(rows))


def toy(volumes: Sequence[float] = (0.02, 0.005, 0.001)) -> None:
    """Print how soon a controller's planted faults are found on the toy road."""
    rows: list[Row] = []
    for volume, misleading in [*((one, False) for one in volumes), (0.005, True)]:
        for method in ("cma-es", "nsga-ii", "random"):
            firsts, distinct = [], []
            for seed in range(REPEATS):
                boxes, half = toy_boxes(volume, FAULTS, 10_000 + seed)  # not the numbers that a search draws
                tried = search(method, TOY_AXES, toy_margin(boxes, half, misleading), seed, stop=False)
                firsts.append(first(tried))
                distinct.append(len({toy_hit(boxes, half, point) for point, _ in tried} - {None}))
            rows.append(_found(volume, ", misleading" if misleading else "", method, firsts, distinct))
            print(rows[-1], file=sys.stderr, flush=True)
    print(table_of(rows))


def sumo(folder: Path, budget: int = BUDGET) -> None:
    """Print how soon the planted faults of a real controller are found in SUMO.

    Parameters
    ----------
    folder
        Kept, so that what was interrupted goes on.
    budget
        Runs of a search.
    """
    folder.mkdir(parents=True, exist_ok=True)
    rows = [planted_in_sumo(folder / f"{volume:g}", volume, budget) for volume in (0.02, 0.005, 0.001)]
    print(table_of(rows))


def planted_in_sumo(folder: Path, volume: float, budget: int) -> Row:
    """Return what a search for the planted faults of a real controller finds.

    Parameters
    ----------
    folder
        Of the search; new, or of the same.
    volume
        Of all boxes, as a share of the space.
    budget
    """
    from cosim.search.search import FalsifyRequest, prepared, silent

    folder.mkdir(parents=True, exist_ok=True)
    files = {"space.toml": planted_driver.SPACE, "criteria.toml": planted_driver.CRITERIA}
    for name, text in files.items():
        (folder / name).write_text(text)
    request = FalsifyRequest(
        "jaywalk_arterial",
        planted_driver.__file__,
        budget,
        settings={"vehicles_per_hour": "0", "volume": f"{volume:g}"},
        space=folder / "space.toml",
        criteria=folder / "criteria.toml",
        out=folder / "search",
        shrink=False,
    )
    tried = prepared(request).run(silent()).tried
    failed = [one for one in tried if one.status == "fail"]
    planted = planted_driver.boxes(volume, 1)
    far = [planted_driver.outside(planted, one.point) for one in failed]
    return {
        "together [%]": f"{100 * volume:g}",
        "runs": len(tried),
        "first failure in run": next((one.number for one in failed), "–"),
        "failures": len(failed),
        "of these outside the boxes": sum(min(one) > planted_driver.MEASURED for one in far),
        f"faults found of {planted_driver.COUNT}": len({one.index(min(one)) for one in far}),
    }


_FAULTS_FOUND = f"faults found of {FAULTS}, mean"


def _found(volume: float, told: str, method: str, firsts: Sequence[int], distinct: Sequence[int]) -> Row:
    return {
        "volume [%]": f"{100 * volume:g}{told}",
        "method": method,
        "repeats": len(firsts),
        "found within 500 [%]": round(100 * sum(one <= BUDGET for one in firsts) / len(firsts)),
        "median runs to the first": "> 500" if median(firsts) > BUDGET else median(firsts),
        _FAULTS_FOUND: round(sum(distinct) / len(firsts), 2),
    }


def estimates(repeats: int = 400, seed: int = 50_000_000) -> None:
    """Print how often the 95 % interval holds a known probability, and with how many runs.

    Parameters
    ----------
    repeats
        Of each limit state; multiples of 100.
    seed
        Of the first one.
    """
    rows: list[Row] = []
    for method in ("importance", "subset"):
        for shape in ("one region", "two regions"):
            for probability in (1e-3, 1e-4, 1e-5, 1e-6):
                limit = _limit(shape, probability)
                found = [
                    estimate(method, limit, 6, variation=0.3, most=40000, seed=seed + 1000 * number)
                    for number in range(repeats)
                ]
                held = [one.low <= probability <= one.high for one in found]
                hundreds = [sum(held[begin : begin + 100]) for begin in range(0, repeats, 100)]
                runs = sum(one.runs for one in found) / len(found)
                crude = 1.0 / (probability * 0.3**2)
                rows.append(
                    {
                        "limit state": shape,
                        "probability": f"{probability:g}",
                        "method": method,
                        "intervals that hold it [%]": f"{100 * sum(held) / repeats:.3g}",
                        "fewest of 100": min(hundreds),
                        "runs, mean": round(runs),
                        "crude runs per run": f"{crude / runs:.3g}",
                    }
                )
                print(rows[-1], file=sys.stderr, flush=True)
    print(table_of(rows))


def extremes(draws: int = 1000) -> None:
    """Print how often the cross-check by extreme values holds a known probability."""
    rows: list[Row] = []
    for shape in ("one region", "two regions"):
        for probability in (1e-2, 1e-3, 1e-4):
            limit = _limit(shape, probability)
            found = []
            for seed in range(100):
                inputs = np.random.default_rng(seed).standard_normal((draws, 6))
                found.append(extrapolated([squashed(one) for one in limit(inputs).tolist()], seed))
            known = [one for one in found if one is not None]
            rows.append(
                {
                    "limit state": shape,
                    "probability": f"{probability:g}",
                    "runs": draws,
                    "intervals that hold it, of 100": sum(
                        one.low <= probability <= one.high for one in known
                    ),
                    "median": f"{median(one.probability for one in known):.2g}",
                }
            )
    print(table_of(rows))


def _limit(shape: str, probability: float) -> Callable[[Any], Any]:
    if shape == "one region":
        far = -norm.ppf(probability)
        return lambda inputs: far - inputs.sum(axis=1) / np.sqrt(inputs.shape[1])
    far = -norm.ppf(0.5 * probability)
    return lambda inputs: far - np.abs(inputs[:, 0])


def time_of_search(budget: int = 200, rounds: int = 3) -> None:
    """Print the wall time of a search, one run at a time, against that of its runs in turn in one process.

    Parameters
    ----------
    budget
        Trials of a search.
    rounds
        Of both in turn, so that what else the machine does falls on both.
    """
    from cosim.running.execution import execute
    from cosim.running.request import RunRequest
    from cosim.search.search import FalsifyRequest, prepared, silent

    rows: list[Row] = []
    for number in range(1, rounds + 1):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "space.toml").write_text(SPACE)
            request = FalsifyRequest(
                "jaywalk_arterial",
                "aeb",
                budget,
                settings={"vehicles_per_hour": "100"},
                space=folder / "space.toml",
                out=folder / "search",
                jobs=1,
                shrink=False,
            )
            started = perf_counter()
            prepared(request).run(silent())
            search_s = perf_counter() - started
            started = perf_counter()
            for scenario in sorted((folder / "search/trials/scenarios").iterdir()):
                execute(RunRequest(str(scenario), "aeb", seed=1, out=folder / scenario.stem))
            in_turn_s = perf_counter() - started
        rows.append(
            {
                "round": number,
                "search [s]": round(search_s, 1),
                "its runs in turn [s]": round(in_turn_s, 1),
                "ratio": round(search_s / in_turn_s, 3),
            }
        )
        print(rows[-1], file=sys.stderr, flush=True)
    print(table_of(rows))
    print(f"median ratio: {median(float(row['ratio']) for row in rows):.2f}")


def agreement(folder: Path, runs: int = 5000) -> None:
    """Print a probability near 1 % in SUMO by thousands of crude runs and by importance sampling.

    Parameters
    ----------
    folder
        Kept, so that what was interrupted goes on.
    runs
        Of crude sampling.
    """
    from cosim.search.estimate import EstimateRequest, prepared_estimate, run_estimate
    from cosim.search.search import silent

    folder.mkdir(parents=True, exist_ok=True)
    space = folder / "space.toml"
    space.write_text(DISTRIBUTED)
    rows: list[Row] = []
    for method, variation, most in (("importance", 0.2, runs), ("crude", 0.001, runs)):
        request = EstimateRequest(
            "jaywalk_arterial",
            "aeb",
            method=method,
            variation=variation,
            budget=most,
            settings={"vehicles_per_hour": "100"},
            space=space,
            out=folder / method,
        )
        found = run_estimate(request, *prepared_estimate(request), silent())
        one = found.probability
        rows.append(
            {
                "method": method,
                "runs": one.runs,
                "of these with a contact": one.events,
                "probability [%]": f"{100 * one.estimate:.3g}",
                "95 % interval [%]": f"{100 * one.low:.3g} to {100 * one.high:.3g}",
                "failed runs": found.invalid,
            }
        )
    print(table_of(rows))


WITH_FOLDER = {"agreement": agreement, "sumo": sumo}
ALONE = {"faults": faults, "estimate": estimates, "extremes": extremes, "time": time_of_search}


def main() -> None:
    """Print the table that is asked for."""
    name, *rest = sys.argv[1:]
    if name in WITH_FOLDER:
        WITH_FOLDER[name](Path(rest[0]), *map(int, rest[1:]))
    elif name == "toy":
        toy(*([[float(one) for one in rest]] if rest else []))
    else:
        ALONE[name](*map(int, rest))


if __name__ == "__main__":
    main()
