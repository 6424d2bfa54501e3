"""The wrong versions of the code that `mutants` tries, as data."""

from dataclasses import dataclass
from itertools import starmap


@dataclass(frozen=True)
class Mutant:
    """One wrong line.

    Attributes:
        name: Its name; one about chained controllers begins with ``chain``.
        files: The module below the package, or a pattern for those that may hold the line.
        text: The part of the line that is replaced.
        replacement: What stands there instead.
        tests: The test files that must notice it, the quickest first.
        survives: Why no test notices it; empty for one that must be caught.
    """

    name: str
    files: str
    text: str
    replacement: str
    tests: tuple[str, ...]
    survives: str = ""


MANAGER = ("tests/twin/test_chains.py", "tests/twin/test_controller_manager.py", "tests/test_ros2_control.py")
PLANNING = (
    "tests/planning/test_plan_controllers.py",
    "tests/planning/test_robot_plan.py",
    "tests/planning/test_gazebo_drive_plan.py",
)
DIAGRAM = (
    "tests/twin/test_chains.py",
    "tests/controllers/test_pid_controller.py",
    "tests/diagram/test_robot_diagram.py",
)
CONTROL = ("tests/twin/test_robot_control.py", "tests/test_ros2_control.py", "tests/test_wrong_use.py")
COMMANDS = ("tests/twin/test_commands.py", "tests/twin/test_failure.py", "tests/test_ros2_control.py")
SESSION = ("tests/twin/test_session.py", "tests/twin/test_living_world.py", "tests/twin/test_snapshot.py")
STEPPER = ("tests/twin/test_stepper.py", "tests/twin/test_failure.py", "tests/diagram/test_robot_diagram.py")
STATE = ("tests/twin/test_state.py", "tests/test_ros2_control.py")
SCHEDULE = ("tests/twin/test_schedule.py", "tests/twin/test_twin.py")
SUBSCRIPTIONS = ("tests/twin/test_subscriptions.py", "tests/twin/test_twin.py", "tests/twin/test_living_world.py")
GAINS = ("tests/diagram/test_servo_gains.py", "tests/test_ros2_control.py")
PROTOCOL = ("tests/cockpit/test_protocol.py",)
FOLLOWER = ("tests/controllers/test_joint_trajectory_controller.py",)
TRAJECTORY = (
    "tests/control/test_trajectory.py",
    "tests/control/test_trajectory_check.py",
    "tests/control/test_stop_trajectory.py",
    "tests/control/test_tolerances.py",
)


def _of(files: str, tests: tuple[str, ...], *lines: tuple[str, ...]) -> list[Mutant]:
    """Return the mutants of some files: name, text, replacement and, for one that survives, why."""

    def mutant(name: str, text: str, replacement: str, survives: str = "") -> Mutant:
        return Mutant(name, files, text, replacement, tests, survives)

    return list(starmap(mutant, lines))


MUTANTS = (
    *_of(
        "twin/controller_*.py",
        MANAGER,
        ("chain: a failure stops one level above", "for below in stopped:", "for below in stopped[:1]:"),
        ("chain: a failure stops namesakes", 'startswith(f"{below}/")', "startswith(below)"),
        ("chain: a failure stops pure writers only", "and any(claim.joint", "and all(claim.joint"),
        ("chain: loose ends forget what starts", "- {*stopped}) | {*started}", "- {*stopped})"),
        ("chain: loose ends forget what stops", "(self._active - {*stopped}) |", "self._active |"),
        ("chain: loose ends are cut at the wrong side", "if name in started:", "if name not in started:"),
        ("chain: one loose end is looked for", "if not loose:", "if not loose or problems:"),
        (
            "chain: a reference is claimed twice",
            "if claim in held:",
            'if claim in held and "/" not in claim.joint:',
        ),
        (
            "chain: two writers start at once",
            "held = dict.fromkeys(self.plans[name].claims, name) | held",
            'held = dict.fromkeys((item for item in self.plans[name].claims if "/" not in item.joint), name) | held',
        ),
        (
            "chain: what is written to is deactivated alone",
            "if owner not in running or (owner in stopped and name not in stopped)",
            "if name in started and owner not in running",
        ),
        (
            "chain: a writer is activated alone",
            "if owner not in running or (",
            "if (owner not in running and name not in started) or (",
        ),
        ("chain: what is written to is restarted alone", "(owner in stopped and name not in stopped)", "False"),
        ("chain: no chain is restarted", "(owner in stopped and name not in stopped)", "owner in stopped"),
        ("chain: a refused restart activates what is active", "if owner in started:", "if owner in ():"),
        ("chain: deactivations are judged first", "(pair[0] not in started, pair)", "(pair[0] in started, pair)"),
        (
            "chain: chained mode is entered without a restart",
            "self._written_to(before) ^ self._written_to(after)",
            "self._written_to(before) - self._written_to(after)",
        ),
        (
            "chain: chained mode is left without a restart",
            "self._written_to(before) ^ self._written_to(after)",
            "self._written_to(after) - self._written_to(before)",
        ),
        (
            "chain: what stays in chained mode is restarted",
            "self._written_to(before) ^ self._written_to(after)",
            "self._written_to(before) | self._written_to(after)",
        ),
        ("chain: what is deactivated in a chain starts again", "and name in stays)", "and name in before)"),
        (
            "chain: what is restarted was never stopped",
            "stopped=(*switch.stopped, *restarted)",
            "stopped=switch.stopped",
        ),
        ("chain: what is restarted stays stopped", "started=(*switch.started, *restarted)", "started=switch.started"),
        ("chain: a switch leaves chained modes", "self._rules.with_chained_mode(switch)", "switch"),
        (
            "chain: references are available while inactive",
            "HardwareInterface(str(reference), self.is_active(plan.name), ",
            "HardwareInterface(str(reference), True, ",
        ),
        (
            "chain: exported states are available while inactive",
            'f"{plan.name}/{name}", self.is_active(plan.name))',
            'f"{plan.name}/{name}", True)',
        ),
        ("chain: FORCE_AUTO restarts what is active", "not in to_start + to_stop]", "not in to_stop]"),
        (
            "chain: only the first below must be active",
            "for owner in chained_to(self.plans[name], self.plans)\n",
            "for owner in chained_to(self.plans[name], self.plans)[:1]\n",
        ),
        ("chain: what starts below does not count", "| {*started}", "| {*started[:1]}"),
        ("chain: a fallback needs nothing below", "below not in plan.fallbacks and", "False and"),
        ("chain: a fallback's chain is not in the list", "below not in plan.fallbacks and", ""),
        (
            "chain: a failure's fallbacks leave the writers",
            "stopped = self._with_writers([*failed,",
            "stopped = list([*failed,",
        ),
        (
            "chain: the fallbacks of writers are forgotten",
            "for each in failed for fallback",
            "for each in failed[:1] for fallback",
        ),
        ("manager: fallbacks replace nobody", "if not fallbacks or switch.message:", "if fallbacks or switch.message:"),
        ("manager: some fallbacks are better than none", "if not fallbacks or switch.message:", "if not fallbacks:"),
        ("manager: conflicts are left out", "if switch.conflicts or (", "if ("),
        ("manager: idle hardware is driven", "if claim.joint in self.idle_joints:", "if not claim:"),
        ("manager: unknown ones are left out", "if names and not any(", "if names and all("),
        ("manager: no default strictness", "strictness or self.default_strictness()", "strictness or 1"),
        ("chain: chained by all references only", "is_chained=any(", "is_chained=all("),
        ("chain: references of active ones only", "in (INACTIVE, ACTIVE)]", "in (ACTIVE,)]"),
        ("chain: FORCE_AUTO is BEST_EFFORT", "if strictness == FORCE_AUTO:", "if not strictness:"),
        ("chain: FORCE_AUTO makes way for the first", "self._in_the_way(to_start)", "self._in_the_way(to_start[:1])"),
        (
            "manager: STRICT is BEST_EFFORT",
            "(switch.message and strictness == STRICT)",
            "(switch.message and not strictness)",
        ),
        (
            "manager: claims of stopped ones hold",
            "if state == ACTIVE and name not in stopped\n",
            "if state == ACTIVE\n",
        ),
        (
            "manager: a switch allows two claims",
            "held = dict.fromkeys(self.plans[name].claims, name) | held",
            "held = dict(held)",
        ),
        (
            "manager: a restarted one stays stopped",
            "self._states.update(dict.fromkeys(switch.started, ACTIVE))",
            "self._states.update({name: ACTIVE for name in switch.started if name not in switch.stopped})",
        ),
        (
            "manager: active ones start again",
            "self.states[name] == ACTIVE and name not in stopped",
            "self.states[name] == ACTIVE and name in stopped",
        ),
        ("manager: stop is not deactivate", "*_names(deactivate), *_names(stop)", "*_names(deactivate)"),
        ("manager: unknown states are set", "or state not in (UNCONFIGURED, INACTIVE, ACTIVE)", ""),
        (
            "manager: starts and stops are reported reversed",
            "self._switched(switch.started, switch.stopped)",
            "self._switched(switch.stopped, switch.started)",
        ),
    ),
    *_of(
        "planning/controller_plan.py",
        PLANNING,
        ("chain: every slash is a chain", "return bool(slash) and owner in controllers", "return bool(slash)"),
        ("chain: a joint named as a controller", "return bool(slash) and owner in", "return owner in"),
        ("chain: writes to the first only", "return tuple(dict.fromkeys(owners))", "return tuple(owners)[:1]"),
    ),
    *_of(
        "planning/*.py",
        PLANNING,
        ("chain: references exist unseen", "not in plans[owner].references", "in ()"),
        (
            "chain: any reference of the joint will do",
            "if Interface(joint, claim.name) not in plans[owner].references:",
            "if joint not in [reference.joint for reference in plans[owner].references]:",
        ),
        ("chain: a circle is allowed", "TopologicalSorter(below).prepare()", "TopologicalSorter(below)"),
        ("chain: claims need not be of joints", "not (separator and owner in known)", "not separator"),
        (
            "chain: references are no claims at the start",
            "if claim in claimed_by)",
            'if claim in claimed_by and "/" not in claim.joint)',
        ),
        ("chain: active above an inactive one at the start", "if found is None:", "if found:"),
        ("chain: only the next above is inactive at the start", "if found is None:", "if found is None or idle:"),
        (
            "planning: the last claim wins",
            "elif wanted == ACTIVE and taken is not None:",
            "elif wanted == ACTIVE and not taken:",
        ),
        ("planning: inactive ones claim", "if state == ACTIVE:\n", "if state:\n"),
        ("planning: a problem leaves it active", "state = UNLOADED", "state = wanted"),
        ("planning: a rate of zero is none", "(rate == 0 or LOWEST_RATE <", "(LOWEST_RATE <"),
        ("planning: a joint may stand twice", "if claim in seen:", "if claim in ():"),
        ("planning: inactive goes before active", "robot.active_controllers is None or name not in active]", "name]"),
        ("planning: one plugin of a name", 'name += "_plugin"', "break"),
    ),
    *_of(
        "planning/*.py",
        PLANNING,
        ("planning: a changed robot keeps its plan", "if plan is None or plan.robot != robot:", "if plan is None:"),
        (
            "planning: starts beyond the upper limit",
            "clamped = min(max(value, joint.limits.lower), joint.limits.upper)",
            "clamped = max(value, joint.limits.lower)",
        ),
        (
            "planning: effort goes before velocity",
            '("velocity", "position", "effort") if name in interfaces',
            '("effort", "position", "velocity") if name in interfaces',
        ),
        ("planning: one link named after the robot is enough", "named_after_robot = all(", "named_after_robot = any("),
        ("planning: the gain's rate is left out", "return 1.0 / (gain * update_rate)", "return 1.0 / gain"),
        ("planning: followers have friction", "joint.friction > 0 and joint.mimic is None", "joint.friction > 0"),
        (
            "planning: topics of a plugin in no namespace",
            'if topic.startswith("/") else robot_topic(plan, topic)',
            "if topic else robot_topic(plan, topic)",
        ),
    ),
    *_of(
        "diagram/robot_diagram.py",
        DIAGRAM,
        ("chain: all update at once", "max((1 + _depth(", "max((_depth("),
        ("chain: the third updates with the second", "min(depths[name], steps - 1)", "min(depths[name], steps - 1, 1)"),
        (
            "chain: built from its lower end",
            "key=lambda entry: depths[entry[0]]",
            "key=lambda entry: -depths[entry[0]]",
        ),
        (
            "chain: what is not written is the first value",
            "if reference in other.claims else -1",
            "if reference in other.claims else 0",
        ),
    ),
    *_of(
        "controllers/periodic_controller.py",
        DIAGRAM,
        ("chain: references of a silent writer are written", "if np.isfinite(values).any():", "if values.size:"),
        ("chain: references are written all or none", "if np.isfinite(values).any():", "if np.isfinite(values).all():"),
    ),
    *_of(
        "controllers/pid_controller.py",
        DIAGRAM,
        (
            "chain: its topic is heard in chained mode",
            "if upstream is not None:",
            "if upstream is not None and message is None:",
        ),
    ),
    *_of(
        "twin/robot_control.py",
        CONTROL,
        (
            "control: a stop does not hold",
            "active = () if self.stopped else self.manager.active",
            "active = self.manager.active",
        ),
        (
            "control: a stopped robot may be limp",
            "self._plan.joints.are_held or self.stopped",
            "self._plan.joints.are_held",
        ),
        ("control: goals outlive a stop", "self.controllers[name].cancel(", "self.controllers[name].goal_state("),
        (
            "control: cleared stops start nothing",
            "self._switch(self.manager.active, self.manager.active)",
            "self._switch((), self.manager.active)",
        ),
        ("control: the last mode is kept", "self.kept = self.kept or now", "self.kept = now"),
        ("control: gravity is left out at rest", "with_gravity=is_check and BRAKE in now.modes", "with_gravity=False"),
        ("control: a saved stop is lost", 'self.stopped = bool(saved["stopped"])', "self.stopped = False"),
        ("control: all joints must be pushed away", "return not all(lower", "return not any(lower"),
        ("control: other joints are released", "if joint in joints]", "if joint not in joints]"),
        ("control: inactive ones are deactivated as faulty", "if fault is not None:", "if fault is None:"),
        (
            "control: what is stopped keeps its commands",
            "for name in stopped:\n            if name in",
            "for name in ():\n            if name in",
        ),
        (
            "control: samples of others are set",
            'if set(saved["samples"]) != {name for name, _, _ in stateful}:',
            'if not saved["samples"]:',
        ),
    ),
    *_of(
        "twin/commands.py",
        COMMANDS,
        ("commands: an expiry outlives its command", "self.expiries.pop(topic, None)", "self.expiries.get(topic)"),
        ("commands: a cleared command expires", "self.expiries.pop(name, None)", "self.expiries.get(name)"),
        ("commands: pending ones outlive a deactivation", "if entry[0] not in own]", "if entry]"),
        ("commands: expiry a step late", "<= time + _ROUNDING:", "<= time - _ROUNDING:"),
        ("commands: expiry counted from zero", "= time + max(timeout,", "= max(timeout,"),
        ("commands: expiry before the next step", "max(timeout, self._clock.time_step)", "timeout"),
        ("commands: an expiry stops no advance", "times = (*self.expiries.values(), ", "times = (*(), "),
        ("commands: the scenario's come last", "in self.queue + pending:", "in pending + self.queue:"),
        ("commands: a failed step counts as published", "item.published = published", "item.published += 0"),
        (
            "commands: a failed step loses what is pending",
            "self._before.expiries, self._before.queue",
            "self._before.expiries, []",
        ),
        ("commands: the last is the first", "value in reversed(self.queue) if", "value in self.queue if"),
        (
            "commands: only silenced ones are published",
            "scheduled.topic not in self.silenced",
            "scheduled.topic in self.silenced",
        ),
        (
            "commands: a goal drops others' commands",
            "else:\n                self.queue.append((topic, value))",
            "else:\n                pass",
        ),
        ("commands: a saved silence is lost", 'set(state["silenced"])', "set()"),
        (
            "commands: robots clear each other's",
            "return (item.robot, item.controller) == (robot, controller)",
            "return item.controller == controller",
        ),
        ("commands: all are published again after a spawn", "0 if index is None else rest.pop(index)[1]", "0"),
    ),
    *_of(
        "twin/session.py",
        SESSION,
        ("session: silence outlives a reset", "self.commands.silenced.clear()", "self.commands.silenced.copy()"),
        (
            "session: a namesake has the old controllers",
            "control is None or control.plan is not plan",
            "control is None",
        ),
        ("session: pushes end with a rebuild", "self.wrenches.put(self.wrenches.items)", "self.wrenches.put(())"),
        (
            "session: a rebuild counts old steps",
            "self.clock.use(scenario.time_step)",
            "self.clock.time_step = scenario.time_step",
        ),
        ("session: new robots are not started", "if control is not known.get(name):", "if control is known.get(name):"),
        (
            "session: goals of all end with a rebuild",
            "self.goals.keep(controls.values())",
            "self.goals.drop_all()",
        ),
        (
            "session: new descriptions are not heard",
            "self.subscriptions.look_again()",
            "self.subscriptions.use(scenario.time_step)",
        ),
        (
            "session: pushes are no state",
            "            self.wrenches,",
            "            # self.wrenches,",
        ),
        ("session: optional commands are needed", "if not command.optional:", "if command.optional:"),
        ("session: deleted robots are switched", "control.retire()", "control.state()"),
    ),
    *_of(
        "twin/wrenches.py",
        ("tests/twin/test_pushes.py", *STEPPER),
        (
            "stepper: pushes last until a stop",
            "clock.time_step) for item in self.items]",
            "clock.time_step) for item in ()]",
        ),
        (
            "stepper: a failed step ends pushes",
            "items, self.pushes, self.steady = self.before",
            "items, self.pushes, self.steady = (), *self.before[1:]",
        ),
    ),
    *_of(
        "twin/stepper.py",
        STEPPER,
        ("stepper: checks where the time is cut", "(clock.step // steps + 1) * steps", "clock.step + steps"),
        ("stepper: two steps are tried once", "if end > clock.step + 1:", "if end > clock.step + 2:"),
        ("stepper: the failed step counts", "clock.go_to(step)\n", "clock.go_to(step + 1)\n"),
        (
            "stepper: a callback advances",
            "if self._is_advancing:\n            self.refuse",
            "if not self._is_advancing:\n            self.refuse",
        ),
        ("stepper: an end leaves a step out", "(step + 0.5) * time_step", "(step + 1.0) * time_step"),
        ("stepper: the target counts old steps", "target = step_at(end, clock.time_step)", "target = int(target)"),
        ("stepper: faulty controllers stay", "control.deactivate_faulty()", "control.check_joints()"),
    ),
    *_of(
        "twin/state.py",
        STATE,
        ("state: velocities are positions", "state[layout.velocities[name]]", "state[layout.positions[name]]"),
        ("state: efforts unasked", "if with_efforts:", "if not with_efforts:"),
        ("state: the order of entries is hashed", "sort_keys=True", "sort_keys=False"),
        ("state: the quaternion's real part is last", ".wxyz().tolist())", ".wxyz().tolist()[::-1])"),
        ("state: efforts in the order of joints", "efforts[layout.efforts[name]]", "efforts[names.index(name)]"),
    ),
    *_of(
        "twin/schedule.py",
        SCHEDULE,
        ("schedule: rounding makes it a step late", "time / time_step - _ROUNDING", "time / time_step"),
        (
            "schedule: due before its time",
            "return ceil(time / time_step - _ROUNDING)",
            "return int(time / time_step + _ROUNDING)",
        ),
        ("schedule: lengths meet in the past", "return -(-step // every) * every", "return step // every * every"),
        (
            "schedule: a timed command comes twice",
            "return inf if self.published else",
            "return inf if self.published > 1 else",
        ),
        (
            "schedule: a period late",
            "+ self.published * self._command.period",
            "+ (self.published + 1) * self._command.period",
        ),
        ("schedule: lengths meet in many steps", "if every * time_step > _LONGEST_WAIT:", "if every > _LONGEST_WAIT:"),
    ),
    *_of(
        "twin/subscriptions.py",
        SUBSCRIPTIONS,
        ("subscriptions: rounding loses a point", "floor(points + 1e-9)", "floor(points)"),
        ("subscriptions: two points of one step", "max(self.due, step + 1)", "self.due"),
        ("subscriptions: what has ended is delivered", "if subscription.due > step:", "if not subscription:"),
        ("subscriptions: what has ended is due", "subscription.due = inf", "subscription.due = 0"),
        ("subscriptions: the same is delivered again", "self._latched = draft.message()", "self._latched = None"),
        ("subscriptions: what is new is not", "message != self._latched", "message == self._latched"),
        (
            "subscriptions: points of the past",
            "self._last_point_before(step * time_step) + 1)",
            "self._last_point_before(step * time_step))",
        ),
        (
            "subscriptions: a new step length is not heard",
            "self._next_point * self._period, time_step)",
            "self._next_point * self._period, 0.001)",
        ),
    ),
    *_of(
        "diagram/joint_loads.py",
        GAINS,
        ("loads: gravity has a sign", "loads = np.abs(", "loads = np.array("),
        (
            "loads: the least inertia",
            "np.maximum(inertia, masses[velocities])",
            "np.minimum(inertia, masses[velocities])",
        ),
        ("loads: those of the start alone", "if sample > 0:", "if sample > _SAMPLES:"),
        (
            "loads: neighbours share samples",
            "[np.random.default_rng(0) for _ in robots]",
            "[np.random.default_rng(0)] * len(robots)",
        ),
        ("loads: weight beyond the effort limit", "return min(weight * lever,", "return max(weight * lever,"),
        ("loads: friction is left out", "float(load) + _friction(plan, actuator)", "float(load)"),
        ("loads: any stiffness", "if time_step == 0.0:", "if time_step >= 0.0:"),
    ),
    *_of(
        "diagram/gyroscopic_moments.py",
        ("tests/physics/test_tumbling.py",),
        ("tumbling: half of the moment", "h / 2 * second", "h / 4 * second"),
        ("tumbling: no third order", "h * h / 6 * third", "0.0 * third"),
        ("tumbling: robots with joints", "len(moving) > len(welded)", "len(moving) < len(welded)"),
        ("tumbling: inertias are as built", "scales.append(scale if", "scales.append(1.0 if"),
    ),
    *_of(
        "diagram/lumped_masses.py",
        ("tests/physics/test_standing_robots.py",),
        ("lumped: no lever", "part.mass * (lever @ lever", "0.0 * (lever @ lever"),
        ("lumped: into the wrong axes", "poses[heaviest].inverse() @ poses[name]", "poses[name]"),
        (
            "lumped: links without shapes",
            "_LIGHT * total or links[name].find",
            "_LIGHT * total or not links[name].find",
        ),
    ),
    *_of(
        "diagram/servo_gains.py",
        GAINS,
        (
            "gains: inertia times the time constant",
            "load.inertia / time_constant,",
            "load.inertia * time_constant,",
        ),
        ("gains: inertia over T", "load.inertia / T**2", "load.inertia / T"),
        ("gains: stiffness over T", "d=stiffness * T", "d=stiffness / T"),
        ("gains: DOWN has none", "if mode in (VELOCITY, UP, DOWN):", "if mode in (VELOCITY, UP):"),
        ("gains: REST has none", "if mode in (BRAKE, REST)", "if mode in (BRAKE,)"),
        ("gains: damping is left out", "load.damping / _RELATIVE_ERROR_UNDER_DAMPING", "0.0"),
        ("gains: a given time constant is ignored", "T = time_constant", "T = 0.25"),
        ("gains: the effort is left out", "min(effort, _STIFFEST * moves)", "0.0"),
        ("gains: as stiff as wanted", "if stiffness > stiffest:", "if stiffness < 0.0:"),
        ("gains: a brake without its limit", "effort_limit / REST_VELOCITY", "effort_limit"),
    ),
    *_of(
        "cockpit/protocol.py",
        PROTOCOL,
        ("protocol: no step at all", "not 1 <= request.count", "not 0 <= request.count"),
        ("protocol: whole numbers of any size", "largest = 2**31", "largest = 2**62"),
        ("protocol: the longest text is too long", "len(value) > longest", "len(value) >= longest"),
        ("protocol: control characters", " or not shown.isprintable()", ""),
        ("protocol: a browser says Gone", "if kind is not Gone}", "}"),
    ),
    *_of(
        "typed_data.py",
        ("tests/test_typed_data.py",),
        (
            "reader: flags are numbers",
            "isinstance(value, int) and not isinstance(value, bool)\n",
            "isinstance(value, int)\n",
        ),
        ("reader: infinite numbers", "(self.are_finite and not isfinite(number))", "False"),
        ("reader: vectors of any length", "if len(kinds) != len(value):", "if not kinds:"),
        ("reader: entries may be missing", "if is_required(item) and item.name not in value:", "if not item.name:"),
        ("reader: unknown entries are lost", "if key not in kinds:", "if not kinds:"),
        ("reader: lists are tuples", "isinstance(value, sequences)", "isinstance(value, tuple | list)"),
        ("reader: whole numbers are what YAML says", "return int(value)", "return value"),
    ),
    *_of(
        "controllers/joint_trajectory_*.py",
        FOLLOWER,
        ("follower: the older command wins", "key=lambda each: each.id", "key=lambda each: -each.id"),
        (
            "follower: a goal that is done is aborted",
            "command is message and state is not None and not state.is_done",
            "command is message and state is not None",
        ),
        ("follower: no path tolerance at the first", "if is_first or not sample.is_over:", "if not sample.is_over:"),
        (
            "follower: goal time zero is at once",
            "0.0 < memory.tolerances.goal_time < late",
            "memory.tolerances.goal_time < late",
        ),
        ("follower: half a step behind", "0.5 * (hold + step)", "0.5 * hold"),
        ("follower: scaling is not looked ahead", "memory.speed_scaling_factor * ahead", "ahead"),
        ("follower: the hint looks back", "(end[i] - begin[i]) /", "(begin[i] - end[i]) /"),
        (
            "follower: moved joints jump back",
            "max(abs(then - commanded), _STILL_THERE)",
            "max(abs(now - commanded), _STILL_THERE)",
        ),
        ("follower: a command is taken again", "last_id=command.id,", "last_id=0,"),
        ("follower: late by rounding", "sample.time_since_point - SAME_TIME", "sample.time_since_point"),
        ("follower: a delay outlives its trajectory", "delay=0.0 if is_first else memory.delay", "delay=memory.delay"),
        ("follower: efforts are not fed forward", "command + middle.effort[i]", "command"),
        ("follower: held joints are judged", "if memory.is_holding:", "if not memory:"),
        (
            "follower: left-out joints go where they are",
            "held = memory.output.positions or measured.positions",
            "held = measured.positions",
        ),
        (
            "follower: a done goal is done again",
            "has_goal = memory.goal is not None and not memory.goal.is_done",
            "has_goal = memory.goal is not None",
        ),
    ),
    *_of(
        "control/trajectory*.py",
        TRAJECTORY,
        ("trajectory: quintic's third coefficient", "- 1.5 * a0 + 0.5 * a1", "- 1.5 * a0 - 0.5 * a1"),
        ("trajectory: cubic's velocities", "3.0 * delta - 2.0 * v0 - v1", "3.0 * delta - v0 - 2.0 * v1"),
        (
            "trajectory: a point is not at its time",
            "bisect_right(self.times, elapsed + SAME_TIME)",
            "bisect_right(self.times, elapsed)",
        ),
        ("trajectory: a state before it was taken up", "max(time - self.start, self.taken_up)", "time - self.start"),
        (
            "trajectory: half a turn the other way",
            "return pi if goal > start else -pi",
            "return -pi if goal > start else pi",
        ),
        ("trajectory: times may stand still", "time <= times[i - 1]", "time < times[i - 1]"),
        ("trajectory: it may end in the past", "start + time < now", "start + time < 0"),
        ("trajectory: the chain rule of curvatures", "* slopes[1:] / T", "* slopes[1:]"),
        (
            "trajectory: partial ones are taken",
            "if missing and not rules.allow_partial_joints_goal:",
            "if missing and rules.allow_partial_joints_goal:",
        ),
        (
            "trajectory: a velocity at the end is taken",
            "if abs(velocity) > _FLOAT32_EPSILON:",
            "if velocity > _FLOAT32_EPSILON:",
        ),
        ("trajectory: integrated from the first slope", "0.5 * (a + b) * duration", "a * duration"),
        ("trajectory: a joint left out goes to zero", "moved(point.positions, nan)", "moved(point.positions, 0.0)"),
    ),
)
