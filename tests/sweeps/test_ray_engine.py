"""``--engine ray``: the rows of the process engine, in a network of its own that has the loopback address alone."""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

import pytest
from network import network_of_its_own
from sweep_files import program, write_sweep
from waiting import until

from drake_twin import sweep
from drake_twin.sweeps.results import read_table

SICK = ("hinge.yaml", "--vary", "hinge.hinge.position=0,1,3,5", "--duration", "0.02", "--metric", "metrics.py:sick")
GRID = ("hinge.yaml", "--vary", "hinge.arm.mass=1:9:40", "--seeds", "2", "--duration", "0.02", "--metric", "max_effort")
LONG = ("hinge.yaml", "--vary", "hinge.arm.mass=1:9:60", "--duration", "2", "--metric", "max_effort")
needs_ray = pytest.mark.skipif(find_spec("ray") is None, reason="needs Ray: pip install '.[ray]'")


@pytest.fixture
def network():
    with network_of_its_own() as network:
        yield network


@pytest.fixture
def folder(tmp_path):
    return write_sweep(tmp_path)


def start(folder, network, *arguments, **environment):
    """Starts the sweep in a network."""
    root = str(Path(__file__).resolve().parents[2])
    return subprocess.Popen(
        network.command(sys.executable, "-m", "drake_twin.sweep", *arguments),
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": root, "HOME": str(folder), "TMPDIR": "/tmp"} | environment,
    )


def rows_of(file):
    """The rows but for their wall time."""
    return [{key: value for key, value in row.items() if key != "wall_time"} for row in read_table(file)[1]]


def lines(file):
    return file.read_bytes().count(b"\n") if file.exists() else 0


def with_processes(folder, arguments, out):
    out_text, err = program(folder, *arguments, "--workers", "2", "--out", out).communicate(timeout=200)
    assert f"{out}: " in out_text, err
    return rows_of(folder / out)


@needs_ray
def test_local_ray_gives_the_same_rows_and_names_each_open_port(folder, network):
    known = with_processes(folder, SICK, "p.jsonl")
    with tempfile.TemporaryDirectory(dir="/tmp") as temporary:  # a short name: it holds sockets
        run = start(folder, network, *SICK, "--workers", "2", "--engine", "ray", "--out", "r.jsonl", TMPDIR=temporary)
        _, err = run.communicate(timeout=200)
        assert os.listdir(temporary) == []
    assert run.returncode == 0, err
    rows = rows_of(folder / "r.jsonl")
    assert rows[2]["reason"] == "its process ended, or the machine that it ran on (in 2 tries)"
    assert known[2]["reason"] == "its process ended by SIGSEGV (in 2 tries)"
    rows[2]["reason"] = known[2]["reason"]
    assert rows == known
    assert "other machines reach" not in err
    assert re.search(r"Ray on \S+ listens at ports that only the machine itself reaches: .*gcs_server \d+", err), err
    assert network.processes == {}
    assert not (folder / ".ray").exists()


@needs_ray
@pytest.mark.slow
def test_the_named_ports_are_those_of_the_systems_tables_and_ctrl_c_leaves_nothing(folder, network):
    run = start(folder, network, *LONG, "--workers", "2", "--engine", "ray", "--out", "r.jsonl")
    until(lambda: lines(folder / "r.jsonl.journal") > 2, run)
    table = network.run("cat", "/proc/net/tcp", "/proc/net/tcp6").stdout.splitlines()
    listening = {int(line.split()[1].rpartition(":")[2], 16) for line in table if line.split()[3] == "0A"}
    run.send_signal(signal.SIGINT)
    out, err = run.communicate(timeout=100)
    assert run.returncode == 130, err
    assert "of 60 episodes are in r.jsonl. To continue: " in out
    named = {int(port) for port in re.findall(r" (\d+)(?=[,\n])", err)}
    assert len(listening) >= 5
    assert named == listening
    assert network.processes == {}


@needs_ray
@pytest.mark.slow
def test_a_sweep_that_is_killed_takes_its_ray_along_and_continues(folder, network):
    known = with_processes(folder, GRID, "p.jsonl")
    run = start(folder, network, *GRID, "--workers", "2", "--engine", "ray", "--out", "r.jsonl")
    until(lambda: lines(folder / "r.jsonl.journal") > 5, run)
    workers = [process for process, line in network.processes.items() if line.startswith("ray::Episodes")]
    assert len(workers) == 2
    os.kill(workers[0], signal.SIGKILL)
    until(lambda: lines(folder / "r.jsonl.journal") > 15, run)
    run.kill()
    out, _ = run.communicate()
    assert out == ""  # Ray itself would print there that a worker has died
    until(lambda: network.processes == {})
    again = start(folder, network, *GRID, "--workers", "1", "--engine", "ray", "--out", "r.jsonl")
    assert "listens at ports" in again.communicate(timeout=200)[1]
    assert rows_of(folder / "r.jsonl") == known


@needs_ray
@pytest.mark.slow
def test_a_node_that_is_killed_loses_no_episode(folder, network):
    known = with_processes(folder, LONG, "p.jsonl")
    environment = {
        **os.environ,
        "PYTHONPATH": str(Path(__file__).resolve().parents[2]),
        "HOME": str(folder),
        "RAY_USAGE_STATS_ENABLED": "0",
        "RAY_AUTH_MODE": "token",
        "RAY_AUTH_TOKEN": "0123456789abcdef" * 4,
    }
    temporary = Path("/tmp") / f"ray_test_{os.getpid()}"  # a short name: it holds sockets
    ray = [sys.executable, "-m", "ray.scripts.scripts", "start", "--num-cpus=1", "--disable-usage-stats"]
    head = ["--head", "--port=6379", "--include-dashboard=false", f"--temp-dir={temporary}"]
    try:
        network.run(*ray, *head, "--node-ip-address=127.0.0.1", env=environment, cwd="/")
        before = set(network.processes)
        network.run(*ray, "--address=127.0.0.1:6379", env=environment, cwd="/")
        node = next(item for item, line in network.processes.items() if item not in before and "/raylet/raylet" in line)
        cluster = set(network.processes)
        token = {name: environment[name] for name in ("RAY_AUTH_MODE", "RAY_AUTH_TOKEN")}
        address = "192.0.2.9:6379" if network.has_outer else "127.0.0.1:6379"
        arguments = (*LONG, "--engine", "ray", "--address", address, "--out", "r.jsonl")
        run = start(folder, network, *arguments, **token)
        until(lambda: lines(folder / "r.jsonl.journal") > 10, run)
        workers = [item for item, line in network.processes.items() if line.startswith("ray::Episodes")]
        assert len(workers) == 2
        assert parent(node) != parent(workers[0])
        assert sum(parent(worker) == node for worker in workers) == 1
        os.kill(node, signal.SIGKILL)
        _, err = run.communicate(timeout=300)
        assert run.returncode == 0, err
        assert rows_of(folder / "r.jsonl") == known
        reach = "other machines reach" if network.has_outer else "only the machine itself reaches"
        assert re.search(rf"Ray on \S+ listens at ports that {reach}: .*gcs_server 6379", err), err
        assert set(network.processes) <= cluster  # nothing of the sweep is left, and the cluster is
        assert any("gcs_server" in line for line in network.processes.values())
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def parent(process):
    return int(Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[1])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("--engine rya", "--engine rya: unknown engine. Did you mean 'ray'? Valid: processes, ray."),
        ("--address 127.0.0.1:1", "--address names a cluster of Ray: it needs --engine ray"),
        pytest.param("--engine ray --address 127.0.0.1:1", "127.0.0.1:1: no cluster answers there (", marks=needs_ray),
        pytest.param("--engine ray --address here", "here: it must read HOST:PORT, as 'ray start", marks=needs_ray),
    ],
)
def test_an_engine_or_a_cluster_that_is_not_there_is_one_paragraph(folder, arguments, message):
    run = program(folder, *GRID, "--out", "t.csv", *arguments.split())
    _, err = run.communicate(timeout=100)
    assert run.returncode == 2, err
    assert message in err
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert not list(folder.glob("t.csv*"))


def test_without_ray_the_command_that_installs_it_is_named(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    monkeypatch.setitem(sys.modules, "ray", None)
    assert sweep.main([*GRID, "--out", "t.csv", "--engine", "ray"]) == 2
    assert "pip install 'ray>=" in capsys.readouterr().err
    assert not list(folder.glob("t.csv*"))
