"""Lines of loggers as rclpy's logging API documents them: levels, once, the first left out, at most so often."""

from types import SimpleNamespace

import pytest

from drake_twin.nodes.rclpy.logging import LoggingSeverity, RcutilsLogger, get_logger


@pytest.fixture
def task(monkeypatch):
    """The thread of a node program, with its simulation time (ns)."""
    found = SimpleNamespace(now=0, program=SimpleNamespace(rclpy={}))
    monkeypatch.setattr("drake_twin.nodes.rclpy.logging.here", lambda: found)
    monkeypatch.setattr("drake_twin.nodes.rclpy.impl.logging_levels.here", lambda: found)
    monkeypatch.setattr("drake_twin.nodes.rclpy.clock.present_task", lambda: found)
    return found


def said(capsys):
    return [line.rpartition(": ")[2] for line in capsys.readouterr().err.splitlines()]


def test_a_line_has_its_level_the_time_and_the_logger(task, capsys):
    task.now = 1_500_000_000
    logger = get_logger("nav")
    assert logger.info("it is info") is True
    assert logger.warn("it is warn") is True
    assert logger.warning("it is warning") is True
    assert logger.error("it is error") is True
    assert logger.fatal("it is fatal") is True
    assert logger.debug("hidden") is False
    assert logger.get_child("map").info("deep") is True
    assert capsys.readouterr().err.splitlines() == [
        "[INFO] [1.500000000] [nav]: it is info",
        "[WARN] [1.500000000] [nav]: it is warn",
        "[WARN] [1.500000000] [nav]: it is warning",
        "[ERROR] [1.500000000] [nav]: it is error",
        "[FATAL] [1.500000000] [nav]: it is fatal",
        "[INFO] [1.500000000] [nav.map]: deep",
    ]


def test_a_logger_has_a_level(task, capsys):
    logger = get_logger("nav")
    logger.set_level(LoggingSeverity.ERROR)
    assert logger.get_effective_level() == LoggingSeverity.ERROR
    assert [logger.warn("no"), logger.error("yes"), logger.is_enabled_for(LoggingSeverity.INFO)] == [False, True, False]
    assert said(capsys) == ["yes"]


def test_once_is_once_for_each_line_of_code(task, capsys):
    logger = RcutilsLogger("nav")
    assert [logger.info(f"{number}", once=True) for number in range(3)] == [True, False, False]
    assert logger.info("other", once=True) is True
    assert said(capsys) == ["0", "other"]


def test_the_first_may_be_left_out(task, capsys):
    logger = RcutilsLogger("nav")
    assert [logger.info(f"{number}", skip_first=True) for number in range(3)] == [False, True, True]
    assert said(capsys) == ["1", "2"]


def test_a_throttle_lets_one_line_through_in_its_time(task, capsys):
    logger = RcutilsLogger("nav")
    for tenth in (*range(12), 1, 2):  # at last the simulation starts again
        task.now = tenth * 100_000_000
        logger.info(f"{tenth}", throttle_duration_sec=0.5)
    assert said(capsys) == ["0", "5", "10", "1"]


def test_a_logger_needs_a_name():
    with pytest.raises(ValueError, match="must not be empty"):
        get_logger("")
