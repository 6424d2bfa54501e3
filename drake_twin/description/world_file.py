"""An SDF world (``.world``, ``.sdf``) as plain, frozen data: gravity, the physics step, and the models in it.

What the twin cannot use (most plugins, scene, GUI, …) is left out with one finding for each kind; so is a
model that cannot be found. Poses are in the world frame.
"""

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import field, replace
from pathlib import Path
from typing import Any

from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.description.added_mass import added_masses
from drake_twin.description.built_in_worlds import built_in_world, find_world
from drake_twin.description.gazebo_plugins import DONE_HERE, is_ros2_control, plugin_kind
from drake_twin.description.link_wind import windy_links_of_sdf
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.plugin_names import misspelt_plugin
from drake_twin.description.robot_description import GazeboPlugin, Pose, RobotDescription, Vector3
from drake_twin.description.saved_state import SavedState
from drake_twin.description.sdf_document import free_name, is_static, read_sdf, sdf_version
from drake_twin.description.sdf_includes import SdfIncludes
from drake_twin.description.sdf_model import falls, mend_model
from drake_twin.description.source_file import read_xml
from drake_twin.description.surroundings import Surroundings, read_surroundings
from drake_twin.description.unread import unread_in_world, unread_in_world_model
from drake_twin.description.unused_contact import unused_in_sdf
from drake_twin.description.used_elements import weight_of
from drake_twin.description.world_frames import WorldFrames
from drake_twin.description.world_plugins import (
    WIND_EFFECTS,
    WorldPlugin,
    is_world_plugin,
    read_world_plugins,
    take_triggers,
)
from drake_twin.description.world_sensors import SensorsOfModel
from drake_twin.description.world_wrenches import WRENCH_SYSTEM, WrenchSystem, read_wrench_systems
from drake_twin.description.xacro_file import expand_xacro
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Cause, Finding, Kind, Place, about_models, merged
from drake_twin.values import is_true

# SDF's default.
_GRAVITY: Vector3 = (0.0, 0.0, -9.8)

# Elements of a world that are used; and those that are not worth a finding.
_USED = {"gravity", "physics", "model", "include", "frame", "state", "magnetic_field", "spherical_coordinates", "wind"}
_HOLDS = "detachable-joint-system"
_OF_SCENE = ("background", "shadows")
_SILENT = {"atmosphere", "light", "audio"}


@dataclass(frozen=True)
class RobotText:
    """A robot's SDF, without a pose, that stands in another file.

    Attributes:
        file: That file's name, without its folder.
        text: The SDF; its lines have the numbers that they have in that file.
    """

    file: str
    text: str


@dataclass(frozen=True)
class WorldModel:
    """A model of a world.

    Attributes:
        name: Its name, unique in the world.
        pose: Its pose at the start, in the world frame.
        is_static: Whether it never moves.
        falls: Whether gravity acts on it.
        text: SDF of this model alone for Drake's parser, its pose included. A static model's planes and collision
            meshes are as in the file, since Drake's parser would take them for something else.
        place: Where the world asks for it.
        robot: Its own SDF, if one of its plugins drives it: it is a robot that stands in the world's file.
        sensing: It and the models inside it that have sensors; one inside another is called ``OUTER::INNER``.
        windy_links: The links with ``<enable_wind>``; one of a model inside it is called ``INNER::LINK``.
        added_masses: Link → the added mass of a fluid about it, see `drake_twin.description.added_mass`.
    """

    name: str
    pose: Pose
    is_static: bool
    falls: bool
    text: str
    place: Place = field(default=Place(""))
    robot: RobotText | None = None
    sensing: tuple[RobotDescription, ...] = ()
    windy_links: tuple[str, ...] = ()
    added_masses: Mapping[str, tuple[float, ...]] = field(default_factory=dict)


@dataclass(frozen=True)
class WorldFile:
    """A world file's content.

    Attributes:
        name: The world's name.
        gravity: The acceleration of free fall (m/s²).
        max_step_size: The physics step that the file asks for (s), if it does.
        models: The models, in file order.
        findings: What was left out or changed.
        file: The file it was read from; None for a built-in world.
        surroundings: Where on Earth it is, its magnetic field, its lights and its wind.
        wrench_systems: Its plugins that push single links by topics.
        plugins: Its plugins that exert forces on what moves, or publish messages when they hear one.
    """

    name: str
    gravity: Vector3
    max_step_size: float | None
    models: tuple[WorldModel, ...]
    findings: tuple[Finding, ...] = ()
    file: Path | None = None
    surroundings: Surroundings = field(default_factory=Surroundings)
    wrench_systems: tuple[WrenchSystem, ...] = ()
    plugins: tuple[WorldPlugin, ...] = ()

    @property
    def forces(self) -> tuple[WorldPlugin, ...]:
        """Those of its plugins that exert forces."""
        return tuple(plugin for plugin in self.plugins if plugin.exerts_forces)

    @property
    def wind_effects(self) -> Any:
        """The `WindEffectsParameters` of the first plugin that lets its wind change; None without one."""
        return next((plugin.parameters for plugin in self.plugins if plugin.type == WIND_EFFECTS), None)


def read_world(
    address: str,
    packages: PackageIndex,
    without: Collection[str] = (),
    poses: Mapping[str, Sequence[float]] | None = None,
    copies: Mapping[str, str] | None = None,
) -> WorldFile:
    """Read a world.

    Args:
        address: Its file: a path, ``package://``, ``model://``, ``file://``, or a name below a folder of
            ``GZ_SIM_RESOURCE_PATH``; or one of `built_in_worlds.BUILT_IN_WORLDS`.
        packages: Resolves it and what it includes.
        without: The names of models to leave out.
        poses: Model → x, y, z (m), roll, pitch, yaw (rad) in the world frame, in place of what the file says.
        copies: Name of a further model → the model of the file that it is like.

    Raises:
        InputError: If the file is missing or is not an SDF world, its includes form a loop, a value is invalid, or a
            model to copy does not exist.
    """
    file = find_world(address, packages)
    text = built_in_world(Path(address)) if file is None else read_xml(file, "world file")
    places = None
    if "xacro" in text and "ros.org/wiki/xacro" in text and file is not None:
        text, places, _ = expand_xacro(file, {}, packages)
    reader = read_sdf(text, file, places)
    world = reader.root.find("world")
    if reader.root.tag != "sdf" or world is None:
        what = "has no <world>" if reader.root.tag == "sdf" else f"begins with <{reader.root.tag}>"
        raise reader.error(reader.root, f"a world is an SDF file with a <world>, but this {what}")
    return _World(reader, world, packages, without, poses or {}, copies or {}).read()


def _robot_text(
    model: etree._Element, version: tuple[int, ...], reader: XmlReader, *, static: bool
) -> RobotText | None:
    """Return a model's own SDF if one of its plugins drives it, or, of a static one, holds another model."""
    plugins = model.findall("plugin")
    if not plugins:
        return None
    from drake_twin.description.gazebo_drives import is_drive

    found = [GazeboPlugin(filename=item.get("filename", ""), name=item.get("name", "")) for item in plugins]
    found = [plugin for plugin in found if not static or plugin_kind(plugin) == _HOLDS]
    if not any(is_drive(plugin) or is_ros2_control(plugin) for plugin in found):
        return None
    copy = deepcopy(model)
    for pose in copy.findall("pose"):
        copy.remove(pose)
    for address in copy.iter("uri"):
        name = (address.text or "").strip()
        if name and "://" not in name and reader.file is not None:  # relative to the file that it stands in
            address.text = str(reader.file.parent / name)
    line: object = model.sourceline  # the stubs' type is not a number's
    above = "\n" * (line - 1 if isinstance(line, int) else 0)
    text = f'{above}<sdf version="{".".join(map(str, version))}">{etree.tostring(copy, encoding="unicode")}</sdf>'
    return RobotText("world.sdf" if reader.file is None else reader.file.name, text)


class _World:
    """One world, while it is read."""

    def __init__(
        self,
        reader: XmlReader,
        world: etree._Element,
        packages: PackageIndex,
        without: Collection[str],
        poses: Mapping[str, Sequence[float]],
        copies: Mapping[str, str],
    ):
        self._without, self._poses, self._copies, self._world = without, poses, copies, world
        self._reader, self._version = reader, sdf_version(reader.root)
        self._includes = SdfIncludes(packages)
        self._findings: list[Finding] = []
        self._of_static: list[WorldPlugin | Finding] = []
        self._mended: dict[Finding, dict[str, Place]] = defaultdict(dict)  # what was done → models

    def read(self) -> WorldFile:
        """Return the world as plain data."""
        world = self._world
        wrong = unread_in_world(self._reader, world)
        models = list(self._models())
        surroundings = read_surroundings(self._reader, world, self._includes.lights, self._lose)
        wrench_systems = tuple(read_wrench_systems(self._reader, world, self._lose))
        of_plugins = [*read_world_plugins(self._reader, world), *self._of_static]
        self._findings += (item for item in of_plugins if isinstance(item, Finding))
        physics = next(
            (item for item in world.findall("physics") if is_true(item.get("default"))), world.find("physics")
        )
        return WorldFile(
            name=world.get("name", ""),
            gravity=self._gravity(physics),
            max_step_size=self._max_step_size(physics),
            models=tuple(models),
            findings=(
                *self._not_used(),
                *wrong,
                *self._includes.not_found(self._reader.place(world)),
                *self._includes.findings,
                *self._findings,
                *about_models(self._mended),
            ),
            file=self._reader.file,
            surroundings=surroundings,
            wrench_systems=wrench_systems,
            plugins=tuple(item for item in of_plugins if isinstance(item, WorldPlugin)),
        )

    def _lose(self, error: InputError) -> None:
        """Leave out one element of the world, as an error about it says why."""
        place = Place(error.file or "", error.line)
        choices = f" Valid: {', '.join(error.valid)}." if error.valid else ""
        what = f"{error.message.rstrip('.')}: it is left out.{choices}"
        self._findings.append(Finding.at(Kind.IGNORED, what, place))

    def _gravity(self, physics: etree._Element | None) -> Vector3:
        element = self._world.find("gravity")
        if element is None and physics is not None:
            element = physics.find("gravity")  # before SDF 1.5
        if element is None:
            return _GRAVITY
        x, y, z = self._reader.parse_numbers(element, element.text or "", "gravity", 3)
        return x, y, z

    def _max_step_size(self, physics: etree._Element | None) -> float | None:
        element = None if physics is None else physics.find("max_step_size")
        if element is None:
            return None
        value = self._reader.parse_number(element, (element.text or "").strip(), "max_step_size")
        return value if value > 0 else None  # zero and less stand for "not given"

    def _models(self) -> Iterator[WorldModel]:
        found = list(self._elements())
        frames = WorldFrames(self._reader, self._world, [(model, pose, reader) for model, _, pose, _, reader in found])
        state = SavedState(self._reader, self._world)
        taken = {"world"}  # which SDF reserves
        copies = [(copy, name) for copy, name in self._copies.items() if copy not in self._without]
        poses = [self._pose(frames, model, pose) for model, _, pose, *_ in found]  # before a model is changed
        for error in frames.unplaced() if all(X is not None for X in poses) else ():  # a model that is lost says so
            self._findings.append(Finding.at(Kind.WARNING, error.message, Place(error.file or "", error.line)))
        for (model, version, _, place, reader), X_WM in zip(found, poses, strict=True):
            name = model.get("name", "")
            if X_WM is None:
                continue
            X = state.pose(name, X_WM)
            own = free_name(name.replace("::", "_"), taken)
            if own != name:
                is_reserved = name == "world" or "::" in name
                why = "SDF reserves such a name; the model" if is_reserved else "several models have this name; one"
                self._findings.append(Finding.at(Kind.WARNING, f"{name}: {why} is called {own}", place))
            taken.add(own)
            for copy in (copy for copy, original in copies if original == own):
                yield self._model(deepcopy(model), copy, version, X, place, reader)
            if own in self._without:
                continue
            if model.find(".//link") is not None:
                yield self._model(model, own, version, X, place, reader)
            elif not self._includes.addresses.missing:  # that finding gives the reason
                self._mended[Finding(Kind.IGNORED, "the model has no link: it is left out")][own] = place
        self._findings += state.findings()
        for copy, original in copies:
            if original not in taken or copy in taken:
                what = f"model_copies: {copy}: {original!r} does not exist" if copy not in taken else f"{copy} is taken"
                raise InputError(what, file=self._reader.file, value=original, valid=sorted(taken))

    def _pose(self, frames: WorldFrames, model: etree._Element, pose: etree._Element | None) -> Any:
        try:
            return frames.pose(model, pose)
        except InputError as error:
            self._lose(error)
            return None

    def _model(
        self, model: etree._Element, name: str, version: tuple[int, ...], X: Any, place: Place, reader: XmlReader
    ) -> WorldModel:
        model.set("name", name)
        model.attrib.pop("placement_frame", "")  # X is the pose of the model's own frame
        static = is_static(model)
        for nested in model.iter("model"):
            for each in nested.findall("static"):
                nested.remove(each)
            # Drake's parser fails at a static model that has links only in the models inside it.
            if static and nested.find("link") is not None:
                etree.SubElement(nested, "static").text = "true"
        pose = Pose.of(X)
        if name in self._poses:
            x, y, z, roll, pitch, yaw = map(float, self._poses[name])
            pose = Pose((x, y, z), (roll, pitch, yaw))
        for each in model.findall("pose"):
            model.remove(each)
        etree.SubElement(model, "pose").text = pose.text
        falling = falls(model)
        robot = _robot_text(model, version, reader, static=static)
        if static and robot is None:
            self._of_static += take_triggers(reader, model)
        documents = self._includes.documents
        windy, added = ((), {}) if static else (tuple(windy_links_of_sdf(model)), dict(added_masses(model, reader)))
        sensors = SensorsOfModel(model, lambda element: documents.get(element, reader))
        before = (*unread_in_world_model(model), *unused_in_sdf(reader, model, with_links=False))
        for finding in (*before, *mend_model(model, reader, self._includes.addresses.find)):
            self._mended[replace(finding, file="", lines=())][name] = place
        root = etree.Element("sdf", version=".".join(map(str, version)))
        root.append(model)
        text = etree.tostring(root, encoding="unicode")
        return WorldModel(name, pose, static, falling, text, place, robot, sensors.described(), windy, added)

    def _elements(self) -> Iterator[tuple[etree._Element, tuple[int, ...], etree._Element | None, Place, XmlReader]]:
        """Yield each model of the world, includes replaced.

        With it come its SDF version, its pose, where the world asks for it and the document that it is in.
        """
        file = self._reader.file
        above = () if file is None else (file,)
        for child in list(self._world):
            if child.tag == "include":
                found = self._includes.model(child, self._reader, above)
                if found is not None:
                    pose = child.find("pose") if child.find("pose") is not None else found.element.find("pose")
                    yield found.element, found.version, pose, self._reader.place(child), found.reader
            elif child.tag == "model":
                try:
                    self._reader.text(child, "name")
                except InputError as error:
                    self._lose(error)
                    continue
                self._includes.expand(child, self._reader, self._version, above)
                yield child, self._version, child.find("pose"), self._reader.place(child), self._reader

    def _not_used(self) -> Iterator[Finding]:
        windows = [(f"<{child.tag}> of the world", child) for child in self._world.iterfind("gui")]
        return merged(
            Finding.at(kind, what, self._reader.place(element), weight=weight_of(element), cause=cause)
            for kind, cause, dropped in (
                (Kind.WINDOW, Cause.WINDOW, windows),
                (Kind.IGNORED, Cause.UNREAD, self._dropped()),
            )
            for what, element in dropped
        )

    def _dropped(self) -> Iterator[tuple[str, etree._Element]]:
        beside = [child for child in self._reader.root if child is not self._world and isinstance(child.tag, str)]
        beside += self._world.findall("gravity")[1:]
        for child in beside:
            yield f"<{etree.QName(child).localname}> beside the first of the world", child
        for child in self._world:
            if not isinstance(child.tag, str) or child.tag in _USED | _SILENT | {"gui"}:
                continue
            if child.tag == "scene" and any(child.find(tag) is not None for tag in _OF_SCENE):
                for part in child.iterchildren(etree.Element):
                    if part.tag not in _OF_SCENE:
                        yield f"<{part.tag}> in <scene> of the world", part
                continue
            what = f"<{etree.QName(child).localname}>"
            if child.tag == "plugin":
                plugin = GazeboPlugin(child.get("filename", ""), child.get("name", ""))
                is_done = plugin_kind(plugin) in DONE_HERE | {WRENCH_SYSTEM} or is_world_plugin(plugin)
                if is_done or misspelt_plugin(plugin):  # `unread` says so
                    continue
                what = f"the plugin {child.get('name') or child.get('filename') or '?'}"
            yield f"{what} of the world", child
