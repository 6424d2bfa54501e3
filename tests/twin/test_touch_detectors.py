"""gz-sim's TouchPlugin (gz-sim-touchplugin-system): what tells that a model has touched another one for some time."""

import pytest

from drake_twin import TwinBuilder
from drake_twin.description.touches import TouchDetector
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.recording import Recording, replay
from drake_twin.scenario import World

G = 9.8  # SDF's default
DROP = 0.05  # m
FALL = (2 * DROP / G) ** 0.5  # s

SENSOR = '<sensor name="s" type="contact"><contact><collision>top</collision></contact></sensor>'
SHAPE = '<collision name="{}"><geometry><box><size>{}</size></box></geometry></collision>'
PLATE = '<link name="plate">' + SHAPE.format("top", "2 2 1") + "{}</link>"
# A box that falls on the plate, whose upper side is at 0.5 m.
SIDE = SHAPE.format("side", "0.5 0.5 0.5")
BOX = f"""<model name="box"><pose>0 0 {0.5 + DROP + 0.25} 0 0 0</pose><link name="body"><inertial><mass>1</mass>
<inertia><ixx>0.04</ixx><iyy>0.04</iyy><izz>0.04</izz></inertia></inertial>{SIDE}</link></model>"""
TOPIC = "/model/stand/touch"


def touch(elements="<target>box</target><time>0.2</time><enabled>true</enabled>"):
    own = 'filename="gz-sim-touchplugin-system" name="gz::sim::systems::TouchPlugin"'
    return f"\n<plugin {own}>{elements}</plugin>"


@pytest.fixture(params=["of_world", "of_robot"])
def build(request, tmp_path):
    """Builds a twin of a stand, a static model of the world or a robot, and of a box that falls on it."""

    def of(plugin, sensor=SENSOR, time_step=0.002, more=""):
        stand = PLATE.format(sensor)
        if request.param == "of_world":
            other = f'<model name="stand"><static>1</static>{stand}{plugin}</model>'
        else:
            foot = '<joint name="foot" type="fixed"><parent>world</parent><child>plate</child></joint>'
            other = ""
            (tmp_path / "s.sdf").write_text(
                f'<sdf version="1.9"><model name="stand">{stand}{foot}{plugin}</model></sdf>'
            )
        (tmp_path / "w.sdf").write_text(f"<sdf version='1.9'><world name='w'>{BOX}{other}{more}</world></sdf>")
        builder = TwinBuilder(world=World(file=str(tmp_path / "w.sdf")), time_step=time_step)
        if request.param == "of_world":
            (tmp_path / "post.sdf").write_text('<sdf version="1.9"><model name="post"><link name="l"/></model></sdf>')
            return builder.robot("post", tmp_path / "post.sdf", xyz=(50, 0, 0)).build()
        return builder.robot("stand", tmp_path / "s.sdf").build()

    return of


def heard(twin, topic=f"{TOPIC}/touched"):
    times = []
    twin.subscribe(topic, lambda message: times.append(twin.time) if message.data else None)
    return times


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_a_touch_is_told_once_after_its_time(build, time_step):
    """The box touches after a fall of 5 cm, and is told to have done so 0.2 s later."""
    twin = build(touch(), time_step=time_step)
    times = heard(twin)
    twin.advance_to(0.5)
    assert times == [pytest.approx(FALL + 0.2, abs=3 * time_step)]
    assert not [item for item in twin.findings if "ouch" in item.what]


def test_a_message_lets_it_look_again_or_no_longer(build):
    twin = build(touch("<target>box</target><time>0.2</time><namespace>mine</namespace>"))
    times = heard(twin, "/mine/touched")
    twin.advance_to(0.5)
    assert times == []
    for enabled in (True, True, False, True):
        twin.publish("/mine/enable", {"data": enabled})
        twin.advance_to(twin.time + 0.1)
    twin.advance_to(1.2)
    assert times == [pytest.approx(0.8 + 0.2, abs=6e-3)]


def test_a_trigger_lets_it_look_by_its_service(build):
    own = 'filename="gz-sim-triggered-publisher-system" name="gz::sim::systems::TriggeredPublisher"'
    request = 'reqType="gz.msgs.Boolean" repType="gz.msgs.Empty" timeout="9" reqMsg="data: true"'
    trigger = (
        f'<plugin {own}><input type="gz.msgs.Empty" topic="/go"/><service name="/{{}}/enable" {request}/></plugin>'
    )
    twin = build(touch("<target>box</target><time>0.1</time><namespace>mine</namespace>"), more=trigger.format("mine"))
    times = heard(twin, "/mine/touched")
    twin.advance_to(0.3)
    twin.publish("/go", {})
    twin.advance_to(0.5)
    assert times == [pytest.approx(0.4, abs=6e-3)]
    twin = build(touch(), more=trigger.format("other"))
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith("it does not call a service: the twin has no service /other/enable")


def test_a_break_begins_the_time_again(build):
    twin = build(touch("<target>box</target><time>0.3</time><enabled>true</enabled>"))
    times = heard(twin)
    twin.advance_to(0.3)
    twin.entities.set_state("box", position=(0, 0, 0.75 + DROP), linear=(0, 0, 0))
    twin.advance_to(0.9)
    assert times == [pytest.approx(0.3 + FALL + 0.3, abs=8e-3)]


@pytest.mark.parametrize("target", ["box", "box::body", "body::side", "model/box/link/body", "sid"])
def test_a_target_is_a_part_of_a_name(build, target):
    twin = build(touch(f"<target>{target}</target><time>0.1</time><enabled>true</enabled>"))
    times = heard(twin)
    twin.advance_to(0.3)
    assert len(times) == 1


def test_others_do_not_count(build):
    twin = build(touch("<target>ball</target><time>0</time><enabled>true</enabled>"))
    times = heard(twin)
    twin.advance_to(0.3)
    assert times == []


def test_only_some_shapes_of_the_model_may_count():
    detector = TouchDetector("t", "box", 0.1, "/touch", collisions=("top", "stand::plate::side"))
    assert detector.is_met("stand::plate::top", "box::body::side")
    assert detector.is_met("stand::plate::side", "box::body::side")
    assert not detector.is_met("stand::plate::bottom", "box::body::side")


def test_a_trigger_hears_it(build):
    own = 'filename="gz-sim-triggered-publisher-system" name="gz::sim::systems::TriggeredPublisher"'
    trigger = (
        f'<plugin {own}><input type="gz.msgs.Boolean" topic="{TOPIC}/touched"><match>data: true</match></input>'
        '<output type="gz.msgs.Boolean" topic="/told">data: true</output></plugin>'
    )
    twin = build(touch(), more=trigger)
    times = heard(twin, "/told")
    twin.advance_to(0.5)
    assert times == [pytest.approx(FALL + 0.2, abs=8e-3)]


def test_it_goes_on_from_a_snapshot_and_is_repeated_to_the_same_bits(build, tmp_path):
    twin = build(touch())
    times = heard(twin)
    twin.recorder.begin()
    twin.advance_to(FALL + 0.1)
    snapshot = twin.snapshot()
    assert snapshot.touching == [["stand", 0, pytest.approx(FALL, abs=6e-3)]]
    twin.advance_to(0.5)
    assert twin.snapshot().touching == []
    end = twin.state_sha256()
    twin.recorder.recording().save(tmp_path / "run.json")
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == end
    twin.restore(snapshot)
    assert twin.snapshot() == snapshot
    twin.advance_to(0.5)
    assert twin.state_sha256() == end
    assert len(times) == 2
    assert times[0] == times[1]
    twin.reset()
    assert twin.snapshot().touching == [["stand", 0, None]]


def test_it_looks_on_after_a_spawn(build, tmp_path):
    twin = build(touch())
    times = heard(twin)
    twin.advance_to(FALL + 0.1)
    twin.entities.copy_model("box", "other", (5, 5, 5))
    twin.advance_to(0.5)
    assert times == [pytest.approx(FALL + 0.2, abs=6e-3)]


@pytest.mark.parametrize(
    ("plugin", "sensor", "why"),
    [
        (touch(), "", "Gazebo plugin touch_plugin: stand has no contact sensor to touch with"),
        (touch("<time>1</time>"), SENSOR, "<target> is missing"),
        (touch("<target>box</target>"), SENSOR, "<time> is missing"),
    ],
)
def test_what_cannot_work_is_a_finding(build, plugin, sensor, why):
    twin = build(plugin, sensor)
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith(why)
    assert finding.lines
    assert twin.built.detection is None or twin.built.detection.touches == ()
    twin.advance_to(0.1)


@pytest.mark.parametrize(
    ("elements", "why"),
    [
        ("<target>box</target><time>soon</time>", "<time> is 'soon', which is not a number"),
        ("<target>box</target><time>1</time><enabled>maybe</enabled>", "<enabled> is 'maybe', which is neither true"),
    ],
)
def test_a_bad_value_is_refused_with_its_file_and_line(build, elements, why):
    with pytest.raises(InputError) as raised:
        build(touch(elements))
    assert f"<plugin filename='gz-sim-touchplugin-system'>: {why}" in str(raised.value)
    assert ".sdf:" in str(raised.value)
