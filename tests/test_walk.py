"""How many calls a reader of the code has to follow from a published number to its port."""

import sys
from pathlib import Path

import pytest
from conftest import rovers

import drake_twin

PACKAGE = str(Path(drake_twin.__file__).parent)
TOPIC = "/robot_1/forward_velocity_controller/commands"
MOST_CALLS = 30
GUARD = "twin/owner.py:_guarded.<locals>.guarded"  # around each public member, see drake_twin/twin/owner.py


def walk(*calls):
    """Return the functions of drake_twin that some calls enter, in their order, as file:function."""
    entered = []

    def note(frame, event, argument):
        if event == "call" and frame.f_code.co_filename.startswith(PACKAGE):
            entered.append(f"{frame.f_code.co_filename[len(PACKAGE) + 1 :]}:{frame.f_code.co_qualname}")

    sys.setprofile(note)
    try:
        for call in calls:
            call()
    finally:
        sys.setprofile(None)
    return entered


@pytest.mark.one_plant
def test_a_published_number_reaches_its_port_in_few_calls():
    twin = rovers(1).build()
    twin.publish(TOPIC, [1.0, 1.0, 1.0, 1.0])  # the first of its kind is looked at more closely
    twin.step(1)
    entered = walk(lambda: twin.publish(TOPIC, [2.0, 2.0, 2.0, 2.0]), lambda: twin.step(1))
    assert twin.diagram.GetInputPort(TOPIC[1:]).Eval(twin.context).data == (2.0, 2.0, 2.0, 2.0)
    desired_state = twin.diagram.GetSubsystemByName("robot_1").GetOutputPort("desired_state")
    context = twin.diagram.GetSubsystemByName("robot_1").GetMyContextFromRoot(twin.context)
    assert desired_state.Eval(context).tolist()[-4:] == [2.0, 2.0, 2.0, 2.0]
    assert any("JointServo" in function for function in entered), "what is counted ends at the servo"
    entered = [function for function in entered if function != GUARD]
    assert len(entered) <= MOST_CALLS, "\n".join(entered)
