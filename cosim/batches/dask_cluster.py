"""Makes the runs of a batch on a Dask cluster, whose workers may come and go.

A worker of the cluster makes its runs in child processes of its own, with the same pool as on one machine.
A run that hangs or crashes ends its child process, never the worker.
"""

from __future__ import annotations

import hashlib
import logging
import multiprocessing
import shutil
import sys
import tempfile
import uuid
import warnings
from collections.abc import Sequence
from concurrent.futures import CancelledError, Future
from pathlib import Path
from time import monotonic
from types import TracebackType
from typing import Any

from cosim.batches.identity import source_digest
from cosim.batches.job import Configuration, Job
from cosim.batches.outcome import Outcome
from cosim.batches.pool import Pool
from cosim.batches.shipping import Bundle, Common, bundles, pack_folder, unpack, unpack_bundle
from cosim.batches.worker import Handling
from cosim.errors import InputError, SimulationError
from cosim.recording import provenance

try:
    from distributed import Client, KilledWorker, WorkerPlugin, get_worker
    from distributed.comm.addressing import parse_address, parse_host_port
    from distributed.comm.registry import get_backend
    from distributed.versions import VersionMismatchWarning
except ImportError as error:
    raise InputError(
        f"--scheduler needs Dask, which is not installed ({error}); pip install 'dask[distributed]'"
    ) from error

_new_client: Any = Client
"""Dask's client without types, as its methods have none."""
LOGGERS = ("distributed", "distributed.client", "tornado.application")
"""Loggers whose level Dask sets."""
COMMON = "common"
"""Folder of a worker for scenarios that are written after the worker has joined."""
CONNECT_TIMEOUT_S = 10.0
LOOK_FOR_WORKERS_EVERY_S = 5.0


class StudyOnWorker(WorkerPlugin):
    """What each worker of the cluster holds of a study: the files of its scenarios, and processes.

    Dask sends it once to each worker, including those that join later.
    """

    def __init__(
        self, name: str, bundles: tuple[Bundle, ...], handling: Handling, common: bytes | None = None
    ) -> None:
        self.name = name
        self._bundles = bundles
        self._handling = handling
        self._common = common
        self._places: dict[str, str] = {}
        self._folder: Path | None = None
        self._pool: Pool | None = None

    def setup(self, worker: Any) -> None:
        """Unpack the files on a worker."""
        self._folder = Path(tempfile.mkdtemp(prefix="cosim-study-", dir=worker.local_directory))
        self._places = {
            one.place: unpack_bundle(one, self._folder / f"scenario-{number}")
            for number, one in enumerate(self._bundles)
        }
        if self._common is not None:
            unpack(self._common, self._folder / COMMON)
        # Dask's workers are daemons, which may have no children. Ours end by themselves when orphaned.
        multiprocessing.current_process()._config["daemon"] = False  # type: ignore[attr-defined]
        self._pool = Pool(worker.state.nthreads, self._handling)

    def teardown(self, worker: Any) -> None:
        """Remove everything from a worker."""
        if self._pool is not None:
            self._pool.close()
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)

    def make(self, job: Job, rest: Bundle | None = None) -> tuple[str, bool, bytes]:
        """Make a run; return why it failed, if so, whether it was lost without being at fault, and its files.

        Parameters
        ----------
        job
        rest
            Files of its scenario besides those that all scenarios have in common.
        """
        assert self._pool is not None
        assert self._folder is not None
        folder = self._folder / uuid.uuid4().hex
        place = self._places.get(job.configuration.place)
        try:
            if rest is not None:
                place = unpack_bundle(rest, self._folder / COMMON)
            outcome = self._pool.submit(job, folder, place).result()
            return outcome.reason, outcome.lost, pack_folder(folder)
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def _make(name: str, job: Job, rest: Bundle | None) -> tuple[str, bool, bytes]:
    """Make a run; this function is called on a worker of the cluster."""
    plugin = get_worker().plugins[name]
    assert isinstance(plugin, StudyOnWorker)
    return plugin.make(job, rest)


def _versions(controllers: tuple[str, ...]) -> dict[str, str]:
    """Return the versions of everything; this function is called on a worker of the cluster."""
    sources = {f"source of {name} and of the tool": source_digest(name) for name in controllers}
    return provenance.versions() | sources


def _connected(address: str) -> Any:
    try:
        scheme, location = parse_address(address)
        get_backend(scheme)
        parse_host_port(location)
        with warnings.catch_warnings():
            # `Cluster._agree` reports the differences between versions that can change a number.
            warnings.simplefilter("ignore", VersionMismatchWarning)
            return _new_client(address, timeout=CONNECT_TIMEOUT_S, set_as_default=False)
    except TypeError as error:  # Dask raises this for an encrypted address if it finds no certificates
        raise InputError(
            f"--scheduler {address}: no certificates for an encrypted connection; expected them in Dask's "
            "configuration, for instance in DASK_DISTRIBUTED__COMM__TLS__CA_FILE and …__CLIENT__CERT"
        ) from error
    except (OSError, ValueError) as error:
        raise InputError(
            f"--scheduler {address}: no Dask scheduler answers there; expected its address, "
            "for instance tcp://127.0.0.1:8786"
        ) from error


class Cluster:
    """A Dask cluster that makes runs; use as a context manager.

    Parameters
    ----------
    address : str
        Address of the scheduler, such as ``tcp://host:8786``.
    study : Path
        The study's folder; the same study replaces what an earlier batch has left on the workers.
    configurations : Sequence
        All configurations whose runs may be submitted.
    handling : Handling
    later : Common
        Files that scenarios written later have in common; ``None`` if there are no such scenarios.

    Raises
    ------
    InputError
        If no scheduler answers, or a worker has another version of anything.
    """

    def __init__(
        self,
        address: str,
        study: Path,
        configurations: Sequence[Configuration],
        handling: Handling,
        later: Common | None = None,
    ) -> None:
        for name in LOGGERS:
            logging.getLogger(name).setLevel(logging.CRITICAL)  # we report what matters ourselves
        self._address = address
        self._name = f"cosim-{hashlib.sha256(str(study.resolve()).encode()).hexdigest()[:12]}"
        controllers = tuple(sorted({one.controller for one in configurations}))
        self._later = later
        self._threads = 0
        self._told = False
        self._looked = -LOOK_FOR_WORKERS_EVERY_S
        self._client = _connected(address)
        try:
            self._agree(controllers)
            first, shared = bundles(configurations), None
            if later is not None:
                first, shared = (), later.packed()
            self._client.register_plugin(StudyOnWorker(self._name, first, handling, shared))
        except BaseException:
            self._client.close()
            raise

    def __enter__(self) -> Cluster:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Leave the cluster, and remove everything from its workers."""
        if self._client.status == "running":
            self._client.unregister_worker_plugin(self._name)
        self._client.close()

    @property
    def processes(self) -> int:
        """Number of runs made at the same time."""
        return self._threads

    def capacity(self) -> int:
        """Return how many runs to hand out at a time; at least one, for workers that have yet to join."""
        now = monotonic()
        if now - self._looked >= LOOK_FOR_WORKERS_EVERY_S:
            self._looked = now
            self._check_alive()
            self._threads = sum(self._client.nthreads().values())
            if self._threads == 0 and not self._told:
                self._told = True
                print(f"no worker has joined the scheduler {self._address} yet", file=sys.stderr, flush=True)
        return max(1, 2 * self._threads)

    def submit(self, job: Job, folder: Path) -> Future[Outcome]:
        """Make a run on the cluster, and write its files to ``folder``, which must not exist."""
        self._check_alive()
        result: Future[Outcome] = Future()
        rest = None if self._later is None else self._later.rest(job.configuration)
        key = f"{job.name}-{uuid.uuid4().hex}"
        inner = self._client.submit(_make, self._name, job, rest, key=key, pure=False)
        inner.add_done_callback(lambda done: result.set_result(self._outcome(done, job, folder)))
        return result

    def _outcome(self, done: Any, job: Job, folder: Path) -> Outcome:
        try:
            reason, lost, archive = done.result()
            unpack(archive, folder)
            return Outcome(job, folder, reason, lost)
        except KilledWorker:
            return Outcome(job, folder, "every worker of the cluster that had this run ended")
        except CancelledError:
            return Outcome(job, folder, f"the scheduler {self._address} has let go of this run", lost=True)
        except Exception as error:  # noqa: BLE001  whatever a worker reports; told as the run's failure
            text = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
            return Outcome(job, folder, " ".join(f"{type(error).__name__}: {text}".split()))

    def _agree(self, controllers: tuple[str, ...]) -> None:
        """Check that all workers have our versions; runs' identities reveal those that join later."""
        ours = _versions(controllers)
        try:
            answers: dict[str, dict[str, str]] = self._client.run(_versions, controllers)
        except Exception as error:  # whatever the worker lacks
            raise InputError(
                f"--scheduler {self._address}: a worker cannot load this tool "
                f"({type(error).__name__}: {error}); expected the same installation as here"
            ) from error
        for worker, theirs in answers.items():
            for key in sorted(ours.keys() | theirs.keys()):
                if ours.get(key) != theirs.get(key):
                    raise InputError(
                        f"--scheduler {self._address}: worker {worker} has {key} {theirs.get(key)}; "
                        f"expected {ours.get(key)}, as here"
                    )

    def _check_alive(self) -> None:
        if self._client.status != "running":
            raise SimulationError(f"the connection to the scheduler {self._address} is lost")
