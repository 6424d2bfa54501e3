"""Services over DDS as rmw_cyclonedds_cpp has them, from the cyclonedds package alone: a program of its own.

The types are written out by hand, with the header of 16 bytes as the first two fields. What was recorded of a real
ROS 2 Jazzy is in test_dds_services.py.
"""

import contextlib
import dataclasses
import itertools
import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, int8, int32, int64, sequence, uint8, uint32, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from waiting import until

LOCAL = (
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1' multicast='false'/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers><Peer address='127.0.0.1'/></Peers></Discovery>"
    "</Domain></CycloneDDS>"
)


@dataclass
class ListParametersRequest(IdlStruct, typename="rcl_interfaces::srv::dds_::ListParameters_Request_"):
    guid_: uint64
    seq_: int64
    prefixes: sequence[str]
    depth: uint64


@dataclass
class ListParametersResult(IdlStruct, typename="rcl_interfaces::msg::dds_::ListParametersResult_"):
    names: sequence[str]
    prefixes: sequence[str]


@dataclass
class ListParametersResponse(IdlStruct, typename="rcl_interfaces::srv::dds_::ListParameters_Response_"):
    guid_: uint64
    seq_: int64
    result: ListParametersResult


@dataclass
class OtherRequest(IdlStruct, typename="std_srvs::srv::dds_::Trigger_Request_"):
    guid_: uint64
    seq_: int64
    structure_needs_at_least_one_member: uint8


@dataclass
class OtherResponse(IdlStruct, typename="std_srvs::srv::dds_::Trigger_Response_"):
    guid_: uint64
    seq_: int64
    success: bool
    message: str


@dataclass
class AddTwoIntsRequest(IdlStruct, typename="example_interfaces::srv::dds_::AddTwoInts_Request_"):
    guid_: uint64
    seq_: int64
    a: int64
    b: int64


@dataclass
class AddTwoIntsResponse(IdlStruct, typename="example_interfaces::srv::dds_::AddTwoInts_Response_"):
    guid_: uint64
    seq_: int64
    sum: int64


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Uuid(IdlStruct, typename="unique_identifier_msgs::msg::dds_::UUID_"):
    uuid: array[uint8, 16]


@dataclass
class StepsGoal(IdlStruct, typename="simulation_interfaces::action::dds_::SimulateSteps_Goal_"):
    steps: uint64


@dataclass
class SendGoalRequest(IdlStruct, typename="simulation_interfaces::action::dds_::SimulateSteps_SendGoal_Request_"):
    guid_: uint64
    seq_: int64
    goal_id: Uuid
    goal: StepsGoal


@dataclass
class SendGoalResponse(IdlStruct, typename="simulation_interfaces::action::dds_::SimulateSteps_SendGoal_Response_"):
    guid_: uint64
    seq_: int64
    accepted: bool
    stamp: Time


@dataclass
class GetResultRequest(IdlStruct, typename="simulation_interfaces::action::dds_::SimulateSteps_GetResult_Request_"):
    guid_: uint64
    seq_: int64
    goal_id: Uuid


@dataclass
class Outcome(IdlStruct, typename="simulation_interfaces::msg::dds_::Result_"):
    result: uint8
    error_message: str


@dataclass
class StepsResult(IdlStruct, typename="simulation_interfaces::action::dds_::SimulateSteps_Result_"):
    result: Outcome


@dataclass
class GetResultResponse(IdlStruct, typename="simulation_interfaces::action::dds_::SimulateSteps_GetResult_Response_"):
    guid_: uint64
    seq_: int64
    status: int8
    result: StepsResult


@dataclass
class GoalInfo(IdlStruct, typename="action_msgs::msg::dds_::GoalInfo_"):
    goal_id: Uuid
    stamp: Time


@dataclass
class CancelGoalRequest(IdlStruct, typename="action_msgs::srv::dds_::CancelGoal_Request_"):
    guid_: uint64
    seq_: int64
    goal_info: GoalInfo


@dataclass
class CancelGoalResponse(IdlStruct, typename="action_msgs::srv::dds_::CancelGoal_Response_"):
    guid_: uint64
    seq_: int64
    return_code: int8
    goals_canceling: sequence[GoalInfo]


@dataclass
class StepsFeedback(IdlStruct, typename="simulation_interfaces::action::dds_::SimulateSteps_Feedback_"):
    completed_steps: uint64
    remaining_steps: uint64


@dataclass
class FeedbackMessage(IdlStruct, typename="simulation_interfaces::action::dds_::SimulateSteps_FeedbackMessage_"):
    goal_id: Uuid
    feedback: StepsFeedback


@dataclass
class Text(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str


def made(kind: Any, values: Any) -> Any:
    """An instance of a type from its fields' values, those of structures as lists."""
    if isinstance(kind, type) and dataclasses.is_dataclass(kind):
        fields = dataclasses.fields(kind)
        return kind(*(made(field.type, value) for field, value in zip(fields, values, strict=True)))
    return values


class Peer:
    """A participant on the loopback interface, with clients of services."""

    def __init__(self, domain: int):
        self._domain = Domain(domain, LOCAL)
        self._participant = DomainParticipant(domain, Qos(Policy.Userdata(b"enclave=/;")))
        self._clients: dict[str, Client] = {}
        self._readers: dict[str, Any] = {}
        self._writers: dict[str, Any] = {}

    def client(self, name: str, service: str, kind: str, **options: Any) -> None:
        self._clients[name] = Client(self._participant, service, kind, **options)

    def listen(self, name: str) -> None:
        self._clients[name].listen()

    def raw(self, name: str, data: str) -> None:
        self._clients[name].raw(bytes.fromhex(data))

    def ask(self, name: str, *fields: Any) -> int:
        return self._clients[name].ask(*fields)

    def answers(self, name: str, count: int) -> list[Any]:
        return self._clients[name].answers(count)

    def call(self, name: str, *fields: Any) -> Any:
        number = self._clients[name].ask(*fields)
        (answer,) = self._clients[name].answers(1)
        assert answer.pop("seq_") == number
        return answer

    def sums(self, name: str, count: int) -> int:
        """Ask AddTwoInts so often, one after the other; return how many sums are right."""
        return sum(self.call(name, number, 1000)["sum"] == number + 1000 for number in range(count))

    def names(self, name: str, count: int) -> list[list[str]]:
        """Ask ListParameters so often, one after the other; return the different answers."""
        found: list[list[str]] = []
        for _ in range(count):
            answer = self.call(name, [], 0)["result"]["names"]
            if answer not in found:
                found.append(answer)
        return found

    def serve(self, service: str, kind: str, answer: Any) -> None:
        """Answer requests: sums with the sum, others with these fields."""
        Server(self._participant, service, kind, answer)

    def publish(self, topic: str, kind: str, *fields: Any, is_best_effort: bool = False) -> None:
        """Publish once somebody listens."""
        if topic not in self._writers:
            where = Topic(self._participant, f"rt{topic}", globals()[kind])
            qos = quality("", 10) + Qos(Policy.Reliability.BestEffort) if is_best_effort else quality("", 10)
            self._writers[topic] = DataWriter(self._participant, where, qos)
        until(self._writers[topic].get_matched_subscriptions)
        self._writers[topic].write(made(globals()[kind], fields))

    def subscribe(self, topic: str, kind: str, is_latched: bool = False) -> None:
        where = Topic(self._participant, f"rt{topic}", globals()[kind])
        qos = quality("", 1000) + Qos(Policy.Durability.TransientLocal) if is_latched else quality("", 1000)
        self._readers[topic] = DataReader(self._participant, where, qos)
        until(lambda: self._readers[topic].get_matched_publications())

    def heard(self, topic: str) -> list[Any]:
        return [dataclasses.asdict(item) for item in self._readers[topic].take(1000) if dataclasses.is_dataclass(item)]


class Server:
    """A server of a service, in a thread of its own."""

    def __init__(self, participant: Any, service: str, kind: str, answer: Any):
        data, request = f"serviceid=1.10.{os.getpid():x}.{next(Client.numbers):x};", globals()[f"{kind}Request"]
        self._response, self._answer = globals()[f"{kind}Response"], answer
        topics = (
            Topic(participant, f"rq{service}Request", request),
            Topic(participant, f"rr{service}Reply", self._response),
        )
        self._writer = DataWriter(participant, topics[1], quality(data, 1000))
        self._reader = DataReader(participant, topics[0], quality(data, 1000))
        threading.Thread(target=self._work, daemon=True).start()

    def _work(self) -> None:
        while True:
            for item in self._reader.take_iter(timeout=duration(seconds=1)):
                if dataclasses.is_dataclass(item) and hasattr(item, "guid_"):
                    answer = [item.a + item.b] if isinstance(item, AddTwoIntsRequest) else self._answer
                    self._writer.write(made(self._response, (item.guid_, item.seq_, *answer)))


class Client:
    """A client of a service.

    Its two endpoints say that they are one client's, as rmw_cyclonedds_cpp's do, but for other `data`. One that
    `is_deaf` has no reader yet; one that `is_wrong` does not wait for the service.
    """

    numbers = itertools.count(1)

    def __init__(
        self,
        participant: Any,
        service: str,
        kind: str,
        data: str | None = None,
        is_deaf: bool = False,
        is_wrong: bool = False,
    ):
        self._data = f"clientid=1.10.{os.getpid():x}.{next(self.numbers):x};" if data is None else data
        self._participant, self._service = participant, service
        self._request, self._response = globals()[f"{kind}Request"], globals()[f"{kind}Response"]
        topic = Topic(participant, f"rq{service}Request", self._request)
        self._writer = DataWriter(participant, topic, quality(self._data, 1000))
        self._guid = int.from_bytes(os.urandom(8))  # rmw_cyclonedds_cpp takes its writer's instance handle
        self._sequence = itertools.count(1)
        if is_wrong:
            return
        if not is_deaf:
            self.listen()
        until(self._writer.get_matched_subscriptions)

    def listen(self) -> None:
        topic = Topic(self._participant, f"rr{self._service}Reply", self._response)
        self._reader = DataReader(self._participant, topic, quality(self._data, 1000))
        until(self._reader.get_matched_publications)

    def ask(self, *fields: Any) -> int:
        number = next(self._sequence)
        self._writer.write(made(self._request, (self._guid, number, *fields)))
        return number

    def raw(self, data: bytes) -> None:
        sample = self._request.__new__(self._request)
        sample.serialize = lambda **_: data
        self._writer.write(sample)

    def answers(self, count: int) -> list[Any]:
        found: list[Any] = []

        def are_all_there() -> bool:
            taken = self._reader.take(1000)
            found.extend(item for item in taken if getattr(item, "guid_", None) == self._guid)
            return len(found) >= count

        until(are_all_there)
        return [{name: value for name, value in dataclasses.asdict(item).items() if name != "guid_"} for item in found]


def quality(data: str, depth: int) -> Qos:
    """The quality of service of rmw_cyclonedds_cpp's services, with the user data."""
    return Qos(
        Policy.Reliability.Reliable(max_blocking_time=duration(seconds=10)),
        Policy.Durability.Volatile,
        Policy.History.KeepLast(depth),
        Policy.DataRepresentation(use_cdrv0_representation=True),
        Policy.WriterDataLifecycle(autodispose=False),
        Policy.Userdata(data.encode()),
    )


class PeerProcess:
    """A `Peer` in a process of its own; its methods are called by their names."""

    def __init__(self, domain: int):
        command = [sys.executable, "-u", "-m", "wires.ros_dds_client", str(domain)]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self.process = subprocess.Popen(command, cwd=Path(__file__).parent.parent, **pipes)

    def __getattr__(self, name: str) -> Any:
        def call(*args: Any, **options: Any) -> Any:
            self.process.stdin.write(json.dumps([name, args, options]) + "\n")
            self.process.stdin.flush()
            answer = json.loads(self.process.stdout.readline())
            if isinstance(answer, str):
                raise AssertionError(answer)
            return answer[0]

        return call

    def kill(self) -> None:
        self.process.kill()
        self.process.communicate()


@contextlib.contextmanager
def dds_peer(domain: int) -> Iterator[PeerProcess]:
    peer = PeerProcess(domain)
    try:
        yield peer
    finally:
        peer.kill()


def main() -> None:
    peer = Peer(int(sys.argv[1]))
    for line in sys.stdin:
        name, args, options = json.loads(line)
        try:
            answer = [getattr(peer, name)(*args, **options)]
        except Exception as error:
            answer = f"{type(error).__name__}: {error}"
        print(json.dumps(answer, default=list))


if __name__ == "__main__":
    main()
