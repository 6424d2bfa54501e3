"""The twin's values of made-up files beside those that libsdformat 12, Gazebo's reader, gave for the same files.

``record.py`` wrote these down; ``compare_files.py`` compares any file where libsdformat is installed.
"""

import json
from collections import Counter
from copy import deepcopy

import pytest

from drake_twin.description.package_index import PackageIndex
from gazebo.compare_files import compare
from gazebo.record import RECORDED, digest, made

CASES = json.loads(RECORDED.read_text(encoding="utf-8"))


def outcome_of(case, folder, models=None):
    kind, seed = case.split()
    recorded = CASES[case]
    assert digest(kind, int(seed)) == recorded["digest"], "the file is another one: python -m gazebo.record"
    file = made(kind, int(seed), folder)
    return compare(file, PackageIndex([folder], {}), lambda _: (models or recorded["models"], ""), folder)


@pytest.mark.parametrize("case", CASES)
def test_poses_names_axes_limits_and_surfaces_are_those_of_gazebos_reader(tmp_path, case):
    outcome = outcome_of(case, tmp_path)
    assert outcome.refused == ""
    assert outcome.differences == []


def test_there_is_enough_to_compare():
    counts = Counter()
    for case in CASES.values():
        for model in case["models"]:
            for link in model.get("links", ()):
                counts.update(collisions=len(link.get("collisions", ())), sensors=len(link.get("sensors", ())))
                counts.update(other=sum(shape["mu"] != 1 for shape in link.get("collisions", ())))
                counts.update(folded=sum("_lump_" in shape["name"] for shape in link.get("collisions", ())))
            counts.update(joint["type"] for joint in model.get("joints", ()))
    assert counts["collisions"] > 200
    assert min(counts[kind] for kind in ("sensors", "other", "folded", "revolute", "prismatic", "fixed")) > 15


def first(models, kind):
    """Return the first link, joint, collision or sensor."""
    for model in models:
        for item in model.get("links", []) + model.get("joints", []):
            if kind == ("joints" if "parent" in item else "links"):
                return item
            if item.get(kind):
                return item[kind][0]
    raise LookupError(kind)


@pytest.mark.parametrize(
    ("of", "key", "value", "kind"),
    [
        ("links", "pose", [0, 0, 1e-4, 1, 0, 0, 0], "pose"),
        ("links", "name", "other", "name"),
        ("joints", "pose", [9, 0, 0, 1, 0, 0, 0], "pose"),
        ("joints", "name", "other", "name"),
        ("joints", "parent", "other", "name"),
        ("joints", "type", "ball", "type"),
        ("joints", "axis", [0, 0.6, 0.8], "axis"),
        ("joints", "limits", [-2.5, 2.5, 3.5, 4.5], "limit"),
        ("links", "self_collide", None, "surface"),
        ("joints", "friction", 7.0, "dynamics"),
        ("collisions", "pose", [9, 0, 0, 1, 0, 0, 0], "pose"),
        ("collisions", "name", "other", "name"),
        ("collisions", "mu", 0.001, "surface"),
        ("sensors", "pose", [9, 0, 0, 1, 0, 0, 0], "pose"),
        ("sensors", "name", "other", "name"),
        ("sensors", "rate", 1e3, "sensor"),
    ],
)
def test_another_value_is_a_difference(tmp_path, of, key, value, kind):
    case = next(case for case, found in CASES.items() if all(map(found_in(found), ("joints", "collisions", "sensors"))))
    models = deepcopy(CASES[case]["models"])
    first(models, of)[key] = value
    outcome = outcome_of(case, tmp_path, models)
    assert kind in {difference.kind for difference in outcome.differences}


def found_in(case):
    def has(kind):
        try:
            return bool(first(case["models"], kind))
        except LookupError:
            return False

    return has
