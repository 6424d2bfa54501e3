import logging

from conftest import rovers
from nodes.node_runs import script

from drake_twin.cockpit.message_log import MessageLog


def test_records_become_lines_with_level_and_simulation_time():
    log = MessageLog()
    log.add("not started", "rviz2")
    log.time = 1.5
    log.handle(logging.LogRecord("drake_twin.x", logging.ERROR, "", 0, "it %s", ("broke",), None))
    first, last = log.as_plain()
    assert (first["level"], first["text"], first["time"]) == ("not started", "rviz2", None)
    assert (last["level"], last["text"], last["time"]) == ("error", "it broke", 1.5)


def test_a_line_that_comes_again_is_counted_and_the_oldest_are_dropped():
    log = MessageLog()
    for _ in range(5):
        log.add("warning", "again")
    (line,) = log.as_plain()
    assert line["times"] == 5
    version = log.version
    for number in range(300):
        log.add("warning", str(number))
    assert log.version > version
    lines = log.as_plain()
    assert len(lines) == 200
    assert lines[-1]["text"] == "299"
    assert lines[-1]["number"] > lines[0]["number"]


def test_a_warning_that_comes_again_among_others_is_counted_where_it_stands():
    log = MessageLog()
    for time in (1.0, 2.0, 3.0):
        log.time = time
        log.add("warning", "robot_1 is stopped")
        log.add("warning", "robot_2 is stopped")
    assert [(line["text"], line["times"], line["time"]) for line in log.as_plain()] == [
        ("robot_1 is stopped", 3, 3.0),
        ("robot_2 is stopped", 3, 3.0),
    ]


def test_an_error_that_comes_again_is_the_last_line():
    log = MessageLog()
    for text in ("no such file", "no such robot", "no such file"):
        log.add("error", text)
    assert [(line["text"], line["times"]) for line in log.as_plain()] == [("no such robot", 1), ("no such file", 2)]


NODE = """
class My(Node):
    def __init__(self):
        super().__init__("talker")
        self.get_logger().debug("not enabled")
        self.get_logger().error("it broke")
"""


def test_lines_of_node_programs_are_there_and_the_packages_own_only_once(tmp_path):
    log = MessageLog()
    with rovers(1).node(script(tmp_path, "node.py", NODE)).build() as twin:
        log.follow(twin)
        logging.getLogger("drake_twin.anything").warning("of the twin")
        twin.advance_to(0.1)
        logging.getLogger("drake_twin.anything").warning("later")
        twin.advance_to(0.2)
        log.end()
        logging.getLogger("drake_twin.anything").warning("after the end")
        twin.advance_to(0.3)
    assert [(line["level"], line["text"], line["times"]) for line in log.as_plain()] == [
        ("warning", "of the twin", 1),
        ("error", "talker: it broke", 1),
        ("warning", "later", 1),
    ]
