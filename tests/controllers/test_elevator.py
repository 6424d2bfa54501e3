"""gz-sim's Elevator (gz-sim-elevator-system): its cabin, its doors and its floors, and when they move."""

import pytest

from drake_twin import TwinBuilder
from drake_twin.errors import CommandError, InputError
from drake_twin.findings import Kind
from drake_twin.recording import Recording, replay
from drake_twin.scenario import World

SPEED, DOOR_SPEED, OPEN = 4.0, 2.0, 0.8  # m/s, m/s, m
HEIGHTS = (0.2, 3.2, 5.2)  # m above the model's frame; the cabin starts at the first one's
TICK = 0.1  # s

CONTROLLER = """<plugin filename="gz-sim-joint-position-controller-system"
name="gz::sim::systems::JointPositionController"><joint_name>{}</joint_name>
<use_velocity_commands>true</use_velocity_commands><cmd_max>{}</cmd_max></plugin>"""
LINK = '<link name="{}"><pose>{}</pose><inertial><mass>{}</mass></inertial></link>'
JOINT = """<joint name="{0}" type="prismatic"><parent>shaft</parent><child>{1}</child>
<axis><xyz>{2}</xyz><limit><lower>{3}</lower><upper>{4}</upper></limit></axis></joint>"""
LIDAR = """<link name="eye_0"><pose>2 -1 1 0 0 1.5707963</pose><sensor name="beam" type="gpu_lidar">
<topic>/model/tower/door_0/lidar</topic><update_rate>10</update_rate><lidar><scan><horizontal><samples>1</samples>
<min_angle>0</min_angle><max_angle>0</max_angle></horizontal></scan><range><min>0.01</min><max>2</max></range></lidar>
</sensor></link><joint name="eye" type="fixed"><parent>shaft</parent><child>eye_0</child></joint>"""


def tower(elements=""):
    parts = [LINK.format("shaft", "0.3 0 0.5 0 0 0", 100), LINK.format("cabin", "0 0 0.2 0 0 0", 20)]
    parts.append('<joint name="foot" type="fixed"><parent>world</parent><child>shaft</child></joint>')
    parts.append(JOINT.format("lift", "cabin", "0 0 1", -10, 10) + CONTROLLER.format("lift", SPEED))
    for floor, height in enumerate(HEIGHTS):
        parts.append(LINK.format(f"panel_{floor}", f"1 0 {height} 0 0 0", 5))
        parts.append(JOINT.format(f"door_{floor}", f"panel_{floor}", "0 1 0", 0, OPEN))
        parts.append(CONTROLLER.format(f"door_{floor}", DOOR_SPEED))
        # The floors' links count from the cabin's zero, as in gz-sim's models.
        parts.append(f'<link name="floor_{floor}"><pose>0 0 {height - 0.2} 0 0 0</pose></link>')
        parts.append(
            f'<joint name="fix_{floor}" type="fixed"><parent>shaft</parent><child>floor_{floor}</child></joint>'
        )
    parts.append(LIDAR)
    plugin = f'<plugin filename="gz-sim-elevator-system" name="gz::sim::systems::Elevator">{elements}</plugin>'
    text = "\n".join(parts)
    return f'<sdf version="1.9"><model name="tower">{text}\n{plugin}</model></sdf>'


BLOCK = """<sdf version="1.9"><world name="w"><model name="block"><static>1</static><pose>2 0 1 0 0 0</pose>
<link name="l"><visual name="v"><geometry><box><size>0.2 0.2 0.2</size></box></geometry></visual></link>
</model></world></sdf>"""


@pytest.fixture
def build(tmp_path):
    """Builds a twin of the tower."""

    def of(text, time_step=0.001, world=None):
        (tmp_path / "tower.sdf").write_text(text)
        (tmp_path / "w.sdf").write_text(BLOCK)
        world = World(file=str(tmp_path / "w.sdf")) if world else World()
        return TwinBuilder(world=world, time_step=time_step).robot("tower", tmp_path / "tower.sdf").build()

    return of


def position(twin, joint):
    state = twin.robot_state("tower", with_efforts=False)
    return state.positions[state.joints.index(joint)]


def time_until(twin, joint, target, latest):
    """Returns when a joint is within 1 mm of a target."""
    while abs(position(twin, joint) - target) > 1e-3:
        assert twin.time < latest, f"{joint} is at {position(twin, joint)}"
        twin.step()
    return twin.time


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_the_cabin_goes_to_the_floor_and_its_door_opens_waits_and_closes(build, time_step):
    """Each way takes its length ÷ its speed; up to a tick passes before the next one begins."""
    twin = build(tower("<open_door_wait_duration>0.5</open_door_wait_duration>"), time_step)
    floors = []
    twin.subscribe("/tower/state", lambda message: floors.append(message.data))
    twin.advance_to(0.15)
    twin.publish("/tower/cmd", {"data": 2})
    late = TICK + 3 * time_step
    height = HEIGHTS[2] - HEIGHTS[0]
    there = time_until(twin, "lift", height, 3.0)
    assert 0 <= there - 0.2 - height / SPEED <= 4 * time_step
    opened = time_until(twin, "door_2", OPEN, 3.0)
    assert 0 <= opened - there - OPEN / DOOR_SPEED <= late
    twin.advance_to(opened + 0.5 - 0.001)
    assert position(twin, "door_2") == pytest.approx(OPEN)
    closed = time_until(twin, "door_2", 0.0, 5.0)
    assert 0 <= closed - opened - 0.5 - OPEN / DOOR_SPEED <= 2 * late
    assert position(twin, "door_0") == position(twin, "door_1") == 0.0
    assert position(twin, "lift") == pytest.approx(height)
    assert floors[0] == 0
    assert sorted(set(floors)) == [0, 1, 2]
    assert floors == sorted(floors)
    assert not [item for item in twin.findings if item.kind is Kind.NOT_STARTED]


def test_floors_are_published_at_their_rate(build):
    twin = build(tower("<state_publish_rate>2</state_publish_rate><state_topic>/at</state_topic>"))
    times = []
    twin.subscribe("/tower/at", lambda message: times.append(twin.time))
    twin.advance_to(3.05)
    assert len(times) == pytest.approx(6, abs=1)
    assert times[2] - times[1] == pytest.approx(0.5, abs=0.01)


def test_a_blocked_doorway_keeps_the_door_open(build):
    """Something stands in the beam for 2 s; then the whole wait passes before the door closes."""
    twin = build(tower("<open_door_wait_duration>0.5</open_door_wait_duration>"), world=True)
    twin.publish("/tower/cmd", {"data": 0})
    opened = time_until(twin, "door_0", OPEN, 2.0)
    twin.advance_to(opened + 2.0)
    assert position(twin, "door_0") == pytest.approx(OPEN)
    twin.entities.place("block", (9, 9, 9))
    twin.advance_to(opened + 2.45)
    assert position(twin, "door_0") == pytest.approx(OPEN)
    closed = time_until(twin, "door_0", 0.0, 9.0)
    assert 0.5 <= closed - opened - 2.0 - OPEN / DOOR_SPEED <= 0.5 + 4 * TICK


def test_a_floor_that_is_asked_for_on_the_way_comes_after_the_first_door(build):
    twin = build(tower("<open_door_wait_duration>0.1</open_door_wait_duration>"))
    twin.publish("/tower/cmd", {"data": 2})
    twin.advance_to(0.3)
    twin.publish("/tower/cmd", {"data": 0})
    twin.advance_to(0.5)
    twin.publish("/tower/cmd", {"data": 1})
    order = [time_until(twin, f"door_{floor}", OPEN, 12.0) for floor in (2, 1, 0)]
    assert order == sorted(order)


def test_joints_still_follow_their_own_topics(build):
    twin = build(tower())
    twin.publish("/tower/joint/door_1/0/cmd_pos", {"data": 0.3})
    twin.advance_to(1.0)
    assert position(twin, "door_1") == pytest.approx(0.3, abs=1e-3)


def test_it_goes_on_from_a_snapshot_and_is_repeated_to_the_same_bits(build, tmp_path):
    twin = build(tower("<open_door_wait_duration>0.2</open_door_wait_duration>"), time_step=0.002)
    twin.recorder.begin()
    twin.advance_to(0.104)
    twin.publish("/tower/cmd", {"data": 1})
    twin.advance_to(0.7)
    twin.publish("/tower/cmd", {"data": 2})
    snapshot = twin.snapshot()
    twin.advance_to(2.6)
    assert position(twin, "lift") > HEIGHTS[1] - HEIGHTS[0] + 0.1
    end = twin.state_sha256()
    twin.recorder.recording().save(tmp_path / "run.json")
    twin.restore(snapshot)
    twin.advance_to(2.6)
    assert twin.state_sha256() == end
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == end
    twin.reset()
    twin.advance_to(1.0)
    assert position(twin, "lift") == pytest.approx(0.0, abs=1e-5)


def test_a_floor_that_there_is_not_is_refused(build):
    twin = build(tower())
    with pytest.raises(CommandError, match="/tower/cmd: 3 is not a floor: they are from 0 to 2"):
        twin.publish("/tower/cmd", {"data": 3})


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (tower("<cabin_joint>rope</cabin_joint>"), "the robot has no movable joint 'rope'"),
        (tower("<door_joint_prefix>gate_</door_joint_prefix>"), "the robot has no movable joint 'gate_0'"),
        (tower("<floor_link_prefix>level</floor_link_prefix>"), "the robot has no link 'level0'"),
        (tower().replace("floor_1", "floor_7"), "the robot has no link 'floor_1'"),
        (tower().replace(f"<upper>{OPEN}", "<upper>inf"), "the door 'door_0' has no upper limit to open to"),
    ],
)
def test_what_cannot_work_is_a_finding(build, text, why):
    twin = build(text)
    found = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert [item.what.endswith(why) for item in found] == [True]
    assert found[0].lines


def test_a_bad_value_is_refused_with_its_file_and_line(build):
    with pytest.raises(InputError) as raised:
        build(tower("<update_rate>fast</update_rate>"))
    what = "<plugin filename='gz-sim-elevator-system'>: <update_rate> is 'fast', which is not a number"
    assert what in str(raised.value)
    assert "tower.sdf:" in str(raised.value)


def test_parameters_of_different_lengths_are_refused(tmp_path):
    (tmp_path / "tower.sdf").write_text(tower())
    builder = TwinBuilder().robot("tower", tmp_path / "tower.sdf")
    values = {"cabin_joint": "lift", "floor_heights": [0.0, 3.0], "door_joints": ["door_0"]}
    builder.controller("tower", "other", "gz_sim/Elevator", {**values, "open_door_positions": [0.8, 0.8]})
    with pytest.raises(InputError, match="door_joints needs one entry for each of the floor_heights"):
        builder.build()
