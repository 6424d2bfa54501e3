"""Files of every kind that the twin reads, altered at random, and a worker that tries them.

    python tests/mutations.py SEED FIRST COUNT

prints the number of each input before it is tried, ``runs`` for a twin that steps, and ``fault …`` for what ends in
anything but that or one readable error. Whoever starts it sees by the last number what killed it.
"""

import json
import logging
import random
import re
import shutil
import signal
import struct
import sys
import tempfile
import traceback
from pathlib import Path

LONGEST = 20  # s for one input
MOST_MEMORY = 2 << 30  # bytes more than an idle worker has

ROBOT = """<?xml version="1.0"?><robot name="all" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="robot_name" default="r"/><xacro:property name="size" value="${0.1 * 2}"/>
<xacro:macro name="wheel" params="name y"><link name="${name}"><inertial><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="MESH" scale="1 1 1"/></geometry></visual>
<collision><geometry><cylinder radius="${size}" length="0.05"/></geometry></collision></link>
<joint name="${name}_joint" type="continuous"><origin xyz="0 ${y} 0" rpy="-1.5708 0 0"/><parent link="base"/>
<child link="${name}"/><axis xyz="0 0 1"/><limit effort="5" velocity="20"/><dynamics damping="0.1" friction="0.1"/>
</joint></xacro:macro>
<link name="base"><inertial><mass value="5"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial>
<collision><geometry><box size="0.4 0.3 0.1"/></geometry></collision></link>
<xacro:wheel name="left" y="0.2"/><xacro:wheel name="right" y="-0.2"/>
<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
<joint name="left_joint"><command_interface name="velocity"><param name="min">-9</param></command_interface>
<state_interface name="position"><param name="initial_value">0.1</param></state_interface></joint></ros2_control>
<gazebo reference="left"><mu1>0.8</mu1><kp>1e6</kp></gazebo>
<gazebo><plugin filename="libgazebo_ros_diff_drive.so" name="drive"><left_joint>left_joint</left_joint>
<right_joint>right_joint</right_joint><wheel_separation>0.4</wheel_separation><wheel_diameter>0.4</wheel_diameter>
</plugin></gazebo></robot>"""
SDF = """<?xml version="1.0"?><sdf version="1.9"><model name="m"><pose>0 0 1 0 0 0</pose><link name="base"><inertial>
<mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial><collision name="c"><geometry>
<box><size>0.2 0.2 0.2</size></box></geometry><surface><friction><ode><mu>0.5</mu></ode></friction></surface>
</collision>
<visual name="v"><geometry><mesh><uri>MESH</uri></mesh></geometry></visual></link><link name="tip"><pose>0 0 0.3 0 0 0
</pose><sensor name="imu" type="imu"><update_rate>10</update_rate></sensor></link><joint name="j" type="revolute">
<parent>base</parent><child>tip</child><axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis>
</joint></model></sdf>"""
WORLD = """<sdf version="1.9"><world name="w"><gravity>0 0 -9.8</gravity><physics type="ode"><max_step_size>0.002
</max_step_size></physics><model name="floor"><static>true</static><link name="l"><collision name="c"><geometry><plane>
<normal>0 0 1</normal></plane></geometry></collision></link></model><model name="crate"><pose>1 0 1 0 0 0</pose><link
name="l"><collision name="c"><geometry><sphere><radius>0.2</radius></sphere></geometry></collision></link></model>
</world></sdf>"""
MJCF = """<mujoco model="m"><compiler angle="radian"/><default><joint damping="0.1"/></default><worldbody>
<body name="b" pos="0 0 1"><geom type="box" size="0.1 0.1 0.1" mass="1"/><body name="t" pos="0 0 0.2"><joint name="j"
type="hinge" axis="0 1 0" range="-1 1"/><geom type="capsule" size="0.02 0.1" mass="0.2"/></body></body></worldbody>
<actuator><motor joint="j" gear="10" ctrlrange="-1 1"/></actuator></mujoco>"""
CONTROLLERS = """controller_manager:
  ros__parameters:
    update_rate: 100
    forward: {type: velocity_controllers/JointGroupVelocityController}
    broadcaster: {type: joint_state_broadcaster/JointStateBroadcaster}
forward:
  ros__parameters:
    joints: [left_joint]
"""
SCENARIO = """robots:
- {name: a, model: robot.urdf.xacro, xyz: [0, 0, 1], controllers: [controllers.yaml]}
time_step: 0.001
commands:
- {topic: /a/forward/commands, data: [1.0], time: 0.0}
static_transforms:
- {parent: world, child: odom}
"""
LAUNCH = """<launch><arg name="n" default="a"/><group><push-ros-namespace namespace="$(var n)"/>
<node pkg="robot_state_publisher" exec="robot_state_publisher"><param name="robot_description"
value="$(command 'xacro FOLDER/robot.urdf.xacro')"/></node><node pkg="ros_gz_sim" exec="create"
args="-name $(var n) -topic robot_description -z 1"/></group><node pkg="tf2_ros" exec="static_transform_publisher"
args="--frame-id world --child-frame-id odom"/></launch>"""
OBJ = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nvn 0 0 1\nf 1//1 3//1 2//1\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
HOSTILE = [
    *("", " ", "0", "-1", "1e308", "-1e-320", "nan", "inf", "9" * 400, "é", "\x01", "../..", "/dev/zero", "true", "~"),
    *("${1/0}", "$(find nothing)", "package://none/x", "[" * 3000, "{" * 3000, "&a", "*a", "!!python/none", "<", "]]>"),
]


def stl():
    corners = [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)]
    faces = b""
    for a, b, c in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)):
        faces += struct.pack("<12fH", 0, 0, 0, *corners[a], *corners[b], *corners[c], 0)
    return b"\0" * 80 + struct.pack("<I", 4) + faces


class Kinds:
    """What is altered, and how it is tried."""

    def __init__(self, folder):
        self.folder = folder
        self.sources = {
            "robot.urdf.xacro": ROBOT.replace("MESH", "tip.stl").encode(),
            "robot.sdf": SDF.replace("MESH", "tip.obj").encode(),
            "world.sdf": WORLD.encode(),
            "robot.xml": MJCF.encode(),
            "controllers.yaml": CONTROLLERS.encode(),
            "scenario.yaml": SCENARIO.encode(),
            "main.launch.xml": LAUNCH.replace("FOLDER", str(folder)).encode(),
            "tip.stl": stl(),
            "tip.obj": OBJ.encode(),
        }
        self.write()
        from drake_twin import TwinBuilder

        twin = TwinBuilder().robot("a", folder / "robot.urdf.xacro", xyz=(0, 0, 1)).build()
        twin.recorder.begin()
        twin.step(3)
        for name, saved in (("state.json", twin.snapshot()), ("run.json", twin.recorder.recording())):
            saved.save(folder / name)
            self.sources[name] = (folder / name).read_bytes()

    def write(self):
        for name, content in self.sources.items():
            (self.folder / name).write_bytes(content)

    def attempt(self, name):
        from drake_twin import Twin, TwinBuilder
        from drake_twin.builder.launch_file import launch_file_scenario
        from drake_twin.scenario import World
        from drake_twin.scenario.scenario_file import ScenarioFile
        from drake_twin.twin.recording import Recording
        from drake_twin.twin.replay import replay
        from drake_twin.twin.snapshot import Snapshot

        file, builder = self.folder / name, TwinBuilder()
        match name:
            case "state.json":
                snapshot = Snapshot.load(file)
                twin = builder.robot("a", self.folder / "robot.urdf.xacro", xyz=(0, 0, 1)).build()
                twin.restore(snapshot)
            case "run.json":
                twin = replay(Recording.load(file))
            case "main.launch.xml":
                twin = Twin(launch_file_scenario(file).scenario)
            case "scenario.yaml":
                twin = Twin(ScenarioFile.read(file).scenario)
            case "world.sdf":
                sled = '<robot name="r"><link name="world"/></robot>'
                (self.folder / "sled.urdf").write_text(sled)
                twin = TwinBuilder(world=World(file=str(file))).robot("r", self.folder / "sled.urdf").build()
            case "robot.xml" | "robot.sdf":
                twin = builder.robot("a", file).build()
            case "tip.obj":
                twin = builder.robot("a", self.folder / "robot.sdf").build()
            case _:
                controllers = [self.folder / "controllers.yaml"] if name == "controllers.yaml" else []
                twin = builder.robot("a", self.folder / "robot.urdf.xacro", controllers=controllers).build()
        twin.step(2)


def altered(content, chance):
    """Bytes with one to three changes: of a value, of a run of bytes, of their order."""
    for _ in range(chance.randint(1, 3)):
        values = list(re.finditer(rb"(?<=[\"'>\s:,\[])[^\"'<>\s:,\[\]{}]+", content)) or [None]
        match chance.randrange(7):
            case 0 | 1 | 2 if values[0] is not None:
                value = chance.choice(values)
                content = content[: value.start()] + chance.choice(HOSTILE).encode() + content[value.end() :]
            case 3:
                at, size = chance.randrange(len(content) + 1), chance.randint(1, 40)
                content = content[:at] + content[at + size :]
            case 4:
                at, size = chance.randrange(len(content) + 1), chance.randint(1, 200)
                content = content[: at + size] + content[at:]
            case 5:
                at = chance.randrange(len(content) + 1)
                content = content[:at] + chance.randbytes(chance.randint(1, 8)) + content[at:]
            case _:
                content = content[: chance.randrange(len(content) + 1)]
    return content


def main(seed, first, count):
    import resource

    from drake_twin.errors import TwinError

    logging.disable(logging.CRITICAL)
    folder = Path(tempfile.mkdtemp(prefix="mutations_"))
    kinds = Kinds(folder)
    names = list(kinds.sources)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MOST_MEMORY, resource.RLIM_INFINITY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    for number in range(first, first + count):
        chance = random.Random(f"{seed} {number}")
        name = names[number % len(names)]
        (folder / name).write_bytes(altered(kinds.sources[name], chance))
        print(number, name, flush=True)
        signal.alarm(LONGEST)
        try:
            kinds.attempt(name)
            print("runs", flush=True)
        except TwinError as error:
            str(error).encode()
        except BaseException as error:
            where = traceback.extract_tb(error.__traceback__)[-1]
            what = f"{type(error).__name__}: {error}"[:200]
            print("fault", json.dumps([number, name, what, f"{Path(where.filename).name}:{where.lineno}"]), flush=True)
        signal.alarm(0)
        kinds.write()
    shutil.rmtree(folder)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
