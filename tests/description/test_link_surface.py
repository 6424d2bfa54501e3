"""Which surface each collision shape of a URDF has: what libsdformat 12 gives the same texts."""

import pytest

from drake_twin.description.link_surface import Friction, LinkSurface, link_surfaces
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError


def surfaces(body):
    return link_surfaces(XmlReader(f"<robot name='r'>{body}</robot>"))


def link(name, *shapes):
    return f"<link name='{name}'>{''.join(f'<collision{shape}/>' for shape in shapes)}</link>"


def fixed(name, parent, child):
    return f"<joint name='{name}' type='fixed'><parent link='{parent}'/><child link='{child}'/></joint>"


def told(name, inside):
    return f"<gazebo reference='{name}'>{inside}</gazebo>"


def named(name):
    return f" name='{name}'"


@pytest.mark.parametrize(
    "inside", ["<mu1>0.9</mu1><mu2>0.8</mu2>", '<mu1 value="0.9"/><mu2 value="0.8"/>', "<mu1> 0.9 </mu1><mu2>.8</mu2>"]
)
def test_friction_is_read_in_both_spellings(inside):
    assert surfaces(link("base", "") + told("base", inside)) == {"base": LinkSurface((Friction(0.9, 0.8),))}


def test_blanks_around_a_reference_do_not_count():
    assert surfaces(link("base", "") + told(" base ", "<mu1>0.9</mu1>")) == {"base": LinkSurface((Friction(0.9, 1.0),))}


def test_two_gazebo_tags_for_one_link_add_up():
    tags = told("base", "<mu1>0.4</mu1>") + told("base", "<selfCollide>1</selfCollide>")
    assert surfaces(link("base", "") + tags) == {"base": LinkSurface((Friction(0.4, 1.0),), self_collide=True)}


def test_a_link_without_shapes_has_only_flags():
    tags = told("base", "<mu1>0.4</mu1><selfCollide>false</selfCollide>")
    assert surfaces(link("base") + tags) == {"base": LinkSurface(self_collide=False)}


def test_links_that_are_folded_together_collide_as_one():
    body = link("hand", "") + link("nail") + link("tip", "") + fixed("b", "hand", "tip") + fixed("a", "hand", "nail")
    body += told("tip", "<selfCollide>true</selfCollide>") + told("hand", "<selfCollide>false</selfCollide>")
    assert surfaces(body) == dict.fromkeys(("hand", "nail", "tip"), LinkSurface(self_collide=True))
    kept = told("b", "<preserveFixedJoint>true</preserveFixedJoint>")
    apart = {"hand": LinkSurface(self_collide=False), "nail": LinkSurface(self_collide=False)}
    assert surfaces(body + kept) == apart | {"tip": LinkSurface(self_collide=True)}


def test_a_surface_in_the_tag_comes_first():
    surface = "<collision><surface><friction><ode><mu>0.3</mu><mu2>0.2</mu2></ode></friction></surface></collision>"
    assert surfaces(link("base", "") + told("base", f"<mu1>0.9</mu1>{surface}")) == {
        "base": LinkSurface((Friction(0.9, 0.2),))
    }


def test_only_shapes_without_a_name_have_it():
    """But one whose name begins with the link's has it, too: libsdformat takes that for a name that it gave itself."""
    body = link("wheel", "", named("tyre"), named("wheel_rim"), "") + told("wheel", "<mu1>0.5</mu1>")
    half = Friction(0.5, 1.0)
    assert surfaces(body) == {"wheel": LinkSurface((half, None, half, half))}


def test_the_shapes_of_a_folded_link_have_its_own_surface():
    body = link("hub", "") + link("tyre", "", named("rib"), named("tyre")) + fixed("j", "hub", "tyre")
    body += told("hub", "<mu1>0.7</mu1>") + told("tyre", "<mu1>0.2</mu1>")
    slippery = Friction(0.2, 1.0)
    assert surfaces(body) == {
        "hub": LinkSurface((Friction(0.7, 1.0),)),
        "tyre": LinkSurface((slippery, None, slippery)),
    }


def test_a_folded_link_whose_name_begins_with_the_others_has_the_surface_of_that():
    body = link("base", "") + link("base_skid", "") + fixed("j", "base", "base_skid")
    body += told("base", "<mu1>0.7</mu1>") + told("base_skid", "<mu1>0.2</mu1>")
    assert surfaces(body) == {
        "base": LinkSurface((Friction(0.7, 1.0),)),
        "base_skid": LinkSurface((Friction(0.7, 1.0),)),
    }


@pytest.mark.parametrize("tag", ["<mu1>-1</mu1>", "<mu2>-0.5</mu2>", "<collision>{}</collision>"])
def test_a_coefficient_below_zero_is_refused_as_by_gazebo(tag):
    inside = tag.format("<surface><friction><ode><mu>-2</mu></ode></friction></surface>")
    with pytest.raises(InputError, match=r"is -.*, and it cannot be negative"):
        surfaces(link("base", "") + told("base", inside))
