"""Which of SUMO's options name input files and which make it write, under any of their names."""

from __future__ import annotations

import re
from collections.abc import Mapping

_SYNONYMS = {
    "configuration-file": "c configuration",
    "net-file": "n net",
    "route-files": "r routes",
    "additional-files": "a additional",
    "weight-files": "w weights",
    "edgedata-files": "data-files m",
    "alternative-net-file": "N",
    "gui-settings-file": "g",
    "device.fcd-replay.files": "device.fcd-replay.file",
    "begin": "b",
    "end": "e",
    "seed": "srand",
    "random": "abs-rand",
    "save-configuration": "C save-config",
    "save-configuration.relative": "save-config.relative",
    "save-commented": "save-template.commented",
    "netstate-dump": "ndump netstate netstate-output",
    "netstate-dump.empty-edges": "dump-empty-edges netstate-output.empty-edges netstate.empty-edges",
    "netstate-dump.precision": "dump-precision netstate-output.precision netstate.precision",
    "person-fcd-output": "person-fcd",
    "summary-output": "summary",
    "tripinfo-output": "tripinfo",
    "personinfo-output": "personinfo",
    "vehroute-output": "vehroutes",
    "vehroute-output.exit-times": "vehroutes.exit-times",
    "vehroute-output.last-route": "vehroutes.last-route",
    "vehroute-output.sorted": "vehroutes.sorted",
    "vehroute-output.dua": "vehroutes.dua",
    "vehroute-output.intended-depart": "vehroutes.intended-depart",
    "vehroute-output.route-length": "vehroutes.route-length",
    "personroute-output": "personroutes",
    "statistic-output": "statistics-output",
    "log": "l log-file",
    "quit-on-end": "Q",
    "game": "G",
    "start": "S",
    "breakpoints": "B",
    "demo": "D",
}
_LONG = {short: name for name, texts in _SYNONYMS.items() for short in texts.split()}

INPUT_FILES = frozenset(
    {"net-file", "route-files", "additional-files", "weight-files", "load-state", "phemlight-path"}
    | {"fcd-output.filter-edges.input-file", "device.ssm.filter-edges.input-file"}
    | {"astar.all-distances", "astar.landmark-distances", "device.fcd-replay.files"}
    | {"gui-settings-file", "edgedata-files", "alternative-net-file", "selection-file"}
)
"""Options whose value is one or several input files."""
_OF_ITS_START = frozenset(
    {"osg-view", "game", "game.mode", "demo", "start", "quit-on-end", "breakpoints", "tracker-interval"}
    | {"gui-testing", "gui-testing-debug", "gui-testing.setting-output", "registry-viewport"}
    | {"configuration-file", "remote-port", "num-clients"}
)
"""Options of the graphical interface, which not every SUMO has, and of control from another process."""
_WRITTEN = re.compile(
    r".*-output(\..*)?|output-(prefix|suffix)|output\..*|netstate-dump(\..*)?|save-state\..*|"
    r"(.*-)?log(\..*)?|device\.rerouting\.output|device\.taxi\..*\.output|device\.(ssm|toc)\.file|"
    r"save-(configuration|template|schema|commented)(\..*)?|pedestrian\.jupedsim\.(wkt|py)"
)
_OF_OUTPUT = re.compile(r"output[-.].*|.*-output\..*|netstate-dump\..*|log\..*|.*-commented|.*\.relative")
"""Options that say how an output is written, but not that it is written."""
_KEPT = frozenset({"no-step-log", "fcd-output.filter-edges.input-file"})


def long_name(name: str) -> str:
    """Return the name under which SUMO lists an option, for any of its names.

    >>> long_name("tripinfo"), long_name("step-length")
    ('tripinfo-output', 'step-length')
    """
    return _LONG.get(name, name)


def is_true(options: Mapping[str, str], name: str) -> bool:
    """Return whether an option is set to one of the words that SUMO reads as true.

    >>> is_true({"mesosim": "Yes"}, "mesosim"), is_true({"mesosim": "0"}, "mesosim"), is_true({}, "mesosim")
    (True, False, False)
    """
    return options.get(name, "false").lower() in ("true", "1", "yes", "on", "t", "x")


def kept_options(options: Mapping[str, str]) -> dict[str, str]:
    """Return the options, by long name, without those that write files or belong to the graphical interface.

    >>> kept_options({"end": "60", "tripinfo-output": "t.xml", "osg-view": "true", "log": "log"})
    {'end': '60'}
    """
    return {
        name: value
        for name, value in options.items()
        if name in _KEPT or not (name in _OF_ITS_START or _WRITTEN.fullmatch(name))
    }


def written_outputs(options: Mapping[str, str]) -> list[str]:
    """Return the options that make SUMO write a file.

    >>> written_outputs({"tripinfo-output": "t.xml", "tripinfo-output.write-unfinished": "true", "end": "9"})
    ['tripinfo-output']
    """
    left_out = options.keys() - kept_options(options).keys() - _OF_ITS_START
    return sorted(name for name in left_out if options[name] and not _OF_OUTPUT.fullmatch(name))
