"""YAML that cannot end the process: PyYAML's composers recurse, in C too, for each level of nesting."""

from typing import Any

import yaml

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
DEEPEST = 100

_PYYAMLS_OWN_BOUND = "exceeded maximum nesting depth"  # since 6.0.4, at 1,000 levels, which the scanner may meet first
_OPENING = (yaml.SequenceStartEvent, yaml.MappingStartEvent)
_CLOSING = (yaml.SequenceEndEvent, yaml.MappingEndEvent)


def load_yaml(text: str) -> Any:
    """Load a document as plain data, as ``yaml.safe_load`` does.

    Raises:
        yaml.YAMLError: If it is not valid YAML, or nests more than `DEEPEST` deep.
    """
    _check_depth(text)
    return yaml.load(text, Loader=LOADER)


def compose_yaml(text: str) -> yaml.Node | None:
    """Compose a document's nodes, as ``yaml.compose`` does.

    Raises:
        yaml.YAMLError: If it is not valid YAML, or nests more than `DEEPEST` deep.
    """
    _check_depth(text)
    return yaml.compose(text, Loader=LOADER)


def _check_depth(text: str) -> None:
    depth = 0
    try:
        for event in yaml.parse(text, Loader=LOADER):
            if isinstance(event, _OPENING):
                depth += 1
                if depth > DEEPEST:
                    raise _too_deep(event.start_mark)
            elif isinstance(event, _CLOSING):
                depth -= 1
    except yaml.MarkedYAMLError as error:
        if error.problem == _PYYAMLS_OWN_BOUND:
            raise _too_deep(error.problem_mark) from None
        raise


def _too_deep(mark: Any) -> yaml.YAMLError:
    return yaml.composer.ComposerError(None, None, f"the values nest more than {DEEPEST} deep", mark)
