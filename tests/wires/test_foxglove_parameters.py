"""Parameters of a twin's nodes in Foxglove, against its own client; a node that can be set is a double in CDR."""

import pytest
from conftest import rovers
from wires.foxglove_client import foxglove_client
from wires.ros_client import while_running

from drake_twin.messages.interface_types import deserialize, make, serialize
from drake_twin.messages.parameter_value import value_fields
from drake_twin.services.graph import connect
from drake_twin.twin.event_topics import PARAMETER_EVENTS
from drake_twin.wires.foxglove_parameters import EVENT, FoxgloveParameters
from drake_twin.wires.foxglove_wire import FoxgloveWire
from drake_twin.wires.wire import WireEndpoint

pytest.importorskip("foxglove")

MANAGER = "/robot_1/controller_manager"


@pytest.fixture(params=[False, True], ids=["shows", "commands"])
def shown(request):
    with rovers(2).build() as twin:
        wire = FoxgloveWire(port=0, control=request.param)
        seam = connect(twin, [wire])
        yield twin, wire, request.param
        seam.close()


def asked(shown, work):
    twin, wire, _ = shown

    def do():
        with foxglove_client(wire.port) as peer:
            return work(peer)

    return while_running(twin, do)


def test_all_parameters_of_all_nodes(shown):
    found = asked(shown, lambda peer: peer.parameters())
    nodes = {name.partition(".")[0] for name in found}
    assert {f"/robot_{n}/{node}" for n in (1, 2) for node in ("controller_manager", "robot_state_publisher")} <= nodes
    assert found[f"{MANAGER}.use_sim_time"] is True
    assert found[f"{MANAGER}.update_rate"] == 100
    assert found["/robot_2/robot_state_publisher.robot_description"].lstrip().startswith("<?xml")
    wheels = [f"robot_1_{end}_{side}_wheel_joint" for end in ("front", "rear") for side in ("left", "right")]
    assert found["/robot_1/forward_velocity_controller.joints"] == wheels


def test_parameters_by_their_names(shown):
    names = f"{MANAGER}.update_rate", "/robot_2/controller_manager.none", "/nobody.rate", "nonsense"
    assert asked(shown, lambda peer: peer.parameters(*names)) == {names[0]: 100}


def test_what_the_files_give_cannot_be_set(shown, caplog):
    name = f"{MANAGER}.update_rate"
    assert asked(shown, lambda peer: peer.set_parameters(parameters=[{"name": name, "value": 50}])) == {name: 100}
    (said,) = [item for item in caplog.messages if "a parameter is not set" in item]
    assert ("it is read-only" if shown[2] else "--foxglove-control") in said


NODE = "/painter"
KINDS = {1: "bool", 2: "integer", 3: "double", 4: "string", 5: "byte_array", 7: "integer_array", 8: "double_array"}


class Painter:
    """A node whose parameters can be set.

    Attributes:
        values: Name → type and value.
    """

    def __init__(self, wire):
        self.values = {"flag": (1, True), "count": (2, 3), "rate": (3, 2.5), "name": (4, "x"), "bytes": (5, [1, 255])}
        self.values |= {"steps": (7, [1, 2]), "gains": (8, [1.0, 0.5])}
        for kind, answer in (("Get", self._get), ("List", self._list), ("Set", self._set)):
            type_ = f"rcl_interfaces/srv/{kind}Parameters"
            name = f"{NODE}/{kind.lower()}_parameters"
            wire.serve(WireEndpoint(name, type_, "RIHS01_0", NODE), self._answers(type_, answer))

    @staticmethod
    def _answers(kind, answer):
        def do(data, reply):
            reply(serialize(make(f"{kind}_Response", answer(deserialize(f"{kind}_Request", data)))))

        return do

    def _get(self, request):
        found = [self.values.get(name, (0, None)) for name in request.names]
        return {"values": [{"type": kind} | ({f"{KINDS[kind]}_value": value} if kind else {}) for kind, value in found]}

    def _list(self, request):
        return {"result": {"names": list(self.values)}}

    def _set(self, request):
        results = []
        for item in request.parameters:
            known = self.values.get(item.name, (None,))[0]
            if item.value.type == 0:
                self.values.pop(item.name, None)
            elif known == item.value.type:
                value = getattr(item.value, f"{KINDS[known]}_value")
                self.values[item.name] = known, value.tolist() if hasattr(value, "tolist") else value
            results.append({"successful": item.value.type in (0, known), "reason": "wrong type"})
        return {"results": results}


def test_each_type_is_read_and_set_as_what_it_is(caplog):
    wire = FoxgloveWire(port=0, control=True)
    painter = Painter(wire)
    old = {"flag": True, "count": 3, "rate": 2.5, "name": "x", "bytes": "Af8=", "steps": [1, 2], "gains": [1, 0.5]}
    new = {"flag": False, "count": -4, "rate": 3, "name": "5", "bytes": "AAE=", "steps": [], "gains": [2, 3]}
    types = {"bytes": "byte_array"}  # others follow from the value; whole numbers from what the parameter is
    try:
        with foxglove_client(wire.port) as peer:
            assert peer.parameters() == {f"{NODE}.{name}": value for name, value in old.items()}
            wanted = [
                {"name": f"{NODE}.{name}", "value": value} | ({"type": types[name]} if name in types else {})
                for name, value in new.items()
            ]
            assert peer.set_parameters(parameters=wanted) == {f"{NODE}.{name}": value for name, value in new.items()}
            assert painter.values["rate"] == (3, 3.0)
            assert painter.values["bytes"] == (5, [0, 1])
            assert painter.values["gains"] == (8, [2.0, 3.0])
            assert peer.set_parameters(parameters=[{"name": f"{NODE}.count", "value": "many"}]) == {f"{NODE}.count": -4}
            assert [text for text in caplog.messages if "count" in text] == [
                f"a parameter is not set: {NODE}.count: wrong type"
            ]
            peer.set_parameters(parameters=[{"name": f"{NODE}.flag"}])
            assert "flag" not in painter.values
    finally:
        wire.close()


def test_a_node_that_does_not_answer_is_left_out(monkeypatch):
    monkeypatch.setattr("drake_twin.wires.foxglove_parameters._LONGEST", 0.1)
    parameters = FoxgloveParameters()
    kind = "rcl_interfaces/srv/GetParameters"
    parameters.add(WireEndpoint("/mute/get_parameters", kind, "RIHS01_0", "/mute"), lambda data, reply: None)
    assert parameters.get(["/mute.x"]) == []
    assert parameters.set({"/mute.x": 1}) == ["/mute does not answer"]


def test_a_node_that_has_ended_is_not_asked():
    parameters, asked = FoxgloveParameters(), []
    services = [
        WireEndpoint(f"/gone/{name}_parameters", f"rcl_interfaces/srv/{name.title()}Parameters", "", "/gone")
        for name in ("list", "get")
    ]
    for service in services:
        parameters.add(service, lambda data, reply: asked.append(data))
    for service in services:
        parameters.remove(service)
        parameters.remove(service)
    assert parameters.get() == parameters.get(["/gone.x"]) == asked == []


def event(node, **values):
    items = [{"name": name, "value": value_fields(value)} for name, value in values.items()]
    return serialize(make(EVENT, {"node": node, "changed_parameters": items}))


def test_changes_are_told_to_those_who_subscribe_to_the_parameter(shown):
    """Also without control, for it only shows; what changes it is not Foxglove."""
    twin, _, _ = shown
    first, second = (f"/robot_{n}/forward_velocity_controller.update_rate" for n in (1, 2))

    def set_rates(rate):
        for robot in ("robot_2", "robot_1"):  # the last event is the one that is awaited
            twin.control.set_parameters(robot, "forward_velocity_controller", {"update_rate": rate})

    def work(peer):
        peer.do("subscribeParameters", names=[first, "/nobody.rate"])
        peer.parameters(first)  # the subscription has been read
        twin.inbox.put(lambda: set_rates(50), between_advances=True)
        peer.first("parameters", parameters=[{"name": first, "value": 50}])
        peer.do("unsubscribeParameters", names=[first])
        peer.do("subscribeParameters", names=[second])
        peer.parameters(first)
        twin.inbox.put(lambda: set_rates(20), between_advances=True)
        peer.first("parameters", parameters=[{"name": second, "value": 20}])
        return [item["parameters"] for item in peer.all("parameters") if "id" not in item]

    assert asked(shown, work) == [[{"name": first, "value": 50}], [{"name": second, "value": 20}]]
    topic = twin._session.events[PARAMETER_EVENTS]
    twin.run(each_frame=lambda: topic.is_heard)  # the client has left: nothing makes events any more
    assert not topic.is_heard


def test_all_types_are_told_and_deleted_parameters_are_not():
    parameters = FoxgloveParameters()
    values = {"flag": True, "count": 3, "rate": 2.5, "name": "x", "steps": [1, 2], "gains": [1.0, 0.5]}
    found = parameters.changed(event("/painter", **values))
    assert {item.name: item.get_value() for item in found} == {f"/painter.{name}": it for name, it in values.items()}
    deleted = {"node": "/painter", "deleted_parameters": [{"name": "count", "value": {"type": 0}}]}
    assert parameters.changed(serialize(make(EVENT, deleted))) == []
