"""CPU time of taking down and checking the hashes of a batch's files, and which share of the batch that is.

``python benchmarks/verification.py STUDY_DIR`` measures the finished runs of a batch in place: their hashes
are taken anew, as at the end of a run, and checked twice, as by its analysis and by a batch that resumes.
The bar is 2 % of the time that the runs took.
"""

from __future__ import annotations

import sys
from pathlib import Path
from time import process_time

from analysis.files import read_json
from analysis.markdown import table_of
from analysis.sealing import damages, seal, seal_recording
from analysis.study.runs import find_run_folders


def measure(folders: list[Path]) -> dict[str, float]:
    """Return the row of the table."""
    made_s = sum(float(read_json(folder / "run.json")["wall_total_s"]) for folder in folders)
    sealing = checking = 0.0
    for folder in folders:
        files = list(folder.iterdir())
        started = process_time()
        seal_recording(folder)
        seal(folder, (path for path in files if path.suffix in (".csv", ".json") and path.stem != "files"))
        sealed = process_time()
        assert not damages(folder)
        checked = process_time()
        sealing += sealed - started
        checking += checked - sealed
    size = sum(path.stat().st_size for folder in folders for path in folder.iterdir())
    return {
        "runs": len(folders),
        "MB": round(size / 1e6, 1),
        "sealing, ms a run": round(1e3 * sealing / len(folders), 2),
        "checking, ms a run": round(1e3 * checking / len(folders), 2),
        "share of the batch [%]": round(100.0 * (sealing + 2.0 * checking) / made_s, 3),
    }


if __name__ == "__main__":
    print(table_of([measure(find_run_folders(Path(sys.argv[1])))]))
