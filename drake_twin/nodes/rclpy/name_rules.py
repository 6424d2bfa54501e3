"""The rules of names, as rcl and rmw check them: what is wrong with one, and at which character."""

import re
from collections.abc import Iterable

Problem = tuple[str, int]  # what is wrong, and the index of the character

_DIGITS = "must not start with a number"
_IN_TOPICS = "alphanumerics, '_', '~', '{', or '}'"


def full_topic_problem(name: str) -> Problem | None:
    """Return what is wrong with a topic's full name, the first problem that ROS finds."""
    return _path_problem("topic name", "", name) or _length_problem(name, 247, "topic length", "255U - 8U")


def namespace_problem(name: str) -> Problem | None:
    """Return what is wrong with a full namespace, the first problem that ROS finds."""
    if name == "/":
        return None
    problem = _path_problem("namespace", ", unless only a '/'", name)
    return problem or _length_problem(name, 245, "namespace", "RMW_NAMESPACE_MAX_NAME_LENGTH")


def node_problem(name: str) -> Problem | None:
    """Return what is wrong with a node's name, the first problem that ROS finds."""
    checks = (
        ("must not be empty", re.match(r"$", name)),
        ("must not contain characters other than alphanumerics or '_'", re.search(r"[^A-Za-z0-9_]", name)),
        (_DIGITS, re.match(r"[0-9]", name)),
    )
    return _first("node name", checks) or _length_problem(name, 255, "node name length", "255")


def topic_problem(name: str) -> Problem | None:
    """Return what is wrong with a topic's name as it is given, with ``~`` and substitutions such as ``{node}``."""
    ends = (
        ("must not be empty string", re.match(r"$", name)),
        ("token " + _DIGITS, re.match(r"[0-9]", name)),
        ("must not end with a forward slash", re.search(r"/$", name)),
    )
    return (
        _first("topic name", ends)
        or _problem_inside(name)
        or _first("topic name", [("token " + _DIGITS, re.search(r"(?<=/)[0-9]", name))])
    )


def _problem_inside(name: str) -> Problem | None:
    start = -1  # of the substitution that is open
    unbalanced = "topic name must not have unmatched (unbalanced) curly braces '{}'"
    for index, letter in enumerate(name):
        if letter == "~" and index:
            return "topic name must not have tilde '~' unless it is the first character", index
        if letter == "}" and start < 0:
            return unbalanced, index
        if letter == "}":
            start = -1
        elif start >= 0 and not re.match(r"[A-Za-z0-9_]", letter):
            return "substitution name must not contain characters other than alphanumerics or '_'", index
        elif start >= 0 and index == start + 1 and letter in "0123456789":
            return f"substitution name {_DIGITS}", index
        elif letter == "{":
            start = index
        elif not re.match(r"[A-Za-z0-9_/~]", letter):
            return f"topic name must not contain characters other than {_IN_TOPICS}", index
    return None if start < 0 else (unbalanced, start)


def _path_problem(what: str, exception: str, name: str) -> Problem | None:
    checks = (
        ("must not be empty", re.match(r"$", name)),
        ("must be absolute, it must lead with a '/'", re.match(r"[^/]", name)),
        (f"must not end with a '/'{exception}", re.search(r"/$", name)),
        ("must not contain characters other than alphanumerics, '_', or '/'", re.search(r"[^A-Za-z0-9_/]", name)),
        ("must not contain repeated '/'", re.search(r"(?<=/)/", name)),
        ("must not have a token that starts with a number", re.search(r"(?<=/)[0-9]", name)),
    )
    return _first(what, checks)


def _first(what: str, checks: Iterable[tuple[str, re.Match[str] | None]]) -> Problem | None:
    return next(((f"{what} {text}", found.start()) for text, found in checks if found is not None), None)


def _length_problem(name: str, limit: int, what: str, shown: str) -> Problem | None:
    return (f"{what} should not exceed '{shown}'", limit - 1) if len(name) > limit else None
