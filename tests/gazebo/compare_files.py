"""Compare what libsdformat, Gazebo's reader, and the twin make of robots' and worlds' files.

``cd tests; python -m gazebo.compare_files [--package-path FOLDER]… FILE…`` prints each difference and a table. It
needs libsdformat 12 with its headers, pkg-config and g++; xacro files are expanded by the twin for both.
"""

import argparse
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from lxml import etree

from drake_twin.description.gazebo_plugins import is_of_gazebo_sim
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.world_file import read_world
from drake_twin.errors import InputError
from gazebo.differences import Difference, by_name, link_differences, robot_differences
from gazebo.gazebo_values import compile_reader, flattened, gazebo_models, transform
from gazebo.twin_values import numbers, values_of_robot, values_of_world

KINDS = ("pose", "name", "axis", "type", "limit", "dynamics", "surface", "sensor")


@dataclass
class Comparison:
    """The outcome for one file: why it was not compared, or how much was, and the differences."""

    file: Path
    refused: str = ""
    counts: Counter[str] = field(default_factory=Counter)
    differences: list[Difference] = field(default_factory=list)


def compare(
    file: Path, packages: PackageIndex, read: Callable[[Path], tuple[list[Any], str]], scratch: Path
) -> Comparison:
    """Compare one file.

    Args:
        file: The file.
        packages: Resolves what it refers to.
        read: Returns Gazebo's models of a file, and what Gazebo's reader says.
        scratch: A folder for the expanded file.
    """
    outcome = Comparison(file)
    text = file.read_text(encoding="utf-8", errors="replace")
    if re.search(r"<sdf\b", text) is not None and re.search(r"<world\b", text) is not None:
        try:
            ours = {model["name"]: model for model in values_of_world(read_world(str(file), packages))}
        except (InputError, RuntimeError) as error:
            outcome.refused = f"by the twin: {error}"
            return outcome
        theirs, said = read(file)
        moved = saved_elsewhere(text)
        for name, X_WM, model in (each for top in theirs for each in flattened(top)):
            if model.get("links"):
                outcome.differences += model_differences(name, X_WM, model, ours, moved, outcome.counts)
    else:
        try:
            robot = load_robot_model(str(file), packages)
            values = values_of_robot(robot)
        except (InputError, RuntimeError) as error:
            outcome.refused = f"by the twin: {error}"
            return outcome
        if robot.drake_format == "urdf":
            file = scratch / "expanded.urdf"
            file.write_text(robot.description.text)
        theirs, said = read(file)
        for model in theirs[:1]:
            outcome.counts += count(model)
            outcome.differences += robot_differences(model, values)
    if not theirs:
        outcome.refused = f"by libsdformat: {said.strip()[:200]}"
    return outcome


def count(model):
    links = model.get("links", ())
    found = {"links": len(links), "joints": len(model.get("joints", ()))}
    return Counter(found | {kind: sum(len(link.get(kind, ())) for link in links) for kind in ("collisions", "sensors")})


def model_differences(name, X_WM, model, ours, moved, counts) -> Iterator[Difference]:
    """Yield the differences of a model of a world; poses are in the world."""
    counts += count(model)
    top, _, inner = name.partition("::")
    own, prefix = ours.get(name), ""
    if own is None and inner and top in ours:  # of a model that classic saved as one
        own, prefix = ours[top], f"{inner.replace('::', '_')}_"
    if own is None:
        yield Difference("name", f"model {name}", name, sorted(ours))
        return
    links = by_name(own["links"])
    for link in model["links"]:
        found = links.get(f"{prefix}{link['name']}")
        if found is None:
            yield Difference("name", f"{name}::{link['name']}", link["name"], sorted(links))
            continue
        known = by_name(found["collisions"])  # planes and meshes are not looked at
        placed = dict(link, pose=numbers(X_WM @ transform(link["pose"])), sensors=[])
        placed["collisions"] = [each for each in link.get("collisions", ()) if each["name"] in known]
        casters = {joint["child"] for joint in model.get("joints", ()) if joint["type"] == "ball"}
        for difference in link_differences(placed, found, f"{name}::{link['name']}", casters):
            reason = "Gazebo classic starts with the poses that it saved in <state>" if top in moved else ""
            yield difference if difference.kind != "pose" else difference._replace(reason=difference.reason or reason)


def saved_elsewhere(text: str) -> set[str]:
    """Return the models of a world of Gazebo classic that have a pose in its state."""
    root = etree.fromstring(text.encode(), etree.XMLParser(recover=True))
    world = root.find("world")
    if world is None or any(map(is_of_gazebo_sim, world.findall("plugin"))):
        return set()
    return {model.get("name", "") for model in world.iterfind("state/model")}


def table(outcomes: list[Comparison]) -> str:
    """Return how many files and values were compared, and how many differ."""
    compared = [outcome for outcome in outcomes if not outcome.refused]
    counts: Counter[str] = Counter()
    kinds: dict[str, Counter[str]] = defaultdict(Counter)
    for outcome in compared:
        counts.update(outcome.counts)
        for difference in outcome.differences:
            kinds[difference.kind][difference.reason] += 1
    lines = [f"{len(compared)} of {len(outcomes)} files compared: {', '.join(f'{n} {k}' for k, n in counts.items())}"]
    refused = Counter(outcome.refused.partition(":")[0] for outcome in outcomes if outcome.refused)
    lines += [f"refused {who}: {number}" for who, number in refused.items()]
    for kind in (*KINDS, *(kind for kind in kinds if kind not in KINDS)):
        lines.append(f"{kind}: {kinds[kind].pop('', 0)} differences")
        lines += [f"    {number} more: {reason}" for reason, number in sorted(kinds[kind].items())]
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Compare files; return 1 if a value differs without a reason."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--package-path", action="append", type=Path, default=[])
    chosen = parser.parse_args(arguments)
    models = sorted({file.parent.parent for path in chosen.package_path for file in path.rglob("model.config")})
    packages = PackageIndex(chosen.package_path, {"GZ_SIM_RESOURCE_PATH": ":".join(map(str, models))})
    outcomes = []
    with TemporaryDirectory() as scratch:
        reader = compile_reader(scratch)
        if reader is None:
            print("libsdformat 12, pkg-config and g++ are needed", file=sys.stderr)
            return 2
        for file in chosen.files:
            outcome = compare(file, packages, partial(gazebo_models, reader, folders=models), Path(scratch))
            outcomes.append(outcome)
            if outcome.refused:
                print(f"{file}: refused {outcome.refused}")
            for kind, of, theirs, own, reason in outcome.differences:
                print(f"{file}: {kind} of {of}: Gazebo {theirs}, twin {own}{f' ({reason})' if reason else ''}")
    print(table(outcomes))
    return int(any(not each.reason for outcome in outcomes for each in outcome.differences))


if __name__ == "__main__":
    sys.exit(main())
