"""``python -m studies.validation.page FOLDER PAGE``: the tables of docs/validation.md."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

from analysis.files import read_csv, read_json
from analysis.markdown import table, write_below

RESULTS = "## Results: one junction in Braunschweig"
ALL, CALIBRATION = "all", "calibration"


def markdown(folder: Path) -> str:
    """Return the text below the heading of the results."""
    rows = read_csv(folder / ALL / "validation.csv")
    record = read_json(folder / ALL / "validation.json")
    blocks = [
        _input(record),
        "### Tracks on the network",
        _fit(record["fit"]),
        _of_file(folder / "misses.md"),
        "### Street and simulation",
        _seeds(folder),
        _comparison(rows),
        *_verdicts(rows),
        "### Calibration",
        _calibration(folder / CALIBRATION),
        "### Controllers in the place of real cars",
        _of_file(folder / "in-place.md"),
        "### Do the intervals hold, and the metrics?",
        _of_file(folder / "planted.md"),
        "Metrics of every pair of a real vehicle and a real pedestrian, against shapely at ten instants for "
        "each recorded one (`python -m tests.cosim.tracks.pairs`):",
        f"```text\n{_of_file(folder / 'pairs.txt')}\n```",
        "### Cost",
        _of_file(folder / "cost.md"),
    ]
    return "\n\n".join(blocks) + "\n"


def _of_file(path: Path) -> str:
    return path.read_text("utf-8").strip()


def _input(record: Mapping[str, object]) -> str:
    departed, left_out = record["departed"], record["left_out"]
    assert isinstance(departed, dict)
    assert isinstance(left_out, dict)
    some = ", ".join(f"{count} {kind}" for kind, count in departed.items())
    others = ", ".join(f"{count} {kind}" for kind, count in left_out.items()) or "none"
    return (
        "**Taken from the tracks, so not validated**: who departed when, where, to where and by what: "
        f"{some}. Left out, because they hardly moved or have no way through the network: {others}."
    )


def _fit(rows: object) -> str:
    assert isinstance(rows, list)
    heads = [
        "class",
        "tracks",
        "moving samples",
        "samples that fit",
        "tracks that fit",
        "median distance [m]",
    ]
    cells = [
        [
            row["class"],
            str(row["n_tracks"]),
            str(row["n_samples"]),
            _percent(row["share_samples"]),
            _percent(row["share_tracks"]),
            "" if row["median_distance_m"] is None else f"{row['median_distance_m']:.2f}",
        ]
        for row in rows
    ]
    return table(heads, cells, heads[1:])


def _seeds(folder: Path) -> str:
    runs = len(list((folder / ALL / "simulated").rglob("traffic.parquet")))
    return (
        f"{runs} runs of SUMO's own types; intervals are 95 % by bootstrap over road users. With as many "
        "quantities as here, about one in twenty is called different by chance."
    )


def _comparison(rows: Sequence[Mapping[str, str]]) -> str:
    heads = [
        "quantity",
        "unit",
        "real",
        "simulated",
        "n real",
        "n simulated",
        "difference (95 %)",
        "in sd",
        "KS",
    ]
    cells = [
        [
            row["quantity"],
            row["unit"],
            _number(row["real_mean"]),
            _number(row["simulated_mean"]),
            row["n_real"],
            row["n_simulated"],
            _interval(row),
            _number(row["effect"]),
            _number(row["ks_distance"]),
        ]
        for row in rows
    ]
    return table(heads, cells, heads[2:])


def _verdicts(rows: Sequence[Mapping[str, str]]) -> list[str]:
    """Return three lists: what is like the street, what is not, and what the data cannot say."""
    titles = {
        "indistinguishable": "Like the street, as far as these data can tell",
        "different": "Not like the street",
        "too few": "What the data cannot say",
    }
    blocks = []
    for verdict, title in titles.items():
        mine = [row for row in rows if row["verdict"] == verdict]
        lines = [f"- {row['meaning']}{_told(row)}" for row in mine] or ["- nothing"]
        blocks.append(f"**{title}**\n\n" + "\n".join(lines))
    return blocks


def _told(row: Mapping[str, str]) -> str:
    unit = "" if row["unit"] == "1" else f" {row['unit']}"
    if row["verdict"] == "indistinguishable":
        return f": a difference of {_number(row['detectable'])}{unit} would have been shown in 4 of 5 cases"
    if row["verdict"] == "different":
        more = "lower" if row["difference"].startswith("-") else "higher"
        size = _number(row["difference"].removeprefix("-"))
        return f": {more} by {size}{unit} in the simulation, {_number(row['effect'])} standard deviations"
    return f": {row['n_real']} real and {row['n_simulated']} simulated road users have a value"


def _calibration(folder: Path) -> str:
    estimates = read_csv(folder / "estimates.csv")
    heads = ["parameter", "unit", "value", "95 %", "n", "method"]
    cells = [
        [
            row["parameter"],
            row["unit"],
            _number(row["value"]),
            f"{_number(row['value_lo'])} … {_number(row['value_hi'])}" if row["value"] else "",
            row["n"],
            row["method"],
        ]
        for row in estimates
    ]
    types = tomllib.loads((folder / "calibrated.toml").read_text("utf-8"))["types"]
    written = "; ".join(
        f"`{kind}`: " + ", ".join(f"{key} = {value}" for key, value in one.items())
        for kind, one in types.items()
    )
    before, after = (read_csv(folder / name / "validation.csv") for name in ("before", "after"))
    rows = [
        [
            one["quantity"],
            one["unit"],
            _number(one["real_mean"]),
            _number(one["simulated_mean"]),
            _number(other["simulated_mean"]),
            one["verdict"],
            other["verdict"],
        ]
        for one, other in zip(before, after, strict=True)
    ]
    compared = ["quantity", "unit", "real", "before", "after", "verdict before", "verdict after"]
    return "\n\n".join(
        [
            "Estimated on seconds 0 to 450:",
            table(heads, cells, heads[2:5]),
            f"Written as types of SUMO: {written}.",
            "Seconds 450 to 900, which the estimates have not seen, with SUMO's own types (before) and with "
            "the calibrated ones (after):",
            table(compared, rows, compared[2:5]),
        ]
    )


def _interval(row: Mapping[str, str]) -> str:
    if not row["difference_lo"]:
        return ""
    return f"{_number(row['difference'])} ({_number(row['difference_lo'])} … {_number(row['difference_hi'])})"


def _number(text: str) -> str:
    return f"{float(text):.2f}" if text else ""


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100.0 * share:.1f} %"


if __name__ == "__main__":
    write_below(
        Path(sys.argv[2]), RESULTS, markdown(Path(sys.argv[1])), "# Is the simulation like the street?"
    )
