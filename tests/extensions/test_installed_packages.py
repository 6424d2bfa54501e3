"""Kinds of installed packages: each is one file that an entry point names, and works on the command line."""

import json
import os
import shutil
import subprocess
import sys
from math import cos, pi
from pathlib import Path
from urllib.request import urlopen

import pytest
from entered_page import entered

FOLDER = Path(__file__).parent
STONE = """<robot name="stone"><link name="stone"><inertial><mass value="{mass}"/>
<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>{more}</robot>"""
ARM = """<robot name="arm"><link name="world"/><link name="a"><inertial><mass value="1"/>
<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="world"/><child link="a"/><axis xyz="0 0 1"/>
<limit effort="500" velocity="50"/></joint>{more}</robot>"""
WITH_VELOCITY = """<ros2_control name="s" type="system">
<hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
<joint name="j"><command_interface name="velocity"/><state_interface name="position"/></joint></ros2_control>"""
WITH_SPRING = """<gazebo><plugin filename="libothers_spring.so" name="spring">
<joint>j</joint><angle>0.7</angle></plugin></gazebo>"""
WITH_HEIGHT = """<gazebo reference="stone"><sensor name="height" type="height"><topic>altitude</topic>
<update_rate>100</update_rate></sensor></gazebo>"""
ROW = '<launch><row file="$(dirname)/stone.urdf" count="3" gap="2.0"/></launch>'
HALF = """<launch><node pkg="ros_gz_sim" exec="create"
args="-name stone -file $(dirname)/stone.urdf -x $(half 3) -z 50"/></launch>"""

ASKER = """
import rclpy
from std_srvs.srv import Trigger

rclpy.init()
node = rclpy.create_node("asker")
for name in ("/highest_robot", "/high/altimeter/height"):
    client = node.create_client(Trigger, name)
    found = client.wait_for_service(timeout_sec=0.1)
    future = client.call_async(Trigger.Request())
    if found:
        rclpy.spin_until_future_complete(node, future)
    print(name, future.result().message if found else "is not there")
"""


class Packages:
    """A folder of installed packages, and the programs that find them."""

    def __init__(self, folder):
        self.folder, self._site = folder, folder / "site"

    def write(self, name, text):
        file = self.folder / name
        file.write_text(text)
        return file

    def install(self, module, group):
        """Install a package of one module, which its entry point of a group names."""
        info = self._site / f"{module}-1.0.dist-info"
        info.mkdir(parents=True)
        shutil.copy(FOLDER / f"{module}.py", self._site)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[{group}]\nmine = {module}\n")

    def options(self, program, *arguments):
        path = os.pathsep.join(filter(None, (str(self._site), os.environ.get("PYTHONPATH", ""))))
        environment = os.environ | {"PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, "-m", f"drake_twin.{program}", *map(str, arguments)]
        return {"args": command, "env": environment, "text": True, "cwd": self.folder}

    def run(self, *arguments, program="run"):
        return subprocess.run(**self.options(program, *arguments), capture_output=True, check=False)

    def robots(self, target, *arguments):
        """What the summary of half a second says of each robot, and what is printed as well."""
        file = self.folder / "summary.json"
        result = self.run(target, "--headless", "--duration", "0.5", "--summary", file, *arguments)
        assert result.returncode == 0, result.stderr
        return json.loads(file.read_text())["robots"], result.stderr


@pytest.fixture
def packages(tmp_path):
    return Packages(tmp_path)


def test_a_controller(packages):
    packages.write("arm.urdf", ARM.format(more=WITH_VELOCITY))
    packages.write(
        "controllers.yaml",
        "controller_manager: {ros__parameters: {wave: {type: others_pkg/Wave}}}\n"
        "wave: {ros__parameters: {joint: j, amplitude: 2.0}}\n",
    )
    scenario = packages.write(
        "scenario.yaml", "robots:\n- {name: arm, model: arm.urdf, controllers: [controllers.yaml]}\n"
    )
    assert "type others_pkg/Wave is not supported" in packages.robots(scenario)[1]
    packages.install("wave_controller", "drake_twin.controllers")
    robots, printed = packages.robots(scenario)
    assert "not supported" not in printed
    integral = 2.0 * (1 - cos(2 * pi * 0.5)) / (2 * pi)  # of the wave, but for a servo's lag and a hold of 10 ms
    assert robots["arm"]["positions"] == [pytest.approx(integral, abs=0.03)]


def test_a_sensor_and_a_wire(packages):
    file = packages.write("stone.urdf", STONE.format(mass=1, more=WITH_HEIGHT))
    scenario = packages.write("scenario.yaml", "robots:\n- {name: stone, model: stone.urdf, xyz: [0, 0, 50]}\n")
    assert "sensor 'height' of type height on 'stone'" in packages.run(file, program="check").stdout
    packages.install("height_sensor", "drake_twin.sensors")
    assert "--lines" not in packages.run("--help").stdout
    packages.install("lines_wire", "drake_twin.wires")
    assert packages.run("--help").stdout.count("--lines FILE") == 2
    packages.robots(scenario, "--lines", "lines.txt")
    lines = [line.split() for line in (packages.folder / "lines.txt").read_text().splitlines()]
    topics = (("/clock", "12", 1000), ("/stone/altitude", "12", 100))  # CDR: 4 of a header, then 8 bytes
    for name, size, rate in topics:
        times = [float(time) for time, topic, _ in lines if topic == name]
        assert times[: rate // 2] == pytest.approx([index / rate for index in range(rate // 2)])
        assert len(times) <= rate // 2 + 1
        assert {length for _, topic, length in lines if topic == name} == {size}


def test_a_gazebo_plugin(packages):
    file = packages.write("arm.urdf", ARM.format(more=WITH_SPRING))
    robots, printed = packages.robots(file)
    assert "spring (libothers_spring.so): the twin has no such plugin" in printed
    assert robots["arm"]["positions"] == [0.0]
    packages.install("spring_plugin", "drake_twin.gazebo_plugins")
    robots, printed = packages.robots(file)
    assert "libothers_spring" not in printed
    assert robots["arm"]["positions"] == [pytest.approx(0.7, abs=1e-3)]


@pytest.mark.parametrize("group", ["drake_twin.launch_actions", "launch.frontend.launch_extension"])
def test_a_launch_action(packages, group):
    packages.write("stone.urdf", STONE.format(mass=1, more=""))
    file = packages.write("row.launch.xml", ROW)
    result = packages.run(file, "--headless", "--duration", "0.5")
    assert result.returncode == 2
    assert "row.launch.xml:1: <row>: unknown element" in result.stderr
    packages.install("row_action", group)
    robots, _ = packages.robots(file)
    assert {name: robot["base_pose"][0] for name, robot in robots.items()} == {f"stone_{i}": 2.0 * i for i in range(3)}


@pytest.mark.parametrize("group", ["drake_twin.substitutions", "launch.frontend.launch_extension"])
def test_a_substitution(packages, group):
    packages.write("stone.urdf", STONE.format(mass=1, more=""))
    file = packages.write("half.launch.xml", HALF)
    result = packages.run(file, "--headless", "--duration", "0.5")
    assert result.returncode == 2
    assert "unknown substitution $(half …)" in result.stderr
    packages.install("half_substitution", group)
    robots, _ = packages.robots(file)
    assert robots["stone"]["base_pose"][0] == 1.5


def test_a_repair(packages):
    file = packages.write("stone.urdf", STONE.format(mass=2500, more=""))
    assert "grams" not in packages.run(file, program="check").stdout
    packages.install("mass_repair", "drake_twin.repairs")
    printed = packages.run(file, program="check").stdout
    assert "a mass of 2500 kg is taken for grams" in printed
    assert "mass_in_grams" in printed


def test_a_panel(packages):
    packages.install("horn_panel", "drake_twin.page_panels")
    options = packages.options("run", "--robots", "1", "--no-browser")
    with subprocess.Popen(**options, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as program:
        try:
            url = program.stdout.readline().removeprefix("page: ").strip()
            with urlopen(f"{entered(url)}files/panel_horn.js") as script:
                text = script.read().decode()
                assert text.startswith("\nexport default")
                assert f'"""{text}"""' in (FOLDER / "horn_panel.py").read_text()
        finally:
            program.terminate()
            program.communicate()


def test_services(packages):
    packages.write("stone.urdf", STONE.format(mass=1, more=""))
    robots = ", ".join(
        f"{{name: {name}, model: stone.urdf, xyz: [0, 0, {z}]}}" for name, z in (("low", 1), ("high", 50))
    )
    command = (
        packages.write("two.yaml", f"robots: [{robots}]"),
        "--node",
        packages.write("asker.py", ASKER),
        "--headless",
    )
    printed = packages.run(*command, "--duration", "0.5").stdout
    assert "/highest_robot is not there\n/high/altimeter/height is not there\n" in printed
    packages.install("highest_service", "drake_twin.services")
    printed = packages.run(*command, "--duration", "0.5").stdout
    assert "/highest_robot high\n/high/altimeter/height 50\n" in printed


KINDS = {
    "controllers": ("wave_controller", "  others_pkg/Wave: Writes "),
    "sensors": ("height_sensor", "  height: Publishes the height of a link's origin above where it started (m). "),
    "gazebo_plugins": ("spring_plugin", "  libothers_spring.so"),
    "repairs": ("mass_repair", "  mass_in_grams: Take a mass of more than a ton for one in grams. "),
    "launch_actions": ("row_action", '  row: ``<row file="FILE" count="3" gap="2.0"/>``'),
    "substitutions": ("half_substitution", "  half: ``$(half NUMBER)``. "),
    "services": ("highest_service", "  /highest_robot"),
    "wires": ("lines_wire", "  lines: ``--lines FILE``. "),
    "page_panels": ("horn_panel", "  horn"),
}


def test_all_are_listed_with_their_documentation_and_module(packages):
    for group, (module, _) in KINDS.items():
        packages.install(module, f"drake_twin.{group}")
    lines = packages.run("--show-kinds").stdout.splitlines()
    for group, (module, start) in KINDS.items():
        assert any(f"(drake_twin.{group}):" in line for line in lines)
        (line,) = [line for line in lines if line.startswith(start)]
        assert line.endswith(f"({module})")
    assert "  imu: Measure orientation, angular velocity and specific force at a point of a link." in lines


def test_a_package_that_cannot_be_imported_is_named_by_whoever_needs_it(packages):
    packages.write("stone.urdf", STONE.format(mass=1, more=""))
    packages.install("row_action", "drake_twin.repairs")  # whose imports are there only while launch files run
    result = packages.run("stone.urdf", "--headless", "--duration", "0.5")
    assert result.returncode == 2
    assert "the entry point mine = row_action of drake_twin.repairs cannot be loaded" in result.stderr
