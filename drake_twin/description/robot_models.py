"""Robot models that several robots share: a file with the same arguments is read once."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from lxml import etree

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import RobotModel, load_robot_model
from drake_twin.description.xml_reader import XmlReader


class RobotModels:
    """Load the models of a scenario's robots, each once for all robots that differ only in their names.

    It lives as long as one scenario is planned: files that change afterwards are read again by the next one.

    Args:
        packages: Resolves the addresses of files.
    """

    def __init__(self, packages: PackageIndex):
        self._packages = packages
        self._known: dict[tuple[object, ...], RobotModel] = {}

    def load(
        self,
        address: str,
        *,
        name: str,
        xacro_args: Mapping[str, str],
        without_repairs: Sequence[str],
        collision: str,
    ) -> RobotModel:
        """Load a robot; see `load_robot_model` for the arguments and errors."""
        key = (address, tuple(sorted(xacro_args.items())), tuple(without_repairs), collision)
        if key in self._known:
            return _renamed(self._known[key], name)
        self._known[key] = model = load_robot_model(
            address,
            self._packages,
            name=name,
            xacro_args=xacro_args,
            without_repairs=without_repairs,
            collision=collision,
        )
        return model


def _renamed(model: RobotModel, name: str) -> RobotModel:
    """Return the model with the name of another robot; only the text for Drake holds it."""
    root = XmlReader(model.drake_text, model.description.file).root
    named = root.find("model") if model.drake_format == "sdf" else root
    assert named is not None
    named.set("model" if model.drake_format == "xml" else "name", name)
    return replace(model, drake_text=etree.tostring(root, encoding="unicode"))
