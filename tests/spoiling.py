"""Files with one slip each, as people make them: a name misspelt, a value broken, a path lost, a name used twice.

What a legal file may say (another mass, another topic, an element less) is no slip: nobody can find it.
"""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from random import Random

ELEMENT, ATTRIBUTE, KEY, KEYWORD = "element renamed", "attribute renamed", "key renamed", "keyword renamed"
NUMBER, SIGN, COUNT = "number broken", "sign turned", "wrong count of numbers"
PATH, REFERENCE, WORD, TWICE = "path lost", "reference broken", "word misspelt", "name twice"


@dataclass(frozen=True)
class Slip:
    """One slip.

    Attributes:
        kind: What is done.
        line: Where (from 1).
        what: The old and the new.
        text: The whole file with it.
    """

    kind: str
    line: int
    what: str
    text: str


def sample(slips: list[Slip], count: int, random: Random) -> list[Slip]:
    """As many slips, kind by kind in turn, so that the rare kinds are among them."""
    kinds: dict[str, list[Slip]] = {}
    for slip in random.sample(slips, len(slips)):
        kinds.setdefault(slip.kind, []).append(slip)
    chosen: list[Slip] = []
    while len(chosen) < count and any(kinds.values()):
        chosen += [of_kind.pop() for of_kind in kinds.values() if of_kind]
    return chosen[:count]


def slips(text: str, name: str, random: Random) -> list[Slip]:
    """All places of a file, each with one slip of each kind that can be made there."""
    if name.endswith(".py"):
        changes = _in_python(text, random)
    elif name.endswith((".yaml", ".yml")):
        changes = _in_yaml(text, random)
    else:
        changes = _in_xml(text, random)
    return [
        Slip(kind, text.count("\n", 0, edits[0][0]) + 1, _told(text, edits), _edited(text, edits))
        for kind, *edits in changes
    ]


Edit = tuple[int, int, str]  # start, end and what stands there then


def _edited(text: str, edits: list[Edit]) -> str:
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[end:]
    return text


def _told(text: str, edits: list[Edit]) -> str:
    start, end, new = edits[0]
    return f"{text[start:end]!r} -> {new!r}"


def misspelt(word: str, random: Random) -> str:
    """A word with two letters in the wrong order, one missing, or one too many; prefixes with ``:`` or ``/`` stay."""
    at = max(word.rfind(":"), word.rfind("/")) + 1
    head, tail = word[:at], word[at:]
    places = [i for i in range(len(tail) - 1) if tail[i].isalpha() and tail[i + 1].isalpha() and tail[i] != tail[i + 1]]
    if not places:
        return f"{word}x"
    i = random.choice(places)
    swapped = tail[:i] + tail[i + 1] + tail[i] + tail[i + 2 :]
    return head + random.choice([swapped, tail[: i + 1] + tail[i + 2 :], tail[: i + 1] + tail[i:]])


_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_BOOLEANS = ("true", "false", "True", "False")


def _of_numbers(value: str, at: int, random: Random) -> Iterator[tuple[str, Edit]]:
    """Slips in a value that consists of numbers."""
    words = list(re.finditer(r"\S+", value))
    if not words or not all(_NUMBER.fullmatch(word[0]) for word in words):
        return
    word = random.choice(words)
    text = word[0]
    broken = [f"{text}m", f"{text}..", "abc", "nan", text.replace(".", ",") if "." in text else f"{text},0"]
    yield NUMBER, (at + word.start(), at + word.end(), random.choice(broken))
    if len(words) > 1:
        fewer = value[: words[-1].start()].rstrip()
        yield COUNT, (at, at + len(value), random.choice([fewer, f"{value.rstrip()} {text}"]))
    else:
        yield COUNT, (at, at + len(value), random.choice([f"{text} {text}", ""]))


_POSITIVE = {"mass", "radius", "length", "ixx", "iyy", "izz", "update_rate", "samples", "width", "height", "far"}
_POSITIVE |= {
    "wheel_radius",
    "wheel_separation",
    "wheel_diameter",
    "max_step_size",
    "kinematics.wheels_radius",
    "stddev",
}
_PATH = re.compile(
    r"[^\s\"'<>]*?([\w-]+)\.(urdf|xacro|sdf|world|dae|stl|STL|obj|yaml|yml|xml|py|so|png|launch)\b[\w.]*"
)


def _of_path(value: str, at: int) -> Iterator[tuple[str, Edit]]:
    found = _PATH.search(value)
    if found is not None and found[2] != "so":
        yield PATH, (at + found.start(1), at + found.end(1), f"{found[1]}_lost")
    elif (address := re.match(r"(?:package|model)://([\w-]+)", value)) is not None:
        yield PATH, (at + address.start(1), at + address.end(1), f"{address[1]}_lost")


# XML -----------------------------------------------------------------------------------------------------------------

_TOKEN = re.compile(
    r"<!--.*?-->|<\?.*?\?>|<!\[CDATA\[.*?\]\]>"
    r"|<(?P<end>/?)(?P<tag>[\w:.-]+)(?P<attributes>(?:\s+[\w:.-]+\s*=\s*(?:\"[^\"]*\"|'[^']*'))*)\s*(?P<empty>/?)>",
    re.DOTALL,
)
_ATTRIBUTE = re.compile(r"([\w:.-]+)\s*=\s*(\"[^\"]*\"|'[^']*')")
_WORDS = {"type", "exec", "pkg", "filename", "plugin", "rotation_format", "expressed_in", "command", "camera_name"}
_INTERFACES = {"command_interface", "state_interface", "param"}
_NAMED = {"link", "joint", "model", "sensor", "collision", "visual", "frame", "body", "geom", "site", "motor", "arg"}


@dataclass
class _Element:
    tag: str
    parent: "_Element | None"
    start: int
    attributes: dict[str, tuple[str, int, int]]  # name → value, where the name and where the value starts
    end_tag: int | None = None
    text: str = ""
    text_at: int = 0

    def is_in(self, tag: str) -> bool:
        return self.parent is not None and (self.parent.tag == tag or self.parent.is_in(tag))


def _elements(text: str) -> list[_Element]:
    found: list[_Element] = []
    open_ones: list[_Element] = []
    for token in _TOKEN.finditer(text):
        if token["tag"] is None:
            continue
        if token["end"]:
            if open_ones:
                element = open_ones.pop()
                element.end_tag = token.start("tag")
                if not any(other.parent is element for other in found):
                    element.text, element.text_at = text[element.text_at : token.start()], element.text_at
            continue
        attributes = {
            match[1]: (match[2][1:-1], match.start(1), match.start(2) + 1)
            for match in _ATTRIBUTE.finditer(text, token.start("attributes"), token.end("attributes"))
        }
        above = open_ones[-1] if open_ones else None
        element = _Element(token["tag"], above, token.start("tag"), attributes, text_at=token.end())
        found.append(element)
        if not token["empty"]:
            open_ones.append(element)
    return found


def _in_xml(text: str, random: Random) -> Iterator[tuple]:
    elements = _elements(text)
    names = Counter((item.tag, item.attributes["name"][0]) for item in elements if "name" in item.attributes)
    known = {name for _, name in names if not name.startswith("$")}
    for item in elements:
        if item.parent is not None:
            new = misspelt(item.tag, random)
            ends = [] if item.end_tag is None else [(item.end_tag, item.end_tag + len(item.tag), new)]
            yield ELEMENT, (item.start, item.start + len(item.tag), new), *ends
        for name, (value, name_at, at) in item.attributes.items():
            if not name.startswith("xmlns"):
                yield ATTRIBUTE, (name_at, name_at + len(name), misspelt(name, random))
            if name != "version":
                yield from _of_value(item, name, value, at, known, random)
        yield from _of_name_twice(item, elements)
        if item.text.strip() and item.text.strip() == item.text.replace("\n", " ").strip():
            yield from _of_value(item, None, item.text, item.text_at, known, random)


def _of_value(
    item: _Element, name: str | None, value: str, at: int, known: set[str], random: Random
) -> Iterator[tuple[str, Edit]]:
    word, start = value.strip(), at + len(value) - len(value.lstrip())
    whole = (start, start + len(word))
    above = item.parent.tag if item.parent is not None else ""
    yield from _of_numbers(word, start, random)
    if {item.tag if name in (None, "value") else name} & _POSITIVE and _NUMBER.fullmatch(word) and float(word) > 0:
        yield SIGN, (*whole, f"-{word}")
    yield from _of_path(word, start)
    is_reference = name != "name" or above == "ros2_control"
    if word in known and is_reference and not (name == "type" or word in _BOOLEANS):
        yield REFERENCE, (*whole, misspelt(word, random))
    elif word in _BOOLEANS or name in _WORDS or (item.tag in _INTERFACES and name == "name"):
        if not _NUMBER.fullmatch(word) and not word.startswith(("$", "package:", "file:", "model:")) and word:
            yield WORD, (*whole, misspelt(word, random))
    elif name == "name" and item.tag == "plugin" and "::" in word:
        yield WORD, (*whole, misspelt(word, random))


def _of_name_twice(item: _Element, elements: list[_Element]) -> Iterator[tuple[str, Edit]]:
    if item.tag not in _NAMED or "name" not in item.attributes:
        return
    value, _, at = item.attributes["name"]
    beside = (other for other in elements if other.parent is item.parent and other.tag == item.tag)
    names = (other.attributes["name"][0] for other in beside if "name" in other.attributes)
    other = next((name for name in names if name != value), None)
    if other is not None:
        yield TWICE, (at, at + len(value), other)


# YAML ----------------------------------------------------------------------------------------------------------------

_YAML_LINE = re.compile(
    r"^(?P<indent>[ ]*(?:- )*)(?:(?P<key>[\w./*~-]+|\"[^\"]+\")\s*:(?=\s|$))?(?P<value>[^#\n]*)", re.M
)
# What may be any name: a misspelt one is as good as another.
_FREE = {"name", "topic", "namespace", "description", "topic_name", "ros_topic_name", "frame_prefix", "robot_name"}
_FREE |= {"value", "default", "odom_frame_id", "output", "exec", "pkg", "child", "parent"}


def _in_yaml(text: str, random: Random) -> Iterator[tuple]:
    for line in _YAML_LINE.finditer(text):
        key, value = line["key"], line["value"]
        if key is not None and not _is_label(key, text, line.end()):
            yield KEY, (line.start("key"), line.end("key"), misspelt(key, random))
        if (key is None and not line["indent"].strip()) or key in _FREE:
            continue
        for scalar in re.finditer(r"[^\s,\[\]{}][^,\[\]{}]*", value):
            word, at = scalar[0].strip().strip("\"'"), 0
            at = line.start("value") + value.index(word, scalar.start()) if word else 0
            if not word:
                continue
            inner = re.match(r"([\w.]+):\s+(\S.*)", word)
            if inner is not None:  # of a mapping in one line
                yield KEY, (at, at + len(inner[1]), misspelt(inner[1], random))
                word, at = inner[2], at + inner.start(2)
                if inner[1] in _FREE:
                    continue
            if _NUMBER.fullmatch(word):
                yield (
                    NUMBER,
                    (at, at + len(word), random.choice(["abc", f"{word} m", word.replace(".", ",") + "x", "[]"])),
                )
                if (inner[1] if inner is not None else key) in _POSITIVE and float(word) > 0:
                    yield SIGN, (at, at + len(word), f"-{word}")
            elif word in _BOOLEANS:
                yield WORD, (at, at + len(word), misspelt(word, random))
            elif _PATH.search(word) is not None:
                yield from _of_path(word, at)
            elif re.fullmatch(r"[\w/:]*[A-Za-z][\w/:]*", word):
                is_type = key is not None and "type" in key
                yield (WORD if is_type else REFERENCE), (at, at + len(word), misspelt(word, random))


def _is_label(key: str, text: str, end: int) -> bool:
    """Whether a key is a controller's name that nothing else of the file has: another name is as good."""
    below = text[end:].lstrip("\n").split("\n", 1)[0].strip()
    return below.startswith("type:") and len(re.findall(rf"\b{re.escape(key)}\s*:", text)) == 1


# Python --------------------------------------------------------------------------------------------------------------

_PLACES = {"package", "executable", "plugin"}


def _in_python(text: str, random: Random) -> Iterator[tuple]:
    lines = [0]
    for line in text.splitlines(keepends=True):
        lines.append(lines[-1] + len(line))
    tree = ast.parse(text)

    def of(node: ast.expr) -> tuple[int, int]:
        start = lines[node.lineno - 1] + node.col_offset
        return start, lines[node.end_lineno - 1] + node.end_col_offset

    # The parameters of nodes are what the nodes declare: no launch file tells.
    of_nodes = [node.value for node in ast.walk(tree) if isinstance(node, ast.keyword) and node.arg == "parameters"]
    free = {below for node in of_nodes for below in ast.walk(node)}
    for node in ast.walk(tree):
        if isinstance(node, ast.keyword) and node.arg is not None:
            start = lines[node.lineno - 1] + node.col_offset
            yield KEYWORD, (start, start + len(node.arg), misspelt(node.arg, random))
        keys = node.keys if isinstance(node, ast.Dict) and node not in free else ()
        for key in keys:
            if isinstance(key, ast.Constant) and isinstance(key.value, str):
                yield KEY, _in_string(text, *of(key), misspelt(key.value, random))
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("LaunchConfiguration", "FindPackageShare"):
            for argument in node.args[:1]:
                if isinstance(argument, ast.Constant):
                    yield REFERENCE, _in_string(text, *of(argument), misspelt(str(argument.value), random))
        if isinstance(node, ast.keyword) and node.arg in _PLACES and isinstance(node.value, ast.Constant):
            yield WORD, _in_string(text, *of(node.value), misspelt(str(node.value.value), random))
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and "\n" not in node.value:
            start, end = of(node)
            if re.fullmatch(r"--?[A-Za-z][\w-]*", node.value):
                yield WORD, _in_string(text, start, end, misspelt(node.value, random))
            elif _PATH.fullmatch(node.value):
                yield from _of_path(text[start:end], start)


def _in_string(text: str, start: int, end: int, new: str) -> Edit:
    literal = re.match(r"(\w*)('''|\"\"\"|'|\")", text[start:end])
    assert literal is not None
    return start + literal.end(), end - len(literal[2]), new
