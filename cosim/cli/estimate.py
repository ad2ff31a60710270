"""``cosim estimate``: how often an event would happen in a passage."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from cosim.cli import terminal
from cosim.cli.options import Debug, Jobs, Scheduler, Settings, here_or_elsewhere
from cosim.cli.search_options import ControllerName, CriteriaFile, OwnFolder, RunTimeout, Searched, Space

if TYPE_CHECKING:
    from cosim.search.estimate import Estimated, EstimateRequest

_EVENTS = {
    "contact": "a contact",
    "preventable-contact": "a contact that a careful driver would have prevented",
    "criteria": "a violated criterion that a careful driver would have kept",
}


def estimate(
    scenario: Searched,
    controller: ControllerName = "vo_mpc",
    event: Annotated[
        str, typer.Option(metavar="NAME", help="contact, preventable-contact or criteria.")
    ] = "contact",
    method: Annotated[str, typer.Option(metavar="NAME", help="crude, subset or importance.")] = "importance",
    variation: Annotated[
        float, typer.Option(metavar="X", help="Stop at this coefficient of variation.")
    ] = 0.3,
    budget: Annotated[
        int, typer.Option(metavar="N", min=1, help="Number of runs; what has begun is finished.")
    ] = 5000,
    seed: Annotated[int, typer.Option(metavar="N", help="Seed of what is drawn.")] = 1,
    space: Space = None,
    criteria: CriteriaFile = None,
    settings: Settings = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    run_timeout_s: RunTimeout = 600.0,
    out: OwnFolder = None,
    debug: Debug = False,
) -> int:
    """Estimate how probable a contact is per passage.

    The parameters of the space are drawn from their declared distributions.

    Repeat the command to resume.

    \b
    Examples:
      cosim estimate jaywalk_arterial --controller aeb --method crude --budget 1000 --out results/crude
      cosim estimate jaywalk_arterial --controller vo_mpc --variation 0.2 --budget 20000

    \b
    Exit codes: 0 done, 2 bad input (nothing is run), 3 no run has a result, or it was interrupted.
    """
    from cosim.batches.progress import shown_tally
    from cosim.errors import InputError
    from cosim.running.request import parse_settings
    from cosim.search.estimate import EstimateRequest, prepared_estimate, run_estimate

    here_or_elsewhere(jobs, scheduler)
    if not 0 <= seed < 2**31 - 10000:
        raise InputError(f"--seed: expected a whole number from 0 to {2**31 - 10001}, got {seed}")
    request = EstimateRequest(
        scenario,
        controller,
        event,
        method,
        variation,
        budget,
        seed,
        parse_settings(settings or []),
        space,
        criteria,
        out,
        jobs,
        scheduler,
        run_timeout_s,
    )
    subject, about = prepared_estimate(request)
    for note in subject.notes:
        typer.echo(f"cosim: note: {note}", err=True)
    try:
        found = run_estimate(request, subject, about, shown_tally())
    except KeyboardInterrupt:
        typer.echo(f"cosim: interrupted; what is finished is kept; to resume: {request.command()}", err=True)
        return 3
    _show(request, found)
    return 0


def _cross_check(found: Estimated) -> str:
    """Return what extreme-value theory says, or why it says nothing."""
    from analysis.search.extremes import FEWEST_PEAKS, SHARE
    from analysis.search.probability import in_words

    one = found.check
    if one is None:
        return (
            f"Cross-check by extreme values: none; it needs {FEWEST_PEAKS} near misses among the nearest "
            f"{100 * SHARE:g} % of the passages drawn, and fewer events than that."
        )
    return (
        f"Cross-check by extreme values, no estimate to rest on: {in_words(one.low, one.high)}, from the "
        f"tail of the {one.peaks} nearest of {one.margins} passages drawn, as if contacts went on from near "
        "misses."
    )


def _show(request: EstimateRequest, found: Estimated) -> None:
    """Print the answer, and what it does not say."""
    from analysis.search.probability import in_words

    console = terminal.console()

    def say(text: str) -> None:
        console.print(text, soft_wrap=True)

    one = found.probability
    what = _EVENTS[request.event]
    if one.events == 0:
        say(f"No run of {one.runs} had {what}.")
    if one.estimate or one.method == "crude":
        say(
            f"{request.controller} on {request.scenario}: {what} in {in_words(one.low, one.high)} passages "
            f"of this kind (95 %), given these distributions; estimate {one.estimate:.2g}"
        )
    else:
        say("The method found no way to the event; that gives no bound: --method crude does.")
    variation = "–" if one.variation is None else f"{one.variation:.2f}"
    say(
        f"{one.runs} runs by {one.method}, {one.events} with the event; coefficient of variation {variation}"
        + ("" if one.reached else f", the wanted {request.variation:g} was not reached")
    )
    if one.replications > 1:
        say(f"The interval is from the scatter of {one.replications} independent estimates.")
    if one.dropped:
        say(
            f"{one.dropped} of {one.dropped + one.replications} independent estimates led nowhere and are "
            "left out, so do not rest on this: passages that just miss may be no sign of contacts here. "
            "--method crude does not depend on it."
        )
    say(_cross_check(found))
    if found.invalid:
        say(f"{found.invalid} runs failed; none of them counts as an event.")
    say(
        "It does not say how often such passages occur, and it holds for the declared distributions only: "
        "what they leave out has probability 0 here. Pedestrians who behave otherwise, other roads and "
        "faults of sensors or software are not in it."
    )
    say(f"files: {found.folder}")
