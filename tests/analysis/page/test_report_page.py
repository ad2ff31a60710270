"""The page without a browser: valid, closed to the network, and each number a cell of a CSV file."""

from __future__ import annotations

import csv
import html
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from analysis.errors import StudyError
from analysis.page.report import Written, write_report
from analysis.page.tables import shown
from analysis.page.terms import terms
from analysis.results.measures import Measure, run_measures
from analysis.validation.statement import SENTENCE
from cosim.cli import main
from cosim.presentation.wording import sentence
from tests.analysis.page.criteria_files import write_criteria
from tests.analysis.page.markup import Markup
from tests.analysis.study.study_folders import write_study_run

WORST = {"severity": "serious", "min_ttc_s": 0.83, "min_dist_m": 0.41, "clearance_min_m": 0.5}
OTHERS: tuple[Mapping[str, Any], ...] = (
    {"severity": "none", "min_ttc_s": None, "min_dist_m": 3.0},
    {"severity": "none", "min_ttc_s": 4.0, "min_dist_m": 6.0},
    {"severity": "slight", "min_ttc_s": 2.0, "min_dist_m": 1.5},
)


def write_study(folder: Path, seeds: Sequence[int] = (1, 2, 3)) -> Path:
    """Write runs of two controllers; ``sumo`` has the worst encounter with seed 2."""
    for seed in seeds:
        for name in ("sumo", "careful"):
            bad = [WORST] if (name, seed) == ("sumo", 2) else []
            write_study_run(
                folder / "runs" / f"{name}-{seed}",
                name,
                seed,
                encounters=[*OTHERS, *bad],
                numbers={"ego_delay_mean_s": 5.0 + seed + (name == "careful"), "n_conflicts": len(bad)},
            )
    return folder


def written(folder: Path, **options: Any) -> tuple[Written, Markup, str]:
    done = write_report([folder], folder, sentence, **options)
    text = done.page.read_text("utf-8")
    return done, Markup(text), text


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Markup, str]:
    """Return a study with its report, which tests only read."""
    folder = write_study(tmp_path_factory.mktemp("report") / "study")
    _, page, text = written(folder)
    return folder, page, text


@pytest.fixture(scope="module")
def eventful(tmp_path_factory: pytest.TempPathFactory) -> tuple[Written, Markup]:
    """Return the report of a study with criteria, a run that is invalid and one that failed."""
    folder = write_study(tmp_path_factory.mktemp("eventful") / "study")
    (folder / "runs/sumo-2/job.json").write_text('{"command": "cosim run road --controller sumo --seed 2"}')
    write_study_run(folder / "runs/sumo-9", "sumo", 9, invalid="ego_0 was teleported")
    # It recorded something before it failed, and is a run of the study, too.
    write_study_run(folder / "failed/road-sumo-11/run", "sumo", 11, invalid="it crashed")
    (folder / "failed.csv").write_text(
        "run,scenario,controller,seed,attempts,reason,command\n"
        "road-sumo-10,road,sumo,10,2,time-out after 600 s,cosim run road --seed 10\n"
        "road-sumo-11,road,sumo,11,1,it crashed,cosim run road --seed 11\n"
    )
    rows = [
        {"criterion_id": "kept away", "value": 3.0, "margin": 2.0, "status": "pass"},
        {"criterion_id": "told only", "value": 0.6, "margin": -0.4, "counts": False},
        {"criterion_id": "too near", "value": 0.41, "margin": -0.59},
    ]
    write_criteria(folder, [{"operator": ">=", "threshold": 1.0, "unit": "m", **row} for row in rows])
    done, page, _ = written(folder)
    return done, page


@pytest.mark.long
def test_the_page_is_well_formed_and_loads_nothing(study: tuple[Path, Markup, str]) -> None:
    _, page, text = study
    assert page.problems == []
    assert page.loaded == set()
    assert "http://" not in text
    assert "https://" not in text
    assert page.elements["table"] >= 3
    assert page.elements["figure"] == 6


@pytest.mark.long
def test_the_page_of_a_simulation_says_what_validation_says(study: tuple[Path, Markup, str]) -> None:
    assert html.escape(SENTENCE, quote=False).replace("'", "&#39;") in study[2]


@pytest.mark.long
def test_the_first_line_is_the_question_and_the_answer_of_cosim_compare(
    study: tuple[Path, Markup, str], capsys: pytest.CaptureFixture[str]
) -> None:
    folder, page, _ = study
    assert "Is careful safer than sumo on road, and slower?" in page.texts
    assert main(["compare", str(folder), "--alt", "careful"]) == 0
    assert capsys.readouterr().out.splitlines()[0] in page.texts


@pytest.mark.long
def test_the_worst_encounter_comes_first_with_its_folder_and_number(study: tuple[Path, Markup, str]) -> None:
    _, _, text = study
    rows = text.split("<tr data-key=")[1:]
    assert len(rows) == 25 - 6
    first = rows[0]
    assert 'data-severity="serious"' in first
    assert "runs/sumo-2" in first
    assert "encounter_id 4" in first
    assert ">0.83<" in first
    ranks = [row.split('data-severity="')[1].split('"')[0] for row in rows]
    assert ranks == ["serious"] + ["slight"] * 6 + ["none"] * 12


@pytest.mark.long
def test_without_tables_beside_the_runs_the_page_writes_those_it_shows(
    study: tuple[Path, Markup, str],
) -> None:
    folder, _, text = study
    with (folder / "report_data/configs.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["metric"] == "ego_delay_mean_s"]
    assert [row["configuration"] for row in rows] == ["careful", "sumo"]
    for row in rows:
        assert f'<span class="value">{float(row["mean"]):.2f}</span>' in text
        ends = [float(row[name]) for name in ("ci95_lo", "ci95_hi")]
        interval = " … ".join(f"{end:.{2 if end < 10.0 else 1}f}" for end in ends)
        assert f'<span class="interval">{interval}</span>' in text
    assert "report_data/configs.csv" in text


@pytest.mark.long
def test_tables_of_a_batch_are_used_only_while_they_are_of_these_runs(tmp_path: Path) -> None:
    from analysis.study.runs import find_run_folders
    from analysis.study.writing import write_tables

    folder = write_study(tmp_path / "study")
    write_tables(folder, find_run_folders(folder), None)
    _, _, text = written(folder)
    assert not (folder / "report_data/configs.csv").exists()
    assert "<code>configs.csv</code>" in text
    write_study(folder, seeds=[4])
    _, _, text = written(folder)
    assert (folder / "report_data/configs.csv").is_file()
    assert "<code>report_data/configs.csv</code>" in text


@pytest.mark.long
def test_an_encounter_without_recording_says_so_and_names_the_command(
    eventful: tuple[Written, Markup],
) -> None:
    done, page = eventful
    assert done.replays == 0
    assert done.not_recorded == done.listed == 19
    assert "no recording" in page.texts
    assert "cosim run road --controller sumo --seed 2" in page.texts
    assert "cosim run road --controller careful --seed 1" in page.texts
    assert any("--drop-recordings" in text for text in page.texts)
    assert not any("▶ Replay" in text for text in page.texts)


@pytest.mark.long
def test_invalid_and_failed_runs_are_named_with_their_reason(eventful: tuple[Written, Markup]) -> None:
    _, page = eventful
    for text in ("runs/sumo-9", "ego_0 was teleported", "road-sumo-10", "time-out after 600 s", "6 of 9"):
        assert text in page.texts
    assert page.texts.count("it crashed") == 1


@pytest.mark.long
def test_criteria_show_what_decides_first(eventful: tuple[Written, Markup]) -> None:
    _, page = eventful
    order = [page.texts.index(name) for name in ("too near", "told only", "kept away")]
    assert order == sorted(order)
    assert "✗ not passed" in page.texts
    assert "2 failed, 1 passed of 3. Source:" in page.texts
    assert page.texts.count("✗ fail") == 2
    assert "does not count" in page.texts


@pytest.mark.long
def test_one_run_is_told_in_numbers_and_compared_with_nobody(tmp_path: Path) -> None:
    folder = write_study_run(tmp_path / "alone", "sumo", 1, encounters=[WORST, *OTHERS])
    _, page, _ = written(folder)
    assert page.problems == []
    assert "How safe is sumo on road?" in page.texts
    told = (
        "4 encounters in 1 valid run, 4 of them entered: no collisions, "
        "smallest time to collision (TTC) 0.83 s, smallest distance 0.41 m."
    )
    assert told in page.texts
    assert "Comparisons" not in page.texts


@pytest.mark.long
def test_a_contact_with_the_standing_ego_is_told_beside_the_collisions(tmp_path: Path) -> None:
    folder = write_study_run(
        tmp_path / "alone",
        "sumo",
        1,
        encounters=[{"min_dist_m": 0.0, "contact_standing": True}],
        numbers={"n_contacts_standing": 1},
    )
    _, page, _ = written(folder)
    values = [page.texts[page.texts.index(name) - 1] for name in ("collisions", "standing contacts")]
    assert values == ["0", "1"]


@pytest.mark.long
def test_each_collision_says_where_it_was_and_whether_a_careful_driver_prevents_it(tmp_path: Path) -> None:
    hit = {"collision": True, "severity": "collision", "contact_place": "carriageway"}
    folder = write_study_run(
        tmp_path / "alone",
        "sumo",
        1,
        encounters=[
            {**hit, "contact_class": "appeared", "preventable_r157": False},
            {**hit, "contact_class": "ego", "preventable_r157": True},
        ],
    )
    _, page, _ = written(folder)
    assert "carriageway, appeared, not preventable" in page.texts
    assert "carriageway, preventable" in page.texts
    values = [page.texts[page.texts.index(name) - 1] for name in ("collisions", "of them preventable")]
    assert values == ["2", "1"]


@pytest.mark.long
def test_every_controller_has_its_own_row_of_tiles_and_nothing_is_added_up(tmp_path: Path) -> None:
    hit = {"collision": True, "severity": "collision"}
    for name, encounters in (("sumo", [hit, hit]), ("careful", [{"entered": False}, OTHERS[1]])):
        write_study_run(tmp_path / name, name, 1, encounters=encounters)
    _, _, text = written(tmp_path)
    rows = text.split('<section class="fact-row" aria-label="')[1:]
    assert [row.partition('"')[0] for row in rows] == ["careful", "sumo"]
    found = [
        re.findall(r'<span class="value">([^<]*)</span> <span class="name">(.*?)</span></li>', row)
        for row in rows
    ]
    tiles = [{re.sub("<[^>]*>", "", name): value for value, name in row} for row in found]
    assert [tile["collisions"] for tile in tiles] == ["0", "2"]
    assert [(tile["encounters"], tile["of them entered"]) for tile in tiles] == [("2", "1"), ("2", "2")]


@pytest.mark.long
def test_terms_and_measures_lead_to_their_definition_on_the_page(study: tuple[Path, Markup, str]) -> None:
    _, _, text = study
    leading = set(re.findall(r'href="#((?:term|def)-[^"]+)"', text))
    assert {"term-ttc", "term-pet", "term-drac", "def-ttc_lt_1p5_share", "def-ego_delay_mean_s"} <= leading
    assert leading <= set(re.findall(r'id="([^"]+)"', text))
    assert "Time to collision (TTC)" in text


def test_every_term_of_the_page_stands_in_the_glossary() -> None:
    glossary = (Path(__file__).parents[3] / "docs/glossary.md").read_text("utf-8")
    headings = {
        re.sub(r"[^a-z]+", "-", line[4:].lower()).strip("-")
        for line in glossary.splitlines()
        if line.startswith("### ")
    }
    assert {term.anchor for term in terms()} <= headings


def test_a_small_difference_is_not_shown_as_none() -> None:
    measures = {measure.name: measure for measure in run_measures()}
    share, rate = (measures[name] for name in ("collision_share", "collisions_per_veh_km"))
    assert shown(0.0004, share, "+") == "+0.04 %"
    assert shown(0.0004, rate, "+") == "+0.0004"


@pytest.mark.long
def test_names_from_files_are_text_and_not_markup(tmp_path: Path) -> None:
    name = "<script>alert(1)</script>"
    write_study_run(tmp_path / "study/runs/a", "sumo", 1, scenario=name, encounters=[WORST])
    _, page, text = written(tmp_path / "study")
    assert page.problems == []
    assert page.elements["script"] == 1
    assert name not in text


@pytest.mark.long
def test_the_same_runs_give_the_same_bytes(study: tuple[Path, Markup, str], tmp_path: Path) -> None:
    assert written(write_study(tmp_path / "elsewhere" / "study"))[2] == study[2]


def test_no_valid_run_is_a_page_too(tmp_path: Path) -> None:
    write_study_run(tmp_path / "study/runs/a", "sumo", 1, invalid="it broke")
    _, page, _ = written(tmp_path / "study")
    assert page.problems == []
    assert "it broke" in page.texts


def test_a_folder_without_runs_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", str(tmp_path)]) == 2
    assert capsys.readouterr().err == (
        f"cosim: {tmp_path}: no run in it; cosim run and cosim batch make them\n"
    )
    assert main(["report", str(tmp_path / "nowhere")]) == 2
    assert capsys.readouterr().err == f"cosim: {tmp_path / 'nowhere'}: no such folder\n"
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_baseline_is_an_error_that_names_what_there_is(tmp_path: Path) -> None:
    def say(rows: Sequence[Mapping[str, Any]], measures: Mapping[str, Measure]) -> str:
        return ""

    folder = write_study(tmp_path / "study")
    with pytest.raises(StudyError, match=r"nobody.*there are careful, sumo"):
        write_report([folder], folder, say, baseline="nobody")


@pytest.mark.slow
def test_a_thousand_runs_stay_below_ten_megabytes(tmp_path: Path) -> None:
    controllers = ("sumo", "aeb", "careful", "swift")
    for seed in range(250):
        for number, name in enumerate(controllers):
            encounters = [
                {
                    "severity": "none" if (seed + i) % 7 else "slight",
                    "min_ttc_s": 1.0 + 0.01 * ((seed * 31 + i * 17 + number) % 500),
                    "pet_area_s": 0.5 + 0.01 * ((seed * 13 + i * 29) % 500),
                    "min_dist_m": 0.5 + 0.02 * ((seed * 7 + i * 3) % 900),
                    "ego_max_decel_mps2": 0.01 * ((seed * 5 + i * 11) % 600),
                    "ped_delay_s": 0.02 * ((seed + i) % 300),
                }
                for i in range(20)
            ]
            write_study_run(
                tmp_path / "study/runs" / f"{name}-{seed}",
                name,
                seed,
                encounters=encounters,
                numbers={"ego_delay_mean_s": 5.0 + 0.01 * seed + number},
            )
    done, page, _ = written(tmp_path / "study")
    assert page.problems == []
    assert done.page.stat().st_size < 10e6
    assert done.listed >= 200
