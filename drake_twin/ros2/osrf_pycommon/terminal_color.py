"""``osrf_pycommon.terminal_color``: the codes of a terminal's colours, which the twin's log does not have."""


def ansi(key: str) -> str:
    """Return the code of a colour or style by its name: always empty."""
    return ""


def sanitize(msg: str) -> str:
    """Return a text in which braces mean themselves."""
    return msg.replace("{", "{{").replace("}", "}}")


def format_color(msg: str) -> str:
    """Return a text as it is."""
    return msg
