"""Executors, tasks and waitables: the expected lines are what rclpy 7.1 prints for the same programs."""

from node_runs import HEAD, lines, running, script

ROUNDS = """
from rclpy.executors import Executor, ShutdownException, SingleThreadedExecutor, TimeoutException
from rclpy.task import Future

rclpy.init()
node = Node("my")
told = []


class Turn(Executor):
    def spin_once(self, timeout_sec=None):
        try:
            handler, entity, node = self.wait_for_ready_callbacks(timeout_sec=timeout_sec)
        except TimeoutException:
            told.append("timeout")
            return
        told.append((type(entity).__name__, node is not None and node.get_name()))
        handler()
        if handler.exception() is not None:
            raise handler.exception()


# Everything that is ready is done once before anything is done again.
heard = []
node.create_subscription(String, "a", lambda message: heard.append("a" + message.data), 10)
node.create_subscription(String, "b", lambda message: heard.append("b" + message.data), 10)
first, second = node.create_publisher(String, "a", 10), node.create_publisher(String, "b", 10)
executor = SingleThreadedExecutor()
executor.add_node(node)
for _ in range(200):
    executor.spin_once(timeout_sec=0.002)
for number in range(2):
    first.publish(String(data=str(number)))
    second.publish(String(data=str(number)))
pause = Future()
executor.spin_until_future_complete(pause, 0.2)
print(heard)

# The newest task is first, and a task that waits is asked again.
order = []


async def early():
    order.append("early")
    return 1


async def late(other):
    order.append("late")
    order.append(await other)


other = executor.create_task(early)
executor.create_task(late, other)
executor.create_task(order.append, "newest")
for _ in range(6):
    executor.spin_once(timeout_sec=0)
print(order)

# What a task raises is raised by the spin.
failed = executor.create_task(lambda: 1 / 0)
try:
    executor.spin_once(timeout_sec=0)
except ZeroDivisionError as error:
    print(error, failed.done(), type(failed.exception()).__name__)
executor.remove_node(node)
print(executor.add_node(node), executor.add_node(node), executor.get_nodes() == [node])
executor.shutdown()
print(executor.get_nodes(), executor._is_shutdown)
try:
    executor.wait_for_ready_callbacks()
except ShutdownException as error:
    print(type(error).__name__)

# An executor of a user's own.
other_node = Node("other")
turn = Turn()
turn.add_node(other_node)
timer = other_node.create_timer(0.05, lambda: told.append("tick"))
guard = other_node.create_guard_condition(lambda: told.append("guard"))
guard.trigger()
turn.spin_once(1)
timer.reset()
turn.spin_once(1)
timer.cancel()
turn.spin_once(0.01)
print(told)
"""

WAITABLE = """
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.guard_condition import GuardCondition
from rclpy.waitable import NumberOfEntities, Waitable


class Bell(Waitable):
    def __init__(self):
        super().__init__(ReentrantCallbackGroup())
        self.guard = GuardCondition(None, None)
        self.index = None
        self.rings = []

    def is_ready(self, wait_set):
        return wait_set.is_ready("guard_condition", self.index)

    def take_data(self):
        return "rung"

    async def execute(self, taken_data):
        self.rings.append(taken_data)

    def get_num_entities(self):
        return NumberOfEntities(num_gcs=1)

    def add_to_wait_set(self, wait_set):
        self.index = wait_set.add_guard_condition(self.guard.handle)


rclpy.init()
node = Node("my")
bell = Bell()
node.add_waitable(bell)
executor = SingleThreadedExecutor()
executor.add_node(node)
for count in (0, 1, 2):
    for _ in range(count):
        bell.guard.trigger()
    for _ in range(3):
        executor.spin_once(timeout_sec=0.01)
    print(count, bell.rings)
node.remove_waitable(bell)
bell.guard.trigger()
executor.spin_once(timeout_sec=0.01)
print(bell.rings, bell in list(node.waitables))
print(NumberOfEntities(1, 2) + NumberOfEntities(1, num_events=4))
"""

FUTURES = """
from rclpy.task import Future

rclpy.init()
future = Future()
future.cancel()
print(future.done(), future.cancelled())
future.set_result(3)
print(future.done(), future.cancelled(), future.result())
waiting = Future()
waiting.add_done_callback(lambda done: 1 / 0)
waiting.add_done_callback(lambda done: print("second", done.result()))
waiting.set_result("x")
"""


def printed(folder, capsys, text):
    with running(script(folder, "my.py", HEAD + text)) as twin:
        twin.advance_to(3.0)
        assert twin.findings == ()
    return lines(capsys)


def test_all_that_is_ready_is_done_once_in_each_round(tmp_path, capsys):
    assert printed(tmp_path, capsys, ROUNDS) == [
        "['a0', 'b0', 'a1', 'b1']",
        "['newest', 'late', 'early', 1]",
        "division by zero True ZeroDivisionError",
        "True False True",
        "[] True",
        "ShutdownException",
        "[('GuardCondition', 'other'), 'guard', ('Timer', 'other'), 'tick', 'timeout']",
    ]


def test_an_executor_waits_for_what_a_user_has_made(tmp_path, capsys):
    assert printed(tmp_path, capsys, WAITABLE) == [
        "0 []",
        "1 ['rung']",
        "2 ['rung', 'rung']",
        "['rung', 'rung'] False",
        "<NumberOfEntities(2, 2, 0, 0, 0, 4)>",
    ]


def test_futures_are_done_only_with_a_result(tmp_path, capsys):
    assert printed(tmp_path, capsys, FUTURES) == ["False True", "True False 3", "second x"]


AWAITED = """
import asyncio
from std_srvs.srv import Trigger

rclpy.init()
node = Node("my")
node.create_service(Trigger, "ask", lambda request, response: Trigger.Response(message="yes"))
client = node.create_client(Trigger, "ask")


async def spin():
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.0)
        await asyncio.sleep(0.01)


async def nested():
    return (await client.call_async(Trigger.Request())).message


async def main():
    spinning = asyncio.create_task(spin())
    print((await client.call_async(Trigger.Request())).message)
    print(await rclpy.get_global_executor().create_task(nested))
    found = await asyncio.gather(*(asyncio.wait_for(ask(), 1.0) for _ in range(2)))
    print(found, node.get_clock().now().nanoseconds < 200_000_000)
    try:
        await asyncio.wait_for(never(), 0.1)
    except asyncio.TimeoutError:
        print("timeout")
    spinning.cancel()


async def ask():
    return (await client.call_async(Trigger.Request())).message


async def never():
    await rclpy.Future()


asyncio.run(main())
"""


def test_asyncio_awaits_what_rclpy_answers(tmp_path, capsys):
    """As in rclpy/actions/minimal_action_client/client_asyncio.py of ros2/examples."""
    with running(script(tmp_path, "my.py", HEAD + AWAITED)) as twin:
        twin.advance_to(3.0)
        assert twin.findings == ()
    assert lines(capsys) == ["yes", "yes", "['yes', 'yes'] True", "timeout"]
