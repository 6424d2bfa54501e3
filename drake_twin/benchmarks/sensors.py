"""What sensors cost: while nobody listens, and for each message."""

from collections.abc import Callable
from functools import partial
from math import cos, pi, sin
from os import getpid, sysconf
from pathlib import Path
from time import process_time

from drake_twin.benchmarks.measure import by_turns, ratio
from drake_twin.benchmarks.report import Table
from drake_twin.benchmarks.size import Size
from drake_twin.builder.twin_builder import TwinBuilder
from drake_twin.dataclass import dataclass
from drake_twin.scenario import World
from drake_twin.twin.twin import Twin

_RAYS = "<samples>{}</samples><min_angle>{}</min_angle><max_angle>{}</max_angle>"
_LIDAR = (
    "<lidar><scan><horizontal>{}</horizontal><vertical>{}</vertical></scan>"
    "<range><min>0.3</min><max>30</max></range></lidar>"
)
_AROUND = f"{-pi}", f"{pi}"
_CAMERA = (
    "<camera><horizontal_fov>1.2</horizontal_fov><image><width>640</width><height>480</height></image>"
    "<clip><near>0.05</near><far>30</far></clip></camera>"
)
_BOXES = 100


@dataclass(frozen=True)
class _Kind:
    """A sensor of each robot.

    Attributes:
        what: What a message is.
        type: The ``type`` of its tag.
        rate: Of its messages (Hz).
        inside: The rest of its element.
        topic: The topic below the robot's namespace.
    """

    what: str
    type: str
    rate: float
    inside: str
    topic: str

    @property
    def name(self) -> str:
        """The sensor's name."""
        return self.topic.partition("/")[0]

    def text(self) -> str:
        """Return the sensor's tag."""
        given = f"<update_rate>{self.rate:g}</update_rate><pose>0 0 0.15 0 0 0</pose>{self.inside}"
        return f'<sensor name="{self.name}" type="{self.type}">{given}</sensor>'


_KINDS = (
    _Kind("IMU", "imu", 100.0, "", "imu/imu"),
    _Kind("contacts", "contact", 100.0, "<contact><collision>box_collision</collision></contact>", "bumper/contact"),
    _Kind("scan of 360 rays", "gpu_lidar", 10.0, _LIDAR.format(_RAYS.format(360, *_AROUND), ""), "lidar/scan"),
    _Kind(
        "points of 16 x 1,800 rays",
        "gpu_lidar",
        10.0,
        _LIDAR.format(_RAYS.format(1800, *_AROUND), _RAYS.format(16, -0.26, 0.26)),
        "cloud/scan/points",
    ),
    _Kind("picture of 640 x 480", "camera", 10.0, _CAMERA, "camera/image"),
    _Kind("depths of 640 x 480", "depth_camera", 10.0, _CAMERA, "depth/depth_image"),
)
_LISTENED = (_KINDS[0], _KINDS[2])  # in the table of runs; others cost what their messages do


def sensors(size: Size) -> list[Table]:
    """Measure runs of robots with sensors beside those without, and the processor time of a message of each kind."""
    world = size.folder / "room.sdf"
    world.write_text(_room(), encoding="utf-8")
    runs = [row for count in size.counts for row in _runs(size, world, count)]
    costs = [row for count in size.counts for row in _costs(size, world, count)]
    columns = ("robots", "sensor", "ms of the twin for a message", "ms of the process that draws")
    return [
        Table(
            "sensors",
            f"Processor time of runs of robots with {len(_KINDS)} sensors each, 1 ms steps",
            ("robots", "listened to", "÷ robots without sensors"),
            tuple(runs),
        ),
        Table("sensors", "Processor time of a message", columns, tuple(costs)),
    ]


def _runs(size: Size, world: Path, count: int) -> list[tuple[int, str, float]]:
    cases = {"no sensors": _twin(size, world, count, with_sensors=False), "nothing": _twin(size, world, count)}
    for kind in _LISTENED:
        what = f"{kind.what} of each at {kind.rate:g} Hz"
        cases[what] = _twin(size, world, count)
        for index in range(count):
            topic = f"/robot_{index}/{kind.topic}"
            if topic in cases[what].graph.topics():
                cases[what].subscribe(topic, lambda message: None)
    span = max(0.1, 0.2 * size.scale)

    def go(twin: Twin) -> None:
        twin.advance_to(twin.time + span)

    for twin in cases.values():
        go(twin)  # the first message makes what others share
    times = by_turns({name: partial(go, twin) for name, twin in cases.items()}, 2 * size.repeats, process_time)
    return [(count, name, ratio(times, name, "no sensors")) for name in cases if name != "no sensors"]


def _costs(size: Size, world: Path, count: int) -> list[tuple[int, str, float | None, float | None]]:
    rows: list[tuple[int, str, float | None, float | None]] = []
    with _twin(size, world, count) as twin:
        for kind in _KINDS:
            topic = f"/robot_0/{kind.topic}"
            if topic not in twin.graph.topics() or twin.latest(topic) is None:
                rows.append((count, kind.what, None, None))
                continue
            own, drawing = _cost(twin, partial(twin.latest, topic), max(3, round(30 * size.scale)))
            rows.append((count, kind.what, own, drawing if kind.type.endswith("camera") else None))
    return rows


def _cost(twin: Twin, measure: Callable[[], object], messages: int) -> tuple[float, float]:
    """Return the mean processor time of a message (ms): the twin's, and that of the process that draws."""
    before, own, plant = _time_of_children(), 0.0, twin.plant
    shared = plant.get_body_spatial_accelerations_output_port(), plant.get_contact_results_output_port()
    for _ in range(messages):
        twin.step()
        for port in shared:  # the solution, which the step that follows needs anyway
            port.Eval(plant.GetMyContextFromRoot(twin.context))
        begin = process_time()
        measure()
        own += process_time() - begin
    return 1e3 * own / messages, 1e3 * (_time_of_children() - before) / messages


def _time_of_children() -> float:
    """Return the processor time of the processes that this one has started and that run (s); 0 but on Linux."""
    file = Path(f"/proc/self/task/{getpid()}/children")
    children = file.read_text().split() if file.is_file() else []
    ticks = [Path(f"/proc/{child}/stat").read_text().rpartition(")")[2].split()[11:13] for child in children]
    return sum(int(tick) for pair in ticks for tick in pair) / sysconf("SC_CLK_TCK")


def _twin(size: Size, world: Path, count: int, *, with_sensors: bool = True) -> Twin:
    file = size.folder / f"{'sensing' if with_sensors else 'plain'}.urdf"
    tags = "".join(f'<gazebo reference="box">{kind.text()}</gazebo>' for kind in _KINDS) if with_sensors else ""
    shape = '<geometry><box size="0.3 0.3 0.2"/></geometry>'
    file.write_text(
        '<robot name="box"><link name="box"><inertial><mass value="2"/>'
        '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
        f"<visual>{shape}</visual><collision>{shape}</collision></link>{tags}</robot>",
        encoding="utf-8",
    )
    builder = TwinBuilder(world=World(file=str(world), ground=True))
    for index in range(count):
        row, column = divmod(index, 8)
        builder.robot(f"robot_{index}", file, xyz=(column - 3.5, row - 2.0, 0.1))
    return builder.build()


def _room() -> str:
    """Return a world of boxes and pillars in a circle."""
    models = []
    for index in range(_BOXES):
        angle, distance = 2 * pi * index / _BOXES, 6.0 + 4.0 * (index % 5)
        box, pillar = "<box><size>0.4 0.6 1</size></box>", "<cylinder><radius>0.3</radius><length>1</length></cylinder>"
        solid = f"<geometry>{box if index % 3 else pillar}</geometry>"
        link = f'<link name="l"><visual name="v">{solid}</visual><collision name="c">{solid}</collision></link>'
        place = f"{distance * cos(angle):.6f} {distance * sin(angle):.6f} 0.5 0 0 {angle:.6f}"
        models.append(f'<model name="m{index}"><static>true</static><pose>{place}</pose>{link}</model>')
    return f'<sdf version="1.9"><world name="room">{"".join(models)}</world></sdf>'
