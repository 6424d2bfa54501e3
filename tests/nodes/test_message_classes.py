"""Classes of messages behave as those of rosidl_generator_py.

The lines cited are those of rosidl_generator_py/test/test_interfaces.py, branch jazzy of ros2/rosidl_python, and of the
messages of ros2/test_interface_files that it imports.
"""

import array
import copy
import enum
import math

import numpy as np
import pytest
from interface_packages import folder_of, write_package

from drake_twin.messages.interface_types import class_of
from drake_twin.nodes.interfaces import Interfaces
from drake_twin.nodes.message_classes import message_class, to_wire

INTEGERS = [f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)]
SCALARS = ["bool", "byte", "char", "float32", "float64", *INTEGERS]
DEFAULTS = {
    "bool": "true",
    "byte": "50",
    "char": "100",
    "float32": "1.125",
    "float64": "1.125",
    "int8": "-50",
    "uint8": "200",
    "int16": "-1000",
    "uint16": "2000",
    "int32": "-30000",
    "uint32": "60000",
    "int64": "-40000000",
    "uint64": "50000000",
}
PYTHON_VALUES = {kind: float(text) if "float" in kind else text for kind, text in DEFAULTS.items()}
PYTHON_VALUES |= {kind: int(DEFAULTS[kind]) for kind in [*INTEGERS, "char"]} | {"bool": True, "byte": b"2"}
CODES = {"char": "B", "float32": "f", "float64": "d", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H"}
CODES |= {"int32": "i", "uint32": "I", "int64": "q", "uint64": "Q"}
TEXTS = r"""
string value
string default1 "Hello world!"   # a comment
string default2 "Hello'world!"
string default3 'Hello"world!'
string default4 'Hello\'world!'
string default5 "Hello\"world!"
string default6 "a # b"
string CONST="Hello world!"
string<=22 bounded
string<=22 bounded_default "Hello world!"
string property
"""
LISTS = r"""
string<=5[3] a
string<=5[<=10] b
string<=5[] c
string[] d
string[3] e
string[<=10] f
string[] g ["What", "a", "wonderful", "world", "!"]
string[3] h ["Hello", "World", "!"]
string[] i ["H\"el'lo", 'Wo\'r"ld']
string[] j ["Hel,lo", ',World', abcd, "!,"]
float64[3] k [1, 2, 3]
bool[] l [true, false]
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The module of a package with the messages that rosidl_generator_py's tests have."""
    files = {
        "Basic": "".join(f"{kind} {kind}_value\n" for kind in SCALARS),
        "Defaulted": "".join(f"{kind} {kind}_value {text}\n" for kind, text in DEFAULTS.items()),
        "Constant": "".join(f"{kind} {kind.upper()}_CONST={text}\n" for kind, text in DEFAULTS.items()),
        "Fixed": "".join(f"{kind}[3] {kind}_values\n" for kind in SCALARS),
        "Bounded": "".join(f"{kind}[<=3] {kind}_values\n" for kind in SCALARS),
        "Unbounded": "".join(f"{kind}[] {kind}_values\n" for kind in SCALARS),
        "Texts": TEXTS,
        "Lists": LISTS,
        "Nested": "Basic basic_types_value\nBasic[] more\n",
    }
    package = write_package(tmp_path_factory.mktemp("interfaces"), "like_rosidl_msgs", msg=files)
    return Interfaces(folder_of(package)).source("like_rosidl_msgs.msg")


def test_types_and_default_values(made):  # :46-75
    message = made.Basic(check_fields=True)
    zeros = {"bool": False, "byte": b"\0", "float32": 0.0, "float64": 0.0}
    for kind in SCALARS:
        value = getattr(message, f"{kind}_value")
        zero = zeros.get(kind, 0)
        assert (value, type(value)) == (zero, type(zero)), kind


def test_assignment(made):  # :78-103
    message = made.Basic(check_fields=True)
    for kind in SCALARS:
        setattr(message, f"{kind}_value", PYTHON_VALUES[kind])
        assert getattr(message, f"{kind}_value") == PYTHON_VALUES[kind]


@pytest.mark.parametrize("check", [True, None])
@pytest.mark.parametrize("bits", [8, 16, 32, 64])
def test_integers_out_of_range(made, bits, check):  # :108-116
    message = made.Basic(check_fields=check)
    refused = [(f"int{bits}", 2 ** (bits - 1)), (f"int{bits}", -(2 ** (bits - 1)) - 1), (f"uint{bits}", -1)]
    for kind, value in [*refused, (f"uint{bits}", 2**bits)]:
        low, high = (0, 2**bits - 1) if kind[0] == "u" else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
        sort = "unsigned integer" if kind[0] == "u" else "integer"
        with pytest.raises(AssertionError) as refusal:
            setattr(message, f"{kind}_value", value)
        assert str(refusal.value) == f"The '{kind}_value' field must be an {sort} in [{low}, {high}]"


def test_floats_out_of_range(made):  # :117-121, :133-148
    message = made.Basic(check_fields=True)
    beyond = float(np.nextafter(3.402823466e38, math.inf))
    for value in (beyond, -beyond):
        with pytest.raises(AssertionError, match=r"must be a float in \[-3.402823466e\+38, 3.402823466e\+38\]"):
            message.float32_value = value
    for value in (math.inf, -math.inf, math.nan):
        message.float32_value = message.float64_value = value
        assert repr(message.float32_value) == repr(message.float64_value) == repr(value)


WRONG = {"bool": 1, "byte": "a", "char": "\x80", "float32": 1, "float64": 1}


@pytest.mark.parametrize("kind", SCALARS)
def test_a_wrong_type_is_refused_in_rosidls_words(made, kind):  # :107, :185 and _msg.py.em
    message = made.Basic()
    python = {"bool": "bool", "float32": "float", "float64": "float"}.get(kind, "int")
    words = "'bytes' or 'ByteString' with length 1" if kind == "byte" else f"'{python}'"
    with pytest.raises(AssertionError) as refusal:
        setattr(message, f"{kind}_value", WRONG.get(kind, 1.0))
    assert str(refusal.value) == f"The '{kind}_value' field must be of type {words}"
    with pytest.raises(AssertionError):
        made.Basic(**{f"{kind}_value": WRONG.get(kind, 1.0)})


def test_texts(made):  # :155-202
    message = made.Texts(check_fields=True)
    assert message.value == "" == message.bounded == message.property
    assert message.default1 == "Hello world!" == made.Texts.CONST == message.bounded_default
    assert message.default2 == message.default4 == "Hello'world!"
    assert message.default3 == message.default5 == 'Hello"world!'
    assert message.default6 == "a # b"
    message.value, message.bounded = "foo", "a" * 22
    assert (message.value, message.bounded) == ("foo", "a" * 22)
    with pytest.raises(AssertionError, match=r"^The 'value' field must be of type 'str'$"):
        message.value = 1234
    with pytest.raises(AssertionError, match=r"^The 'bounded' field must be string value not longer than 22$"):
        message.bounded = "a" * 23
    with pytest.raises(AttributeError):
        message.invalid = "foo"
    with pytest.raises(AttributeError):
        _ = message.invalid2


def test_lists_of_texts(made):  # :219-259
    message = made.Lists(check_fields=True)
    short, long = ["aa", "bbb", "cccc"], ["aa", "bbb", "cccccc"]
    for name, empty, most in (("a", ["", "", ""], 3), ("b", [], 10), ("c", [], 0)):
        assert getattr(message, name) == empty
        setattr(message, name, short)
        assert getattr(message, name) == short
        with pytest.raises(AssertionError) as refusal:
            setattr(message, name, long)
        length = {"a": "with length 3 ", "b": "with length <= 10 ", "c": ""}[name]
        assert str(refusal.value) == (
            f"The '{name}' field must be a set or sequence {length}and each string value not longer than 5 "
            "and each value of type 'str'"
        )
        if most:
            with pytest.raises(AssertionError):
                setattr(message, name, ["x"] * (most + 1))
    with pytest.raises(AssertionError):
        message.a = ["aa", "bbb"]
    message.c = [str(index) for index in range(11)]
    with pytest.raises(AssertionError):
        message.d = "abc"


def test_default_values_of_lists(made):
    message = made.Lists()
    assert message.g == ["What", "a", "wonderful", "world", "!"]
    assert message.h == ["Hello", "World", "!"]
    assert message.i == ["H\"el'lo", "Wo'r\"ld"]
    assert message.j == ["Hel,lo", ",World", "abcd", "!,"]
    assert message.k.tolist() == [1.0, 2.0, 3.0]
    assert message.l == [True, False]
    message.g.append("more")
    message.k[0] = 9.0
    assert made.Lists().g[-1] == "!"
    assert made.Lists().k[0] == 1.0


def test_unknown_arguments(made):  # :267
    with pytest.raises(AssertionError, match=r"^Invalid arguments passed to constructor: other, unknown$"):
        made.Texts(unknown="test", value="x", other=1)
    with pytest.raises(TypeError):
        made.Texts("x")


def test_constants(made):  # :272-288
    for kind in SCALARS:
        value = getattr(made.Constant, f"{kind.upper()}_CONST")
        assert value == PYTHON_VALUES[kind] == getattr(made.Constant(), f"{kind.upper()}_CONST")
        assert type(value) is type(PYTHON_VALUES[kind])
    with pytest.raises(AttributeError):
        made.Constant.INT32_CONST = 42
    assert made.Constant.get_fields_and_field_types() == {}


def test_default_values(made):  # :294-315
    message = made.Defaulted(check_fields=True)
    for kind in SCALARS:
        assert getattr(message, f"{kind}_value") == PYTHON_VALUES[kind], kind
    message.int32_value = 42
    assert message.int32_value == 42
    assert made.Defaulted.INT32_VALUE__DEFAULT == -30000
    with pytest.raises(AttributeError):
        made.Defaulted.INT32_VALUE__DEFAULT = 24


@pytest.mark.parametrize("shape", ["Fixed", "Bounded", "Unbounded"])
@pytest.mark.parametrize("kind", SCALARS)
def test_several_values(made, shape, kind):  # :318-503, :527-741, :751-890
    name = f"{kind}_values"
    message = getattr(made, shape)(check_fields=True)
    held = np.ndarray if shape == "Fixed" else array.array
    value = getattr(message, name)
    assert isinstance(value, held if kind in CODES else list)
    assert len(value) == (3 if shape == "Fixed" else 0)
    if kind in CODES and shape != "Fixed":
        assert value.typecode == CODES[kind]
    good = {"bool": [True, False, True], "byte": [b"a", b"b", b"c"], "char": [0, 1, 255]}.get(kind)
    if good is None and "float" in kind:
        good = [0.5, -1.125, 1.125]
    elif good is None:
        good = [0, int(np.iinfo(kind).min), int(np.iinfo(kind).max)]
    setattr(message, name, good)
    assert list(getattr(message, name)) == good
    refused = [["not", "a", "value"], "abc", 3]
    refused += {"Fixed": [good[:1]], "Bounded": [[*good, good[0]]], "Unbounded": []}[shape]
    if kind in CODES and "float" not in kind:
        low, high = (0, 255) if kind == "char" else (int(np.iinfo(kind).min), int(np.iinfo(kind).max))
        refused += [[high + 1, 1, 2], [low - 1, 1, 2], [0.5, 1.0, 2.0]]
    if kind == "float32":
        beyond = float(np.nextafter(3.402823466e38, math.inf))
        refused += [[-beyond, 0.0, 0.0], [0.0, 0.0, beyond]]
    for wrong in refused:
        with pytest.raises(AssertionError, match=f"^The '{name}' field must be a set or sequence "):
            setattr(message, name, wrong)
    assert list(getattr(message, name)) == good


def test_words_of_refused_sequences(made):  # _msg.py.em, from the line "a set or sequence"
    message = made.Bounded(check_fields=True)
    for name, value, words in (
        ("float64", ["a"], "float' and each double in [-179769"),
        ("float32", ["a"], "float' and each float in [-340282346600000016151267322115014000640.000000, 3402823466000"),
        ("int8", [128], "int' and each integer in [-128, 127]"),
        ("uint16", [-1], "int' and each unsigned integer in [0, 65535]"),
        ("bool", [1], "bool'"),
        ("byte", ["a"], "bytes'"),
    ):
        with pytest.raises(AssertionError) as refusal:
            setattr(message, f"{name}_values", value)
        start = f"The '{name}_values' field must be a set or sequence with length <= 3 and each value of type '{words}"
        assert str(refusal.value).startswith(start)
    with pytest.raises(AssertionError, match=r"must have the type code of 'd'"):
        message.float64_values = array.array("f")
    with pytest.raises(AssertionError, match=r"must have a size <= 3"):
        message.float64_values = array.array("d", [0.0] * 4)
    fixed = made.Fixed(check_fields=True)
    with pytest.raises(AssertionError, match=r"numpy.ndarray.. must have the dtype of 'numpy.float64'"):
        fixed.float64_values = np.zeros(3, dtype="float32")
    with pytest.raises(AssertionError, match=r"numpy.ndarray.. must have a size of 3"):
        fixed.float64_values = np.zeros(4)


def test_numbers_are_taken_as_jazzy_takes_them(made):
    """As a Jazzy without ROS_PYTHON_CHECK_FIELDS=1 takes them (_msg.py.em, "if self._check_fields")."""
    message = made.Unbounded()
    message.float64_values = [0, 1, True]
    assert message.float64_values == array.array("d", [0.0, 1.0, 1.0])
    message.float64_values = np.arange(3)
    assert message.float64_values == array.array("d", [0.0, 1.0, 2.0])
    assert made.Unbounded(int8_values=(1, 2)).int8_values == array.array("b", [1, 2])
    fixed = made.Fixed()
    fixed.float64_values = [1, 2, 3]
    assert fixed.float64_values.tolist() == [1.0, 2.0, 3.0]
    assert fixed.float64_values.dtype == float
    fixed.float64_values = np.arange(3, dtype="float32")
    assert fixed.float64_values.dtype == float
    for wrong in ([1, 2], [1, 2, 3, 4], ["a", "b", "c"], 3.0, "abc"):
        with pytest.raises(AssertionError):
            fixed.float64_values = wrong
    for wrong in ([1.5, 2.0, 3.0], [300, 0, 0], np.array([300, 0, 0])):
        with pytest.raises(AssertionError):
            fixed.int8_values = wrong
    with pytest.raises(AssertionError):
        message.int8_values = [300]


def test_unchecked_fields_take_anything(made):
    message = made.Basic(check_fields=False, unknown=3)
    message.int8_value = "text"
    assert message.int8_value == "text"


def test_field_types(made):  # :900-998
    assert made.Nested.get_fields_and_field_types() == {
        "basic_types_value": "like_rosidl_msgs/Basic",
        "more": "sequence<like_rosidl_msgs/Basic>",
    }
    found = made.Lists().get_fields_and_field_types()
    expected = ["string<5>[3]", "sequence<string<5>, 10>", "sequence<string<5>>", "sequence<string>", "string[3]"]
    assert [*found.values()][:6] == [*expected, "sequence<string, 10>"]
    found[1] = 2
    assert 1 not in made.Lists.get_fields_and_field_types()
    basic = made.Basic.get_fields_and_field_types()
    assert [basic[f"{kind}_value"] for kind in ("bool", "byte", "char", "float32", "float64")] == [
        "boolean",
        "octet",
        "uint8",
        "float",
        "double",
    ]


def test_messages_in_messages(made):
    message = made.Nested()
    with pytest.raises(AssertionError, match=r"^The 'basic_types_value' field must be a sub message of type 'Basic'$"):
        message.basic_types_value = made.Texts()
    with pytest.raises(AssertionError, match=r"a set or sequence and each value of type 'Basic'$"):
        message.more = [made.Texts()]
    message.more = [made.Basic()]
    twin = copy.deepcopy(message)
    shallow = copy.copy(message)
    assert twin == message == shallow
    twin.more[0].int8_value = 3
    assert twin != message
    assert shallow.more is message.more
    assert message != made.Basic()
    assert message != 3


def test_equality_of_arrays_is_rosidls():
    """rosidl_generator_py calls arrays of numbers different if all their elements are (_msg.py.em, __eq__)."""
    covariance = message_class("geometry_msgs/msg/PoseWithCovariance")
    one, other = covariance(), covariance()
    other.covariance[0] = 1.0
    assert one == other
    other.covariance[:] = 1.0
    assert one != other


def test_shown():
    """As rosidl_generator_py's __repr__ writes it: module without its last part, sequences without ``array``."""
    states = message_class("sensor_msgs/msg/JointState")(name=["a"], position=[0.5])
    assert repr(states) == (
        "sensor_msgs.msg.JointState(header=std_msgs.msg.Header(stamp=builtin_interfaces.msg.Time(sec=0, nanosec=0), "
        "frame_id=''), name=['a'], position=[0.5], velocity=[], effort=[])"
    )
    assert repr(message_class("unique_identifier_msgs/msg/UUID")()).startswith(
        "unique_identifier_msgs.msg.UUID(uuid=array([0"
    )


def test_default_values_of_ros():
    """geometry_msgs/msg/Quaternion.msg:3-6, sensor_msgs/msg/NavSatStatus.msg:13 (ros2/common_interfaces, jazzy)."""
    rotation = message_class("geometry_msgs/msg/TransformStamped")().transform.rotation
    assert (rotation.x, rotation.y, rotation.z, rotation.w) == (0.0, 0.0, 0.0, 1.0)
    assert message_class("sensor_msgs/msg/NavSatStatus")().status == -2
    assert message_class("simulation_interfaces/srv/StepSimulation_Request")().steps == 1  # StepSimulation.srv:7


def test_messages_are_not_hashable_and_the_same_class_is_given_again():
    with pytest.raises(TypeError):
        hash(message_class("geometry_msgs/msg/Twist")())
    assert message_class("geometry_msgs/msg/Twist") is message_class("geometry_msgs/msg/Twist")
    assert message_class("geometry_msgs/msg/Twist") is not class_of("geometry_msgs/msg/Twist")


def test_members_of_enums_that_are_numbers_or_texts_are_taken_as_such():
    """What the real one sends of them (Jazzy, with rmw_cyclonedds_cpp); a plain enum ends its process there."""

    class Number(enum.IntEnum):
        ONE = 1

    class Text(str, enum.Enum):  # noqa: UP042  # its `str` is its name
        ONE = "one"

    class Plain(enum.Enum):
        ONE = 1

    number, text = message_class("std_msgs/msg/Int32"), message_class("std_msgs/msg/String")
    assert to_wire(number(data=Number.ONE)).data == 1
    sent = to_wire(text(data=Text.ONE)).data
    assert (type(sent), sent) == (str, "one")
    with pytest.raises(AssertionError, match="The 'data' field must be of type 'int'"):
        number(data=Plain.ONE)
