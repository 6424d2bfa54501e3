"""The exceptions of tf2."""


class TransformException(Exception):  # noqa: N818 (ROS's name)
    """The base of all exceptions of tf2."""


class ConnectivityException(TransformException):
    """Raised where two frames are not in one tree."""


class LookupException(TransformException):
    """Raised where a frame does not exist."""


class ExtrapolationException(TransformException):
    """Raised where a transform at a time would have to be extrapolated."""


class InvalidArgumentException(TransformException):
    """Raised for names that no frame can have."""


class TimeoutException(TransformException):
    """Raised after a time-out."""
