"""The older address of `drake_twin.twin.recording`; ``from drake_twin import Recording, replay`` is shorter."""

from drake_twin.twin.recording import Call, Recording, replay

__all__ = ["Call", "Recording", "replay"]
