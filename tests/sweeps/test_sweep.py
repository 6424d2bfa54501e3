"""``python -m drake_twin.sweep``: stopped, killed, on a full disk, and with wrong input."""

import os
import resource
import signal

import pytest
from sweep_files import children, finished, program, runs, write_sweep
from waiting import until

from drake_twin import run, sweep
from drake_twin.sweeps.results import read_table

GRID = ("hinge.yaml", "--vary", "hinge.arm.mass=1:9:40", "--seeds", "2", "--duration", "0.02", "--metric", "max_effort")


@pytest.fixture
def folder(tmp_path):
    return write_sweep(tmp_path)


def rows_of(file):
    """The rows but for their wall time."""
    return [{key: value for key, value in row.items() if key != "wall_time"} for row in read_table(file)[1]]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    folder = write_sweep(tmp_path_factory.mktemp("undisturbed"))
    run = finished(folder, *GRID, "--out", "t.csv", "--workers", "1")
    assert run.returncode == 0, run.stderr
    return [without_folder(row) for row in rows_of(folder / "t.csv")]


def without_folder(row):
    return {key: value for key, value in row.items() if key != "id"}  # the hinge's file is in another folder


def journal_lines(folder, least):
    file = folder / "t.csv.journal"
    return lambda: file.exists() and file.read_bytes().count(b"\n") > least


def test_ctrl_c_writes_what_is_done_and_names_the_command_that_continues(folder, undisturbed):
    run = program(folder, *GRID, "--out", "t.csv", "--workers", "2")
    until(journal_lines(folder, 8), run)
    run.send_signal(signal.SIGINT)
    out, err = run.communicate(timeout=60)
    assert run.returncode == 130, err
    assert "of 80 episodes are in t.csv. To continue: python -m drake_twin.sweep hinge.yaml --vary" in out
    assert 8 <= len(rows_of(folder / "t.csv")) < 80
    assert not (folder / "t.csv.journal").exists()
    again = finished(folder, *GRID, "--out", "t.csv", "--workers", "3")
    assert again.returncode == 0, again.stderr
    assert [without_folder(row) for row in rows_of(folder / "t.csv")] == undisturbed


def test_a_sweep_that_is_killed_leaves_no_process_and_continues_without_a_row_too_many(folder, undisturbed):
    for least in (5, 30):
        run = program(folder, *GRID, "--out", "t.csv", "--workers", "2")
        until(journal_lines(folder, least), run)
        workers = children(run)
        run.kill()
        run.communicate()
        assert len(workers) >= 2
        until(lambda workers=workers: not any(map(runs, workers)))
        assert not (folder / "t.csv").exists()
    last = finished(folder, *GRID, "--out", "t.csv")
    assert last.returncode == 0, last.stderr
    assert [without_folder(row) for row in rows_of(folder / "t.csv")] == undisturbed


def test_a_full_disk_is_named_and_the_sweep_continues_when_there_is_space(folder, undisturbed):
    def small_files():
        resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000))

    run = finished(folder, *GRID, "--out", "t.csv", "--workers", "2", preexec_fn=small_files)
    assert run.returncode == 1
    assert "t.csv.journal cannot be written (" in run.stderr
    assert "rows are safe. To continue: python -m drake_twin.sweep" in run.stderr
    again = finished(folder, *GRID, "--out", "t.csv", "--workers", "2")
    assert again.returncode == 0, again.stderr
    assert [without_folder(row) for row in rows_of(folder / "t.csv")] == undisturbed


def test_a_row_is_run_again_to_the_same_state(folder, undisturbed, monkeypatch, capsys):
    done = finished(folder, *GRID[:2], "hinge.arm.mass=1,5", *GRID[3:], "--out", "t.jsonl")
    assert done.returncode == 0, done.stderr
    monkeypatch.chdir(folder)
    assert run.main(["--headless", "--episode", "t.jsonl:3"]) == 0
    assert "row 3: the same state as in the table, to the last bit" in capsys.readouterr().err
    urdf = folder / "hinge.urdf"
    urdf.write_text(urdf.read_text().replace('ixx="1"', 'ixx="1"').replace('izz="1"', 'izz="1.5"'))
    assert run.main(["--headless", "--episode", "t.jsonl:3"]) == 0
    assert "warning: row 3: the state differs from the table's" in capsys.readouterr().err
    for text, message in (("t.jsonl:9", "rows lack this number"), ("t.jsonl", "FILE:ROW"), ("x.csv:0", "not exist")):
        assert run.main(["--headless", "--episode", text]) == 2
        assert message in capsys.readouterr().err
    assert run.main(["--headless", "--episode", "t.jsonl:1", "--seed", "3"]) == 2
    assert run.main(["--headless", "--episode", "t.jsonl:1", "--engine", "cenic"]) == 2
    assert "cannot be combined" in capsys.readouterr().err


def test_the_table_is_shown_and_drawn(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    done = finished(folder, *GRID, "--out", "t.parquet", "--plot", "a.png")
    assert done.returncode == 0, done.stderr
    assert "t.parquet: 80 rows (80 done)" in done.stdout
    assert (folder / "a.png").stat().st_size > 5000
    assert sweep.main(["--show", "t.parquet", "--plot", "b.svg"]) == 0
    assert "hinge.arm.mass" in capsys.readouterr().out
    assert "<svg" in (folder / "b.svg").read_text()
    assert sweep.main([*GRID, "--out", "t.parquet"]) == 0
    assert "all 80 episodes are there already" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("hinge.yaml", "--out FILE is missing"),
        ("hinge.yaml --out t.xls", "unknown format"),
        ("nothing.yaml --out t.csv", "nothing.yaml"),
        (
            "hinge.yaml --out t.csv --vary frictoin=1,2",
            "nothing of this name to vary. Did you mean 'friction'",
        ),
        ("hinge.yaml --out t.csv --vary hinge.arm.mass=1,0", "hinge.arm.mass is 0: it must be above zero"),
        ("hinge.yaml --out t.csv --vary hinge.arn.mass=1,2", "has no link 'arn'. Did you mean 'arm'"),
        ("hinge.yaml --out t.csv --vary friction=-1,1", "friction is -1: it must be zero or above"),
        ("hinge.yaml --out t.csv --vary hinge.arm.izz=1,100", "the largest principal moment"),
        (
            "hinge.yaml --out t.csv --vary hinge.velocty.joints=1,2",
            "has no controller 'velocty', and its parts no such value. Did you mean 'hinge.velocity.joints'",
        ),
        ("hinge.yaml --out t.csv --vary hinge.arm.mas=1,2", "Did you mean 'hinge.arm.mass'"),
        (
            "hinge.yaml --out t.csv --vary hinge.velocity.p=1",
            "controller 'velocity' has no parameter 'p'. Did you mean",
        ),
        ("hinge.yaml --out t.csv --vary hinge.payloda=1", "Did you mean 'hinge.payload'"),
        (
            "hinge.yaml --out t.csv --vary hinge.arm.mass=normal(1,2)",
            "hinge.arm.mass is -1.04366: it must be above zero",
        ),
        ("hinge.yaml --out t.csv --vary hinge.arm.inertia=0,1", "hinge.arm.inertia is 0: it must be above zero"),
        ("hinge.yaml --out t.csv --vary hinge.world.mass=0", "hinge.world.mass is 0: it must be above zero"),
        ("hinge.yaml --out t.csv --vary hinge.world.inertia=2", "has no mass in its file, so that it needs one here"),
        ("hinge.yaml --out t.csv --vary hinge.friction=0,-1", "-1 is below zero"),
        ("hinge.yaml --out t.csv --vary hinge.hinge.friction=0,-1", "-1 is below zero"),
        ("hinge.yaml --out t.csv --vary ground_friction=0,-1", "-1 is below zero"),
        ("hinge.yaml --out t.csv --vary hinge.noise=-1", "-1 is below zero"),
        ("hinge.yaml --out t.csv --vary hinge.command_delay=2", "2 s is not a delay from 0 to 1 s"),
        ("hinge.yaml --out t.csv --vary seed=1,2", "--seeds N runs each episode with the seeds 0 to N-1"),
        ("hinge.yaml --out t.csv --vary friction=1,1.0", "the value 1 stands there twice"),
        ("hinge.yaml --out t.csv --vary friction=nan", "nan is not a finite number"),
        ("hinge.yaml --out t.csv --seeds 1000000000", "--seeds 1000000000: it must be 1,000,000 at most"),
        ("hinge.yaml --out t.csv --vary a=uniform(0,1) --samples 10000000", "it must be 1,000,000 at most"),
        (
            "hinge.yaml --out t.csv --vary friction=0:1:1000000 --vary hinge.x=0:1:1000000 --vary hinge.y=0:1:1000000",
            "1,000,000,000,000,000,000 episodes: a sweep has 1,000,000,000,000,000 at most",
        ),
        ("hinge.yaml --out t.csv --vary friction=1,2 --vary friction=1", "--vary friction is given twice"),
        ("hinge.yaml --out t.csv --vary friction=0:1:1000000 --seeds 1000", "1,000,000,000 episodes: --yes runs them"),
        ("hinge.yaml --out t.csv --metric metrics.py:nothing", "has no function 'nothing'"),
        ("hinge.yaml --out t.csv --metric speed", "unknown metric"),
        ("hinge.yaml --out t.csv --until never", "unknown condition"),
        (
            "hinge.yaml --out t.csv --metric id=metrics.py:start",
            "--metric id: the table has a column of this name already",
        ),
        (
            "hinge.yaml --out t.csv --vary friction=1,2 --metric friction=metrics.py:start",
            "--metric friction: the table has a column of this name already",
        ),
        (
            "hinge.yaml --out t.csv --metric m=metrics.py:start --metric m=metrics.py:text",
            "--metric m is given twice",
        ),
        ("hinge.yaml --out t.csv --metric =metrics.py:start", "'' is not the name of a column"),
        ("hinge.yaml --out t.csv --vary friction=1.2.3:2:3", "'1.2.3:2:3' is not a number"),
        ("hinge.yaml --out t.csv --vary friction=uniform(1.2.3,2)", "not a distribution with two numbers"),
        ("hinge.yaml --out t.csv --plot t.txt", "--plot t.txt: unknown format"),
        ("hinge.yaml --out t.csv --pairs nowhere/t.png", "the folder does not exist"),
        (f"hinge.yaml --out {'t' * 300}.csv", "no file can be written there (File name too long)"),
        ("hinge.yaml --out t.csv --forc", "unrecognized arguments: --forc"),
        ("hinge.yaml --out t.csv --workers 0", "--workers 0: it must be 1 or more"),
        ("hinge.yaml --out t.csv --duration 0", "--duration 0: it must be above zero"),
        ("--show nothing.parquet", "the file does not exist"),
    ],
)
def test_wrong_input_is_one_paragraph_before_anything_runs(folder, monkeypatch, capsys, arguments, message):
    monkeypatch.chdir(folder)
    assert sweep.main(arguments.split()) == 2
    err = capsys.readouterr().err
    assert message in err
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert not (folder / "t.csv").exists()
    assert not (folder / "t.csv.journal").exists()


def test_an_out_file_of_another_sweep_is_refused(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    assert finished(folder, "hinge.yaml", "--duration", "0.01", "--out", "t.csv").returncode == 0
    before = (folder / "t.csv").read_bytes()
    assert sweep.main(["hinge.yaml", "--duration", "0.02", "--out", "t.csv"]) == 2
    assert "the file is of another sweep (duration differ)" in capsys.readouterr().err
    assert (folder / "t.csv").read_bytes() == before
    assert not os.path.exists(folder / "t.csv.journal")


def test_servos_are_retuned_where_that_is_asked_for_and_the_table_knows(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    rows = {}
    for options in ((), ("--retune",)):
        given = ["hinge.yaml", "--vary", "hinge.arm.mass=1,2", "--vary", "hinge.arm.inertia=1,3", *options]
        assert sweep.main([*given, "--duration", "0.1", "--out", "t.csv", "--workers", "1", "--force"]) == 0
        rows[options] = rows_of(folder / "t.csv")
    plain, tuned = rows.values()
    assert len({row["id"] for row in (*plain, *tuned)}) == 8
    same = [one["state_sha256"] == two["state_sha256"] for one, two in zip(plain, tuned, strict=True)]
    assert same[0]
    assert not same[1]
    capsys.readouterr()
    for number in (1, 3):
        assert run.main(["--headless", "--episode", f"t.csv:{number}"]) == 0
        assert f"row {number}: the same state as in the table, to the last bit" in capsys.readouterr().err
