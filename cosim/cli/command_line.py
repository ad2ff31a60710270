"""The command ``cosim``: parses arguments, prints one line per error and returns an exit code.

Exit codes: 0 success; 1 a criterion is not met; 2 bad usage or input, found before the first step; 3 a run
that failed after it.
"""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Sequence
from functools import cache
from typing import Annotated, Any

import typer

from analysis.errors import DamageError
from cosim.cli import analyse, calibrate, compare, completion, conformance, listing, papers, schema
from cosim.cli import batch as batch_command
from cosim.cli import check as check_command
from cosim.cli import estimate as estimate_command
from cosim.cli import export as export_command
from cosim.cli import falsify as falsify_command
from cosim.cli import inspect as inspect_command
from cosim.cli import plot as plot_command
from cosim.cli import replay as replay_command
from cosim.cli import report as report_command
from cosim.cli import run as run_command
from cosim.cli import screen as screen_command
from cosim.cli import stand_in as stand_in_command
from cosim.cli import validate as validate_command
from cosim.cli import verify as verify_command
from cosim.cli.apart import OWN_PROCESS
from cosim.cli.interruption import termination_interrupts
from cosim.errors import InputError, SimulationError

INTERRUPTED = 130
"""Exit code that typer makes of an interruption, without a word."""
# The base class of typer's usage errors, which has no public name.
UsageProblem: Any = typer.BadParameter.__mro__[2]

SUMMARIES = {
    "run": "Drive an ego through a scenario; say how safe it was.",
    "batch": "Run a study: scenarios × controllers × seeds × parameters.",
    "check": "Hold runs against criteria: pass or fail, with JUnit XML.",
    "screen": "Rank the crossings of a network by risk.",
    "falsify": "Search for the cases in which a controller fails.",
    "estimate": "Estimate how probable a contact is per passage.",
    "validate": "Compare simulated road users with real ones.",
    "calibrate": "Estimate types of road users from tracks.",
    "stand-in": "Drive in the place of a recorded vehicle.",
    "analyse": "Recompute the CSV files of recorded runs.",
    "compare": "Is one controller safer than another, and slower?",
    "report": "Write report.html: tables, figures, replays.",
    "verify": "Check that no file of a finished run was altered.",
    "conformance": "Check the coupling with SUMO, or a controller.",
    "inspect": "Does a network support a pedestrian study?",
    "plot": "Draw a trip or an encounter.",
    "replay": "Write a film of an encounter.",
    "export": "Write an encounter as OpenSCENARIO.",
    "list": "List scenarios, controllers, metrics and more.",
    "completion": "Print a shell's completion script.",
    "schema": "Print the JSON schema of a scenario or study file.",
}
"""Lines of the top-level help that are short enough not to be cut off; others would be."""

app = typer.Typer(
    name="cosim",
    help="Drive controllers through pedestrian crossings in SUMO traffic and report how safe they were.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
)
app.command("run")(run_command.run)
app.command("batch")(batch_command.batch)
app.command("check")(check_command.check)
app.command("screen")(screen_command.screen)
app.command("falsify")(falsify_command.falsify)
app.command("estimate")(estimate_command.estimate)
app.command("validate")(validate_command.validate)
app.command("stand-in")(stand_in_command.stand_in)
app.command("calibrate")(calibrate.calibrate)
app.command("analyse")(analyse.analyse)
app.command("compare")(compare.compare)
app.command("report")(report_command.report)
app.command("verify")(verify_command.verify)
app.command("conformance")(conformance.conformance)
app.command("inspect")(inspect_command.inspect)
app.command("plot")(plot_command.plot)
app.command("replay")(replay_command.replay)
app.command("export")(export_command.export)
app.command("list")(listing.show)
app.command("schema")(schema.schema)
app.command("completion")(completion.completion)
for command in app.registered_commands:
    command.short_help = SUMMARIES.get(str(command.name))
app.command("papers", hidden=True, context_settings=papers.ANYTHING)(papers.papers)


def _show_version(wanted: bool) -> None:
    if wanted:
        from cosim.recording.provenance import versions

        typer.echo(", ".join(f"{name} {version}" for name, version in versions().items()))
        raise typer.Exit()


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show versions and exit.")
    ] = False,
) -> None:
    pass


@cache
def _command() -> Any:
    """Return the command line made of ``app``, which takes longer than many a command."""
    return typer.main.get_command(app)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    owner = OWN_PROCESS if arguments is None else None
    arguments = list(sys.argv[1:] if arguments is None else arguments) or ["--help"]
    # Before NumPy is loaded: several BLAS threads make small problems slower, not faster.
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    if completion.VARIABLE in os.environ:
        completion.prepare()
    try:
        with termination_interrupts():
            code = int(_command()(arguments, prog_name="cosim", standalone_mode=False, obj=owner) or 0)
        return _tell("interrupted", INTERRUPTED, arguments) if code == INTERRUPTED else code
    except UsageProblem as error:
        return _tell(error.format_message(), 2, arguments)
    except InputError as error:
        return _tell(str(error), 2, arguments)
    except SimulationError as error:
        return _tell(str(error), 3, arguments)
    except (KeyboardInterrupt, typer.Abort):
        return _tell("interrupted", INTERRUPTED, arguments)
    except DamageError as error:
        return _tell(str(error), 3, arguments)
    except MemoryError:
        return _tell("there is not enough memory", 3, arguments)
    except Exception as error:  # noqa: BLE001  last resort: one line instead of a traceback
        what = f"internal error, {type(error).__name__}: {error} (use --debug for the traceback)"
        return _tell(what, 3, arguments)


def _tell(text: str, code: int, arguments: Sequence[str]) -> int:
    if "--debug" in arguments:
        traceback.print_exc()
    print("cosim: " + " ".join(text.split()), file=sys.stderr)
    return code
