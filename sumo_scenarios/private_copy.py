"""A configuration as a run uses it: the same input, and nothing written beside the user's files.

SUMO writes what a configuration or an additional file tells it to, relative to that file: into the user's
folder, over the results of the user's own runs. And it refuses options of a window that it was built without.
So a run starts from a copy of the configuration that lacks both, and of those files that name outputs.
"""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import quoteattr

from sumo_scenarios.file_names import plain_name, split_names
from sumo_scenarios.outputs import SilentCopies
from sumo_scenarios.sumo_options import INPUT_FILES, kept_options, written_outputs
from sumo_scenarios.sumocfg import SumoConfiguration


def private_configuration(
    configuration: SumoConfiguration, work_dir: Path, copies: SilentCopies
) -> tuple[Path, list[str]]:
    """Write a copy of a configuration for one run, and return it with the outputs that it leaves out.

    Parameters
    ----------
    configuration : the user's
    work_dir : where the copy goes
    copies : makes those of the files that it names
    """
    folder = configuration.path.parent
    work_dir.mkdir(parents=True, exist_ok=True)
    options: dict[str, str] = {}
    for key, value in kept_options(configuration.options).items():
        options[key] = _absolute(value, folder, work_dir) if key in INPUT_FILES else value
    for key, files in (
        ("net-file", (configuration.net_file,)),
        ("route-files", configuration.route_files),
        ("additional-files", configuration.additional_files),
    ):
        if files:
            options[key] = ",".join(_beside(copies.of(path.resolve()), work_dir) for path in files)
    target = work_dir / "run.sumocfg"
    lines = [f"    <{key} value={quoteattr(value)}/>" for key, value in options.items()]
    target.write_text("<configuration>\n" + "\n".join(lines) + "\n</configuration>\n", encoding="utf-8")
    return target, written_outputs(configuration.options)


def _beside(path: Path, work_dir: Path) -> str:
    """Return a file as the copy names it: one beside it by its name, which is the same in every folder."""
    name = Path(plain_name(path, work_dir))
    return name.name if name.parent.resolve() == work_dir.resolve() else str(name)


def _absolute(names: str, folder: Path, work_dir: Path) -> str:
    """Return file names, separated by commas, as they are seen from anywhere."""
    return ",".join(plain_name((folder / name).resolve(), work_dir) for name in split_names(names))
