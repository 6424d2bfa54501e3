"""The decision of a controller manager which controllers a switch activates and deactivates."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace

from drake_twin.dataclass import dataclass
from drake_twin.planning.controller_plan import ACTIVE, INACTIVE, UNCONFIGURED, ControllerPlan, chained_to


@dataclass(frozen=True)
class Switch:
    """What a request comes down to.

    Attributes:
        started: The controllers to activate.
        stopped: The controllers to deactivate before; one that is in both is restarted.
        problems: Why other parts of the request are impossible.
        conflicts: Why nothing may be switched, with any strictness.
    """

    started: tuple[str, ...]
    stopped: tuple[str, ...]
    problems: tuple[str, ...] = ()
    conflicts: tuple[str, ...] = ()

    @property
    def message(self) -> str:
        """All reasons as one sentence."""
        return "; ".join((*self.problems, *self.conflicts))


@dataclass(frozen=True)
class SwitchRules:
    """The controllers of a robot and what holds for their activation.

    Attributes:
        plans: All controllers that may be loaded.
        states: Loaded controller → unconfigured, inactive or active.
        idle_joints: Joint → why its hardware cannot be commanded.
    """

    plans: Mapping[str, ControllerPlan]
    states: Mapping[str, str]
    idle_joints: Mapping[str, str]

    def resolve(self, to_start: Iterable[str], to_stop: Iterable[str]) -> Switch:
        """Return the possible parts of a switch, and why the others are impossible."""
        problems: list[str] = []
        stopped = []
        for name in to_stop:
            if self.states.get(name) == ACTIVE:
                stopped.append(name)
            else:
                problems.append(f"controller {name!r} is not active" if name in self.states else self.not_loaded(name))
        started = []
        for name in to_start:
            problem = self._refusal(name, stopped)
            if problem is None:
                started.append(name)
            else:
                problems.append(problem)
        self._cut_loose_ends(stopped, started, problems)
        conflicts = self._conflicts(started, stopped)
        return Switch(tuple(started), tuple(stopped), tuple(problems), tuple(conflicts))

    def with_chained_mode(self, switch: Switch) -> Switch:
        """Return a switch that also restarts the controllers that enter or leave chained mode and stay active.

        A controller is in chained mode while an active one writes to it. As in ROS 2, what it was told before is
        dropped when that changes.
        """
        before = self._active
        after = (before - {*switch.stopped}) | {*switch.started}
        changed = self._written_to(before) ^ self._written_to(after)
        stays = before - {*switch.stopped}
        restarted = tuple(name for name in self.states if name in changed and name in stays)
        return replace(switch, started=(*switch.started, *restarted), stopped=(*switch.stopped, *restarted))

    def not_loaded(self, name: str) -> str:
        """Say that a controller is not loaded."""
        return f"controller {name!r} is not loaded; loaded controllers: {', '.join(self.states) or 'none'}"

    def _refusal(self, name: str, stopped: list[str]) -> str | None:
        """Return why a controller cannot be activated; None if it can."""
        if name not in self.states:
            return self.not_loaded(name)
        if self.states[name] == UNCONFIGURED:
            return f"controller {name!r} is unconfigured"
        if self.states[name] == ACTIVE and name not in stopped:
            return f"controller {name!r} is already active"
        plan = self.plans[name]
        if plan.problem is not None:
            return f"controller {name!r}: {plan.problem}"
        for fallback in plan.fallbacks:
            if self.states.get(fallback) not in (INACTIVE, ACTIVE):
                return f"controller {name!r}: its fallback controller {fallback!r} is not configured"
            for below in chained_to(self.plans[fallback], self.plans):
                if below not in plan.fallbacks and self.states.get(below) != ACTIVE:
                    return (
                        f"controller {name!r}: its fallback controller {fallback!r} writes to {below!r}, which is"
                        " neither active nor one of its fallback controllers"
                    )
        return None

    def _conflicts(self, started: list[str], stopped: list[str]) -> list[str]:
        """Return the claims of controllers to be activated that are not free, also among them, or of idle hardware."""
        held = {
            claim: name
            for name, state in self.states.items()
            if state == ACTIVE and name not in stopped
            for claim in self.plans[name].claims
        }
        conflicts = []
        for name in started:
            for claim in self.plans[name].claims:
                if claim in held:
                    conflicts.append(
                        f"resource conflict for controller {name!r}: command interface {claim} is already claimed by"
                        f" {held[claim]!r}"
                    )
                    break
                if claim.joint in self.idle_joints:
                    conflicts.append(f"controller {name!r} claims {claim}: {self.idle_joints[claim.joint]}")
                    break
            held = dict.fromkeys(self.plans[name].claims, name) | held
        return conflicts

    def _cut_loose_ends(self, stopped: list[str], started: list[str], problems: list[str]) -> None:
        """Keep chains whole: a controller that writes to another one is active only while that one is.

        Below one that stays active, none is restarted either.
        """
        while True:
            running = (self._active - {*stopped}) | {*started}
            loose = [
                (name, owner)
                for name in running
                for owner in chained_to(self.plans[name], self.plans)
                if owner not in running or (owner in stopped and name not in stopped)
            ]
            if not loose:
                return
            name, owner = min(loose, key=lambda pair: (pair[0] not in started, pair))  # activations are judged first
            if name in started:
                started.remove(name)
                what = "is to be deactivated" if owner in stopped else "is not active"
                problems.append(f"controller {name!r} writes to {owner!r}, which {what}")
            else:
                stopped.remove(owner)
                if owner in started:
                    started.remove(owner)
                problems.append(f"controller {owner!r} is written to by {name!r}, which is active")

    @property
    def _active(self) -> set[str]:
        return {name for name, state in self.states.items() if state == ACTIVE}

    def _written_to(self, names: Collection[str]) -> set[str]:
        """Return the controllers that some controllers write to."""
        return {below for name in names for below in chained_to(self.plans[name], self.plans)}
