"""The engine of several machines: Ray's actors, each with one built twin. Needs the extra ``ray``.

Ray listens at ports of its own. A cluster that this module starts is bound to the loopback address, which Ray does by
itself only where it takes machines to stand alone (macOS and Windows); one that is joined listens as it was started.
What is open is therefore read from the system's tables, on each machine.
"""

import contextlib
import os
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Collection, Iterable
from importlib import import_module
from pathlib import Path
from typing import Any

from drake_twin.errors import InputError, RunError, TwinError, described
from drake_twin.program import say
from drake_twin.requirements import missing
from drake_twin.sweeps.dispatch import Dispatcher, Worker, WorkerEndedError
from drake_twin.sweeps.episode import Row, Runner, Sweep
from drake_twin.sweeps.listening import Port, family, ports_of
from drake_twin.sweeps.variation import Episode
from drake_twin.versions import stamp

_STORE = 80 * 2**20  # bytes of shared memory, the least that Ray takes: rows are small
_ANSWER = 10.0  # s in which a cluster's address answers
_START = 30.0  # s in which workers start, or are not waited for any longer

# What Ray reads from the environment: no reports to its makers, and graphics cards as they are.
_QUIET = {"RAY_USAGE_STATS_ENABLED": "0", "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0"}
# What makes Ray take the loopback address, as on systems where it knows no clusters.
_ALONE = {"RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0", "RAY_AUTH_MODE": "token"}
# No spare processes, which would open ports when all have been named.
_ALONE |= dict.fromkeys(("RAY_enable_worker_prestart", "RAY_prestart_worker_first_driver"), "0")
# Ray's servers end with this process, but for its agents if it is killed: they then search for the servers for minutes.
_CLEAN_UP = 'cat; sleep 1; rm -rf "$1"; shift; kill -9 "$@" 2>/dev/null'


class Episodes:
    """What an actor of Ray runs."""

    def __init__(self, sweep: Sweep, folder: str):
        self._sweep = sweep
        with contextlib.suppress(OSError):  # a machine without this folder finds files by their packages
            os.chdir(folder)
        self._runner = Runner(sweep)

    def start(self, session: str) -> tuple[str, int, list[Port]]:
        """Return the machine, this process, and the ports of Ray's session on this machine.

        Raises:
            RunError: If another version is installed on this machine.
        """
        if stamp() != self._sweep.version:
            raise RunError(f"{socket.gethostname()} has {stamp()}, and the sweep is of {self._sweep.version}")
        return socket.gethostname(), os.getpid(), ports_of({*family(session), os.getpid()})

    def run(self, episode: Episode) -> Row:
        """Run an episode."""
        return self._runner.run(episode)


class _Actor(Worker):
    """An actor, and the result that it owes."""

    def __init__(self, engine: "RayEngine", actor: Any, session: str):
        super().__init__()
        self._engine, self._actor = engine, actor
        self._process: int | None = None
        self.result = actor.start.remote(session)

    @property
    def process(self) -> int | None:
        return self._process

    def send(self, episode: Episode) -> None:
        self.result = self._actor.run.remote(episode)

    def receive(self) -> Row | None:
        ray, result, self.result = self._engine.ray, self.result, None
        try:
            received = ray.get(result)
        except ray.exceptions.RayTaskError as error:
            if isinstance(error.cause, TwinError):
                raise error.cause from None
            raise WorkerEndedError(f"it failed in Ray: {described(error.cause)}") from None
        except ray.exceptions.RayError:
            raise WorkerEndedError("its process ended, or the machine that it ran on") from None
        if self.is_ready:
            row: Row = received
            return row
        machine, self._process, ports = received
        self._engine.announce(machine, ports)
        return None

    def end(self) -> None:
        self._engine.ray.kill(self._actor)


class RayEngine(Dispatcher[_Actor]):
    """Runs a sweep's episodes in actors of Ray; see `Dispatcher`.

    Args:
        sweep: The sweep.
        workers: The number of actors; as many as the cluster has cores if these are fewer.
        timeout: The longest wall time of an episode (s).
        address: HOST:PORT of a cluster of which this machine is a node. By default a cluster of this machine alone is
            started, and ended with the engine.

    Raises:
        InputError: If Ray is not installed, or no cluster answers at the address.
    """

    def __init__(self, sweep: Sweep, workers: int, timeout: float, address: str | None = None):
        self.ray = _imported(alone=address is None)
        self._folder: str | None = None  # of a cluster of its own
        self._announced: set[tuple[str, Port]] = set()
        self._ended = contextlib.ExitStack()
        with self._ended:
            self._session = self._connect(workers, address)
            cores = int(self.ray.cluster_resources().get("CPU", 1))
            options = {"num_cpus": 1, "max_restarts": 0, "max_task_retries": 0, "scheduling_strategy": "SPREAD"}
            self._actors = self.ray.remote(**options)(Episodes)
            super().__init__(sweep, max(1, min(workers, cores)), timeout)
            # A port of a worker is open once it has started: those of this machine stand in one message.
            started = [worker.result for worker in self._workers]
            self.ray.wait(started, num_returns=len(started), timeout=_START)
            self._clean_up_if_killed()
            self.announce(socket.gethostname(), ports_of({*family(self._session), os.getpid()}))
            self._ended = self._ended.pop_all()

    def __exit__(self, *error: object) -> None:
        with self._ended:
            super().__exit__(*error)

    def announce(self, machine: str, ports: Iterable[Port]) -> None:
        """Print which ports are open on a machine, but for those that have been printed."""
        new = [port for port in ports if (machine, port) not in self._announced]
        self._announced |= {(machine, port) for port in new}
        for are_reachable, who in ((True, "other machines reach"), (False, "only the machine itself reaches")):
            named = ", ".join(str(port) for port in new if port.is_reachable == are_reachable)
            if named:
                say(f"Ray on {machine} listens at ports that {who}: {named}", sys.stderr)

    def _connect(self, workers: int, address: str | None) -> str:
        """Start or join a cluster; return the name of its session."""
        options: dict[str, Any] = {"log_to_driver": False, "configure_logging": False}
        if address is None:
            folder = tempfile.mkdtemp(prefix="ray_")  # a short name: it holds sockets
            self._folder = folder
            self._ended.callback(shutil.rmtree, folder, ignore_errors=True)
            options |= {"address": "local", "num_cpus": workers, "_temp_dir": folder, "_node_ip_address": "127.0.0.1"}
            options |= {"include_dashboard": False, "object_store_memory": _STORE}
        else:
            _check_address(address)
            options["address"] = address
        self._ended.callback(self.ray.shutdown)
        handler = signal.getsignal(signal.SIGTERM)
        try:
            context = self.ray.init(**options)
        except Exception as error:
            reason = " ".join(str(error).split())
            what = f"--address {address}: the cluster cannot be joined" if address else "Ray cannot be started"
            raise InputError(f"{what} ({reason[:300]})") from None
        finally:
            with contextlib.suppress(ValueError):  # only the main thread may handle signals
                signal.signal(signal.SIGTERM, handler)  # in place of Ray's own
        return Path(context.address_info["session_dir"]).name

    def _clean_up_if_killed(self) -> None:
        """Let a shell end the processes of an own cluster when its input ends, which it does with this process."""
        if self._folder is None:
            return
        processes = map(str, family(self._session) - {os.getpid()})
        command = ["sh", "-c", _CLEAN_UP, "sh", self._folder, *processes]
        null = subprocess.DEVNULL
        shell = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=null, stderr=null, start_new_session=True)
        self._ended.callback(shell.wait)
        self._ended.callback(shell.kill)

    def _start(self) -> _Actor:
        return _Actor(self, self._actors.remote(self._sweep, os.getcwd()), self._session)

    def _heard(self, timeout: float) -> Collection[_Actor]:
        owing = {worker.result: worker for worker in self._workers if worker.result is not None}
        ready, _ = self.ray.wait([*owing], num_returns=len(owing), timeout=0)
        if not ready:
            ready, _ = self.ray.wait([*owing], num_returns=1, timeout=timeout)
        return [owing[result] for result in ready]


def _check_address(address: str) -> None:
    """Check that something listens at an address, for which Ray itself takes minutes.

    Raises:
        InputError: If it is not HOST:PORT, or nothing listens there.
    """
    host, _, port = address.rpartition(":")
    if not host or not port.isdecimal():
        raise InputError(f"--address {address}: it must read HOST:PORT, as 'ray start --head' prints it")
    try:
        socket.create_connection((host.strip("[]"), int(port)), timeout=_ANSWER).close()
    except (OSError, OverflowError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"--address {address}: no cluster answers there ({reason})") from None


def _imported(*, alone: bool) -> Any:
    """Import Ray, which reads much of its environment as it is imported.

    Raises:
        InputError: If it is not installed.
    """
    before = dict(os.environ)
    for name, value in _QUIET.items():
        os.environ.setdefault(name, value)
    if alone:
        os.environ.update(_ALONE, RAY_AUTH_TOKEN=secrets.token_hex(32))
    try:
        ray = import_module("ray")
    except ImportError:
        os.environ.clear()
        os.environ.update(before)
        raise missing("--engine ray needs", "ray") from None
    # A paragraph on standard output for each worker that dies, also with log_to_driver=False. The table has the reason.
    import_module("ray._private.worker").print_to_stdstream = lambda *_, **__: None  # type: ignore[attr-defined]
    return ray
