"""What a generated document says at each place: mostly what is right, now and then what is strategically wrong."""

import random
from collections.abc import Sequence
from xml.etree import ElementTree

NUMBERS = ["nan", "inf", "-inf", "1e308", "-1e308", "1e150", "1e30", "1e9", "1e-9", "1e-300", "-1", "0", "-0.0", "100"]
NUMBERS += ["9" * 400, "-" + "9" * 30, "4294967296", "9223372036854775808", "1e400", "5e-324", "0x10", "1_000", "1,5"]
WORDS = ["", " ", "world", "..", "/", "a/b", "é", "\u202e", "\U0001f916", "~", "true", "null", "1", "-1", "a b", "%s"]
WORDS += ["{}", "$(rm x)", "<!--", "a" * 10_000, "__import__('os')", "package://none/x", "file:///dev/zero", "../../x"]
WORDS += ["\n", "\t", "map", "base_link"]
WORDS += [".", "${1/0}", "$(find none)", "x;y", "`x`", "*", "&a", "[", "{", "#", "'", '"']
RATES = (0.0, 0.005, 0.02, 0.05, 0.2)


class Choices(random.Random):
    """The choices of one document.

    Args:
        name: What they follow from; the same name makes the same document.
    """

    def __init__(self, name: str):
        super().__init__(name)
        self.rate = self.choice(RATES)

    def is_wrong(self) -> bool:
        return self.random() < self.rate

    def maybe(self, probability: float = 0.5) -> bool:
        """Tell whether an optional part is there."""
        return self.random() < probability

    def number(self, low: float = -1.0, high: float = 1.0) -> str:
        if self.is_wrong():
            return self.choice(NUMBERS + WORDS[:12])
        return f"{self.uniform(low, high):.4g}"

    def positive(self, high: float = 1.0) -> str:
        return self.number(0.01 * high, high)

    def numbers(self, count: int, low: float = -1.0, high: float = 1.0) -> str:
        if self.is_wrong():
            count = self.choice((0, 1, 2, 4, 7, 10_000))
        return " ".join(self.number(low, high) for _ in range(count))

    def word(self, *usual: str) -> str:
        return self.choice(WORDS + NUMBERS) if self.is_wrong() else self.choice(usual)

    def tag(self, *usual: str) -> str:
        """Return an element's name, or one that no reader knows."""
        return self.choice(("other", "xacro", "link", "muscle")) if self.is_wrong() else self.choice(usual)

    def of(self, known: Sequence[str], otherwise: str = "none") -> str:
        """Return a reference to one of the known names, or a wrong one."""
        return self.word(*(known or (otherwise,)))

    def some(self, *items: str, most: int = 3) -> list[str]:
        return self.sample(items, self.randint(0, min(most, len(items))))

    def value(self, depth: int = 0):
        """Return any plain value, as of JSON or YAML."""
        kind = self.randrange(9 if depth < 3 else 7)
        if kind == 7:
            return [self.value(depth + 1) for _ in range(self.randrange(4))]
        if kind == 8:
            return {self.choice(WORDS): self.value(depth + 1) for _ in range(self.randrange(4))}
        plain = (None, True, self.choice(WORDS), self.choice((-1, 0, 1, 2**31, 2**63, 2**64, 10**30)), 0.5, 1e308)
        return (*plain, self.choice((float("nan"), float("inf"), -0.0, 1e-320)))[kind]

    def altered(self, data):
        """Return plain data with some of its values replaced, dropped, doubled or nested."""
        if self.random() < self.rate / 2:
            return self.value()
        if isinstance(data, dict):
            items = [(key, self.altered(value)) for key, value in data.items() if not self.random() < self.rate / 2]
            if self.random() < self.rate / 2:
                items.append((self.choice((*data, *WORDS[:12])), self.value()))
            return dict(items)
        if isinstance(data, list):
            found = [self.altered(value) for value in data]
            if found and self.random() < self.rate / 2:
                found += found[:1] * self.choice((1, 1, 1000))
            return found
        return data


def as_xml(root: ElementTree.Element, choices: Choices) -> bytes:
    """Write a document after changes of its structure: elements lost, doubled, moved, nested, of another name."""
    for _ in range(choices.choice((1, 1, 2, 4)) if choices.random() < 4 * choices.rate else 0):
        _restructure(root, choices)
    text = ElementTree.tostring(root, encoding="unicode")
    text = text.replace("&#10;", "\n")
    if choices.is_wrong():
        text = choices.choice((_bomb, _external, _deep, _namespaced, _declared))(text, choices)
    data = text.encode("utf-16") if choices.random() < choices.rate / 10 else text.encode("utf-8", "surrogatepass")
    return damaged(data, choices)


def _restructure(root: ElementTree.Element, choices: Choices) -> None:
    parents = [element for element in root.iter() if len(element)]
    if not parents:
        return
    parent, other = choices.choice(parents), choices.choice(parents)
    child = choices.choice(list(parent))
    match choices.randrange(8):
        case 0:
            parent.remove(child)
        case 1:
            parent.append(child)  # twice
        case 2 if child is not other and other not in child.iter():
            parent.remove(child)
            other.append(child)
        case 3:
            child.tag = choices.choice([*(element.tag for element in root.iter()), "other", "include", "x:y"])
        case 4 if child.attrib:
            del child.attrib[choices.choice(list(child.attrib))]
        case 5 if child.attrib:
            value = child.attrib.pop(choices.choice(list(child.attrib)))
            child.set(choices.choice(("name", "value", "type", "file", "link", "other")), value)
        case 6:
            child.text = choices.choice(WORDS + NUMBERS)
        case _ if child.attrib:
            child.set(choices.choice(list(child.attrib)), choices.choice(WORDS + NUMBERS))


def _bomb(text: str, choices: Choices) -> str:
    levels = choices.choice((3, 9, 12))
    entities = '<!ENTITY e0 "0 0 0 ">' + "".join(f'<!ENTITY e{n + 1} "{f"&e{n};" * 10}">' for n in range(levels))
    place = text.find('"', text.find("=") + 2)
    return f"<!DOCTYPE x [{entities}]>" + text[:place] + f"&e{levels};" + text[place:]


def _external(text: str, choices: Choices) -> str:
    address = choices.choice(("file:///etc/passwd", "file:///dev/zero", "http://localhost:1/x", "missing.xml"))
    end = text.find(">") + 1
    return f'<!DOCTYPE x [<!ENTITY e SYSTEM "{address}">]>{text[:end]}&e;{text[end:]}'


def _deep(text: str, choices: Choices) -> str:
    end, count = text.find(">") + 1, choices.choice((50, 255, 300, 5_000))
    tag = choices.choice(("link", "x", "model", "group", "body"))
    return text[:end] + f"<{tag}>" * count + f"</{tag}>" * count + text[end:]


def _namespaced(text: str, choices: Choices) -> str:
    address = choices.choice(("http://x", "", "urn:a", "http://www.ros.org/wiki/xacro"))
    return text.replace(" ", f' xmlns:{choices.choice(("a", "xacro", "gz", "drake"))}="{address}" ', 1)


def _declared(text: str, choices: Choices) -> str:
    encoding = choices.choice(("utf-8", "utf-16", "latin-1", "ascii", "none", "utf-7", "idna", "base64", "rot13"))
    return f'<?xml version="{choices.choice(("1.0", "1.1", "9"))}" encoding="{encoding}"?>{text}'


def damaged(data: bytes, choices: Choices) -> bytes:
    """Return bytes, now and then cut off, with a run of them changed, doubled, or with zeros."""
    if choices.random() >= choices.rate / 3:
        return data
    at = choices.randrange(len(data) + 1)
    match choices.randrange(6):
        case 0:
            return data[:at]
        case 1:
            return data[:at] + choices.randbytes(choices.choice((1, 4, 100))) + data[at + 1 :]
        case 2:
            return data[:at] + data
        case 3:
            return data[:at] + bytes(choices.choice((1, 8, 1000))) + data[at:]
        case 4:
            return b""
        case _:
            return data[:at] + b"\xff" * 4 + data[at + 4 :]
