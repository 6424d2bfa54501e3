"""Topics of events: who hears what, when, and that nobody pays while nobody listens."""

import gc
import logging
import threading
import weakref

import pytest
from conftest import rovers

from drake_twin.errors import InputError
from drake_twin.twin.event_topics import PARAMETER_EVENTS, ROSOUT, EventTopics
from drake_twin.twin.owner import Owner
from drake_twin.twin.rosout import TwinLog, put_line


@pytest.fixture
def clock():
    return [0.0]


@pytest.fixture
def topics(clock):
    return EventTopics(Owner(), lambda: clock[0])


def log(topics, text):
    put_line(topics[ROSOUT], time=0.5, level=20, name="a.b", text=text, place=("/f.py", "go", 7))


def event(topics, node, made=None):
    def fields():
        if made is not None:
            made.append(node)
        return {"node": node}

    topics[PARAMETER_EVENTS].put(fields)


def test_who_comes_late_gets_the_lines_of_the_last_ten_seconds(topics, clock):
    """The lifespan and the depth of rcl's qos_profile_rosout_default."""
    log(topics, "old")
    clock[0] = 5.0
    log(topics, "young")
    clock[0] = 10.5
    heard = []
    topics[ROSOUT].subscribe(lambda line: heard.append(line.msg))
    assert heard == []
    topics.deliver()
    log(topics, "new")
    topics.deliver()
    assert heard == ["young", "new"]


def test_no_more_than_the_depth_is_kept(topics):
    for number in range(1005):
        log(topics, str(number))
    heard = []
    topics[ROSOUT].subscribe(lambda line: heard.append(line.msg))
    topics.deliver()
    assert heard == [str(number) for number in range(5, 1005)]


def test_a_line_of_a_time_that_has_not_come_after_a_reset_is_not_kept(topics, clock):
    clock[0] = 5.0
    log(topics, "before the reset")
    clock[0] = 0.0
    heard = []
    topics[ROSOUT].subscribe(heard.append)
    topics.deliver()
    assert heard == []


def test_a_volatile_topic_keeps_nothing_and_makes_nothing_while_nobody_listens(topics):
    made, heard = [], []
    event(topics, "/a", made)
    end = topics[PARAMETER_EVENTS].subscribe(lambda message: heard.append(message.node))
    event(topics, "/b", made)
    topics.deliver()
    end()
    event(topics, "/c", made)
    topics.deliver()
    assert (made, heard) == (["/b"], ["/b"])
    assert not topics.is_waiting


def test_one_message_is_made_for_all(topics):
    heard = []
    for _ in range(2):
        topics[PARAMETER_EVENTS].subscribe(heard.append)
    topics[PARAMETER_EVENTS].subscribe(lambda draft: heard.append(draft.message()), drafts=True)
    event(topics, "/a")
    topics.deliver()
    assert len(heard) == 3
    assert all(message is heard[0] for message in heard)


def test_who_ends_while_messages_wait_hears_no_more(topics):
    heard, ends = [], []

    def hear(line):
        heard.append(line.msg)
        ends[0]()

    ends.append(topics[ROSOUT].subscribe(hear))
    log(topics, "first")
    log(topics, "second")
    topics.deliver()
    assert heard == ["first"]


@pytest.fixture
def twin():
    with rovers(1).build() as twin:
        yield twin


WRONG_SIZE = "/robot_1/forward_velocity_controller/commands"


def test_what_the_twin_logs_is_on_rosout_with_the_nodes_name(twin):
    heard = []
    twin.subscribe(ROSOUT, lambda line: heard.append((twin.time, line)))
    twin.advance_to(0.25)
    with pytest.raises(InputError):
        twin.publish(WRONG_SIZE, [1.0])
    logging.getLogger("drake_twin.anything").warning("of the %s", "twin")
    twin.advance_to(0.5)
    (_, failed), (_, own) = heard
    assert [time for time, _ in heard] == [0.25, 0.25]
    assert (failed.name, failed.level) == ("robot_1.controller_manager", failed.ERROR)
    assert (failed.stamp.sec, failed.stamp.nanosec) == (0, 250_000_000)
    assert "forward_velocity_controller is deactivated" in failed.msg
    assert (failed.function, failed.file.rpartition("/")[2]) == ("deactivate", "robot_control.py")
    assert (own.name, own.level, own.msg) == ("drake_twin", own.WARN, "of the twin")
    assert (own.file, own.function) == (__file__, "test_what_the_twin_logs_is_on_rosout_with_the_nodes_name")


def test_a_controller_manager_tells_what_it_does_as_ros2_control(twin):
    """The texts are those of Jazzy's controller_manager.cpp."""
    heard, name = [], "forward_velocity_controller"
    twin.subscribe(ROSOUT, heard.append)
    manager = twin.control.manager("robot_1")
    manager.switch_controller(deactivate=[name])
    manager.unload_controller(name)
    manager.load_controller(name)
    manager.configure_controller(name)
    manager.switch_controller(activate=[name, "nobody"], strictness=2)  # all or nothing
    manager.switch_controller(activate=[name])
    twin.advance_to(0.1)
    assert {(line.name, line.level) for line in heard} == {("robot_1.controller_manager", 20)}
    assert [line.msg for line in heard] == [
        f"Deactivating controllers: [ {name} ]",
        "Successfully switched controllers!",
        f"Unloading controller: '{name}'",
        f"Loading controller : '{name}' of type 'forward_command_controller/ForwardCommandController'",
        f"Configuring controller: '{name}'",
        f"Activating controllers: [ {name} ]",
        "Successfully switched controllers!",
    ]


def test_the_package_has_no_handler_of_a_twin_that_nobody_listens_to(twin, monkeypatch):
    log = logging.getLogger("drake_twin")
    monkeypatch.setattr(log, "handlers", [])
    ends = [twin.subscribe(ROSOUT, lambda line: None) for _ in range(2)]
    assert len(log.handlers) == 1
    for end in ends:
        end()
    assert log.handlers == []
    twin.subscribe(ROSOUT, lambda line: None)
    twin.close()
    assert log.handlers == []


def test_a_program_without_handlers_still_prints_warnings_once(monkeypatch, capsys):
    """As Python's handler of last resort does while there is no other one."""
    for name in (None, "drake_twin"):
        monkeypatch.setattr(logging.getLogger(name), "handlers", [])
    ends = []
    for _ in range(2):
        topics = EventTopics(Owner(), lambda: 0.0)
        TwinLog(topics[ROSOUT])
        ends.append(topics[ROSOUT].subscribe(lambda line: None))
    logging.getLogger("drake_twin.x").warning("seen")
    assert capsys.readouterr().err == "seen\n"
    for end in ends:
        end()
    logging.getLogger("drake_twin.x").warning("seen")
    assert capsys.readouterr().err == "seen\n"


def test_a_twin_that_nobody_keeps_is_not_kept_by_who_listens(monkeypatch):
    log = logging.getLogger("drake_twin")
    monkeypatch.setattr(log, "handlers", [])
    topics = EventTopics(Owner(), lambda: 0.0)
    TwinLog(topics[ROSOUT])
    topics[ROSOUT].subscribe(lambda line: None)
    gone = weakref.ref(topics[ROSOUT])
    assert len(log.handlers) == 1
    del topics
    gc.collect()
    assert gone() is None
    assert log.handlers == []


def test_lines_of_other_threads_come_in_the_thread_that_advances_the_twin(twin):
    threads = []
    twin.subscribe(ROSOUT, lambda line: threads.append(threading.get_ident()))
    other = threading.Thread(target=logging.getLogger("drake_twin.other").warning, args=("from elsewhere",))
    other.start()
    other.join()
    twin.advance_to(0.1)
    assert threads == [threading.get_ident()]


def test_lines_come_while_the_twin_is_paused(twin):
    heard = []
    twin.subscribe(ROSOUT, lambda line: heard.append(line.msg))
    twin.pause()
    logging.getLogger("drake_twin.anything").warning("while paused")
    twin.run(each_frame=lambda: not heard)
    assert (heard, twin.time) == (["while paused"], 0.0)


def test_a_callback_of_a_line_may_pause_the_twin(twin):
    twin.subscribe(ROSOUT, lambda line: twin.pause())
    twin.subscribe("/clock", lambda _: logging.getLogger("drake_twin.x").warning("stop") if twin.time > 0.2 else None)
    assert twin.advance_to(1.0) < 0.5


def test_the_topics_are_among_the_others(twin):
    topics = twin.graph.topics()
    assert topics[ROSOUT] == "rcl_interfaces/msg/Log"
    assert topics[PARAMETER_EVENTS] == "rcl_interfaces/msg/ParameterEvent"
    assert twin.latest(ROSOUT) is None
    with pytest.raises(InputError, match="/rosout"):
        twin.subscribe("/rosou", lambda line: None)
