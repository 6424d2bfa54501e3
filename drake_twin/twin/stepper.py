"""Advance a session: from one step at which something is due to the next, and back when a step fails."""

import logging
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import floor
from operator import lt
from typing import Any

from pydrake.systems.analysis import InitializeParams

from drake_twin.errors import CommandError, InputError, RunError
from drake_twin.scenario import CENIC
from drake_twin.twin.failure import Moment, failure, is_possible
from drake_twin.twin.inbox import Inbox
from drake_twin.twin.schedule import ScheduledCommand, step_at
from drake_twin.twin.session import Session

_log = logging.getLogger(__name__)

_INSTANT = 1e-9  # s; a continuous plant stands still for so long where a discrete one is between two steps
_LONGEST_ADVANCE = 1.0  # s that are simulated at one go, and once more when one of the steps fails
_LONGEST_LAG = 0.01  # s of what is delivered without a stop


class Stepper:
    """Advances a session in the thread that asks for it, in a fixed order, so that a run is repeatable to the bit.

    Args:
        session: The session.
        publish: Publishes a scheduled command as if a user had published it.
        inbox: What other threads ask of the twin.

    Attributes:
        paused: Whether time stands still.
    """

    def __init__(self, session: Session, publish: Callable[[str, Any], None], inbox: Inbox):
        self._session = session
        self._inbox = inbox
        self._publish = publish
        self._is_advancing = False
        self._refused: dict[str, str] = {}  # topics of the scenario's commands → why the last one was refused
        self.paused = False
        session.is_advancing = session.owner.is_advancing = lambda: self.is_advancing

    @property
    def is_advancing(self) -> bool:
        """Whether the session is advancing, so that the caller is a callback."""
        return self._is_advancing

    def refuse_inside_callback(self, what: str) -> None:
        """Refuse what a callback cannot do.

        Raises:
            InputError: If the session is advancing.
        """
        if self._is_advancing:
            raise InputError(f"a callback cannot {what} the twin that calls it: it may publish, pause and subscribe")

    def advance(self, target: int, time: float | None = None) -> None:
        """Advance to a step, or until paused.

        Args:
            target: The step, in steps of the present length.
            time: The time (s) from which the step follows, if it does: a step of another length may meet it better.

        Raises:
            InputError: If the session is advancing already.
            RunError: If a step fails; the state is the one before that step then.
        """
        if self._is_advancing:
            self.refuse_inside_callback("advance")
        self._is_advancing = True
        session, clock = self._session, self._session.clock
        if session.physics.is_handed_out:
            session.physics.look_at_parameters()
        start = clock.step * clock.time_step
        end = target * clock.time_step if time is None else time
        try:
            while clock.step < target and not self.paused:
                if not session.subscriptions.is_caught_up:
                    session.subscriptions.catch_up(clock.step)
                if session.subscriptions.due_step <= clock.step:
                    session.subscriptions.deliver(clock.step)
                    if self.paused or session.alarm.requests:
                        break
                if session.alarm.due_step <= clock.step:
                    session.alarm.ring()
                    if self.paused or session.alarm.requests:
                        break
                if session.events.is_waiting:
                    session.events.deliver()
                    if self.paused or session.alarm.requests:
                        break
                if self._inbox.is_open and self._inbox.is_waiting:
                    self._inbox.look()
                    if self.paused:
                        break
                if session.triggers.pending:
                    session.triggers.apply()
                    if session.events.is_waiting:
                        session.events.deliver()
                    if self.paused or session.alarm.requests:
                        break
                dropped = session.reactions.deployments
                if dropped is not None and dropped.fix_due(session.triggers.request):
                    break
                if clock.next_time_step is not None and self.change_time_step():
                    target = step_at(end, clock.time_step)
                    continue
                self._advance_once(target)
            if not session.subscriptions.is_caught_up:
                session.subscriptions.catch_up(clock.step)
            if session.events.is_waiting:
                session.events.deliver()
            if clock.next_time_step is not None:
                self.change_time_step()  # the next caller finds the step length that is valid from here on
        finally:
            session.simulated += clock.step * clock.time_step - start
            self._is_advancing = False

    def change_time_step(self) -> bool:
        """Change to the next step length if its time has come; return whether the step has changed."""
        clock = self._session.clock
        if clock.next_time_step is None or clock.change_step() != clock.step:
            return False
        new, clock.next_time_step = clock.next_time_step, None
        if new != clock.time_step:
            self._session.rebuild(replace(self._session.scenario, time_step=new))
        return True

    def _advance_once(self, target: int) -> None:
        """Advance to the next step at which something is due."""
        session = self._session
        clock, physics, controls = session.clock, session.physics, session.controls.values()
        start = physics.moment()
        for control in controls:
            control.kept = None
        time = clock.step * clock.time_step
        wrenches = session.wrenches
        if wrenches.items or wrenches.pushes:
            wrenches.update(clock)
        else:
            wrenches.before = (), (), wrenches.steady
        if session.triggers.heard:
            session.triggers.keep()
        session.commands.apply(time, self._publish_scheduled)
        if not physics.detachable_joints.is_empty:
            physics.detachable_joints.follow()
        for control in controls:
            if control.check_period is not None and clock.step % clock.steps(control.check_period) == 0:
                control.check_joints()
        # CENIC's steps follow from where it is stopped: always at the same places, whatever is subscribed.
        is_watching = session.reactions.are_noticing and session.reactions.are_watching
        is_next = target == clock.step + 1 or session.scenario.engine == CENIC or is_watching
        next_step = clock.step + 1 if is_next else self._next_stop(target)
        try:
            noticed = self._advance_simulator(next_step)
        except (Exception, SystemExit) as error:  # of Drake, or of a system that the user has added
            raise self._go_back_from(error, start, next_step) from error
        except KeyboardInterrupt:  # somewhere within a step
            self._go_back_to_start(start)
            raise
        step = round(physics.context.get_time() / clock.time_step)
        clock.step, clock.time = step, step * clock.time_step  # as `Clock.go_to`, which is a call more in each advance
        if noticed:
            for control in controls:
                control.deactivate_faulty()
                control.follow_commands()
        if session.goals.items:
            session.goals.deliver()
        if is_watching:
            session.reactions.look(physics)

    def _publish_scheduled(self, scheduled: ScheduledCommand) -> None:
        try:
            self._publish(scheduled.topic, scheduled.data)
        except CommandError as error:
            if self._refused.get(scheduled.topic) != str(error):  # once for each cause
                _log.warning("%s", error)
            self._refused[scheduled.topic] = str(error)
        else:
            self._refused.pop(scheduled.topic, None)

    def _advance_simulator(self, step: int) -> bool:
        """Advance to a step, or to the first one at which a controller ends the advance; return whether one did."""
        physics, clock = self._session.physics, self._session.clock
        if physics.new_events:
            physics.meet_new_events()
        status = None
        if self._inbox.is_open:  # a look into it costs less than a stop
            look = clock.step
            while (look := (look // (period := clock.steps(self._inbox.period)) + 1) * period) < step:
                status = physics.simulator.AdvanceTo(physics.time_of(look))
                if self._inbox.has_request() or not status.succeeded():
                    break
                status = None
        status = status or physics.simulator.AdvanceTo(physics.time_of(step))
        noticed = not status.succeeded()  # Drake raises what it cannot do
        if noticed:
            self._finish_step()
        if not physics.check():
            raise RuntimeError("the state is not made of finite numbers")
        return noticed

    def _finish_step(self) -> None:
        """Advance to the next step from where a controller has ended an advance."""
        # All that happens at this time has happened, but Drake would do it again from here, the plant's step too: so
        # it is continued from between two steps. An update a rounding before its step leaves that step to come.
        physics, time_step = self._session.physics, self._session.clock.time_step
        now = physics.context.get_time()
        if self._session.scenario.engine == CENIC:
            next_step = floor(now / time_step + 1e-6) + 1
            physics.context.SetTime(now + _INSTANT)
        else:
            step = round(now / time_step)
            is_early = now < step * time_step
            next_step = step if is_early else step + 1
            physics.context.SetTime(step * time_step if is_early else (step + 0.5) * time_step)
        physics.simulator.Initialize(InitializeParams(suppress_initialization_events=True))
        physics.simulator.AdvanceTo(physics.time_of(next_step))

    def _go_back_from(self, error: BaseException, start: Moment, end: int) -> RunError:
        """Return to the last good state, and return the error to raise.

        Args:
            error: What was raised.
            start: The moment from which the simulator was to advance.
            end: The step that it was to advance to.
        """
        session, clock, physics = self._session, self._session.clock, self._session.physics
        if not is_possible(start.state):  # it was written into the context
            return failure(session.built, physics.plant_context, clock.time, error)
        good = before = start
        if end > clock.step + 1:  # a second try finds which of the steps fails
            physics.go_back(start)
            try:
                for step in range(clock.step + 1, end + 1):
                    self._advance_simulator(step)
                    before, good = good, physics.moment()
                    clock.go_to(step)
            except (Exception, SystemExit) as again:
                error = again
        earlier = None if before is good else before
        found = failure(session.built, physics.plant_context, clock.time, error, good, earlier)
        if good is start:
            self._go_back_to_start(start)
        else:
            physics.go_back(good)
        return found

    def _go_back_to_start(self, start: Moment) -> None:
        """Return to where an advance began: what was due then is still due."""
        session = self._session
        session.wrenches.take_back()
        session.commands.take_back()
        session.triggers.take_back()
        for control in session.controls.values():
            control.take_back()
        session.physics.go_back(start)

    def _next_stop(self, target: int) -> int:
        """Return the next step at which something is due, the end of the longest advance, or the target."""
        session, clock = self._session, self._session.clock
        longest_advance = _LONGEST_ADVANCE if session.subscriptions.is_caught_up else _LONGEST_LAG
        longest = max(1, round(longest_advance / clock.time_step))
        due = [
            target,
            clock.step + longest,
            session.subscriptions.due_step,
            session.alarm.due_step,
            *session.commands.due_steps(),
        ]
        if session.triggers.pending:
            due += session.triggers.due_steps()
        if session.reactions.deployments is not None:
            due += session.reactions.deployments.due_steps()
        if session.wrenches.items or session.wrenches.pushes:
            due += session.wrenches.due_steps(clock)
        if (change := clock.change_step()) is not None:
            due.append(change)
        for control in session.controls.values():
            if control.check_period is not None:
                steps = clock.steps(control.check_period)
                due.append((clock.step // steps + 1) * steps)
        return int(min(filter(partial(lt, clock.step), due)))
