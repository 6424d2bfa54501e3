"""What the groups of a twin's methods have in common."""

from drake_twin.twin.owner import Owned
from drake_twin.twin.recording import Recorder
from drake_twin.twin.session import Session
from drake_twin.twin.stepper import Stepper


class Group(Owned):
    """Methods of a twin under one name, as `Twin` has it.

    Args:
        session: The twin's session.
        stepper: Advances it.
        recorder: Records the calls.
    """

    def __init__(self, session: Session, stepper: Stepper, recorder: Recorder):
        self._owner = session.owner
        self._session, self._stepper, self._recorder = session, stepper, recorder
