"""gz-sim's Breadcrumbs (gz-sim-breadcrumbs-system): models that a robot drops where it is."""

import logging
from math import cos, sin

import pytest

from drake_twin import TwinBuilder
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.recording import Recording, replay

G = 9.81  # a world without a file

# A robot that flies: its root stands 0.5 m above its model's frame.
FLYER = """<sdf version="1.9"><model name="flyer"><link name="body"><pose>0 0 0.5 0 0 0</pose>
<inertial><mass>2</mass></inertial></link>
{}</model></sdf>"""
STONE = """<model name="stone"><pose>{pose}</pose><link name="l"><pose>0 0 0.25 0 0 0</pose><inertial><mass>3</mass>
</inertial></link></model>"""
TOPIC = "/model/flyer/breadcrumbs/stone/deploy"


def drops(elements="", stone=STONE, pose="1 0 0 0 0 0"):
    name = 'filename="gz-sim-breadcrumbs-system" name="gz::sim::systems::Breadcrumbs"'
    sdf = f'<breadcrumb><sdf version="1.6">{stone.format(pose=pose)}</sdf></breadcrumb>'
    return f"<plugin {name}>{elements}{sdf}</plugin>"


@pytest.fixture
def build(tmp_path):
    """Builds a twin of the flyer, which is turned by 0.7 rad."""

    def of(plugins, time_step=0.002):
        (tmp_path / "flyer.sdf").write_text(FLYER.format(plugins))
        builder = TwinBuilder(time_step=time_step)
        return builder.robot("flyer", tmp_path / "flyer.sdf", xyz=(3, 2, 50), rpy=(0, 0, 0.7)).build()

    return of


def fallen(time):
    return G / 2 * time**2


def place(twin, name):
    return twin.entities.state(name).position


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_a_model_is_dropped_beside_the_frame_of_the_robot_and_falls(build, time_step):
    """At 1 s it is 1 m in front of the robot, which has fallen G/2 · 1 s²; then it falls by itself from rest."""
    twin = build(drops(), time_step)
    twin.advance_to(1.0)
    twin.publish(TOPIC, {})
    twin.advance_to(1.5)
    assert twin.robots == ("flyer", "stone_0")
    x, y, z = place(twin, "stone_0")
    assert (x, y) == pytest.approx((3 + cos(0.7), 2 + sin(0.7)))
    late = G / 2 * time_step * 1.5  # what steps add to a fall of 1.5 s
    assert z == pytest.approx(50 + 0.25 - fallen(1.0) - fallen(0.5), abs=1.01 * late)
    assert place(twin, "flyer")[2] == pytest.approx(50.5 - fallen(1.5), rel=0.01)
    assert not [item for item in twin.findings if "readcrumb" in item.what]


def test_only_so_many_are_dropped_and_the_rest_is_told(build):
    twin = build(drops("<max_deployments>2</max_deployments><topic>/drop</topic>"))
    left = []
    twin.subscribe("/drop/remaining", lambda message: left.append(message.data))
    for count in range(3):
        twin.publish("/drop", {})
        twin.advance_to(0.1 * (count + 1))
    assert left == [1, 0, 0]
    assert twin.robots == ("flyer", "stone_0", "stone_1")


def test_what_is_asked_for_twice_in_one_step_is_dropped_twice(build):
    twin = build(drops())
    twin.publish(TOPIC, {})
    twin.publish(TOPIC, {})
    twin.step()
    assert twin.robots == ("flyer", "stone_0", "stone_1")


@pytest.mark.parametrize(("may", "names"), [("true", ("stone_0", "stone_0_1")), ("false", ("stone_0",))])
def test_a_name_that_is_taken(build, may, names, caplog):
    twin = build(drops() + drops(f"<topic>/other</topic><allow_renaming>{may}</allow_renaming>"))
    twin.publish(TOPIC, {})
    twin.step()
    twin.publish("/other", {})
    with caplog.at_level(logging.WARNING):
        twin.step()
    assert twin.robots == ("flyer", *names)
    assert ("Entity [stone_0] already exists." in caplog.text) == (may == "false")


def test_a_model_is_fixed_to_the_world_after_its_time(build):
    twin = build(drops("<disable_physics_time>0.3</disable_physics_time>"))
    twin.publish(TOPIC, {})
    twin.advance_to(0.2)
    assert place(twin, "stone_0")[2] == pytest.approx(50.25 - fallen(0.2), abs=2e-3)
    assert twin.snapshot().to_be_fixed == [[pytest.approx(0.3), "stone_0"]]
    twin.advance_to(0.6)
    height = place(twin, "stone_0")[2]
    assert height == pytest.approx(50.25 - fallen(0.3), abs=4e-3)
    assert twin.snapshot().to_be_fixed == []
    twin.advance_to(0.8)
    assert place(twin, "stone_0")[2] == height
    assert place(twin, "flyer")[2] == pytest.approx(50.5 - fallen(0.8), abs=0.02)


def test_it_goes_on_from_a_snapshot_and_is_repeated_to_the_same_bits(build, tmp_path):
    twin = build(drops("<disable_physics_time>0.2</disable_physics_time><max_deployments>2</max_deployments>"))
    twin.recorder.begin()
    twin.advance_to(0.1)
    twin.publish(TOPIC, {})
    twin.advance_to(0.2)
    snapshot = twin.snapshot()
    assert snapshot.deployed == [["flyer", "breadcrumbs", 1]]
    for time in (0.25, 0.3):
        twin.advance_to(time)
        twin.publish(TOPIC, {})
    twin.advance_to(0.6)
    assert twin.robots == ("flyer", "stone_0", "stone_1")
    end = twin.state_sha256()
    twin.recorder.recording().save(tmp_path / "run.json")
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == end
    twin.restore(snapshot)
    assert twin.robots == ("flyer", "stone_0")
    assert twin.snapshot() == snapshot
    for time in (0.25, 0.3):
        twin.advance_to(time)
        twin.publish(TOPIC, {})
    twin.advance_to(0.6)
    assert twin.state_sha256() == end


def test_after_a_reset_what_was_dropped_is_there_and_counts(build):
    twin = build(drops("<max_deployments>2</max_deployments>"))
    for _ in range(2):
        twin.publish(TOPIC, {})
        twin.advance_to(twin.time + 0.1)
        twin.reset()
    assert twin.robots == ("flyer", "stone_0", "stone_1")
    twin.publish(TOPIC, {})
    twin.advance_to(0.1)
    assert twin.robots == ("flyer", "stone_0", "stone_1")


def test_a_start_without_what_was_dropped_counts_anew(build):
    twin = build(drops("<max_deployments>1</max_deployments>"))
    scenario = twin.scenario
    for _ in range(2):
        twin.publish(TOPIC, {})
        twin.advance_to(0.1)
        assert twin.robots == ("flyer", "stone_0")
        twin.reset(scenario)
        assert twin.robots == ("flyer",)


def test_a_model_that_is_deleted_before_its_time_is_not_fixed(build):
    twin = build(drops("<disable_physics_time>0.3</disable_physics_time>"))
    twin.publish(TOPIC, {})
    twin.advance_to(0.1)
    twin.entities.delete("stone_0")
    assert twin.snapshot().to_be_fixed == []
    twin.advance_to(0.5)
    assert twin.robots == ("flyer",)


def test_none_are_dropped_where_it_is_disabled(build):
    twin = build(drops("<max_deployments>0</max_deployments>"))
    assert TOPIC not in twin.graph.topics()
    assert not [item for item in twin.findings if "readcrumb" in item.what]


@pytest.mark.parametrize(
    ("plugin", "why"),
    [
        (drops().replace("breadcrumb>", "crumb>"), "<breadcrumb> is missing"),
        (drops("<performer_volume/>"), "<geometry> with a <box> is missing"),
        (drops(stone="<light/>"), "<model> is missing in <breadcrumb>"),
        (drops().replace('<model name="stone">', "<model>"), "the <model> of its <breadcrumb> has no name"),
    ],
)
def test_what_cannot_work_is_a_finding(build, plugin, why):
    twin = build(plugin)
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith(why)
    assert finding.lines == (3,)


def test_what_is_dropped_as_a_performer_is_noticed(build):
    """The robot's own region is 1 m about its frame: the dropped volume, 2 m wide, is inside until the robot leaves."""
    volume = "<performer_volume><geometry><box><size>2 2 2</size></box></geometry></performer_volume>"
    region = "<geometry><box><size>2 2 2</size></box></geometry><topic>/near</topic>"
    name = 'filename="gz-sim-performer-detector-system" name="gz::sim::systems::PerformerDetector"'
    twin = build(drops(volume) + drops("<topic>/other</topic>") + f"<plugin {name}>{region}</plugin>")
    heard = []
    twin.subscribe("/near/header", lambda message: heard.append((message.name, message.values[1].value)))
    twin.advance_to(0.2)
    twin.publish(TOPIC, {})
    twin.advance_to(0.3)
    assert heard == [("stone_0", "1")]
    snapshot = twin.snapshot()
    twin.entities.set_state("flyer", position=(9, 9, 60))
    twin.advance_to(0.4)
    assert heard[1:] == [("stone_0", "0")]
    twin.restore(snapshot)
    twin.publish("/other", {})
    twin.advance_to(0.4)
    assert heard[2:] == []
    assert not [item for item in twin.findings if "performer" in item.what]


@pytest.mark.parametrize(
    ("plugin", "why"),
    [
        (drops("<max_deployments>1.5</max_deployments>"), "<max_deployments> is 1.5, which is not a whole number"),
        (
            drops("<disable_physics_time>x</disable_physics_time>"),
            "<disable_physics_time> is 'x', which is not a number",
        ),
        (drops("<allow_renaming>perhaps</allow_renaming>"), "<allow_renaming> is 'perhaps', which is neither true nor"),
        (drops("<performer_volume><geometry><box><size>1</size></box></geometry></performer_volume>"), "<size> is '1'"),
        (drops(pose="1 2"), "<pose> of the <breadcrumb> is '1 2', which is not six finite numbers"),
    ],
)
def test_a_bad_value_is_refused_with_its_file_and_line(build, plugin, why):
    with pytest.raises(InputError) as raised:
        build(plugin)
    assert f"flyer.sdf:3: <plugin filename='gz-sim-breadcrumbs-system'>: {why}" in str(raised.value)
