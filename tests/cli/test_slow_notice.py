"""What a run that is slow is told."""

import pytest
from conftest import rovers

from drake_twin import TwinBuilder
from drake_twin.cli import slow_notice
from drake_twin.cli.slow_notice import SlowNotice, slow_text
from drake_twin.errors import RunError
from drake_twin.scenario import World
from drake_twin.twin import step_costs as step_costs_module
from drake_twin.twin.step_costs import step_costs

BOX = """<sdf version="1.9"><world name="w"><model name="ground"><static>true</static><link name="l">
<collision name="c"><geometry><plane><normal>0 0 1</normal><size>9 9</size></plane></geometry></collision>
</link></model>
<model name="crate"><pose>5 0 0.1 0 0 0</pose><link name="l"><inertial><mass>1</mass>
<inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>
<collision name="c"><geometry><box>
<size>.2 .2 .2</size></box></geometry></collision></link></model></world></sdf>"""


def standing(builder):
    twin = builder.build()
    twin.advance_to(0.3)
    return twin


def test_four_wheels_touch_the_world_in_four_points():
    costs = step_costs(standing(rovers(2)))
    assert costs.pairs == {("the world", "robot_1"): 4, ("the world", "robot_2"): 4}
    assert not costs.has_faces
    assert 0.0 < costs.contact < costs.step


def test_a_crate_has_the_most_and_its_faces(tmp_path):
    (tmp_path / "w.sdf").write_text(BOX)
    rover = "package://rover_description/urdf/rover.urdf.xacro"
    builder = TwinBuilder(time_step=0.01, world=World(file=str(tmp_path / "w.sdf"))).robot("r", rover, xyz=(0, 0, 0.13))
    costs = step_costs(standing(builder))
    assert costs.has_faces
    assert next(iter(costs.pairs)) == ("the world", "crate")


def test_measuring_changes_nothing():
    measured, plain = standing(rovers(2)), standing(rovers(2))
    step_costs(measured)
    assert measured.state_sha256() == plain.state_sha256()
    for twin in (measured, plain):
        twin.advance_to(0.6)
    assert measured.state_sha256() == plain.state_sha256()


@pytest.fixture
def clock(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(slow_notice, "_now", lambda twin: (now[0], now[0], twin.clock.simulated))
    return now


def test_half_of_real_time_is_told_once(clock, capsys):
    twin = standing(rovers(1))
    notice = SlowNotice(twin)
    for clock[0] in (4.0, 5.5, 6.0, 20.0):
        twin.advance_to(twin.time + 0.1)
        notice.look()
    told = capsys.readouterr().err
    assert told.startswith("slow: 0.036 times real time (")  # 0.2 s in 5.5 s
    assert told.count("\n") == 1


@pytest.mark.parametrize("rate", [1.0, 0.1])
def test_what_is_fast_enough_or_was_wanted_slow_is_not_told(clock, capsys, rate):
    twin = standing(rovers(1))
    twin.clock.real_time_rate = rate
    notice = SlowNotice(twin)
    clock[0] = 6.0
    twin.advance_to(twin.time + (4.0 if rate == 1.0 else 0.6))
    notice.look()
    assert capsys.readouterr().err == ""


def test_a_pause_does_not_count(clock, capsys):
    twin = standing(rovers(1))
    notice = SlowNotice(twin)
    twin.pause()
    clock[0] = 60.0
    notice.look()
    twin.play()
    clock[0] = 66.0
    twin.advance_to(twin.time + 5.0)
    notice.look()
    assert capsys.readouterr().err == ""


def test_what_is_named_is_what_costs(tmp_path):
    twin = standing(rovers(2))
    text = slow_text(twin, 1e-6)  # so that physics is all of it
    assert "the world and robot_1: 4, the world and robot_2: 4" in text
    assert "--time-step auto" in text
    assert "contact: point" not in text
    assert "messages, sensors, nodes and page" in slow_text(twin, 1000.0)


def test_a_step_that_fails_does_so_by_itself(clock, capsys, monkeypatch):
    def fail(*_):
        raise RunError("the next step fails")

    twin = standing(rovers(1))
    monkeypatch.setattr(step_costs_module, "touching", fail)
    notice = SlowNotice(twin)
    clock[0] = 6.0
    twin.advance_to(twin.time + 0.1)
    notice.look()
    assert capsys.readouterr().err == ""
