"""The services that gz-sim's TriggeredPublisher (gz-sim-triggered-publisher-system) calls when it hears a message."""

import logging

import pytest

from drake_twin import TwinBuilder
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.recording import Recording, replay
from drake_twin.scenario import World

G = 9.8  # SDF's default

# A box that falls; its link stands 0.2 m above its model's frame.
BOX = """<model name="box"><pose>5 0 10 0 0 0</pose><link name="link"><pose>0 0 0.2 0 0 0</pose>
<inertial><mass>1</mass></inertial></link></model>"""
# A robot in the air, whose root is 1 m in front of its model's frame, with a wheel that an effort of 0 N·m drives.
ROVER = """<sdf version="1.9"><model name="rover"><link name="body"><pose>1 0 0 0 0 0</pose>
<inertial><mass>2</mass></inertial></link><link name="wheel"><pose>1 0 0 0 0 0</pose></link>
<joint name="turn" type="revolute"><parent>body</parent><child>wheel</child><axis><xyz>0 1 0</xyz></axis></joint>
<plugin filename="gz-sim-apply-joint-force-system" name="gz::sim::systems::ApplyJointForce">
<joint_name>turn</joint_name></plugin></model></sdf>"""
STONE = "<model name='stone'><link name='link'><inertial><mass>3</mass></inertial></link></model>"


def service(name, kind, message, more=""):
    request = f'reqType="gz.msgs.{kind}" repType="gz.msgs.Boolean" timeout="3000" reqMsg="{message}"'
    own = 'filename="gz-sim-triggered-publisher-system" name="gz::sim::systems::TriggeredPublisher"'
    call = f'<service name="{name}" {request}></service>'
    return f'<plugin {own}><input type="gz.msgs.Empty" topic="/start"/>{more}{call}</plugin>'


CREATE = service(
    "/world/w/create",
    "EntityFactory",
    f"sdf: &quot;{STONE.replace('<', '&lt;')}&quot;, allow_renaming: true, pose: {{position: {{x: -4, z: 30}}}}",
)
REMOVE = service("/world/w/remove", "Entity", "name: 'box', type: MODEL")
MOVE = service("/world/w/set_pose", "Pose", "name: 'box', position: {x: -3, z: 7}")


@pytest.fixture
def build(tmp_path):
    """Builds a twin of a world with a box that falls, and the rover."""

    def of(plugins, time_step=0.001):
        (tmp_path / "rover.sdf").write_text(ROVER)
        (tmp_path / "w.sdf").write_text(f"<sdf version='1.9'><world name='w'>{BOX}\n{plugins}</world></sdf>")
        builder = TwinBuilder(world=World(file=str(tmp_path / "w.sdf")), time_step=time_step)
        return builder.robot("rover", tmp_path / "rover.sdf", xyz=(0, 0, 20)).build()

    return of


def started(build, plugins, time=0.1):
    twin = build(plugins)
    twin.advance_to(time)
    twin.publish("/start", {})
    return twin


def test_a_model_is_moved_by_its_frame_and_keeps_its_velocity(build):
    twin = started(build, MOVE)
    twin.step()
    state = twin.entities.state("box")
    assert state.position == pytest.approx((-3, 0, 7.2), abs=2e-3)
    assert state.linear[2] == pytest.approx(-G * 0.101)
    assert not [item for item in twin.findings if "trigger" in item.what]


def test_a_robot_is_turned_about_its_frame(build):
    """Half a turn about the model's frame puts the root link, 1 m in front of it, 1 m behind it."""
    pose = "name: 'rover', position: {x: 3, y: 2, z: 50}, orientation: {z: 2}"
    twin = started(build, service("/world/w/set_pose", "Pose", pose))
    twin.step()
    state = twin.entities.state("rover")
    assert state.position == pytest.approx((2, 2, 50), abs=2e-3)
    assert [abs(part) for part in state.orientation] == pytest.approx([0, 0, 0, 1])


def test_several_models_are_moved_by_one_request(build):
    poses = "pose: {name: 'box', position: {z: 3}}, pose: {name: 'rover', position: {z: 4}}"
    twin = started(build, service("/world/w/set_pose_vector", "Pose_V", poses))
    twin.step()
    assert twin.entities.state("box").position == pytest.approx((0, 0, 3.2), abs=2e-3)
    assert twin.entities.state("rover").position == pytest.approx((1, 0, 4), abs=2e-3)


def test_models_come_and_go_and_all_others_keep_their_state(build):
    twin = started(build, CREATE + REMOVE)
    twin.advance_to(0.2)
    assert twin.robots == ("rover", "stone")
    assert "box" not in twin.latest("/model_states").name
    # It has fallen for 0.1 s, the rover for 0.2 s.
    assert twin.entities.state("stone").position == pytest.approx((-4, 0, 30 - G / 2 * 0.01), abs=2e-3)
    assert twin.entities.state("rover").position[2] == pytest.approx(20 - G / 2 * 0.04, abs=2e-3)
    twin.publish("/start", {})
    twin.advance_to(0.3)
    assert twin.robots == ("rover", "stone", "stone_1")


def test_what_the_trigger_publishes_comes_before_the_service_and_both_after_the_delay(build):
    more = '<delay_ms>50</delay_ms><output type="gz.msgs.Int32" topic="/told">data: 7</output>'
    twin = build(service("/world/w/set_pose", "Pose", "name: 'box'", more))
    heard = []
    twin.subscribe("/told", lambda message: heard.append(twin.entities.state("box").position[2] > 5))
    twin.publish("/start", {})
    twin.advance_to(0.05)
    assert twin.entities.state("box").position[2] > 9
    twin.advance_to(0.06)
    assert twin.entities.state("box").position[2] < 1
    assert len(heard) == 1


def test_the_world_is_paused_and_is_reset(build):
    twin = started(build, service("/world/w/control", "WorldControl", "pause: true"))
    assert twin.advance_to(0.2) == pytest.approx(0.1)
    assert twin.clock.paused
    twin = started(build, service("/world/w/control", "WorldControl", "reset: {all: true}"))
    assert twin.advance_to(0.2) == 0.0
    assert not twin.clock.paused
    twin.advance_to(0.2)
    assert twin.entities.state("box").position[2] == pytest.approx(10.2 - G / 2 * 0.04, abs=2e-3)


def test_a_recording_is_repeated_to_the_same_bits_and_a_snapshot_goes_on(build, tmp_path):
    control = "/world/w/control", "WorldControl"
    others = service(*control, "pause: true").replace("/start", "/stop"), service(*control, "reset: {all: true}")
    twin = build(CREATE + REMOVE + others[0] + others[1].replace("/start", "/again"))
    twin.recorder.begin()
    twin.advance_to(0.05)
    twin.publish("/again", {})
    twin.advance_to(0.3)
    assert twin.time == 0.0
    twin.advance_to(0.03)
    twin.publish("/start", {})
    snapshot = twin.snapshot()
    twin.advance_to(0.2)
    twin.publish("/stop", {})
    twin.advance_to(0.3)
    twin.play()
    twin.advance_to(0.3)
    assert twin.robots == ("rover", "stone")
    end = twin.state_sha256()
    twin.recorder.recording().save(tmp_path / "run.json")
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == end
    twin.restore(snapshot)
    assert twin.robots == ("rover",)
    twin.advance_to(0.3)
    assert twin.robots == ("rover", "stone")
    assert twin.state_sha256() == end


def test_a_request_that_cannot_be_done_is_logged_once_for_each_cause(build, caplog):
    twin = started(build, service("/world/w/set_pose", "Pose", "name: 'cat'"))
    with caplog.at_level(logging.WARNING):
        twin.advance_to(0.2)
        twin.publish("/start", {})
        twin.advance_to(0.3)
    (line,) = [record.getMessage() for record in caplog.records]
    assert line.startswith("/world/w/set_pose: Entity [cat] does not exist.")


@pytest.mark.parametrize(
    ("plugin", "why"),
    [
        (service("/world/w/set_physics", "Physics", "x: 1"), "the twin has no service /world/w/set_physics"),
        (service("/marker", "Marker", "id: 1"), "the twin has no service /marker"),
        (
            service("/world/w/remove", "Pose", "name: 'box'"),
            "remove takes a gz.msgs.Entity, and not a gz.msgs.Pose",
        ),
        (service("/world/v/remove", "Entity", "name: 'box'"), "/world/v/remove: the world is not called 'v'"),
        (service("/world/w/control", "WorldControl", "multi_step: 5"), "no field 'multi_step' of gz.msgs.WorldControl"),
    ],
)
def test_a_service_that_the_twin_has_not_is_a_finding_and_the_rest_is_done(build, plugin, why):
    told = '<output type="gz.msgs.Int32" topic="/told">data: 7</output><service'
    twin = build(plugin.replace("<service", told, 1))
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert why in finding.what
    assert finding.lines
    heard = []
    twin.subscribe("/told", heard.append)
    twin.publish("/start", {})
    twin.advance_to(0.1)
    assert len(heard) == 1


def test_a_service_without_a_request_is_a_finding(build):
    twin = build(MOVE.replace("reqMsg", "msg"))
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith("<service> has no reqMsg")


@pytest.mark.parametrize(
    ("name", "kind", "message", "why"),
    [
        ("set_pose", "Pose", "name: 3", "'name' is 3, which is not a text"),
        ("set_pose", "Pose", "position: {x: 1}", "the pose has no name of a model"),
        ("set_pose", "Pose", "name: 'box', position: {x: 'a'}", "'x' is 'a', which is not a finite number"),
        ("set_pose", "Pose", "name 'box'", "':' is missing after 'name'"),
        ("create", "EntityFactory", "name: 'a'", "neither sdf nor sdf_filename is given"),
        ("remove", "Entity", "name: 'box', type: LIGHT", "only models can be removed, and by their names"),
        ("control", "WorldControl", "pause: 2", "'pause' is 2, which is neither true nor false"),
        ("control", "WorldControl", "reset: 2", "'reset' is 2, which is not a message in braces"),
    ],
)
def test_a_bad_request_is_refused_with_its_file_and_line(build, name, kind, message, why):
    with pytest.raises(InputError) as raised:
        build(service(f"/world/w/{name}", kind, message))
    assert "w.sdf:3: <plugin filename='gz-sim-triggered-publisher-system'>: reqMsg of <service> is " in str(
        raised.value
    )
    assert str(raised.value).endswith(f": {why}.")
