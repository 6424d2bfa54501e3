"""What becomes of generated files: a worker that tries them, and the search that starts workers.

    python tests/grammars/tried_cases.py KIND FIRST COUNT

tries cases of a kind (or of ``all`` kinds by turns) and prints what ends in anything but a robot or one paragraph.
"""

import contextlib
import json
import logging
import multiprocessing
import os
import resource
import shutil
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Iterator
from multiprocessing.connection import Connection
from pathlib import Path

import bag_grammars
import mesh_grammars
import text_grammars
import xml_grammars
import yaml
from choices import Choices

LONGEST = 10.0  # s for one case
MOST_MEMORY = 1 << 30  # bytes of the whole worker
MOST_CASES = 1000  # that a worker tries: what it keeps of each is not looked at here
FIRST_CASE = 120.0  # s, with the imports

KINDS = {
    **{kind.__name__: kind for kind in (xml_grammars.urdf, xml_grammars.xacro, xml_grammars.sdf, xml_grammars.world)},
    **{kind.__name__: kind for kind in (xml_grammars.mjcf, text_grammars.scenario, text_grammars.controllers)},
    **{kind.__name__: kind for kind in (text_grammars.launch_xml, text_grammars.launch_yaml, text_grammars.launch_py)},
    **{kind.__name__: kind for kind in (mesh_grammars.gltf, mesh_grammars.glb, mesh_grammars.stl, mesh_grammars.obj)},
    **{kind.__name__: kind for kind in (mesh_grammars.dae, mesh_grammars.ply, bag_grammars.mcap, bag_grammars.db3)},
    "message": bag_grammars.message,
}

BOX = """<robot name="r"><link name="base"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0"
izz="1"/></inertial>{shapes}</link>{more}</robot>"""
WHEEL = """<link name="{side}"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0"
izz="0.1"/></inertial></link><joint name="{side}_joint" type="continuous"><parent link="base"/><child link="{side}"/>
<axis xyz="0 1 0"/></joint>"""
CONTROL = """<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
{joints}</ros2_control>"""
JOINT = """<joint name="{side}_joint"><command_interface name="velocity"/><command_interface name="position"/>
<state_interface name="position"/><state_interface name="velocity"/></joint>"""
SDF = '<sdf version="1.9"><model name="m"><link name="base"/></model></sdf>'


def generated(kind: str, number: int) -> dict[str, bytes]:
    """The files of a case: the same ones each time."""
    return KINDS[kind](Choices(f"{kind} {number}"))


def robot_with(shapes: str = "") -> str:
    more = "".join(WHEEL.format(side=side) for side in ("left", "right"))
    joints = "".join(JOINT.format(side=side) for side in ("left", "right"))
    return BOX.format(shapes=shapes, more=more + CONTROL.format(joints=joints))


class Bench:
    """A folder in which cases are tried."""

    def __init__(self, folder: Path):
        self.folder = folder
        self._sound = {"robot.urdf": robot_with().encode(), "robot.sdf": SDF.encode()}
        self._sound |= {f"tip.{kind}": next(iter(KINDS[kind](_Sound(kind)).values())) for kind in ("stl", "obj", "dae")}

    def try_case(self, kind: str, number: int) -> str:
        """Return ``accepted``, ``refused`` or ``failed: …``."""
        from drake_twin.errors import TwinError

        files = generated(kind, number)
        shutil.rmtree(self.folder, ignore_errors=True)
        for name, content in (self._sound | files).items():
            place = self.folder / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content.replace(b"FOLDER", str(self.folder).encode()))
        try:
            self._read(kind, number, files)
        except TwinError as error:
            text = str(error)
            if kind == "launch_py" and "the launch file's code fails\n" in text:
                return "refused"  # with the traceback of its code
            is_paragraph = text.strip() and not set("\n\r").intersection(text)
            return "refused" if is_paragraph else f"failed: no paragraph: {text!r}"
        except BaseException:  # SystemExit, too
            return f"failed: {traceback.format_exc()}"
        return "accepted"

    def _read(self, kind: str, number: int, files: dict[str, bytes]) -> None:
        from drake_twin import Twin, TwinBuilder
        from drake_twin.builder.launch_file import launch_file_scenario
        from drake_twin.scenario import World
        from drake_twin.scenario.scenario_file import ScenarioFile

        main, robot = self.folder / next(iter(files)), self.folder / "robot.urdf"
        match kind:
            case "urdf" | "xacro" | "sdf" | "mjcf":
                self._run(TwinBuilder().robot("r", main, xyz=(0, 0, 0.5)).build())
            case "world":
                self._run(TwinBuilder(world=World(file=str(main))).robot("r", robot).build())
            case "controllers":
                self._run(TwinBuilder().robot("r", robot, controllers=[main]).build())
            case "scenario":
                self._run(Twin(ScenarioFile.read(main).scenario))
            case "launch_xml" | "launch_yaml" | "launch_py":
                launched = launch_file_scenario(main)
                self._run(Twin(launched.scenario, plans=launched.plans))
            case "mcap" | "db3":
                self._read_bag(self.folder / "bag")
            case "message":
                self._read_messages(files, number)
            case _:
                self._read_mesh(main, number)

    def _run(self, twin) -> None:
        twin.step(2)
        twin.close()

    def _read_mesh(self, file: Path, number: int) -> None:
        from drake_twin import TwinBuilder
        from drake_twin.description.meshes import collision_mesh, visual_mesh

        visual_mesh(file)
        collision_mesh(file)
        if number % 4 == 0:
            geometry = f'<geometry><mesh filename="{file}"/></geometry>'
            robot = robot_with(f"<visual>{geometry}</visual><collision>{geometry}</collision>")
            (self.folder / "robot.urdf").write_text(robot, encoding="utf-8")
            self._run(TwinBuilder().robot("r", self.folder / "robot.urdf").build())

    def _read_bag(self, folder: Path) -> None:
        from drake_twin import Twin
        from drake_twin.errors import InputError
        from drake_twin.playback.bag import Bag
        from drake_twin.playback.bag_player import BagPlayer
        from drake_twin.playback.robots import recorded_scenario

        with Bag(folder) as bag:
            for message in bag.messages(lambda topic, kind: True):
                with contextlib.suppress(InputError):
                    message.read()
            scenario, robots = recorded_scenario(bag)
            twin = Twin(scenario)
            player = BagPlayer(bag, twin, robots)
            player.advance_to(min(bag.duration, 1.0))
            twin.close()

    def _read_messages(self, files: dict[str, bytes], number: int) -> None:
        from drake_twin.description.bounded_yaml import load_yaml
        from drake_twin.errors import InputError
        from drake_twin.messages import message
        from drake_twin.messages.interface_types import deserialize
        from drake_twin.messages.json_messages import from_json
        from drake_twin.nodes.interface_files import InterfaceFiles

        kind, refused = files["type"].decode(), []
        for read in (
            lambda: deserialize(kind, files["message.cdr"]),
            lambda: from_json(kind, files["message.json"]),
            lambda: message(kind, load_yaml(files["message.yaml"].decode())),
            lambda: InterfaceFiles(lambda package: self.folder).load(f"own{number}_msgs/msg/Own"),
        ):
            try:
                read()
            except (ValueError, yaml.YAMLError, InputError) as error:  # what their docstrings name
                refused.append(str(error))
        if refused:
            raise InputError(" ".join(" ".join(refused).split()))


class _Sound(Choices):
    """Choices of which none is wrong."""

    def __init__(self, name: str):
        super().__init__(name)
        self.rate = 0.0


def serve(connection: Connection, folder: Path) -> None:
    """In the worker: kinds and numbers come in, what became of each goes out."""
    os.environ["XDG_CACHE_HOME"] = str(folder / "cache")
    os.chdir(folder)
    os.environ["HOME"] = str(folder)
    quiet = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(quiet, descriptor)
    logging.disable(logging.CRITICAL)
    bench, is_bounded = Bench(folder / "case"), False
    while True:
        kind, number = connection.recv()
        outcome = bench.try_case(kind, number)
        if not is_bounded:  # of what one case is given, not of the libraries' addresses
            pages = [int(word) for word in Path("/proc/self/statm").read_text().split()[:2]]
            size, used = (count * resource.getpagesize() for count in pages)
            resource.setrlimit(resource.RLIMIT_AS, (size + MOST_MEMORY - used,) * 2)
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            is_bounded = True
        connection.send(outcome)


class Worker:
    """A process that tries cases, started again when it dies, hangs or has tried many."""

    def __init__(self) -> None:
        self._folder = Path(tempfile.mkdtemp(prefix="cases_"))
        self._process: multiprocessing.process.BaseProcess | None = None
        self._tried = 0

    def outcome(self, kind: str, number: int) -> str:
        if self._process is None or self._tried >= MOST_CASES:
            self._start()
        self._tried += 1
        return self._answer(kind, number, LONGEST)

    def _answer(self, kind: str, number: int, patience: float) -> str:
        self._connection.send((kind, number))
        try:
            if self._connection.poll(patience):
                return str(self._connection.recv())
            self._end()
        except (EOFError, ConnectionResetError):
            self._process.join()
            code = self._process.exitcode
            self._end()
            return f"failed: the process died (exit code {code})"
        return f"failed: no answer within {patience:g} s"

    def close(self) -> None:
        self._end()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _end(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None

    def _start(self) -> None:
        self._end()
        shutil.rmtree(self._folder, ignore_errors=True)
        self._folder.mkdir()
        spawn = multiprocessing.get_context("spawn")
        self._connection, its_end = spawn.Pipe()
        self._process = spawn.Process(target=serve, args=(its_end, self._folder), daemon=True)
        self._process.start()
        its_end.close()
        self._tried = 0
        for kind in ("urdf", "stl"):  # the first ones take the time of the imports
            assert not self._answer(kind, 0, FIRST_CASE).startswith("failed: the process")


def tried(kinds: list[str], first: int, count: int) -> Iterator[tuple[str, int, str]]:
    """Try as many cases of each kind, by turns; yield kind, number and what became of each."""
    worker = Worker()
    try:
        for number in range(first, first + count):
            for kind in kinds:
                yield kind, number, worker.outcome(kind, number)
    finally:
        worker.close()


def main(kind: str, first: int, count: int) -> None:
    counts: Counter[tuple[str, str]] = Counter()
    for name, number, outcome in tried([*KINDS] if kind == "all" else kind.split(","), first, count):
        counts[name, outcome.partition(":")[0]] += 1
        if outcome.startswith("failed"):
            print(json.dumps([name, number, outcome]), flush=True)
        if sum(counts.values()) % 1000 == 0:
            print(sum(counts.values()), "tried", file=sys.stderr, flush=True)
    for (name, outcome), several in sorted(counts.items()):
        print(name, outcome, several)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
