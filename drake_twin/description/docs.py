"""The page of gz-sim's systems and what each becomes here, generated from the registries.

Generate it by ``python -m drake_twin.description.docs > drake_twin/docs/gazebo_systems.md``; a test compares the two.
"""

import inspect
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from drake_twin.description.gazebo_drive import GAZEBO_PLUGINS
from drake_twin.description.gazebo_plugins import DONE_HERE, class_kind
from drake_twin.description.unread import WHY_ABSENT
from drake_twin.description.world_plugins import WORLD_PLUGINS
from drake_twin.description.world_wrenches import WRENCH_SYSTEM, read_wrench_systems

_PACKAGE = Path(__file__).resolve().parents[1]

# The classes of gz-sim 10's systems, and the kind of their library where it does not follow from that of the class.
_SYSTEMS = """
AckermannSteering AcousticComms AdvancedLiftDrag AirPressure AirSpeed Altimeter ApplyJointForce ApplyLinkWrench
Breadcrumbs Buoyancy BuoyancyEngine CameraVideoRecorder ColladaWorldExporter CommsEndpoint Contact CpuLidar
DetachableJoint DiffDrive DopplerVelocityLogSystem=dvl DriveToPoseController Elevator EntitySemantics
EnvironmentPreload EnvironmentalSystem=environmental-sensor FollowActor ForceTorque=forcetorque FreeSpaceExplorer
Hydrodynamics Imu JointController JointPositionController JointStatePublisher JointTrajectoryController
KineticEnergyMonitor Label LedPlugin LensFlare LiftDrag LighterThanAirDynamics=lighter_than_air_dynamics
LinearBatteryPlugin=linearbatteryplugin LogPlayback=log LogRecord=log LogVideoRecorder
LogicalAudioSensorPlugin=logicalaudiosensorplugin LogicalCamera LookupWheelSlip Magnetometer MecanumDrive
ModelPhotoShoot MulticopterMotorModel MulticopterVelocityControl=multicopter-control NavSat=navsat OdometryPublisher
OpticalTactilePlugin=opticaltactileplugin ParticleEmitter PerfectComms PerformerDetector Physics PosePublisher
PythonSystemLoader RFComms=rf-comms SceneBroadcaster Sensors ShaderParam SpacecraftThrusterModel Thermal ThermalSensor
Thruster TouchPlugin=touchplugin TrackController TrackedVehicle TrajectoryFollower TriggeredPublisher UserCommands
VelocityControl WebsocketServer WheelSlip WindEffects
"""

# What reads a system that is neither a controller nor a force of the world.
_OTHERS: dict[str, Callable[..., Any]] = {WRENCH_SYSTEM: read_wrench_systems}

_INTRODUCTION = """\
# gz-sim's systems

What becomes of a `<plugin>` of a robot or a world that is one of gz-sim's own systems (gz-sim 10):

- *runs*: as upstream's sources do it, under the names of its elements and topics;
- *provided*: the twin does its work without it;
- *a finding*: it is named with its file and line, in some cases with a reason, and nothing else happens.

The files are those of `drake_twin/description/plugins/`, which name the controller or the force of the world, or of
the folder above it.

{numbers}. This page is written by `python -m drake_twin.description.docs`.

| system | here | what it becomes, or why not | file | tests |
|---|---|---|---|---|
"""


def systems() -> dict[str, str]:
    """Return gz-sim's systems: class → kind, as `drake_twin.description.gazebo_plugins.plugin_kind` names it."""
    found = {}
    for entry in _SYSTEMS.split():
        name, given, kind = entry.partition("=")
        found[name] = f"{kind}-system" if given else class_kind(name)
    return found


def systems_page(tests: Path) -> str:
    """Return the page.

    Args:
        tests: The folder of the tests, which are searched for the names of the libraries.
    """
    texts = {file: file.read_text(encoding="utf-8") for file in sorted(tests.rglob("*.py"))}
    rows, numbers = [], Counter[str]()
    for name, kind in systems().items():
        convert = GAZEBO_PLUGINS.get(kind) or WORLD_PLUGINS.get(kind) or _OTHERS.get(kind)
        support = "runs" if convert else "provided" if kind in DONE_HERE else "a finding"
        numbers[support] += 1
        what, file, held = "", "", ""
        if convert is not None:
            what, file = _outcome(convert), f"`{_file(convert)}`"
            held = ", ".join(f"`{test.name}`" for test in _about(kind, texts))
        elif kind not in DONE_HERE:
            what = next((why for part, why in WHY_ABSENT.items() if part in kind), "")
        rows.append(f"| {name} | {support} | {what} | {file} | {held} |")
    runs, provided, findings = (numbers[support] for support in ("runs", "provided", "a finding"))
    total = f"Of {numbers.total()} {runs} run, {provided} are provided, {findings} are findings"
    return _INTRODUCTION.format(numbers=total) + "\n".join(rows) + "\n"


def _outcome(convert: Callable[..., Any]) -> str:
    """Return what a plugin becomes, from the first line of the docstring of what converts it."""
    first = (inspect.getdoc(convert) or "").partition("\n")[0].rstrip(".")
    return first.partition("`` to ")[2] or first.partition("``: ")[2] or first.partition("``, ")[2]


def _file(convert: Callable[..., Any]) -> str:
    return Path(inspect.getfile(convert)).name


def _about(kind: str, texts: dict[Path, str]) -> list[Path]:
    """Return the files of tests that name the library."""
    return [file for file, text in texts.items() if f"-{kind}" in text and file.name != "test_systems_page.py"][:2]


if __name__ == "__main__":
    print(systems_page(_PACKAGE.parent / "tests"), end="")
