"""A sensor's element: what is read of it, and what of it nobody has read."""

import pytest
from urdf_text import parse_urdf

from drake_twin.description.sensor_element import SensorElement
from drake_twin.errors import InputError

NOISE = "<imu>\n<angular_velocity><x><noise type='gaussian'><stddev>0.1</stddev></noise></x></angular_velocity></imu>"
PLUGIN = "<plugin name='p' filename='libgazebo_ros_imu_sensor.so'><ros><namespace>/r</namespace></ros></plugin>"


def element(inside=""):
    text = f'<gazebo reference="base"><sensor name="s" type="imu">{inside}</sensor></gazebo>'
    (sensor,) = parse_urdf(f'<robot name="r"><link name="base"/>\n{text}</robot>').sensors
    return SensorElement(sensor)


def unread(found):
    return [item.what for item in found.unread()]


def test_a_value_is_read_and_then_no_finding():
    found = element(NOISE)
    assert unread(found) == ["<imu> in <sensor> of sensor 's'"]
    assert found.has("imu")
    assert unread(found) == ["<angular_velocity> in <imu> of sensor 's'"]
    noise = found.part("imu/angular_velocity/x/noise")
    assert (noise.attribute("type"), noise.number("stddev", 0.0, least=0.0)) == ("gaussian", 0.1)
    assert unread(found) == []


def test_what_an_empty_element_of_its_kind_lacks_is_no_finding():
    assert unread(element("<imu/>")) == []
    assert unread(element("<camera/>")) == ["<camera> in <sensor> of sensor 's'"]


def test_an_attribute_that_nobody_reads_is_a_finding():
    found = element("<imu speed='3'><x/></imu>")
    found.has("imu")
    assert unread(found) == ["the attribute speed of <imu> of sensor 's'", "<x> in <imu> of sensor 's'"]
    found.take_all()
    assert unread(found) == ["the attribute speed of <imu> of sensor 's'"]


def test_its_plugin_is_known_by_its_library():
    assert (element().plugin, element().plugin_kind) == (None, "")
    found = element(PLUGIN)
    assert (found.plugin.filename, found.plugin.name) == ("libgazebo_ros_imu_sensor.so", "p")
    assert found.plugin_kind == "gazebo_ros_imu_sensor"
    assert unread(found) == []


def test_an_element_without_text_is_its_default():
    found = element("<a/><b> </b><c>0</c><d>x</d>")
    assert (found.number("a", 1.5), found.number("b", 2.5), found.number("e", 3.5), found.number("c", 4.5)) == (
        *(1.5, 2.5, 3.5),
        0.0,
    )
    assert (found.flag("a", True), found.flag("c", True), found.flag("e", False)) == (True, False, False)
    assert (found.text("a", "d"), found.text("a", default="y"), found.choice("e", ("u", "v"))) == ("x", "y", "u")
    assert found.numbers("e", 2, (1.0, 2.0)) == (1.0, 2.0)


@pytest.mark.parametrize(
    ("read", "text"),
    [
        (lambda found: found.number("v", 0.0, least=4.0), "v is '3', but it must be at least 4"),
        (lambda found: found.number("v", 0.0, most=2.0), "v is '3', but it must be at most 2"),
        (lambda found: found.number("v", 0.0, least=4.0, most=5.0), "v is '3', but it must be 4 to 5"),
        (lambda found: found.flag("v", False), "v is '3', which is neither true nor false"),
        (lambda found: found.choice("v", ("a", "b")), "unknown v '3'.*Valid: a, b"),
        (lambda found: found.numbers("v", 2, (0.0, 0.0)), "v is '3', where two numbers are needed"),
    ],
)
def test_a_value_that_cannot_be_used_is_refused_with_its_line(read, text):
    with pytest.raises(InputError, match=rf":?4?.*{text}") as error:
        read(element("\n\n<v>3</v>"))
    assert error.value.line == 4
    assert element("<v>4</v>").number("v", 0.0, least=4.0, most=4.0) == 4.0
