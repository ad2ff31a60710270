"""Private copy of a SUMO configuration for a run: the same input, but no output beside the user's files.

SUMO writes the outputs of a configuration or an additional file relative to that file: into the user's
folder, over the results of the user's own runs. It also refuses options of the graphical interface if built
without it. So a run starts from a copy of the configuration that lacks both, and from copies of the files
that name outputs.
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
    configuration : the user's configuration
    work_dir : folder for the copy
    copies : makes copies of the files that the configuration names
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
    """Return a file's name for the copy; without a folder if the file is beside it, wherever that is."""
    name = Path(plain_name(path, work_dir))
    return name.name if name.parent.resolve() == work_dir.resolve() else str(name)


def _absolute(names: str, folder: Path, work_dir: Path) -> str:
    """Return file names, separated by commas, as absolute names."""
    return ",".join(plain_name((folder / name).resolve(), work_dir) for name in split_names(names))
