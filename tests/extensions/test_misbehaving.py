"""Kinds of other packages that misbehave: each is named and not called again, and the rest goes on."""

import gc
import re
import subprocess
import sys
import weakref
from pathlib import Path

import numpy as np
import pytest
from conftest import ARM

from drake_twin import InputError, Recording, RunError, TwinBuilder, messages, replay
from drake_twin.cli.plugins import load_plugins
from drake_twin.cockpit.others_parts import NO_STATE, make_overlay, make_panel
from drake_twin.cockpit.overlay import OVERLAY_KINDS, overlay
from drake_twin.cockpit.panel import PANEL_KINDS, panel
from drake_twin.extensions import MODULES_OF_OTHERS
from drake_twin.findings import Kind, texts
from drake_twin.plugin_watch import PluginWatch
from drake_twin.sensors import sensor
from drake_twin.sensors.registry import SENSORS
from drake_twin.sensors.sensor_system import SensorSystem
from drake_twin.services.offered import services_of
from drake_twin.services.registry import OF_TWIN, twin_service
from drake_twin.sweeps.episode import Runner, Sweep
from drake_twin.sweeps.variation import Design
from drake_twin.twin.others_code import OthersCode
from drake_twin.wires.others_wire import OthersWire
from drake_twin.wires.seam import Seam
from drake_twin.wires.wire import Nothing

TRIGGER = "std_srvs/srv/Trigger"
SCRIPT = "export default class {\n}\n"
FLOAT = "std_msgs/msg/Float64"
FOLDER = Path(__file__).parent


@pytest.fixture(autouse=True)
def passing():
    """Forget at the end what a test has registered."""
    registries, modules = (OF_TWIN, OVERLAY_KINDS, PANEL_KINDS, SENSORS), set(MODULES_OF_OTHERS)
    for registry in registries:
        registry._kinds = registry._kinds.new_child()
    yield
    for registry in registries:
        registry._kinds = registry._kinds.parents
    MODULES_OF_OTHERS.intersection_update(modules)


@pytest.fixture
def twin():
    with TwinBuilder(time_step=0.002).robot("arm", ARM).build() as twin:
        yield twin


def failed(twin):
    return texts(twin.findings, Kind.FAILED)


def plain_hash(time):
    with TwinBuilder(time_step=0.002).robot("arm", ARM).build() as twin:
        twin.advance_to(time)
        return twin.state_sha256()


def asked(twin, name="/bad"):
    (found,) = (service for service in services_of(twin) if service.name == name)
    return found.answer(None)


# Services -------------------------------------------------------------------------------------------------------------


def raises(twin, request):
    raise ZeroDivisionError("a mistake")


def ends(twin, request):
    raise SystemExit(3)


def garbage(twin, request):
    return {"no_such_field": 1}


def nothing(twin, request):
    return None


@pytest.mark.parametrize(
    ("answer", "why"),
    [
        (raises, "ZeroDivisionError: a mistake ("),
        (ends, "SystemExit: 3"),
        (garbage, "no_such_field"),
        (nothing, "Error"),
    ],
)
def test_a_service_that_fails_is_refused_from_then_on(twin, answer, why):
    calls = []

    def counted(twin, request):
        calls.append(1)
        return answer(twin, request)

    twin_service(TRIGGER, "/bad")(counted)
    for _ in range(3):
        with pytest.raises(RunError, match=r"service /bad has failed, and is not called again: "):
            asked(twin)
    assert len(calls) == 1
    (finding,) = failed(twin)
    assert finding.startswith("service /bad: ")
    assert why in finding
    twin.advance_to(0.1)
    assert twin.state_sha256() == plain_hash(0.1)


def test_what_a_service_refuses_in_words_is_no_failure(twin):
    @twin_service(TRIGGER, "/bad")
    def refuses(twin, request):
        raise InputError("not now")

    for _ in range(2):
        with pytest.raises(InputError, match="not now"):
            asked(twin)
    assert failed(twin) == ()


def test_an_answer_that_takes_several_frames_may_fail_later(twin):
    @twin_service(TRIGGER, "/bad")
    def later(twin, request):
        yield 1
        raise KeyError("late")

    answer = asked(twin)
    assert next(answer) == 1
    with pytest.raises(RunError, match="KeyError: 'late'"):
        next(answer)


def test_an_answer_that_takes_several_frames_is_returned(twin):
    @twin_service(TRIGGER, "/bad")
    def later(twin, request):
        yield 1
        return {"success": True}

    answer = asked(twin)
    next(answer)
    with pytest.raises(StopIteration) as end:
        next(answer)
    assert end.value.value == {"success": True}


def test_a_state_that_is_changed_behind_the_twins_back_is_named(twin):
    @twin_service(TRIGGER, "/bad")
    def behind(twin, request):
        plant = twin.plant
        plant.SetPositions(plant.GetMyMutableContextFromRoot(twin.context), np.full(plant.num_positions(), 0.1))
        return {"success": True}

    with pytest.raises(RunError, match="it has changed the state by Drake's own methods"):
        asked(twin)
    (finding,) = failed(twin)
    assert finding.startswith("service /bad: it has changed the state by Drake's own methods, which no recording has")
    with pytest.raises(RunError, match="is not called again"):
        asked(twin)


def test_a_state_that_is_changed_by_the_twins_methods_is_recorded(twin, tmp_path):
    @twin_service(TRIGGER, "/bad")
    def moves(twin, request):
        twin.entities.set_joint_positions("arm", {"joint_1": 0.2})
        twin.step()
        return {"success": True}

    twin.recorder.begin()
    asked(twin)
    assert failed(twin) == ()
    twin.recorder.recording().save(tmp_path / "it.json")
    assert replay(Recording.load(tmp_path / "it.json")).state_sha256() == twin.state_sha256()


# Parts of the page ----------------------------------------------------------------------------------------------------


class Good:
    def __init__(self, *given):
        self.asked = []

    def state(self):
        return {"asked": len(self.asked)}

    def ask(self, data):
        self.asked.append(data)

    def draw(self):
        pass

    def remove(self):
        pass


def broken(method, value=None):
    """A class whose method returns a value, or raises."""

    def bad(self, *given):
        if value is None:
            raise ValueError(f"in {method}")
        return value

    return type("Broken", (Good,), {method: bad})


@pytest.mark.parametrize(
    "kind", [broken("__init__"), broken("state"), broken("state", {1, 2}), broken("state", float("nan"))]
)
def test_a_panel_that_fails_has_no_state(twin, kind):
    panel("bad", SCRIPT)(kind)
    made = make_panel(PANEL_KINDS["bad"], twin)
    assert (made.state(), made.state()) == (NO_STATE, NO_STATE)
    assert len(failed(twin)) == 1
    assert failed(twin)[0].startswith("panel 'bad': ")
    with pytest.raises(InputError, match="panel 'bad' has failed, and is not called again"):
        made.ask({})
    made.watch(True)


def test_a_panel_keeps_its_last_state_and_a_good_one_works(twin):
    panel("good", SCRIPT)(Good)
    panel("bad", SCRIPT)(broken("ask"))
    good, bad = (make_panel(PANEL_KINDS[name], twin) for name in ("good", "bad"))
    assert bad.state() == {"asked": 0}
    with pytest.raises(InputError, match="in ask"):
        bad.ask({})
    good.ask({})
    assert (good.state(), bad.state()) == ({"asked": 1}, {"asked": 0})
    assert len(failed(twin)) == 1


def test_what_others_add_does_not_keep_a_twin():
    panel("good", SCRIPT)(Good)
    twin = TwinBuilder().robot("arm", ARM).build()
    make_panel(PANEL_KINDS["good"], twin).state()
    gone = weakref.ref(twin)
    del twin
    gc.collect()
    assert gone() is None


@pytest.mark.parametrize("method", ["__init__", "draw", "remove"])
def test_an_overlay_that_fails_is_not_drawn(twin, method):
    overlay("bad", "Bad")(broken(method))
    made = make_overlay(OVERLAY_KINDS["bad"], None, twin)
    for _ in range(2):
        made.draw()
        made.remove()
    assert len(failed(twin)) == 1


# Wires ----------------------------------------------------------------------------------------------------------------


class Bad:
    """A wire whose methods of one name raise."""

    def __init__(self, what):
        self._what = what
        self.calls = []

    is_heard = True

    def __getattr__(self, name):
        if name == "client":
            raise AttributeError(name)

        def call(*arguments):
            self.calls.append(name)
            if name == "advertise":
                arguments[1](True)
            if name == self._what:
                raise OSError("gone")
            return self

        return call


@pytest.mark.parametrize("what", ["advertise", "listen", "send", "close"])
def test_a_wire_that_fails_carries_nothing_and_the_twin_goes_on(twin, what):
    code, wire = OthersCode("wire 'bad'"), Bad(what)
    seam = Seam(twin, [OthersWire(wire, code)])
    code.tell(twin)
    twin.advance_to(0.1)
    assert twin.state_sha256() == plain_hash(0.1)
    seam.close()
    assert wire.calls.count(what) == 1
    assert failed(twin)[0].startswith("wire 'bad': OSError: gone")
    assert isinstance(OthersWire(wire, code).serve(None, None), Nothing)
    assert "serve" not in wire.calls


# Sensors --------------------------------------------------------------------------------------------------------------

STONE = """<robot name="stone"><link name="stone"><inertial><mass value="1"/>
<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link><gazebo reference="stone">
<sensor name="bad" type="bad"><topic>bad</topic><update_rate>100</update_rate></sensor>
<sensor name="imu" type="imu"><topic>imu</topic><update_rate>100</update_rate></sensor></gazebo></robot>"""


@pytest.mark.parametrize(
    ("value", "why"),
    [(None, "ValueError: no measurement"), ("text", "'text' is not a message"), (3.0, "is not a message")],
)
def test_a_sensor_that_fails_measures_no_more(tmp_path, value, why):
    (tmp_path / "stone.urdf").write_text(STONE)
    calls = []

    @sensor("bad")
    class Sensor(SensorSystem):
        message_type = FLOAT

        def __init__(self, setup):
            super().__init__(setup)
            self.declare_message_output(self._calc)

        def _calc(self, context, output):
            calls.append(context.get_time())
            if context.get_time() < 0.045:
                output.set_value(messages.message(FLOAT, {"data": 1.0}))
            elif value is None:
                raise ValueError("no measurement")
            else:
                output.set_value(value)

    twin, heard = TwinBuilder(time_step=0.01).robot("stone", tmp_path / "stone.urdf", xyz=(0, 0, 9)).build(), []
    twin.subscribe("/stone/bad", heard.append)
    twin.subscribe("/stone/imu", heard.append)
    twin.advance_to(0.1)
    assert len(calls) == 6
    assert [message.__msgtype__ for message in heard].count(FLOAT) == 5
    assert len(heard) == 5 + 10
    assert twin.latest("/stone/bad") is None
    (finding,) = failed(twin)
    assert finding.startswith("stone: sensor bad: ")
    assert why in finding


# What takes too long --------------------------------------------------------------------------------------------------

ENDLESS = """
from drake_twin.controllers import PeriodicController, controller, Update
from drake_twin.services.registry import twin_service


@twin_service("std_srvs/srv/Trigger", "/endless")
def endless(twin, request):
    while True:
        pass
"""


def test_an_endless_loop_is_ended(twin, tmp_path):
    (tmp_path / "endless.py").write_text(ENDLESS.replace("from drake_twin.controllers import", "# from"))
    with PluginWatch(patience=0.2, look=0.02):
        load_plugins([str(tmp_path / "endless.py")])
        with pytest.raises(RunError, match=r"service /endless has failed.*TooLongError: it has computed for too long"):
            asked(twin, "/endless")
        twin.advance_to(0.1)
    assert failed(twin)[0].startswith("service /endless: TooLongError: ")
    assert twin.state_sha256() == plain_hash(0.1)


def test_at_the_end_it_is_said_what_was_ended_and_how_often(twin, tmp_path, caplog):
    (tmp_path / "endless.py").write_text(ENDLESS.replace("from drake_twin.controllers import", "# from"))
    with PluginWatch(patience=0.2, look=0.02):
        load_plugins([str(tmp_path / "endless.py")])
        with pytest.raises(RunError, match="TooLongError"):
            asked(twin, "/endless")
        twin.advance_to(0.1)
    said = f"{tmp_path / 'endless.py'}: endless computed for too long in one call, and was interrupted, "
    assert caplog.messages[-1].startswith(said)
    assert re.fullmatch(r"\d+ times?", caplog.messages[-1].removeprefix(said))


def test_an_endless_loop_is_ended_where_threads_have_no_clock_of_the_processors_time(twin, tmp_path, monkeypatch):
    monkeypatch.delattr("time.pthread_getcpuclockid")  # as on macOS
    test_an_endless_loop_is_ended(twin, tmp_path)


def test_an_endless_loop_in_an_episode_of_a_sweep_is_its_reason(tmp_path, monkeypatch):
    monkeypatch.setattr("drake_twin.sweeps.episode.plugins_watched", lambda names: PluginWatch(0.2, 0.02))
    (tmp_path / "stone.urdf").write_text(STONE)
    (tmp_path / "endless_sensor.py").write_text(MAKES.replace('raise ValueError("boo")', "while True: pass"))
    scenario = TwinBuilder().robot("stone", tmp_path / "stone.urdf").scenario()
    load_plugins([str(tmp_path / "endless_sensor.py")])
    sweep = Sweep.of(scenario, Design(()), 0.1)
    row = Runner(sweep).run(next(sweep.design.episodes()))
    assert (row["outcome"], row["reason"].partition(" (")[0]) == (
        "error",
        "TooLongError: it has computed for too long in one call, and is ended",
    )


def test_an_endless_import_is_ended(tmp_path):
    (tmp_path / "endless_import.py").write_text("while True:\n    pass\n")
    with PluginWatch(patience=0.2, look=0.02), pytest.raises(InputError, match="TooLongError: it has computed for too"):
        load_plugins([str(tmp_path / "endless_import.py")])


def test_code_of_the_twin_and_of_tests_is_left_alone(twin):
    with PluginWatch(patience=0.0, look=0.001):
        twin.advance_to(2.0)
    assert failed(twin) == ()


# When files are read --------------------------------------------------------------------------------------------------

REPAIR = """
from drake_twin.description.repairs import repair


@repair("bad_repair")
def bad_repair(reader):
    yield reader.root, "something"
    raise KeyError("oops")
"""
PLUGIN = """
from drake_twin.description.gazebo_drive import gazebo_plugin


@gazebo_plugin("libbad.so")
def bad(plugin):
    return 1 / 0
"""
READS = """
from drake_twin.sensors import sensor
from drake_twin.sensors.sensor_system import SensorSystem


@sensor("bad")
class Bad(SensorSystem):
    message_type = "std_msgs/msg/Float64"

    @classmethod
    def read(cls, element):
        raise ValueError("boo")
"""
MAKES = READS.replace("    @classmethod\n    def read(cls, element):", "    def __init__(self, setup):")


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        (REPAIR, 1, "failed: stone: repair bad_repair: KeyError: 'oops' ("),
        (PLUGIN, 1, "failed: stone: Gazebo plugin bad (libbad.so): ZeroDivisionError: division by zero ("),
        (READS, 1, "failed: stone: sensor 'bad' of type bad on 'stone', topic bad: ValueError: boo ("),
        (MAKES, 1, "ValueError: boo: code of another package has failed (--debug: the traceback)"),
    ],
    ids=["repair", "plugin", "sensor", "made"],
)
def test_what_fails_when_files_are_read_is_a_sentence(tmp_path, text, code, said):
    gazebo = '<gazebo><plugin filename="libbad.so" name="bad"/></gazebo></robot>'
    (tmp_path / "stone.urdf").write_text(STONE.replace("</robot>", gazebo))
    (tmp_path / "bad.py").write_text(text)
    command = [sys.executable, "-m", "drake_twin.run", "stone.urdf", "--plugin", "bad.py", "--headless", "--duration"]
    run = subprocess.run([*command, "0.05"], cwd=tmp_path, capture_output=True, text=True, timeout=100, check=False)
    assert run.returncode == code, run.stdout + run.stderr
    assert said in run.stdout + run.stderr
    assert "Traceback" not in run.stderr
    assert "bad.py:" in run.stdout + run.stderr
    *_, last = run.stderr.splitlines()
    assert last.startswith("error: ")
    assert said.removeprefix("failed: ") in last
