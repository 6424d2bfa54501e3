"""Models that joints fix to the world."""

import pytest
from lxml import etree

from drake_twin.description.welded_models import weld_to_world


def model(inside):
    return etree.fromstring(f'<model name="m">{inside}</model>')


def welds(element):
    return [(joint.findtext("parent"), joint.findtext("child")) for joint in element.findall("joint[@type='fixed']")]


def test_each_link_that_no_joint_holds_is_fixed():
    joint = '<joint name="j" type="revolute"><parent>a</parent><child>b</child></joint>'
    element = model(f'<link name="a"/><link name="b"/><link name="c"/>{joint}')
    weld_to_world(element)
    assert welds(element) == [("world", "a"), ("world", "c")]


def test_a_model_without_links_cannot_be_fixed():
    with pytest.raises(ValueError, match="no link of its own"):
        weld_to_world(model("<model name='n'><link name='l'/></model>"))
