"""``/parameter_events`` of node programs, as rclpy publishes them (node.py, _set_parameters_atomically_common)."""

from nodes.node_runs import running, script

from drake_twin.messages.parameter_value import python_value

NODE = """
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.parameter import Parameter


class My(Node):
    def __init__(self):
        super().__init__("tuned", namespace="/lab")
        self.count = 0
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.count += 1
        if self.count == 1:
            self.declare_parameter("gain", 2.5)
            self.declare_parameter("names", ["a", "b"])
            self.declare_parameter("loose", 1, ParameterDescriptor(dynamic_typing=True))
        elif self.count == 2:
            self.set_parameters([Parameter("gain", value=3.5), Parameter("loose", value="text")])
        elif self.count == 3:
            self.set_parameters_atomically([Parameter("gain", value=4.5), Parameter("names", value=["c"])])
        elif self.count == 4:
            self.set_parameters([Parameter("gain", value="wrong")])
            self.set_parameters([Parameter("loose")])
            self.undeclare_parameter("names")
"""


def told(event):
    def values(parameters):
        return {item.name: (item.value.type, python_value(item.value)) for item in parameters}

    stamp = event.stamp.sec + event.stamp.nanosec * 1e-9
    kinds = event.new_parameters, event.changed_parameters, event.deleted_parameters
    return (round(stamp, 3), event.node, *map(values, kinds))


def test_new_changed_and_deleted_parameters_are_told(tmp_path):
    """The types are those of rcl_interfaces/msg/ParameterType; what is refused is not told, nor what is undeclared."""
    heard = []
    with running(script(tmp_path, "node.py", NODE)) as twin:
        twin.advance_to(0.05)
        twin.subscribe("/parameter_events", heard.append)
        twin.advance_to(0.55)
    node = "/lab/tuned"
    assert [told(event) for event in heard] == [
        (0.1, node, {"gain": (3, 2.5)}, {}, {}),
        (0.1, node, {"names": (9, ["a", "b"])}, {}, {}),
        (0.1, node, {"loose": (2, 1)}, {}, {}),
        (0.2, node, {}, {"gain": (3, 3.5)}, {}),
        (0.2, node, {}, {"loose": (4, "text")}, {}),
        (0.3, node, {}, {"gain": (3, 4.5), "names": (9, ["c"])}, {}),
        (0.4, node, {}, {}, {"loose": (0, None)}),
    ]


def test_a_node_tells_of_use_sim_time_when_it_begins(tmp_path):
    heard = []
    with running(script(tmp_path, "node.py", NODE)) as twin:
        twin.subscribe("/parameter_events", heard.append)
        twin.advance_to(0.05)
    found = [(event.node, item.name, item.value.bool_value) for event in heard for item in event.new_parameters]
    names = ("use_sim_time", "start_type_description_service")
    assert found == [("/lab/tuned", name, True) for name in names]


UNDECLARED = """
from rclpy.parameter import Parameter


class My(Node):
    def __init__(self):
        super().__init__("free", allow_undeclared_parameters=True)
        self.create_subscription(String, "go", lambda message: None, 1)
        self.set_parameters([Parameter("x", value=1)])
        self.set_parameters([Parameter("x", value="other type")])
        print(self.describe_parameter("x").dynamic_typing, self.get_parameter("x").value)
        self.set_parameters([Parameter("x")])
        print(self.has_parameter("x"))
"""


def test_undeclared_parameters_come_and_go_by_their_values(tmp_path, capsys):
    heard = []
    with running(script(tmp_path, "node.py", UNDECLARED)) as twin:
        twin.subscribe("/parameter_events", heard.append)
        twin.advance_to(0.05)
    assert capsys.readouterr().out.split() == ["True", "other", "type", "False"]
    assert [told(event)[2:] for event in heard[2:]] == [
        ({"x": (2, 1)}, {}, {}),
        ({}, {"x": (4, "other type")}, {}),
        ({}, {}, {"x": (0, None)}),
    ]


LISTENER = """
from rcl_interfaces.msg import ParameterEvent
from rclpy.qos import qos_profile_parameter_events


class My(Node):
    def __init__(self):
        super().__init__("watch")
        self.create_subscription(ParameterEvent, "/parameter_events", self.hear, qos_profile_parameter_events)

    def hear(self, event):
        for item in event.changed_parameters:
            print(event.node, item.name, item.value.double_value)
"""


def test_a_node_hears_the_events_of_another(tmp_path, capsys):
    files = [script(tmp_path, f"{name}.py", text) for name, text in (("tuned", NODE), ("watch", LISTENER))]
    with running(*files) as twin:
        twin.advance_to(0.25)
    assert "/lab/tuned gain 3.5" in capsys.readouterr().out


HANDLER = """
from rclpy.parameter_event_handler import ParameterEventHandler


class My(Node):
    def __init__(self):
        super().__init__("watch", namespace="/lab")
        self.handler = ParameterEventHandler(self)
        self.first = self.handler.add_parameter_callback("gain", "tuned", lambda item: self.tell("first", item))
        self.handler.add_parameter_callback("gain", "/lab/tuned", lambda item: self.tell("second", item))
        self.handler.add_parameter_callback("gain", "/tuned", lambda item: self.tell("of another node", item))
        self.handler.add_parameter_event_callback(lambda event: print("event", event.node))
        self.create_timer(0.25, self.stop)

    def tell(self, who, item):
        print(who, item.name, item.value.double_value)

    def stop(self):
        self.handler.remove_parameter_callback(self.first)
        try:
            self.handler.remove_parameter_callback(self.first)
        except RuntimeError as error:
            print(error)
            self.destroy_timer(next(iter(self.timers)))
"""


def test_a_handler_calls_back_for_parameters_the_last_one_first(tmp_path, capsys):
    """As rclpy's parameter_event_handler.py: new and changed values, names of nodes relative to the handler's own."""
    files = [script(tmp_path, f"{name}.py", text) for name, text in (("watch", HANDLER), ("tuned", NODE))]
    with running(*files) as twin:
        twin.advance_to(0.35)
    told = [line for line in capsys.readouterr().out.splitlines() if not line.startswith("event")]
    assert told == [
        "second gain 2.5",
        "first gain 2.5",
        "second gain 3.5",
        "first gain 3.5",
        "Callback doesn't exist",
        "second gain 4.5",
    ]
