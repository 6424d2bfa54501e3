import gc
import logging
import os
import signal
import subprocess
import sys
import weakref

import pytest

from drake_twin.errors import InputError, RunError
from drake_twin.program import NO_MEMORY, PATIENCE, ArgumentParser, collecting_later, run_program, say, stop_signals


def failing(error):
    def program(arguments):
        raise error

    return program


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (InputError("x"), 2),
        (RunError("x"), 1),
        (OSError("x"), 2),
        (OSError(28, "x"), 1),
        (MemoryError(), 1),
        (KeyboardInterrupt(), 130),
    ],
)
def test_errors_become_exit_codes(error, code, capsys):
    assert run_program(failing(error), []) == code
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize(("name", "shows"), [("drake_twin.nodes.nodes", True), ("aiohttp.server", False)])
def test_tracebacks_are_of_nodes_and_not_of_libraries(name, shows, capsys):
    """A stranger at a port must not fill the program's output."""

    def program(arguments):
        try:
            raise ValueError("no way")
        except ValueError:
            logging.getLogger(name).exception("it has failed")
        return 0

    run_program(program, [])
    told = capsys.readouterr().err
    assert told.startswith("error: it has failed\n")
    assert ("Traceback" in told) is shows


def test_a_lack_of_memory_is_one_paragraph_also_where_drake_makes_another_error_of_it(capsys):
    def program(arguments):
        try:
            bytearray(1 << 60)
        except MemoryError as error:
            raise ImportError("initialization failed") from error

    assert run_program(program, []) == 1
    assert capsys.readouterr().err == f"error: {NO_MEMORY} (--debug: the traceback)\n"


def test_wrong_options_are_one_paragraph(capsys):
    assert run_program(lambda arguments: ArgumentParser(prog="p").parse_args(arguments) and 0, ["--fly"]) == 2
    assert capsys.readouterr().err == "error: unrecognized arguments: --fly (--help lists the options).\n"


def test_debug_lets_the_error_through():
    with pytest.raises(InputError):
        run_program(failing(InputError("x")), ["--debug"])


@pytest.fixture
def default_ctrl_c():
    """A job in the background starts without it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_a_second_signal_kills_only_where_the_first_one_does_not_end_the_program_soon(monkeypatch, default_ctrl_c):
    now = 100.0
    monkeypatch.setattr("time.monotonic", lambda: now)
    with stop_signals() as stopped:
        os.kill(os.getpid(), signal.SIGINT)
        now += PATIENCE
        os.kill(os.getpid(), signal.SIGTERM)
        os.kill(os.getpid(), signal.SIGINT)
        assert stopped == [signal.SIGINT, signal.SIGTERM, signal.SIGINT]
        now += 0.1
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)


def test_a_closed_terminal_does_not_end_what_nohup_has_started():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with stop_signals() as stopped:
            os.kill(os.getpid(), signal.SIGHUP)
        assert stopped == []
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_reader_that_went_away_does_not_end_a_program(tmp_path):
    file = tmp_path / "out.json"
    command = (
        f"{sys.executable} -m drake_twin.run --headless --duration 0.1 --summary {file} | true; exit ${{PIPESTATUS[0]}}"
    )
    result = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert file.exists()


def test_a_closed_output_does_not_end_a_program(tmp_path):
    command = f"{sys.executable} -m drake_twin.run --headless --duration 0.1 >&-"
    result = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


def test_output_that_a_full_disk_loses_is_exit_code_1():
    words = [sys.executable, "-m", "drake_twin.run", "--robots", "1", "--show-scenario"]
    with open("/dev/full", "w") as full:
        result = subprocess.run(words, stdout=full, stderr=subprocess.PIPE, text=True, check=False, timeout=60)
    assert result.returncode == 1
    what = "standard output cannot be written (No space left on device): a part of it is lost"
    assert result.stderr == f"error: {what}\n"


def test_say_goes_on_when_nobody_reads():
    read, write = os.pipe()
    os.close(read)
    with open(write, "w", closefd=True) as stream:
        say("hello", stream)
        say("again", stream)


def test_a_warning_while_running_is_shown_once(tmp_path):
    """Drake gives Python's root logger a handler of its own once it has something to log."""
    program = (
        "import logging, sys; from drake_twin.run import main; main(sys.argv[1:]);"
        " logging.getLogger('drake_twin.any').warning('careful'); logging.getLogger('other').warning('mind')"
    )
    command = [sys.executable, "-c", program, "--headless", "--duration", "0.01"]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    assert result.stderr == "warning: careful\nwarning: mind\n"


def test_what_is_made_while_collecting_later_is_visited_later_and_still_collected():
    class Ring:
        def __init__(self):
            self.itself = self

    collections = []
    gc.collect()
    gc.callbacks.append(lambda phase, info: collections.append(info["generation"]))
    try:
        with collecting_later():
            assert not gc.isenabled()
            watched = [weakref.ref(ring) for ring in [Ring() for _ in range(5000)]]
        assert gc.isenabled()
        further = [Ring() for _ in range(10)]
        assert collections == []
        assert len(further) == 10
    finally:
        gc.callbacks.pop()
    assert gc.get_freeze_count() == 0
    gc.collect()
    assert {ring() for ring in watched} == {None}


def test_a_program_says_how_numpys_threads_wait_before_it_imports_numpy(monkeypatch):
    code = "import sys, drake_twin.run, drake_twin.check; print('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "False\n"
    monkeypatch.delenv("OPENBLAS_THREAD_TIMEOUT", raising=False)
    assert run_program(lambda arguments: int(os.environ["OPENBLAS_THREAD_TIMEOUT"]), []) == 4
    monkeypatch.setenv("OPENBLAS_THREAD_TIMEOUT", "20")  # the user's
    assert run_program(lambda arguments: int(os.environ["OPENBLAS_THREAD_TIMEOUT"]), []) == 20
