"""Docstrings, comments and messages are in the field's English; docs/…/voice says how. These phrases were counted."""

import io
import re
import tokenize
from pathlib import Path

import drake_twin

ROOT = Path(drake_twin.__file__).parent

PHRASES = (
    r"\bis no (?!longer\b)",
    r"\b(is|are) none\b",
    r"\bgoes on\b",
    r"\bbegins anew\b",
    r"\banew\b",
    r"\bwhoever\b",
    r"\bsomebody\b",
    r"\bSays it\.",
    r"\bSets it\.",
    r"\bForgets the others\b",
    r"\bwhat waits\b",
    r"\brefuses what\b",
    r"\bof no use\b",
    r"\bTakes up\b",
    r"\bgives? up\b",
    r"\bobeys?\b",
)
COUNTED = re.compile("|".join(PHRASES))


# Python 3.12 and later read the text of an f-string as tokens of their own.
READ = {tokenize.STRING, tokenize.COMMENT, getattr(tokenize, "FSTRING_MIDDLE", tokenize.STRING)}


def words(source: str):
    """The strings and comments of a program, with their lines."""
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type in READ:
            yield token.start[0], token.string


def found(source: str):
    return [(line, match[0]) for line, text in words(source) for match in COUNTED.finditer(text)]


def test_no_counted_phrase_is_left():
    left = [
        f"{file.relative_to(ROOT)}:{line}: {phrase}"
        for file in sorted(ROOT.rglob("*.py"))
        for line, phrase in found(file.read_text(encoding="utf-8"))
    ]
    assert left == []


def test_a_phrase_is_found_in_docstrings_comments_and_messages():
    source = 'def f():\n    """Goes, as it is none."""\n    x = 1  # whoever\n    raise E(f"{x} is no robot")\n'
    assert found(source) == [(2, "is none"), (3, "whoever"), (4, "is no ")]
    assert found('"""It is no longer there."""\n') == []
