"""Grammars of URDF, xacro, SDF, worlds and MJCF: documents that a robot's author could have written, and wrong ones."""

from xml.etree import ElementTree

from choices import Choices, as_xml

XACRO = "http://www.ros.org/wiki/xacro"
ElementTree.register_namespace("xacro", XACRO)
PARAMS = ("name",) * 9 + ("name *origin", "name x:=1", "name **block", "name n:=^|3")
MESHES = ("tip.stl", "tip.obj", "tip.dae", "missing.stl", "package://rover_description/meshes/x.stl")


def add(parent: ElementTree.Element, tag: str, text: str | None = None, **attributes: str) -> ElementTree.Element:
    element = ElementTree.SubElement(parent, tag, attributes)
    element.text = text
    return element


def urdf(choices: Choices) -> dict[str, bytes]:
    root = ElementTree.Element("robot", name=choices.word("robot", "r2"))
    _fill_urdf(root, choices)
    return {"robot.urdf": as_xml(root, choices)}


def _fill_urdf(root: ElementTree.Element, c: Choices) -> None:
    links = [f"l{number}" for number in range(c.choice((1, 2, 3, 5, 8)))]
    if c.maybe(0.2):
        links[0] = "world"
    if c.is_wrong():
        links += c.choice((links[-1:], ["world"], [f"n{number}" for number in range(300)]))
    if c.maybe(0.3):
        add(add(root, "material", name="red"), "color", rgba=c.numbers(4, 0, 1))
    for name in links:
        _urdf_link(root, name, c)
    joints = []
    for number, child in enumerate(links[1:], start=1):
        joints.append(f"j{number}")
        _urdf_joint(root, joints, c.of(links[:number]), child if not c.is_wrong() else c.of(links), c)
    if c.maybe(0.4):
        _ros2_control(root, joints, c)
    for _ in range(c.choice((0, 0, 1, 2))):
        _gazebo(root, links, joints, c)


def _urdf_link(root: ElementTree.Element, name: str, c: Choices) -> None:
    link = add(root, "link", name=name)
    if c.maybe(0.8):
        inertial = add(link, "inertial")
        if c.maybe():
            add(inertial, "origin", xyz=c.numbers(3), rpy=c.numbers(3, -3, 3))
        add(inertial, "mass", value=c.positive(5))
        moments = {f"i{axis}": c.positive(0.1) for axis in ("xx", "yy", "zz")}
        add(inertial, "inertia", ixy="0", ixz=c.number(0, 0), iyz="0", **moments)
    for tag in c.some("visual", "collision", "collision"):
        shape = add(link, tag)
        if c.maybe():
            add(shape, "origin", xyz=c.numbers(3), rpy=c.numbers(3, -3, 3))
        geometry = add(shape, "geometry")
        match c.randrange(5):
            case 0:
                add(geometry, "box", size=c.numbers(3, 0.01, 1))
            case 1:
                add(geometry, "sphere", radius=c.positive())
            case 2:
                add(geometry, c.choice(("cylinder", "capsule")), radius=c.positive(), length=c.positive())
            case _:
                add(geometry, "mesh", filename=c.word(*MESHES[:2]), scale=c.numbers(3, 0.1, 1))
        if tag == "visual" and c.maybe():
            add(shape, "material", name=c.word("red"))


def _urdf_joint(root: ElementTree.Element, joints: list[str], parent: str, child: str, c: Choices) -> None:
    kind = c.word("revolute", "continuous", "prismatic", "fixed", "planar", "floating")
    joint = add(root, "joint", name=joints[-1], type=kind)
    add(joint, "parent", link=parent)
    add(joint, "child", link=child)
    add(joint, "origin", xyz=c.numbers(3), rpy=c.numbers(3, -3, 3))
    add(joint, "axis", xyz=c.word("1 0 0", "0 1 0", "0 0 1", c.numbers(3)))
    if kind in ("revolute", "prismatic") or c.maybe(0.2):
        low, high = c.number(-2, 0), c.number(0, 2)
        add(joint, "limit", lower=low, upper=high, effort=c.positive(50), velocity=c.positive(5))
    if c.maybe(0.3):
        add(joint, "dynamics", damping=c.positive(), friction=c.positive(0.1))
    if c.maybe(0.1):
        add(joint, "mimic", joint=c.of(joints), multiplier=c.number(), offset=c.number())
    if c.maybe(0.05):
        add(joint, "safety_controller", k_velocity=c.number(), soft_lower_limit=c.number())


def _ros2_control(root: ElementTree.Element, joints: list[str], c: Choices) -> None:
    system = add(root, "ros2_control", name="s", type=c.word("system", "actuator", "sensor"))
    hardware = add(system, "hardware")
    add(hardware, "plugin", c.word("gz_ros2_control/GazeboSimSystem", "mock_components/GenericSystem"))
    for name in c.some(*joints, most=4):
        joint = add(system, c.choice(("joint", "joint", "gpio", "sensor")), name=c.word(name))
        for interface in c.some("position", "velocity", "effort", "digital_output", most=2):
            command = add(joint, "command_interface", name=c.word(interface))
            if c.maybe(0.3):
                add(command, "param", c.number(-5, 0), name=c.word("min", "max"))
        state = add(joint, "state_interface", name=c.word("position", "velocity", "effort"))
        if c.maybe(0.2):
            add(state, "param", c.number(), name="initial_value")


def _gazebo(root: ElementTree.Element, links: list[str], joints: list[str], c: Choices) -> None:
    gazebo = add(root, "gazebo", **({"reference": c.of(links + joints)} if c.maybe() else {}))
    match c.randrange(3):
        case 0:
            for tag in c.some("mu1", "mu2", "kp", "kd", "selfCollide", "material", "gravity", "maxVel"):
                add(gazebo, tag, c.number(0, 1))
        case 1:
            _sensor(gazebo, c)
        case _:
            library = c.word("gz-sim-diff-drive-system", "libgazebo_ros_diff_drive.so", "gz_ros2_control-system")
            plugin = add(gazebo, "plugin", filename=library, name=c.word("gz::sim::systems::DiffDrive", "p"))
            for tag in ("left_joint", "right_joint"):
                add(plugin, tag, c.of(joints))
            for tag in c.some("wheel_separation", "wheel_radius", "odom_publish_frequency", "max_linear_velocity"):
                add(plugin, tag, c.positive())


def _sensor(parent: ElementTree.Element, c: Choices) -> None:
    kind = c.word("imu", "gpu_lidar", "ray", "contact", "navsat", "altimeter", "force_torque", "magnetometer")
    sensor = add(parent, "sensor", name=c.word("s"), type=kind)
    add(sensor, "update_rate", c.positive(30))
    if c.maybe():
        add(sensor, "topic", c.word("scan", "/imu"))
    if kind in ("gpu_lidar", "ray"):
        scan = add(add(add(sensor, c.choice(("ray", "lidar"))), "scan"), "horizontal")
        for tag, text in (("samples", c.word("1", "8")), ("min_angle", "-1"), ("max_angle", c.number())):
            add(scan, tag, text)


def xacro(choices: Choices) -> dict[str, bytes]:
    c = choices
    tag = f"{{{XACRO}}}".__add__
    root = ElementTree.Element("robot", name="r")
    expression = c.word("1", "${pi/2}", "${n * 2}", "$(arg size)", "${[i for i in range(3)][1]}", "${'a' + 'b'}")
    hostile = ("${n}", "${9**9**9}", "${'a' * 10**12}", "${().__class__}", "${{}}", "$")
    if c.is_wrong():
        expression = c.choice((*hostile, "${xacro.load_yaml('x.yaml')}", "${open('/etc/passwd').read()}", "${n[n]}"))
    add(root, tag("arg"), name="size", default=c.number())
    add(root, tag("property"), name="n", value=c.word("3", "0.5", expression))
    if c.maybe(0.3):
        add(root, tag("property"), name=c.word("m", "n"), value=expression)
    macro = add(root, tag("macro"), name="part", params=c.word(*PARAMS))
    link = add(macro, "link", name="${name}")
    inertial = add(link, "inertial")
    add(inertial, "mass", value=expression)
    add(inertial, "inertia", ixx="${n}", iyy="1", izz="1")
    if c.maybe(0.3):
        inner = add(macro, tag(c.choice(("if", "unless"))), value=c.word("0", "0", "${n > 4}", "true"))
        _call(inner, tag("none" if c.is_wrong() else "part"), c)  # recursion, with or without an end
    for number in range(c.choice((1, 1, 2))):
        call = _call(root, tag("part"), c, f"l{number}")
        if "*" in macro.get("params", "") or c.is_wrong():
            add(call, "origin", xyz=c.numbers(3))
    if c.maybe(0.3):
        include = c.word("part.xacro", "$(find rover_description)/urdf/wheel.xacro", "robot.urdf.xacro")
        add(root, tag("include"), filename=include)
    if c.is_wrong():
        add(root, tag("insert_block"), name=c.word("origin", "n"))
    files = {"robot.urdf.xacro": as_xml(root, c)}
    part = ElementTree.Element("robot")
    add(part, tag("property"), name="p", value=c.word("1", "${n}"))
    files["part.xacro"] = as_xml(part, c)
    return files


def _call(parent: ElementTree.Element, tag: str, c: Choices, name: str = "x") -> ElementTree.Element:
    return add(parent, tag, **{"other" if c.is_wrong() else "name": c.word(name)} if c.maybe(0.95) else {})


def sdf(choices: Choices) -> dict[str, bytes]:
    root = ElementTree.Element("sdf", version=choices.word("1.6", "1.7", "1.9", "1.10"))
    _model(root, "m", choices)
    return {"robot.sdf": as_xml(root, choices)}


def world(choices: Choices) -> dict[str, bytes]:
    c = choices
    root = ElementTree.Element("sdf", version=c.word("1.6", "1.9"))
    inner = add(root, "world", name=c.word("w"))
    add(inner, "gravity", c.word("0 0 -9.8", c.numbers(3)))
    physics = add(inner, "physics", type="ode")
    add(physics, "max_step_size", c.word("0.001", "0.002", c.positive(0.01)))
    for number in range(c.choice((0, 1, 2, 4))):
        model = _model(inner, f"m{number}", c)
        if c.maybe(0.5):
            add(model, "static", c.word("true", "1", "false"))
    if c.maybe(0.3):
        include = add(inner, "include")
        add(include, "uri", c.word("model://m", "robot.sdf", "world.sdf", "https://localhost:1/x", "part.sdf"))
        add(include, "pose", c.numbers(6))
    if c.maybe(0.2):
        add(inner, "light", name="sun", type=c.word("directional", "point"))
    if c.maybe(0.2):
        spherical = add(inner, "spherical_coordinates")
        add(spherical, "latitude_deg", c.number(-90, 90))
    part = ElementTree.Element("sdf", version="1.7")
    _model(part, "part", c)
    return {"world.sdf": as_xml(root, c), "part.sdf": as_xml(part, c)}


def _model(parent: ElementTree.Element, name: str, c: Choices, depth: int = 0) -> ElementTree.Element:
    model = add(parent, "model", name=c.word(name))
    links = [f"l{number}" for number in range(c.choice((1, 2, 4)))]
    for link_name in links:
        link = add(model, "link", name=c.word(link_name))
        if c.maybe():
            pose = add(link, "pose", c.numbers(6))
            if c.maybe(0.3):
                pose.set("relative_to", c.of([*links[: links.index(link_name)], "__model__"]))
        if c.maybe(0.7):
            inertial = add(link, "inertial")
            add(inertial, "mass", c.positive(3))
            inertia = add(inertial, "inertia")
            for axis in ("ixx", "iyy", "izz"):
                add(inertia, axis, c.positive(0.1))
        for tag in c.some("visual", "collision", most=2):
            _sdf_shape(add(link, tag, name=c.word(tag)), c)
        if c.maybe(0.2):
            _sensor(link, c)
    for number, child in enumerate(links[1:]):
        joint = add(model, "joint", name=f"j{number}", type=c.word("revolute", "prismatic", "fixed", "ball", "screw"))
        add(joint, "parent", c.of(links[: number + 1]) if not c.is_wrong() else "world")
        add(joint, "child", c.word(child))
        axis = add(joint, "axis")
        add(axis, "xyz", c.word("0 0 1", "1 0 0", c.numbers(3)))
        limit = add(axis, "limit")
        add(limit, "lower", c.number(-2, 0))
        add(limit, "upper", c.number(0, 2))
    if c.maybe(0.2):
        add(add(model, "frame", name="f", attached_to=c.of([*links, "f"])), "pose", c.numbers(6))
    if depth < 3 and c.maybe(0.15):
        _model(model, "inner", c, depth + 1)
    if c.maybe(0.15):
        plugin = add(model, "plugin", filename=c.word("gz-sim-diff-drive-system"), name="gz::sim::systems::DiffDrive")
        add(plugin, "left_joint", c.of(["j0"]))
        add(plugin, "right_joint", c.of(["j1"]))
    return model


def _sdf_shape(shape: ElementTree.Element, c: Choices) -> None:
    geometry = add(shape, "geometry")
    match c.randrange(6):
        case 0:
            add(add(geometry, "box"), "size", c.numbers(3, 0.01, 1))
        case 1:
            add(add(geometry, "sphere"), "radius", c.positive())
        case 2:
            cylinder = add(geometry, c.choice(("cylinder", "capsule", "cone")))
            add(cylinder, "radius", c.positive())
            add(cylinder, "length", c.positive())
        case 3:
            add(add(geometry, "plane"), "normal", c.word("0 0 1", c.numbers(3)))
        case 4:
            add(add(geometry, c.choice(("ellipsoid", "heightmap", "polyline"))), "radii", c.numbers(3, 0.1, 1))
        case _:
            mesh = add(geometry, "mesh")
            add(mesh, "uri", c.word(*MESHES[:2]))
            add(mesh, "scale", c.numbers(3, 0.1, 1))


def mjcf(choices: Choices) -> dict[str, bytes]:
    c = choices
    root = ElementTree.Element("mujoco", model=c.word("m"))
    add(root, "compiler", angle=c.word("radian", "degree"), autolimits="true", meshdir=c.word(".", ""))
    if c.maybe(0.3):
        add(root, "option", timestep=c.word("0.002", c.positive(0.01)), gravity=c.numbers(3, -10, 0))
    default = add(root, "default")
    add(default, "joint", damping=c.positive())
    named = add(default, "default", **{"class": c.word("d")})
    add(named, "geom", rgba=c.numbers(4, 0, 1))
    assets = add(root, "asset")
    add(assets, "mesh", name="tip", file=c.word("tip.stl", "tip.obj"), scale=c.numbers(3, 0.1, 1))
    worldbody = add(root, "worldbody")
    joints: list[str] = []
    for number in range(c.choice((1, 1, 2))):
        _body(worldbody, f"b{number}", joints, c)
    actuator = add(root, "actuator")
    for joint in c.some(*joints):
        motor = add(
            actuator, c.tag("motor", "position", "velocity", "general"), joint=c.word(joint), gear=c.number(1, 10)
        )
        motor.set("ctrlrange", c.word("-1 1", "0 2"))
    if c.maybe(0.2):
        add(add(root, "equality"), c.choice(("joint", "weld", "connect")), joint1=c.of(joints), joint2=c.of(joints))
    if c.maybe(0.2):
        add(root, "include", file=c.word("part.xml", "part.xml", "robot.xml"))
    if c.maybe(0.2):
        add(add(root, "sensor"), "accelerometer", name="a", site=c.word("s"))
    part = ElementTree.Element("mujoco")
    _body(add(part, "worldbody"), "p", joints, c)
    return {"robot.xml": as_xml(root, c), "part.xml": as_xml(part, c)}


def _body(parent: ElementTree.Element, name: str, joints: list[str], c: Choices, depth: int = 0) -> None:
    body = add(parent, "body", name=c.word(name), pos=c.numbers(3))
    if c.maybe(0.2):
        turned, count = c.choice((("quat", 4), ("euler", 3), ("axisangle", 4), ("xyaxes", 6), ("zaxis", 3)))
        body.set(turned, c.numbers(count))
    if c.maybe(0.3):
        add(body, "inertial", pos=c.numbers(3), mass=c.positive(), diaginertia=c.numbers(3, 0.01, 0.02))
    if c.maybe(0.7):
        kind = c.word("hinge", "slide", "ball", "free")
        joints.append(f"j{len(joints)}")
        joint = add(body, "joint", name=joints[-1], type=kind, axis=c.word("0 0 1", c.numbers(3)))
        joint.set("range", c.word("-1 1", c.numbers(2)))
    kind = c.word("box", "sphere", "capsule", "cylinder", "ellipsoid", "mesh")
    geom = add(body, "geom", type=kind, mass=c.positive())
    geom.set("mesh" if kind == "mesh" else "size", c.word("tip") if kind == "mesh" else c.numbers(3, 0.01, 0.2))
    if c.maybe(0.2):
        geom.set("class", c.word("d"))
    for number in range(c.choice((0, 0, 1, 2)) if depth < 4 else 0):
        _body(body, f"{name}_{number}", joints, c, depth + 1)
