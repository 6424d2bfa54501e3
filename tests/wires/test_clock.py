"""``/clock`` as Gazebo has it: each physics step, and while time stands still."""

from struct import unpack

import pytest
from conftest import rovers
from local_wire import LocalSender, LocalWire

from drake_twin import InputError
from drake_twin.run import main
from drake_twin.twin.stepper import Stepper
from drake_twin.wires.bag_wire import BagWire
from drake_twin.wires.seam import Seam


def wired(**options):
    twin, wire = rovers(1, **options).build(), LocalWire()
    return twin, wire, Seam(twin, [wire])


def ticks(sent):
    """The times of clock messages (ns), which must be those at which they are said to be published."""
    found = []
    for data, time in sent:
        seconds, nanoseconds = unpack("<iI", data[4:])
        assert seconds * 1_000_000_000 + nanoseconds == time
        found.append(time)
    return found


@pytest.mark.parametrize(("rate", "period"), [(0.0, 1), (50.0, 20), (1000.0, 1), (1e6, 1), (300.0, 10 / 3)])
def test_the_clock_ticks_at_the_chosen_rate_each_time_once(rate, period):
    twin, wire, seam = wired(clock_rate=rate)
    sent = wire.hear("/clock")
    twin.inbox.work()
    twin.advance_to(0.1)
    seam.close()
    expected = [-(-round(1000 * k * period) // 1000) * 1_000_000 for k in range(round(100 / period) + 1)]
    assert ticks(sent) == expected


def test_a_python_callback_sees_each_step_at_its_time():
    twin, seen = rovers(1).build(), []
    twin.subscribe("/clock", lambda message: seen.append((message.clock.nanosec, round(twin.time * 1e9))))
    twin.advance_to(0.02)
    assert [stamp for stamp, _ in seen] == [1_000_000 * step for step in range(20)]
    assert all(stamp == time for stamp, time in seen)


def test_the_simulation_does_not_stop_for_ticks_and_they_go_before_what_is_measured_then(monkeypatch):
    stops = []
    advance = Stepper._advance_once
    monkeypatch.setattr(Stepper, "_advance_once", lambda self, target: (stops.append(0), advance(self, target))[1])
    order = []
    monkeypatch.setattr(
        LocalSender, "send", lambda self, data, time: self.topic.latched or order.append((time, self.topic.name))
    )
    twin, wire, seam = wired()
    for topic in ("/clock", "/robot_1/joint_states"):
        wire.hear(topic)
    twin.inbox.work()
    twin.advance_to(0.1)
    seam.close()
    assert len(stops) == 10  # as many as joint states
    assert order == sorted(order, key=lambda item: (item[0], item[1] != "/clock"))
    assert [name for _, name in order].count("/clock") == 101


def test_who_comes_late_hears_the_stamps_that_others_hear():
    twin, wire, seam = wired(clock_rate=100.0)
    twin.advance_to(0.0123)
    sent = {topic: wire.hear(topic) for topic in ("/clock", "/robot_1/joint_states", "/tf")}
    twin.inbox.work()
    twin.advance_to(0.102)
    seam.close()
    for topic, period in (("/clock", 10), ("/robot_1/joint_states", 10), ("/tf", 50)):
        first = -(-12 // period) * period
        assert [time for _, time in sent[topic]] == [1_000_000 * time for time in range(first, 102, period)]


def test_who_comes_late_gets_the_time_of_a_paused_twin(monkeypatch):
    now = [100.0]
    monkeypatch.setattr("drake_twin.wires.seam.monotonic", lambda: now[0])
    twin, wire, seam = wired()
    twin.advance_to(0.05)
    twin.pause()
    sent = wire.hear("/clock")
    for wall, expected in ((100.0, 1), (100.05, 1), (100.101, 2), (100.102, 2), (109.0, 3)):
        now[0] = wall
        twin.inbox.work()
        seam.flush()
        assert ticks(sent) == [50_000_000] * expected
    twin.play()
    now[0] = 110.0
    twin.inbox.work()
    twin.advance_to(0.053)
    seam.close()
    assert ticks(sent)[3:] == [50_000_000, 51_000_000, 52_000_000, 53_000_000]


def test_a_bag_does_not_grow_while_time_stands_still(monkeypatch, tmp_path):
    now = [100.0]
    monkeypatch.setattr("drake_twin.wires.seam.monotonic", lambda: now[0])
    written = []
    twin = rovers(1).build()
    seam = Seam(twin, [BagWire(tmp_path / "bag", ["/clock"])])
    monkeypatch.setattr(BagWire, "write", lambda self, kind, number, time, content: written.append(time))
    twin.advance_to(0.003)
    twin.pause()
    for _ in range(3):
        now[0] += 1.0
        twin.inbox.work()
    seam.close()
    assert written == [0, 1_000_000, 2_000_000, 3_000_000]


@pytest.mark.parametrize("rate", [-1.0, 2e6])
def test_an_impossible_rate_is_refused(rate):
    with pytest.raises(InputError, match=r"clock_rate: .* Hz is out of bounds: valid are 0 to 1e\+06 Hz"):
        rovers(1, clock_rate=rate).scenario()


def test_the_command_line_sets_the_rate(capsys):
    assert main(["--robots", "1", "--clock-rate", "250", "--show-scenario"]) == 0
    assert "clock_rate: 250" in capsys.readouterr().out
    assert main(["--robots", "1", "--clock-rate", "0"]) == 2
    assert "--clock-rate 0: the value must be above zero" in capsys.readouterr().err
