"""The older address of `drake_twin.twin.recording`; ``from drake_twin import Recording, replay`` is shorter."""

from drake_twin.twin.recording import Call, Recording
from drake_twin.twin.replay import replay

__all__ = ["Call", "Recording", "replay"]
