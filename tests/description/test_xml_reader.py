import pytest
from lxml import etree

from drake_twin.description.xml_reader import XmlReader, described
from drake_twin.errors import InputError
from drake_twin.findings import Place

TEXT = """<robot>
  <joint name="elbow">
    <limit upper="2.5" lower="{lower}"/>
    <origin xyz="{xyz}"/>
  </joint>
</robot>"""


def reader_of(lower="-1", xyz="1 2 3", **options) -> XmlReader:
    return XmlReader(TEXT.format(lower=lower, xyz=xyz), "arm.urdf", **options)


def refusal(call, *arguments) -> str:
    with pytest.raises(InputError) as raised:
        call(*arguments)
    return str(raised.value)


def test_values_are_read_as_their_types():
    reader = reader_of()
    limit, origin = reader.root.find("joint/limit"), reader.root.find("joint/origin")
    assert reader.number(limit, "upper", 0.0) == 2.5
    assert reader.vector3(origin, "xyz", (0.0, 0.0, 0.0)) == (1.0, 2.0, 3.0)
    assert reader.text(reader.root.find("joint"), "name") == "elbow"


def test_attributes_that_are_absent_take_the_default():
    reader = reader_of()
    limit = reader.root.find("joint/limit")
    assert reader.number(limit, "effort", 7.0) == 7.0
    assert reader.vector3(limit, "xyz", (0.0, 0.0, 1.0)) == (0.0, 0.0, 1.0)
    assert reader.text(limit, "type", "soft") == "soft"


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ("one", "is not a number"),
        ("1_000", "is not a number"),
        ("١", "is not a number"),
        ("", "is not a number"),
        ("nan", "is not finite"),
        ("-inf", "is not finite"),
    ],
)
def test_a_wrong_number_gives_file_line_element_and_value(value, reason):
    reader = reader_of(lower=value)
    text = refusal(reader.number, reader.root.find("joint/limit"), "lower", 0.0)
    assert text == f'arm.urdf:3: <limit> of <joint name="elbow">: lower is {value!r}, which {reason}.'


@pytest.mark.parametrize("value", ["1 2", "1 2 3 4", ""])
def test_a_vector_of_another_length_is_refused(value):
    reader = reader_of(xyz=value)
    text = refusal(reader.vector3, reader.root.find("joint/origin"), "xyz", (0.0, 0.0, 0.0))
    assert text.endswith(f"xyz is {value!r}, where three numbers are needed.")
    assert text.startswith("arm.urdf:4:")


@pytest.mark.parametrize("value", ["", "  "])
def test_a_required_attribute_that_is_blank_counts_as_missing(value):
    reader = XmlReader(f'<robot><link name="{value}"/></robot>')
    assert "the attribute 'name' is missing" in refusal(reader.text, reader.root.find("link"), "name")


def test_places_of_generated_text_are_those_it_was_made_from():
    count = len(list(reader_of(lower="one").root.iter()))
    reader = reader_of(lower="one", places=[Place("part.xacro", 10 + number // 2) for number in range(count)])
    reader = reader.copy()
    text = refusal(reader.number, reader.root.find("joint/limit"), "lower", 0.0)
    number = [element.tag for element in reader.root.iter()].index("limit")
    assert text.startswith(f'part.xacro:{10 + number // 2}: <limit> of <joint name="elbow">')
    added = etree.SubElement(reader.root, "link")
    assert reader.place(added) == Place("arm.urdf")


def test_xml_that_is_not_well_formed_gives_file_and_line():
    assert refusal(XmlReader, "<robot>\n<link>\n</robot>", "arm.urdf").startswith(
        "arm.urdf:3: this is not well-formed XML"
    )


def test_entities_do_not_read_files(tmp_path):
    (tmp_path / "secret").write_text("secret")
    text = f'<!DOCTYPE robot [<!ENTITY x SYSTEM "file://{tmp_path}/secret">]><robot>&x;</robot>'
    assert "not well-formed" in refusal(XmlReader, text)


def test_an_entity_of_the_file_itself_is_replaced():
    reader = XmlReader('<!DOCTYPE robot [<!ENTITY r "0.1">]><robot radius="&r;"/>')
    assert reader.number(reader.root, "radius", 0.0) == 0.1


def test_an_element_is_described_by_its_name_or_by_what_holds_it():
    root = reader_of().root
    assert described(root.find("joint")) == '<joint name="elbow">'
    assert described(root.find("joint/limit")) == '<limit> of <joint name="elbow">'
    assert described(root) == "<robot>"


def test_places_beyond_what_libxml2_can_number_are_unknown():
    text = f"<robot>{'<gazebo/>' * 66_000}</robot>"
    reader = XmlReader(text, "big.urdf", places=[Place("big.xacro", line) for line in range(66_001)])
    assert reader.place(reader.root[9]) == Place("big.xacro", 10)
    assert reader.place(reader.root[-1]) == Place("big.urdf")
