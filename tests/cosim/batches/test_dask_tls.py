"""Runs on a cluster whose every connection is encrypted and authenticated, as docs/cluster.md starts it."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.cosim.batches.studies import batch, lasting, refused, runs, write_study
from tests.cosim.batches.test_dask_cluster import cluster

pytestmark = [
    pytest.mark.slow,
    pytest.mark.sumo,
    pytest.mark.skipif(shutil.which("openssl") is None, reason="certificates are made with openssl"),
]


def certificate(folder: Path) -> Path:
    """Make a key and a certificate that signs itself, and return the file that holds both."""
    folder.mkdir(parents=True)
    words = "openssl req -x509 -newkey rsa:2048 -nodes -days 1 -subj /CN=cosim -keyout key.pem -out cert.pem"
    subprocess.run(words.split(), cwd=folder, check=True, capture_output=True)
    both = folder / "both.pem"
    both.write_text((folder / "key.pem").read_text() + (folder / "cert.pem").read_text())
    return both


def encrypted(file: Path) -> dict[str, str]:
    """Return the environment of scheduler, workers and batch."""
    tls = "DASK_DISTRIBUTED__COMM__TLS__"
    roles = {f"{tls}{role}__CERT": str(file) for role in ("SCHEDULER", "WORKER", "CLIENT")}
    return {
        **roles,
        f"{tls}CA_FILE": str(file),
        "DASK_DISTRIBUTED__COMM__REQUIRE_ENCRYPTION": "true",
        "PYTHONSAFEPATH": "1",
    }


def test_runs_on_an_encrypted_cluster_are_those_made_here_and_nobody_else_gets_in(tmp_path: Path) -> None:
    study = write_study(tmp_path, seeds="1-3")
    batch(study, "--out", "here", "--jobs", "2", folder=tmp_path)
    environment = encrypted(certificate(tmp_path / "tls"))
    folder = tmp_path / "cluster"
    folder.mkdir()
    # Nor does a file in the folder in which a worker was started.
    for name in ("multiprocessing", "signal", "queue"):
        (folder / f"{name}.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'a').write({name!r})\n")
    with cluster(folder, environment, protocol="tls") as there:
        assert there.address.startswith("tls://127.0.0.1:")
        line = refused(study, "--out", "out", "--scheduler", there.address, folder=tmp_path)
        assert "no certificates for an encrypted connection" in line
        batch(study, "--out", "there", "--scheduler", there.address, folder=tmp_path, environment=environment)
    assert len(runs(tmp_path / "there")) == 3
    assert lasting(tmp_path / "there") == lasting(tmp_path / "here")
    assert not (tmp_path / "executed").exists()
