"""A signal ends what is built: at the next step of it, or at the next import."""

import importlib
import sys
import threading

import pytest

from drake_twin.cli.build_line import build_line
from drake_twin.progress import tell

MODULE = "this"  # which nothing else imports


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr("drake_twin.cli.build_line._PATIENCE", -1.0)
    monkeypatch.delitem(sys.modules, MODULE, raising=False)


def built(stopped, do):
    with build_line(stopped):
        tell("before")
        stopped.append(2)
        do()
    pytest.fail("it continues")


def import_as_drake_does():
    try:
        importlib.import_module(MODULE)
    except KeyboardInterrupt as error:
        raise ImportError("initialization failed") from error


@pytest.mark.parametrize(
    "do",
    [lambda: tell("reading"), lambda: importlib.import_module(MODULE), import_as_drake_does],
    ids=["step", "import", "import by Drake"],
)
def test_a_signal_ends_what_is_built(impatient, do):
    with pytest.raises(KeyboardInterrupt):
        built([], do)
    tell("afterwards")
    importlib.import_module(MODULE)


def test_another_error_stays_what_it_is(impatient):
    with pytest.raises(ImportError, match="nothing"), build_line([2]):
        raise ImportError("nothing")


def test_what_another_thread_imports_is_not_interrupted(impatient):
    with build_line([2]):
        thread = threading.Thread(target=importlib.import_module, args=(MODULE,))
        thread.start()
        thread.join()
    assert MODULE in sys.modules
