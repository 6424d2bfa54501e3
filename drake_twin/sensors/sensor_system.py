"""The base of all sensors of a robot."""

import logging
from collections.abc import Callable, Iterable, Sequence
from typing import Any, ClassVar

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, CacheEntry, Context, InputPort, OutputPort, ValueProducer

from drake_twin import messages
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Sensor
from drake_twin.description.sensor_element import SensorElement
from drake_twin.errors import described
from drake_twin.sensors.classic import classic_frame
from drake_twin.sensors.noise import SILENT, Noise
from drake_twin.sensors.sensor_host import SensorHost
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.systems.no_message import empty_value, or_none, set_value
from drake_twin.systems.weak_callback import weakly

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class SensorTopic:
    """A topic of a sensor.

    Attributes:
        own: The name of the sensor's output port.
        type: The ROS message type.
        name: Its name in Gazebo; of a plugin of Gazebo classic, which publishes on ROS itself, its name in ROS below
            the robot's namespace, or with a leading slash elsewhere.
        is_ros: Whether the name is one in ROS, so that no bridge is needed.
    """

    own: str
    type: str
    name: str
    is_ros: bool = False


class SensorSystem:
    """A sensor: it measures what the plant's and the scene graph's ports carry, on ports of a `SensorHost`.

    A message is computed when someone asks for it, at t = k / rate, and is stamped with that time. There are no events:
    a sensor without listeners costs nothing. A broadcaster of ros2_control reads the vector port of a sensor that
    has one.

    Attributes:
        message_type: The ROS type of its topic, for a kind with one topic.
        gz_topic: The last part of the topic that Gazebo gives a sensor without ``<topic>``.
        values_port: The vector port that a broadcaster of ros2_control reads; empty without one.
        on: The element that such a sensor is on: ``link`` or ``joint``; set by the registry.
        setup: What it was built from.
        host: The system that has its ports.
        warnings: Why it does not measure all that its file asks for, as sentences.
        delay: How long after its measurement a message is published (s); None for at once.
        fault: Why one of another package measures no more; None while it does.
    """

    message_type: ClassVar[str] = ""
    gz_topic: ClassVar[str] = ""
    values_port: ClassVar[str] = ""
    on: ClassVar[str] = "link"

    @classmethod
    def read(cls, element: SensorElement) -> Any:
        """Read the kind's own part of a sensor's element; what it does not read is reported as ignored.

        Raises:
            InputError: If a value is invalid.
        """
        element.take_all()
        return None

    @classmethod
    def problem(cls, settings: Any) -> str | None:
        """Return why a sensor with these settings is not simulated; None if it is."""
        return None

    @classmethod
    def topics(cls, sensor: Sensor, settings: Any, base: str) -> Iterable[SensorTopic]:
        """Return the topics of a sensor.

        Args:
            sensor: The sensor.
            settings: What `read` has returned.
            base: Its topic in Gazebo: its ``<topic>``, or the default.
        """
        return (SensorTopic("message", cls.message_type, base),)

    @classmethod
    def default_frame(cls, sensor: Sensor, settings: Any, scoped: str) -> str:
        """Return the ``frame_id`` of a sensor whose file gives none: the link for a plugin of Gazebo classic.

        Args:
            sensor: The sensor.
            settings: What `read` has returned.
            scoped: The name that Gazebo gives it, ``ROBOT/LINK/SENSOR``, which is the frame of the others.
        """
        return classic_frame(sensor, scoped)

    @classmethod
    def rate(cls, sensor: Sensor, settings: Any) -> float:
        """Return the rate of its measurements (Hz); 0 for at every step."""
        return sensor.update_rate

    @classmethod
    def noises(cls, settings: Any) -> dict[str, Noise]:
        """Return the noise of each channel: the ``noises`` of the settings, if they have any."""
        return getattr(settings, "noises", {})

    def __init__(self, setup: SensorSetup):
        self.setup = setup
        self.host = SensorHost() if setup.host is None else setup.host
        self.host.sensors.append(self)
        self.warnings: tuple[str, ...] = ()
        self.delay: float | None = None
        self.fault: str | None = None
        self._inputs: list[InputPort] = []
        self._channels = {
            name: setup.noise.channel(name, noise)
            for name, noise in self.noises(setup.settings).items()
            if noise != SILENT
        }

    @property
    def is_noisy(self) -> bool:
        """Whether a channel has noise."""
        return bool(self._channels)

    def noisy(self, channel: str, value: Any, time: float) -> Any:
        """Return a measured value, or an array, with the noise of a channel at a time (s)."""
        found = self._channels.get(channel)
        return value if found is None else found.apply(value, time)

    def noisy_values(self, channels: Sequence[str], values: np.ndarray, time: float) -> np.ndarray:
        """Return measured values, one for each channel, with the channels' noise at a time (s)."""
        if not self.is_noisy:
            return values
        return np.array([self.noisy(*item, time) for item in zip(channels, values, strict=True)])

    def header(self, context: Context) -> Any:
        """Return the header of a message of the present time."""
        return messages.header(context.get_time(), self.setup.frame)

    def ask(self, own: str, context: Context) -> Callable[[], Any]:
        """Begin to measure at the present time, for a sensor with a `delay`.

        Args:
            own: The topic's `SensorTopic.own`.
            context: The host's.

        Returns:
            A function that returns the message, or None without one; it waits for it and needs no context.
        """
        raise NotImplementedError

    def measurement_tickets(self) -> set[Any]:
        """Return what a measurement depends on: the plant's ports declared so far, and time if it has noise."""
        tickets = {self.host.input_port_ticket(port.get_index()) for port in self._inputs}
        return tickets | ({self.host.time_ticket()} if self.is_noisy else set())

    def declare_plant_input(self, name: str, value: AbstractValue | None = None) -> InputPort:
        """Return the port that carries a port of the plant, or ``query`` of the scene graph.

        Args:
            name: One of those of `PlantReader.declare_plant_input`.
            value: As there.
        """
        port = self.host.declare_plant_input(name, value)
        self._inputs.append(port)
        return port

    def declare_values_output(self, size: int, calc: Callable[[Context, BasicVector], None]) -> OutputPort:
        """Declare the vector port `values_port`, set by ``calc(context, output)`` from the plant's ports so far."""
        name = self.port_name(self.values_port)
        return self.host.DeclareVectorOutputPort(name, size, self._weakly(calc), self.measurement_tickets())

    def declare_cache_entry(self, name: str, calc: Callable[..., None], *first: Any) -> CacheEntry:
        """Declare what several topics have in common, set by ``calc(*first, context, value)`` from the plant's ports.

        Its value is any Python object: ``entry.Eval(context)``.
        """
        producer = ValueProducer(allocate=empty_value, calc=weakly(calc, *first))
        return self.host.DeclareCacheEntry(self.port_name(name), producer, self.measurement_tickets())

    def declare_message_output(self, calc: Callable[..., None], own: str = "message", *first: Any) -> OutputPort:
        """Declare the output port of a topic, set by ``calc(*first, context, output)`` from the plant's ports and time.

        Args:
            calc: Sets a message, or None while it has none.
            own: The topic's `SensorTopic.own`.
            *first: The first arguments of ``calc``.
        """
        return self.host.DeclareAbstractOutputPort(
            self.port_name(own),
            empty_value,
            self._weakly(calc, *first),
            {*self.measurement_tickets(), self.host.time_ticket()},
        )

    def _weakly(self, calc: Callable[..., None], *first: Any) -> Callable[..., Any]:
        """Return a port's callback; that of another package's sensor is guarded."""
        is_own = type(self).__module__.startswith("drake_twin.")
        return weakly(calc, *first) if is_own else weakly(self._measure, calc.__func__, *first)  # type: ignore[attr-defined]

    def _measure(self, calc: Callable[..., None], *arguments: Any) -> None:
        """Set a port's value; one that has failed once has no message from then on."""
        output = arguments[-1]
        if self.fault is None:
            try:
                calc(self, *arguments)
                if isinstance(output, AbstractValue) and not hasattr(output.get_value(), "__msgtype__"):
                    if or_none(output.get_value()) is None:
                        return
                    raise TypeError(f"{messages.shortened(output.get_value())} is not a message")
            except Exception as error:
                self.fault = described(error)
                where = f"sensor {self.setup.sensor.name} of {self.setup.owner}"
                _log.error("%s has failed, and measures no more: %s", where, self.fault)
            else:
                return
        if isinstance(output, AbstractValue):
            set_value(output, None)
        else:
            output.SetFromVector(np.full(output.size(), np.nan))

    def port_name(self, own: str) -> str:
        """Return the name of one of its ports of the host."""
        return f"{self.setup.prefix}{own}"

    def output(self, own: str) -> OutputPort:
        """Return the port of one of its topics, or its `values_port`."""
        return self.host.GetOutputPort(self.port_name(own))
