"""The thread that a twin belongs to: what others may use, what they are told, and how they ask."""

import concurrent.futures
import copy
import inspect
import pickle
import subprocess
import sys
import threading
import typing
from dataclasses import is_dataclass
from pathlib import Path

import eight_threads
import pytest

import drake_twin
from drake_twin import InputError, RunError, ThreadError, Twin, TwinBuilder
from drake_twin.errors import CopyError
from drake_twin.twin import docs
from drake_twin.twin.inbox import MOST, Inbox
from drake_twin.twin.owner import Owned, Owner, is_for_any_thread, public_members

ARM = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
PROGRAM = Path(__file__).parent / "eight_threads.py"


@pytest.fixture
def twin():
    with TwinBuilder(time_step=0.002).robot("arm", ARM).build() as twin:
        yield twin


def elsewhere(function, name="elsewhere"):
    """Call a function in a thread of its own; return what it returns, or raise what it raises."""
    found = concurrent.futures.Future()

    def call():
        try:
            found.set_result(function())
        except Exception as error:
            found.set_exception(error)

    thread = threading.Thread(target=call, name=name)
    thread.start()
    thread.join(60)
    return found.result(0)


def while_advancing(twin, function):
    """Advance a twin until a function has ended in another thread; return what it returns."""
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        found = pool.submit(function)
        while not found.done():
            twin.step()
        return found.result()


# What is guarded ------------------------------------------------------------------------------------------------------


def test_a_member_says_whose_the_twin_is_and_what_to_do(twin):
    with pytest.raises(ThreadError) as caught:
        elsewhere(lambda: twin.robot_state("arm"), "reader")
    assert str(caught.value) == (
        "twin.robot_state: the twin belongs to the thread 'MainThread', and this is 'reader'. Ask from here with"
        " twin.inbox.ask(function).result(), or call twin.owner.hand_over() in 'MainThread' first"
    )
    assert isinstance(caught.value, RuntimeError)


def test_each_member_of_a_subclass_is_guarded_unless_it_is_marked():
    for path, kind in Owned.PATHS.items():
        for name, member in public_members(kind):
            functions = [member.fget, member.fset] if isinstance(member, property) else [member]
            for function in filter(None, functions):
                assert ("guarded" in function.__code__.co_name) != is_for_any_thread(member), f"{path}.{name}"


def returned(member):
    """The package's own classes that a method or a property returns, by its annotation."""
    function = inspect.unwrap(member.fget if isinstance(member, property) else member)
    waiting = [typing.get_type_hints(function, localns={"Future": concurrent.futures.Future}).get("return")]
    while waiting:
        kind = waiting.pop()
        waiting += typing.get_args(kind)
        if isinstance(kind, type) and kind.__module__.startswith("drake_twin."):
            yield kind


def test_what_a_twin_hands_out_is_guarded_or_data():
    bare = {
        kind.__name__
        for each in Owned.PATHS.values()
        for _, member in public_members(each)
        for kind in returned(member)
        if not issubclass(kind, Owned | tuple) and not is_dataclass(kind)
    }
    # Drafts may be made in any thread, topics are guarded each, and what drafts are made of is read by the owner only.
    assert bare == {"Draft", "EventTopics", "Reading"}


def test_the_end_of_a_subscription_is_guarded(twin):
    for topic in ("/clock", "/rosout"):
        end = twin.subscribe(topic, lambda message: None)
        with pytest.raises(ThreadError, match="the end of a subscription"):
            elsewhere(end)
        end()


def test_what_reads_one_value_may_be_read_anywhere(twin):
    twin.advance_to(0.1)
    read = elsewhere(lambda: (twin.time, twin.robots, twin.clock.step_count, twin.clock.time_step, twin.clock.paused))
    assert read == (0.1, ("arm",), 50, 0.002, False)
    elsewhere(twin.pause)
    assert twin.advance_to(0.2) == 0.1


def test_a_refused_call_is_not_recorded(twin):
    twin.recorder.begin()
    with pytest.raises(ThreadError):
        elsewhere(lambda: twin.publish("/arm/forward_velocity_controller/commands", [1.0] * 4))
    assert twin.recorder.recording().calls == ()


def test_the_page_of_threads_is_generated():
    """Python -m drake_twin.twin.docs > drake_twin/docs/threads.md"""
    page = Path(drake_twin.__file__).parent / "docs" / "threads.md"
    assert page.read_text(encoding="utf-8") == docs.threads_page()


# Whose it is ----------------------------------------------------------------------------------------------------------


def test_a_twin_that_is_handed_over_belongs_to_the_next_thread_that_uses_it(twin):
    twin.owner.hand_over()
    assert twin.owner.name is None
    with concurrent.futures.ThreadPoolExecutor(1, "worker") as pool:
        assert pool.submit(twin.advance_to, 0.1).result() == 0.1
        assert twin.owner.name == "worker_0"
        with pytest.raises(ThreadError, match=r"twin\.step: the twin belongs to the thread 'worker_0'"):
            twin.step()
        with pytest.raises(ThreadError, match="hand_over"):
            twin.owner.hand_over()
        pool.submit(twin.owner.hand_over).result()
        assert twin.advance_to(0.2) == pytest.approx(0.2)


def test_a_thread_that_has_ended_owns_nothing():
    twin = elsewhere(TwinBuilder().robot("arm", ARM).build)
    assert twin.owner.name is None
    with twin:
        assert twin.advance_to(0.01) == 0.01
        assert twin.owner.name == "MainThread"


def test_a_new_thread_is_not_taken_for_an_ended_one_whose_number_it_has():
    twin = elsewhere(TwinBuilder().robot("arm", ARM).build)
    others = concurrent.futures.ThreadPoolExecutor(1)
    others.submit(threading.get_ident).result()  # the system gives it the number of the thread that has ended
    with twin, others:
        twin.step()
        with pytest.raises(ThreadError):
            others.submit(twin.step).result()


def test_a_callback_cannot_hand_over(twin):
    errors = []

    def hand_over(message):
        try:
            twin.owner.hand_over()
        except InputError as error:
            errors.append(str(error))

    twin.subscribe("/clock", hand_over, rate=1.0)
    twin.step()
    assert errors == ["a callback cannot hand over the twin that calls it: let it end first."]


# Asking ---------------------------------------------------------------------------------------------------------------


def test_what_is_asked_is_done_in_the_twins_thread(twin):
    def ask():
        names = twin.inbox.ask(lambda: (threading.current_thread().name, twin.robot_state("arm").joints)).result()
        twin.inbox.ask(lambda: twin.publish("/arm/forward_velocity_controller/commands", [0.5, 0, 0, 0])).result()
        return names

    name, joints = while_advancing(twin, ask)
    assert name == "MainThread"
    assert joints[0] == "joint_1"
    assert list(twin.graph.command("/arm/forward_velocity_controller/commands").data) == [0.5, 0, 0, 0]
    assert not twin.inbox.is_open


def test_what_a_callback_cannot_do_is_asked_between_advances(twin):
    robot = drake_twin.Robot("other", ARM, xyz=(0, 3, 0))

    def spawn(**how):
        return twin.inbox.ask(lambda: twin.entities.spawn(robot), **how)

    with pytest.raises(InputError, match="a callback cannot spawn"):
        while_advancing(twin, lambda: spawn().result())
    answer = elsewhere(lambda: spawn(between_advances=True))
    twin.step()
    assert not answer.done()
    twin.advance_to(twin.time)
    assert answer.result(0) is None
    assert twin.robots == ("arm", "other")


def test_what_the_function_raises_reaches_who_asked(twin):
    with pytest.raises(InputError, match="unknown robot 'leg'"):
        while_advancing(twin, lambda: twin.inbox.ask(lambda: twin.robot_state("leg")).result())


def test_the_own_thread_is_answered_at_once(twin):
    assert twin.inbox.ask(lambda: 3).result(0) == 3


def test_a_cancelled_request_is_not_done(twin):
    done = []
    assert elsewhere(lambda: twin.inbox.ask(lambda: done.append(1)).cancel())
    twin.advance_to(0.1)
    assert done == []
    assert not twin.inbox.is_open


def test_a_closed_twin_answers_nobody():
    twin = TwinBuilder().robot("arm", ARM).build()
    waiting = elsewhere(lambda: twin.inbox.ask(lambda: 1))
    twin.close()
    for ask in (lambda: waiting.result(0), lambda: elsewhere(lambda: twin.inbox.ask(lambda: 1))):
        with pytest.raises(RunError, match="the twin is closed"):
            ask()


def test_a_full_inbox_refuses():
    inbox = Inbox(Owner())

    def fill():
        for _ in range(MOST):
            inbox.ask(lambda: None)
        with pytest.raises(RunError, match=f"{MOST} requests wait"):
            inbox.ask(lambda: None)

    elsewhere(fill)


# Copies ---------------------------------------------------------------------------------------------------------------


def copies(each):
    return (lambda: copy.copy(each), lambda: copy.deepcopy(each), lambda: pickle.loads(pickle.dumps(each)))


def test_what_would_share_the_simulation_is_not_copied():
    twin = eight_threads.build()
    things = eight_threads.objects(twin, twin.graph.send_goal(eight_threads.ACTION, eight_threads.GOAL))
    assert things.keys() == Owned.PATHS.keys()
    for each in (*things.values(), twin.owner):
        words = rf"a {type(each).__name__} cannot be copied or pickled.*twin\.snapshot\(\)"
        for make in copies(each):
            with pytest.raises(CopyError, match=words):
                make()
            with pytest.raises(TypeError):  # which libraries expect
                make()
    things["page"].close()
    assert twin.advance_to(0.01) == pytest.approx(0.01)


def test_data_of_all_public_classes_can_be_copied(twin):
    """All but the twin's, functions, enumerations, and those in the test above; the text of an error stays, too."""
    twin.recorder.begin()
    command = drake_twin.Command("/arm/forward_velocity_controller/commands", (0.0,) * 4)
    things = [twin.scenario, twin.scenario.robots[0], twin.scenario.world, twin.snapshot(), twin.recorder.recording()]
    things += [twin.robot_state("arm"), twin.entities.state("arm"), command, drake_twin.StaticTransform("a", "b")]
    things += [drake_twin.Finding(drake_twin.Kind.FAILED, "x"), twin.findings, twin.latest("/tf")]
    things += [TwinBuilder().robot("arm", ARM), InputError("x", file="f", line=3, valid=["a"], value="b")]
    things += [drake_twin.CommandError("x"), RunError("x"), ThreadError("x"), drake_twin.TwinError("x")]
    others = {"Kind", "Weight", "ActionGoal", "Rewind", "Twin", "TwinPage", "__version__", "replay", "show"}
    assert {type(each).__name__ for each in things} >= set(drake_twin.__all__) - others
    for each in things:
        for make in copies(each):
            if isinstance(each, TwinBuilder):
                make().robot("more", ARM)
                assert each.scenario() == make().scenario() == TwinBuilder().robot("arm", ARM).scenario()
            else:
                assert (type(make()), str(make())) == (type(each), str(each))


# All at once ----------------------------------------------------------------------------------------------------------


def hashes(rounds, others):
    command = [sys.executable, "-X", "dev", "-X", "faulthandler", str(PROGRAM), str(rounds), others]
    run = subprocess.run(command, capture_output=True, text=True, timeout=1200, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout.splitlines()[-1].split()


@pytest.mark.parametrize("rounds", [1, pytest.param(80, marks=pytest.mark.slow)])
def test_eight_threads_at_every_member_change_nothing(rounds):
    """The 80 rounds take a minute."""
    alone = hashes(1, "no")
    assert len(alone) == 3
    assert hashes(rounds, "yes") == alone


def test_the_class_of_a_twin_keeps_its_documentation():
    assert "Drake diagram" in Twin.diagram.__doc__
    assert Twin.advance_to.__name__ == "advance_to"
