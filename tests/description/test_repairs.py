import pytest
from lxml import etree
from urdf_to_repair import BROKEN, HEALTHY, arm, joint, mend

from drake_twin.description.repairs import REPAIRS, check_repair_names, repair, repair_urdf
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError


def test_each_rule_has_a_broken_robot_here():
    assert set(BROKEN) == set(REPAIRS)


@pytest.mark.parametrize("rule", BROKEN)
def test_a_rule_says_what_it_did_and_where(rule):
    name, body = BROKEN[rule]
    _, repairs = mend(body, name)
    (said,) = (text for text in repairs if text.endswith(f"[{rule}]"))
    assert said.startswith("arm.xacro:")


@pytest.mark.parametrize("rule", BROKEN)
def test_a_rule_that_is_left_out_changes_nothing(rule):
    name, body = BROKEN[rule]
    root, repairs = mend(body, name, without=[rule])
    assert not [text for text in repairs if text.endswith(f"[{rule}]")]
    if not repairs:
        assert etree.tostring(root).decode() == f"<robot {name}>\n{body}\n</robot>".replace("<robot >", "<robot>")


@pytest.mark.parametrize("rule", BROKEN)
def test_what_was_mended_needs_no_second_repair(rule):
    name, body = BROKEN[rule]
    root, _ = mend(body, name)
    assert repair_urdf(XmlReader(etree.tostring(root, encoding="unicode"))) == []


def test_a_healthy_robot_is_left_alone():
    root, repairs = mend(HEALTHY)
    assert repairs == []
    assert etree.tostring(root).decode() == f'<robot name="r">\n{HEALTHY}\n</robot>'


def test_a_rule_that_does_not_exist_is_refused_with_those_there_are():
    check_repair_names(["inertia"])
    with pytest.raises(
        InputError,
        match=r"unknown repair 'inertias'\. Did you mean 'inertia'\? Valid: color, continuous_joint",
    ):
        check_repair_names(["inertias"])


def test_another_package_adds_a_repair(monkeypatch):
    body = arm(joint(inside='<axis xyz="1 0 0"/>'), joint("wrist", "fixed", "arm", "hand"))
    with monkeypatch.context() as added:
        added.setattr(REPAIRS, "_kinds", REPAIRS._kinds.new_child())

        @repair("axis_upwards")
        def axis_upwards(reader):
            """Turn each axis upwards."""
            for axis in reader.root.iterfind("joint/axis"):
                axis.set("xyz", "0 0 1")
                yield axis, "the axis is turned upwards"

        root, repairs = mend(body)
        assert root.find("joint/axis").get("xyz") == "0 0 1"
        assert repairs == ["arm.xacro:5: the axis is turned upwards [axis_upwards]"]
        check_repair_names(["axis_upwards"])
        assert mend(body, without=["axis_upwards"])[1] == []
        with pytest.raises(InputError, match=r"repair 'axis_upwards' is registered by \S*test_repairs and by"):
            repair("axis_upwards")(arm)
    assert mend(body)[1] == []
    with pytest.raises(InputError, match="unknown repair 'axis_upwards'"):
        check_repair_names(["axis_upwards"])
