"""gz-sim's PerformerDetector (gz-sim-performer-detector-system): who enters and leaves a region, and when."""

from math import sin, sqrt

import pytest

from drake_twin import TwinBuilder
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.recording import Recording, replay
from drake_twin.scenario import World

G = 9.8  # SDF's default

# A box that falls from 10 m; its volume reaches 0.5 m below it.
BOX = """<model name="box"><pose>5 0 10 0 0 0</pose><link name="link"><inertial><mass>1</mass></inertial></link></model>
"""
PERFORMERS = """<plugin name="gz::sim" filename="dummy"><performer name="falling"><ref>box</ref>
<geometry><box><size>2 2 1</size></box></geometry></performer></plugin>"""
# A body on a rail, moved by a velocity.
SLIDER = """<sdf version="1.9"><model name="slider"><link name="rail"/>
<joint name="to_world" type="fixed"><parent>world</parent><child>rail</child></joint>
<link name="mass"><inertial><mass>2</mass></inertial></link>
<joint name="slide" type="prismatic"><parent>rail</parent><child>mass</child><axis><xyz>1 0 0</xyz></axis></joint>
<plugin filename="gz-sim-joint-controller-system" name="gz::sim::systems::JointController">
<joint_name>slide</joint_name><topic>/go</topic></plugin>{}</model></sdf>"""
SIZE = "<geometry><box><size>4 4 2</size></box></geometry>"


def detector(more=SIZE):
    name = "gz::sim::systems::PerformerDetector"
    return f'<plugin filename="gz-sim-performer-detector-system" name="{name}">{more}</plugin>'


def gate(more=SIZE, pose="5 0 4 0 0 0", name="gate"):
    return f'<model name="{name}"><static>1</static><pose>{pose}</pose><link name="l"/>{detector(more)}</model>'


@pytest.fixture
def build(tmp_path):
    """Builds a twin of a world with a box that falls, and the slider."""

    def of(of_world=PERFORMERS, of_slider="", time_step=0.001):
        (tmp_path / "slider.sdf").write_text(SLIDER.format(of_slider))
        (tmp_path / "w.sdf").write_text(f"<sdf version='1.9'><world name='w'>{BOX}{of_world}</world></sdf>")
        world = World(file=str(tmp_path / "w.sdf"))
        return TwinBuilder(world=world, time_step=time_step).robot("slider", tmp_path / "slider.sdf").build()

    return of


def heard(twin, topic):
    found = []
    twin.subscribe(topic, lambda message: found.append((twin.time, message)))
    return found


def entries(message):
    return {item.key: item.value for item in message.values}


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_a_falling_box_is_noticed_when_the_boxes_meet_and_when_they_part(build, time_step):
    """The region is from 3 m to 5 m, the box from 0.5 m below its middle to 0.5 m above: inside from 5.5 to 2.5 m."""
    twin = build(PERFORMERS + gate(), time_step=time_step)
    topic = "/model/gate/performer_detector/status"
    poses, headers = heard(twin, topic), heard(twin, f"{topic}/header")
    twin.advance_to(1.5)
    times = [time for time, _ in poses]
    for time, height in zip(times, (5.5, 2.5), strict=True):
        assert time == pytest.approx(sqrt(2 * (10 - height) / G), abs=2 * time_step)
    assert [entries(message) for _, message in headers] == [
        {"frame_id": "gate", "state": "1", "count": "1"},
        {"frame_id": "gate", "state": "0", "count": "0"},
    ]
    assert [message.name for _, message in headers] == ["box", "box"]


def test_the_pose_is_in_the_frame_of_the_model_that_has_the_region(build):
    twin = build(PERFORMERS + gate(pose="5 0 4 0 0 0.7"))
    poses = heard(twin, "/model/gate/performer_detector/status")
    twin.advance_to(1.0)
    _, message = poses[0]
    assert message.header.frame_id == "gate"
    assert message.header.stamp.nanosec == pytest.approx(1e9 * poses[0][0])
    assert message.pose.position.z == pytest.approx(1.5, abs=0.01)
    assert message.pose.orientation.z == pytest.approx(-sin(0.35))


@pytest.mark.parametrize(("x", "y"), [(1, 0), (-1, 0), (0, 1), (0, -1)])
@pytest.mark.parametrize(("distance", "count"), [(2.95, 2), (3.05, 0)])
def test_boxes_beside_each_other_meet_at_the_sum_of_their_half_sides(build, x, y, distance, count):
    """The region's is 2 m, the performer's 1 m."""
    twin = build(PERFORMERS + gate(pose=f"{5 + x * distance} {y * distance} 4 0 0 0"), time_step=0.01)
    poses = heard(twin, "/model/gate/performer_detector/status")
    twin.advance_to(1.4)
    assert len(poses) == count


def test_the_region_is_put_beside_its_model_and_is_not_turned_with_it(build):
    """Its offset is in the model's axes: of a model turned by half a turn, 3 m along y are -3 m in the world.

    The region is 1 m and the box 1 m from its middle to its side: they meet within 2 m along the axes of the world.
    """
    region = "<geometry><box><size>2 2 2</size></box></geometry><pose>0 3 0 1 0 0</pose>"
    turned = gate(region, pose="3.1 3 4 0 0 3.14159265")
    twin = build(PERFORMERS + turned)
    poses = heard(twin, "/model/gate/performer_detector/status")
    twin.advance_to(1.0)
    assert len(poses) == 1
    twin = build(PERFORMERS + turned.replace("3.1 3 4", "2.9 3 4"))
    poses = heard(twin, "/model/gate/performer_detector/status")
    twin.advance_to(1.0)
    assert poses == []


def test_a_moving_model_may_have_the_region_and_a_robot_may_be_a_performer(build):
    """The root of the slider does not move: its region waits for the box, and it stands itself in that of the gate."""
    both = PERFORMERS.replace(
        "</plugin>", '<performer name="p"><ref>slider</ref><geometry><box/></geometry></performer></plugin>'
    )
    header = "<header_data><key>kind</key><value>own</value></header_data><header_data><key>none</key></header_data>"
    twin = build(
        both + gate(pose="0 0 0 0 0 0"),
        detector(f"<topic>/seen</topic><pose>5 0 0 0 0 0</pose>{SIZE}{header}"),
    )
    at_gate, seen = heard(twin, "/model/gate/performer_detector/status/header"), heard(twin, "/seen/header")
    twin.advance_to(1.6)
    assert [(time, message.name) for time, message in at_gate] == [(pytest.approx(0.001), "slider")]
    (time, message), _ = seen
    assert message.name == "box"
    assert entries(message) == {"frame_id": "slider", "state": "1", "count": "1", "kind": "own"}
    assert time == pytest.approx(sqrt(2 * (10 - 1.5) / G), abs=2e-3)


def test_a_trigger_hears_it_and_knows_who_and_whether(build):
    match = """<match field="header.data">{key: "state", value: "0"}</match><match field="name">"box"</match>"""
    other = match.replace('"box"', '"someone"')
    name = 'filename="gz-sim-triggered-publisher-system" name="gz::sim::systems::TriggeredPublisher"'
    trigger = (
        f'<plugin {name}><input type="gz.msgs.Pose" topic="/model/gate/performer_detector/status">{{}}</input>'
        '<output type="gz.msgs.Double" topic="/go">data: {}</output></plugin>'
    )
    twin = build(PERFORMERS + gate() + trigger.format(match, 1.5) + trigger.format(other, 9))
    twin.advance_to(1.2)
    assert twin.robot_state("slider").velocities[0] == 0.0
    twin.advance_to(1.5)
    assert twin.robot_state("slider").velocities[0] == pytest.approx(1.5, abs=1e-3)
    assert not [item for item in twin.findings if "plugin" in item.what]


def test_it_goes_on_from_a_snapshot_and_is_repeated_to_the_same_bits(build, tmp_path):
    twin = build(PERFORMERS + gate())
    headers = heard(twin, "/model/gate/performer_detector/status/header")
    twin.recorder.begin()
    twin.advance_to(1.1)
    snapshot = twin.snapshot()
    assert snapshot.detected == [["gate", 0, ["box"]]]
    twin.advance_to(1.5)
    end = twin.state_sha256()
    twin.recorder.recording().save(tmp_path / "run.json")
    twin.restore(snapshot)
    assert twin.snapshot() == snapshot
    twin.advance_to(1.5)
    assert twin.state_sha256() == end
    assert [entries(message)["state"] for _, message in headers] == ["1", "0", "0"]
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == end
    twin.reset()
    twin.advance_to(1.1)
    assert entries(headers[-1][1]) == {"frame_id": "gate", "state": "1", "count": "1"}


def test_a_performer_that_is_deleted_is_no_longer_inside(build):
    other = '<performer name="p"><ref>slider</ref><geometry><box/></geometry></performer></plugin>'
    twin = build(PERFORMERS.replace("</plugin>", other) + gate())
    twin.advance_to(1.1)
    twin.entities.delete("box")
    twin.advance_to(1.2)
    assert twin.snapshot().detected == []
    twin = build(PERFORMERS + gate())
    twin.advance_to(1.1)
    twin.entities.place("gate", (9, 9, 9))  # which builds the diagram again
    assert twin.snapshot().detected == [["gate", 0, ["box"]]]
    twin.advance_to(1.101)
    assert twin.snapshot().detected == []


@pytest.mark.parametrize(
    ("world", "why"),
    [
        (PERFORMERS + gate("<geometry><sphere/></geometry>"), "<geometry> with a <box> is missing"),
        (PERFORMERS + detector(), "it has to be in a model"),
        (PERFORMERS.replace("<ref>box</ref>", "") + gate(), "a <performer> has no <ref>"),
        (
            PERFORMERS.replace(
                "</plugin>", '<performer name="p"><ref>box</ref><geometry><box/></geometry></performer></plugin>'
            ),
            "falling and p are performers of one model, box",
        ),
        (PERFORMERS.replace("box</ref>", "cat</ref>") + gate(), "performer falling: no model is called 'cat'"),
    ],
)
def test_what_cannot_work_is_a_finding(build, world, why):
    twin = build(world)
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert why in finding.what
    assert finding.lines
    twin.advance_to(0.1)


@pytest.mark.parametrize(
    ("world", "why"),
    [
        (
            PERFORMERS.replace("2 2 1", "2 2") + gate(),
            "w.sdf:2: <plugin filename='dummy'>: <size> is '2 2', which is not 3",
        ),
        (PERFORMERS + gate(SIZE.replace("4 4 2", "4 -4 2")), "<size> is '4 -4 2', and has to be three numbers of zero"),
        (PERFORMERS + gate(SIZE + "<pose>a</pose>"), "<pose> is 'a', which is not 6 finite numbers"),
        (PERFORMERS + gate(SIZE + "<pose>1 2 inf 0 0 0</pose>"), "<pose> is '1 2 inf 0 0 0', which is not 6 finite"),
    ],
)
def test_a_bad_value_is_refused_with_its_file_and_line(build, world, why):
    with pytest.raises(InputError) as raised:
        build(world)
    assert why in str(raised.value)
    assert "w.sdf:" in str(raised.value)


def test_levels_are_all_there_and_nothing_is_said_of_them(build):
    level = "<level name='one'><pose>1 2 3 0 0 0</pose><geometry><box/></geometry><ref>box</ref></level>"
    twin = build(PERFORMERS.replace("</plugin>", f"{level}</plugin>") + gate())
    assert not [item for item in twin.findings if "level" in item.what or "gz::sim" in item.what]
