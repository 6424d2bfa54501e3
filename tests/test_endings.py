"""However a run ends, its files are whole, or as they were before."""

import json
import os
import random
import resource
import signal
import subprocess
import sys

import pytest

from drake_twin.program import NO_MEMORY

FILES = {"--summary": "summary.json", "--record": "run.json", "--save-state": "state.json", "--save-html": "run.html"}


def command(folder, *more):
    options = [word for option, name in FILES.items() for word in (option, str(folder / name))]
    return [sys.executable, "-m", "drake_twin.run", "--robots", "1", "--headless", *options, *more]


def is_whole(file):
    """Whether a file is one that the program has finished."""
    text = file.read_text()
    if file.suffix == ".html":
        return text.rstrip().endswith("</html>")
    try:
        return isinstance(json.loads(text), dict)
    except ValueError:
        return False


def assert_whole(folder, before):
    for name in FILES.values():
        file = folder / name
        assert not file.exists() or file.read_text() == before or is_whole(file), name
    assert [item.name for item in folder.iterdir() if item.name.endswith(".part")] == []


@pytest.mark.parametrize("moments", [2, pytest.param(25, marks=pytest.mark.slow)])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
@pytest.mark.parametrize("before", ["", "as it was before"])
def test_a_signal_at_any_moment(tmp_path, number, before, moments):
    """The moments are counted in what the program prints, not in time."""
    chance = random.Random(f"{number} {before}")
    for _ in range(moments):
        for name in FILES.values():
            if before:
                (tmp_path / name).write_text(before)
        process = subprocess.Popen(
            command(tmp_path, "--echo", "/clock"), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        for _ in range(chance.randrange(1, 200)):
            process.stdout.readline()
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
        assert process.returncode == (-signal.SIGKILL if number == signal.SIGKILL else 0), err
        if number != signal.SIGKILL:
            assert all(is_whole(tmp_path / name) for name in FILES.values())
        assert "Traceback" not in err
        assert_whole(tmp_path, before)


@pytest.mark.parametrize("size", [0, 100, 2000, 50_000, 1_000_000])
def test_a_full_disk(tmp_path, size):
    """No file may be larger than so many bytes, which a write then finds out as on a full disk."""
    before = "as it was before"
    for name in FILES.values():
        (tmp_path / name).write_text(before)

    def limited():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    result = subprocess.run(
        command(tmp_path, "--duration", "0.1"),
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=limited,
        # without modules, which Python 3.11 would cut off
        env={**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache"), "PYTHONDONTWRITEBYTECODE": "1"},
    )
    assert result.returncode in (1, 2)
    assert "Traceback" not in result.stderr
    assert "cannot be" in result.stderr
    assert_whole(tmp_path, before)


def test_a_file_that_cannot_be_written_keeps_no_other_from_it(tmp_path, monkeypatch, capsys):
    from drake_twin import run
    from drake_twin.errors import RunError
    from drake_twin.twin.snapshot import Snapshot

    def full(self, file):
        raise RunError("the disk is full")

    monkeypatch.setattr(Snapshot, "save", full)
    assert run.main(command(tmp_path, "--duration", "0.01")[3:]) == 1
    assert "error: the disk is full" in capsys.readouterr().err
    assert all(is_whole(tmp_path / name) for name in ("summary.json", "run.json", "run.html"))


def test_a_lack_of_memory_while_it_runs(tmp_path, monkeypatch, capsys):
    from drake_twin import run
    from drake_twin.cli.status_line import StatusLine

    monkeypatch.setattr(StatusLine, "show", lambda self: bytearray(1 << 60))
    assert run.main(command(tmp_path)[3:]) == 1
    assert capsys.readouterr().err == f"error: {NO_MEMORY}\n"
    assert all(is_whole(tmp_path / name) for name in FILES.values())
