"""The same bytes in every run: noise, seeds, listeners, snapshots, spawns, other steps."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from conftest import ROVER
from pydrake.geometry import Box, HalfSpace
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlant, CoulombFriction, MultibodyPlantConfig
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from rig import BODY, on_box, twin_with

from drake_twin import Twin, TwinBuilder
from drake_twin.errors import InputError
from drake_twin.messages import type_store
from drake_twin.scenario import Robot
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.twin.snapshot import Snapshot

NOISE = """<noise type="gaussian"><stddev>{}</stddev><bias_mean>0.3</bias_mean><bias_stddev>0.1</bias_stddev>
<dynamic_bias_stddev>0.2</dynamic_bias_stddev><dynamic_bias_correlation_time>0.5</dynamic_bias_correlation_time></noise>"""
AXES = "".join(f"<{axis}>{NOISE.format(0.01)}</{axis}>" for axis in "xyz")
IMU = f"""<update_rate>100</update_rate><imu><angular_velocity>{AXES}</angular_velocity>
<linear_acceleration>{AXES.replace("0.01", "0.02")}</linear_acceleration></imu>"""
MAGNETOMETER = f"<update_rate>40</update_rate><magnetometer>{AXES}</magnetometer>"
CONTACT = "<contact><collision>box_collision</collision></contact>"
SENSORS = (on_box("imu", IMU, "i"), on_box("magnetometer", MAGNETOMETER, "m"), on_box("contact", CONTACT, "c"))
TOPICS = ("/box/i/imu", "/box/m/magnetometer", "/box/c/contact")


def listen(twin, topics=TOPICS):
    """The bytes of each message by topic and time."""
    heard = {}
    for topic in topics:
        kind = twin.graph.topics()[topic]

        def take(message, topic=topic, kind=kind):
            heard[topic, round(twin.time, 9)] = bytes(type_store().serialize_cdr(message, kind))

        twin.subscribe(topic, take)
    return heard


@pytest.fixture
def first(tmp_path):
    twin = twin_with(tmp_path, *SENSORS)
    heard = listen(twin)
    twin.advance_to(0.3)
    assert len(heard) == 30 + 12 + 299  # it touches the ground from its first step on
    return heard, twin.state_sha256()


def test_another_order_of_subscribing_and_pauses_change_no_byte(tmp_path, first):
    twin = twin_with(tmp_path, *SENSORS)
    heard = listen(twin, TOPICS[::-1])
    for time in (0.05, 0.0731, 0.2, 0.3):
        twin.advance_to(time)
    assert (heard, twin.state_sha256()) == first


def test_what_nobody_heard_before_changes_no_byte(tmp_path, first):
    twin = twin_with(tmp_path, *SENSORS)
    twin.advance_to(0.2)
    heard = listen(twin, TOPICS[:1])
    twin.advance_to(0.3)
    assert len(heard) == 10
    assert heard.items() <= first[0].items()
    assert twin.state_sha256() == first[1]


def test_a_reset_repeats_and_another_seed_or_no_noise_does_not(tmp_path, first):
    twin = twin_with(tmp_path, *SENSORS)
    twin.advance_to(0.1)
    twin.reset()
    heard = listen(twin)
    twin.advance_to(0.3)
    assert heard == first[0]
    for options in ({"seed": 1}, {"sensor_noise": False}):
        other = twin_with(tmp_path, *SENSORS, **options)
        else_heard = listen(other, TOPICS[:2])
        other.advance_to(0.3)
        assert all(else_heard[key] != first[0][key] for key in else_heard)
        assert other.state_sha256() == first[1]


def test_a_snapshot_restored_in_another_twin_continues_to_the_same_bytes(tmp_path, first):
    twin = twin_with(tmp_path, *SENSORS, seed=0)
    twin.advance_to(0.151)
    twin.snapshot().save(tmp_path / "state.json")
    saved = Snapshot.load(tmp_path / "state.json")
    other = Twin(ScenarioFile(saved.scenario, "saved").scenario)
    other.restore(saved)
    heard = listen(other)
    other.advance_to(0.3)
    assert len(heard) > 150
    assert {key: value for key, value in heard.items() if key[1] > 0.151}.items() <= first[0].items()


def test_a_spawn_in_between_leaves_the_noise_as_it_was(tmp_path):
    """The plant's numbers differ in the last bits with another robot in it; the field and its noise do not."""

    def run(spawns):
        twin = twin_with(tmp_path, *SENSORS)
        fields = []
        twin.subscribe("/box/m/magnetometer", lambda message: fields.append(message.magnetic_field.x))
        twin.advance_to(0.1)
        if spawns:
            twin.entities.spawn(Robot("other", ROVER, xyz=(-3, 0, 0.13)))
        twin.advance_to(0.2)
        if spawns:
            twin.entities.delete("other")
        twin.advance_to(0.3)
        return fields

    assert run(spawns=True) == pytest.approx(run(spawns=False), abs=1e-12)


def test_another_step_leaves_the_wandering_bias_as_it_was(tmp_path):
    twin = twin_with(tmp_path, on_box("magnetometer", MAGNETOMETER, "m"))
    fields = []
    twin.subscribe("/box/m/magnetometer", lambda message: fields.append(message.magnetic_field.x))
    twin.advance_to(0.1)
    twin.clock.set_time_step(0.005)
    twin.advance_to(0.3)
    again = twin_with(tmp_path, on_box("magnetometer", MAGNETOMETER, "m"))
    expected = []
    again.subscribe("/box/m/magnetometer", lambda message: expected.append(message.magnetic_field.x))
    again.advance_to(0.3)
    assert fields == pytest.approx(expected, abs=1e-9)


def test_two_processes_publish_the_same_bytes(tmp_path):
    (tmp_path / "box.urdf").write_text(
        '<robot name="box"><link name="box"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0"'
        f' ixz="0" iyz="0"/></inertial></link>{SENSORS[0]}</robot>'
    )
    command = [sys.executable, "-m", "drake_twin.run", str(tmp_path / "box.urdf"), "--headless", "--duration", "0.05"]
    runs = set()
    for _ in range(2):
        said = subprocess.run([*command, "--echo", "/box/i/imu"], capture_output=True, check=True).stdout
        runs.add(said.rpartition(b"---")[0])  # the last line has the wall time
    assert len(runs) == 1
    assert b"angular_velocity" in runs.pop()
    summary = tmp_path / "summary.json"
    subprocess.run([*command, "--seed", "7", "--no-sensor-noise", "--summary", str(summary)], check=True)
    assert {key: json.loads(summary.read_text())[key] for key in ("seed", "sensor_noise")} == {
        "seed": 7,
        "sensor_noise": False,
    }


def test_the_seed_is_part_of_the_scenario(tmp_path):
    scenario = twin_with(tmp_path, SENSORS[0], seed=5, sensor_noise=False).scenario
    assert (scenario.seed, scenario.sensor_noise) == (5, False)
    assert ScenarioFile(scenario_to_yaml(scenario), "saved").scenario == scenario
    with pytest.raises(InputError, match="seed: -1 is below zero"):
        replace(scenario, seed=-1)


_INTERFACES = (
    *(f"orientation.{axis}" for axis in "xyzw"),
    *(f"{kind}.{axis}" for kind in ("angular_velocity", "linear_acceleration") for axis in "xyz"),
)
_STATES = "".join(f'<state_interface name="{name}"/>' for name in _INTERFACES)
BROADCASTER = (
    '<ros2_control name="s" type="sensor"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>'
    f'<sensor name="i">{_STATES}</sensor></ros2_control>'
)


def test_a_broadcaster_and_the_sensors_own_topic_have_the_same_values(tmp_path):
    (tmp_path / "box.urdf").write_text(BODY.format(SENSORS[0] + BROADCASTER))
    parameters = {"sensor_name": "i", "frame_id": "box"}
    builder = TwinBuilder().robot("box", tmp_path / "box.urdf", xyz=(0, 0, 0.1))
    kind = "imu_sensor_broadcaster/IMUSensorBroadcaster"
    twin = builder.controller("box", "b", kind, parameters).build()
    twin.advance_to(0.05)
    own, other = twin.latest("/box/i/imu"), twin.latest("/box/b/imu")
    for part in ("orientation", "angular_velocity", "linear_acceleration"):
        assert getattr(own, part) == getattr(other, part)
    assert abs(own.angular_velocity.x) > 0.05  # its bias
    assert np.asarray(own.angular_velocity_covariance).tolist() == pytest.approx([1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4])
    assert np.asarray(own.linear_acceleration_covariance)[0] == pytest.approx(4e-4)


def test_with_cenic_a_listener_changes_no_state(tmp_path):
    hashes = set()
    for listens in (False, True):
        twin = twin_with(tmp_path, *SENSORS, engine="cenic", time_step=0.01)
        heard = listen(twin) if listens else {}
        twin.advance_to(0.2)
        hashes.add(twin.state_sha256())
        assert bool(heard) == listens
    assert len(hashes) == 1


RAYS = """<update_rate>50</update_rate><lidar><scan><horizontal><samples>90</samples><min_angle>-3</min_angle>
<max_angle>3</max_angle></horizontal></scan><range><min>0.5</min><max>9</max></range></lidar>"""


@pytest.mark.parametrize("is_welded", [True, False])
def test_a_spawn_in_between_changes_no_byte_of_a_robot_that_touches_nothing(tmp_path, is_welded):
    """One that is fixed in the world, and one that falls, while a rover stands on the ground elsewhere."""
    body = BODY
    if is_welded:
        joint = '<link name="world"/><joint name="w" type="fixed"><parent link="world"/><child link="box"/></joint>{}'
        body = BODY.replace("{}", joint)
    rays = on_box("gpu_lidar", f"<pose>0 0 0 0 1.2 0</pose>{RAYS}", "l")
    topics = ("/box/i/imu", "/box/m/magnetometer", "/box/l/scan", "/box/ground_truth/odom")

    def run(spawns):
        twin = twin_with(tmp_path, *SENSORS[:2], rays, body=body, xyz=(0, 0, 3.0))
        heard = listen(twin, topics)
        for time, act in (
            (0.1, lambda: twin.entities.spawn(Robot("other", ROVER, xyz=(-30, 0, 0.13)))),
            (0.2, lambda: None),
        ):
            twin.advance_to(time)
            if spawns:
                act()
        if spawns:
            twin.entities.delete("other")
        twin.advance_to(0.3)
        return heard

    heard = run(spawns=True)
    assert len(heard) > 60
    assert heard == run(spawns=False)


@pytest.mark.parametrize(("height", "is_equal"), [(5.0, True), (0.1, False)])
def test_drake_solves_all_contacts_as_one_problem(height, is_equal):
    """Why a robot on the ground moves otherwise in the last bits beside another: a bare plant, without the twin.

    Whether the solution has converged is judged by all contacts together. If this fails, a spawn in between may change
    no byte of any robot, and the documentation of sensors is to say so.
    """

    def run(count):
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlant(MultibodyPlantConfig(time_step=0.001, contact_model="point"), builder)
        rough = CoulombFriction(1.0, 1.0)
        plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "ground", rough)
        bodies = []
        for index in range(count):
            inertia = SpatialInertia.SolidBoxWithMass(1.0 + index, 0.2, 0.2, 0.2)
            bodies.append(plant.AddRigidBody(f"body_{index}", plant.AddModelInstance(f"model_{index}"), inertia))
            plant.RegisterCollisionGeometry(bodies[-1], RigidTransform(), Box(0.2, 0.2, 0.2), f"box_{index}", rough)
        plant.Finalize()
        simulator = Simulator(builder.Build())
        context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        for index, body in enumerate(bodies):
            plant.SetFreeBodyPose(context, body, RigidTransform([3.0 * index, 0.0, 0.11 if index else height + 0.01]))
        simulator.AdvanceTo(0.2)
        return plant.GetPositionsAndVelocities(context, bodies[0].model_instance())

    alone, beside = run(1), run(2)
    assert np.array_equal(alone, beside) == is_equal
    assert beside == pytest.approx(alone, abs=1e-7)
