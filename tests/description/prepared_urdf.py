"""Robots prepared for Drake's parser, and checked with it."""

from pathlib import Path

import pytest
import trimesh
from lxml import etree
from pydrake.geometry import SceneGraph
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_twin.description.drake_urdf import PreparedUrdf, prepare_urdf
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.urdf import describe_urdf
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Kind

DRAKE = "{http://drake.mit.edu}"
JOINT = """<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>"""
BOX = "<geometry><box size='1 1 1'/></geometry>"
MESH = "<geometry><mesh filename='{}'/></geometry>"


def prepared(body: str, file: Path | None = None, *folders: Path, **options) -> PreparedUrdf:
    text = f"<robot name='own'>{body}</robot>"
    reader = XmlReader(text, file)
    return prepare_urdf(reader, describe_urdf(reader, text), "robot_1", PackageIndex(folders, {}), **options)


def prepare(body: str, file: Path | None = None, *folders: Path, **options) -> tuple[etree._Element, list[str]]:
    """The prepared robot, which Drake's parser also accepted, and what was mended."""
    made = prepared(body, file, *folders, **options)
    in_drake(made.text)
    return etree.fromstring(made.text), [str(item) for item in made.findings if item.kind is Kind.MENDED]


def ignored(body: str, **options) -> list[str]:
    return [str(item) for item in prepared(body, **options).findings if item.kind is Kind.IGNORED]


def refusal(body: str, file: Path | None = None, **options) -> str:
    with pytest.raises(InputError) as raised:
        prepared(body, file, **options)
    return str(raised.value)


def in_drake(text: str) -> MultibodyPlant:
    plant, scene_graph = MultibodyPlant(time_step=0.001), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    Parser(plant).AddModelsFromString(text, "urdf")
    return plant


def joint(name="elbow", parent="base", child="arm", inside="") -> str:
    return JOINT.format(name=name, parent=parent, child=child, inside=inside)


def links(*names: str) -> str:
    return "".join(f"<link name='{name}'/>" for name in names)


def write_wedge(file: Path) -> Path:
    """A mesh that is no primitive."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(trimesh.creation.cone(radius=1.0, height=1.0).export(file_type="stl"))
    return file
