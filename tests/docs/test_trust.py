"""What docs/trust.md says of files that strangers wrote: which of them run code, read, write and listen."""

import ast
import asyncio
import os
import re
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest
from wires.zenoh_peer import free_port

import drake_twin
from drake_twin import TwinBuilder
from drake_twin.check import main as check
from drake_twin.run import main as run
from drake_twin.sweeps.listening import ports_of

PACKAGE = Path(drake_twin.__file__).parent
ROVER = "package://rover_description/urdf/rover.urdf.xacro"
INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
# xacro looks for names with two underscores, but not inside a function.
ESCAPE = (
    "(lambda: [c for c in ().__class__.__base__.__subclasses__() if c.__name__ == '_wrap_close'][0]"
    ".__init__.__globals__['system']('touch ran'))()"
)
MOMENT = ("--headless", "--duration", "0.01")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def robot(text="", name="l", file="r.urdf", before="", more=""):
    Path(file).write_text(f'{before}<robot name="r" {more}><link name="{name}">{INERTIAL}{text}</link></robot>')
    return file


def ran():
    return Path("ran").exists()


# What runs code


@pytest.mark.parametrize("more", [XACRO, ""])
def test_a_robot_file_with_an_expression_runs_code_whatever_its_ending(more):
    check([robot(name=f"l${{{ESCAPE}}}", more=more)])
    assert ran()


@pytest.mark.parametrize("action", [(), ("--show-args",), ("--show-scenario",)])
def test_a_python_launch_file_runs_whatever_is_asked_of_it(action):
    Path("a.launch.py").write_text(
        "open('ran', 'w')\nfrom launch import LaunchDescription\n"
        "def generate_launch_description(): return LaunchDescription([])\n"
    )
    run(["a.launch.py", *(action or MOMENT)])
    assert ran()


@pytest.mark.parametrize(
    ("substitution", "runs"),
    [
        ("$(command 'touch ran')", True),
        ("$(eval '__import__(&quot;os&quot;).system(&quot;touch ran&quot;)')", True),
        ("touch ran", False),
    ],
)
def test_substitutions_of_an_xml_launch_file_run_and_its_executables_do_not(substitution, runs):
    executable = "" if runs else '<executable cmd="touch ran" output="screen"/>'
    Path("a.launch.xml").write_text(f'<launch>{executable}<let name="a" value="{substitution}"/></launch>')
    run(["a.launch.xml", *MOMENT])
    assert ran() == runs


def with_node():
    Path("node.py").write_text("open('ran', 'w')\nimport rclpy\nrclpy.init()\n")
    return TwinBuilder().robot("r", robot()).node("node.py")


def test_the_nodes_of_a_scenario_and_of_a_saved_state_run_and_those_of_a_recording_do_not():
    with with_node().build() as twin:
        twin.recorder.begin()
        twin.step()
        twin.snapshot().save("state.json")
        twin.recorder.recording().save("run.json")
    Path("scenario.yaml").write_text("robots: [{name: r, model: r.urdf}]\nnodes: [{executable: node.py}]\n")
    for arguments, runs in (
        (["--replay", "run.json", "--headless", "--end-with-recording"], False),
        (["scenario.yaml", "--show-scenario"], False),
        (["--load-state", "state.json", *MOMENT], True),
        (["scenario.yaml", *MOMENT], True),
    ):
        Path("ran").unlink(missing_ok=True)
        assert run(arguments) == 0
        assert ran() == runs, arguments


def test_files_of_a_package_for_its_build_and_its_shell_do_not_run(folder):
    share = folder / "src" / "p"
    (share / "env-hooks").mkdir(parents=True)
    (share / "urdf").mkdir()
    (share / "package.xml").write_text("<package><name>p</name></package>")
    (share / "setup.py").write_text("open('ran', 'w')")
    (share / "CMakeLists.txt").write_text("project(p)\nexecute_process(COMMAND touch ran)\n")
    for name in ("local_setup.sh", "local_setup.bash", "env-hooks/p.sh", "env-hooks/p.dsv"):
        (share / name).write_text("touch ran")
    assert check([robot(file=str(share / "urdf" / "r.urdf"))]) == 0
    assert not ran()


@pytest.mark.parametrize("file", ["a.yaml", "a.launch.yaml"])
def test_tags_of_yaml_make_no_objects(file):
    Path(file).write_text('robots: !!python/object/apply:os.system ["touch ran"]\n')
    assert run([file, *MOMENT]) == 2
    assert not ran()


def test_no_pickle_and_no_yaml_with_objects_is_read():
    """A moment of the timeline is packed in memory, and environments of Gymnasium are pickled by who makes them."""
    using = {"pickle": set(), "np.load": set(), "yaml.load": set(), "eval": set(), "exec": set()}
    for file in sorted(PACKAGE.rglob("*.py")):
        if file.is_relative_to(PACKAGE / "docs"):
            continue
        name = file.relative_to(PACKAGE).as_posix()
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import) and any(
                item.name in ("pickle", "marshal", "shelve") for item in node.names
            ):
                using["pickle"].add(name)
            if isinstance(node, ast.Call) and (called := ast.unparse(node.func)) in using:
                using[called].add(name)
                assert not {word.arg for word in node.keywords} & {"allow_pickle"}, name
    assert using == {
        "pickle": {"twin/rewind.py"},
        "np.load": {"description/mesh_triangles.py", "description/solid_mesh.py"},
        "yaml.load": {"description/bounded_yaml.py", "description/xacro_expressions.py"},
        "eval": {
            "description/xacro_expressions.py",
            "ros2/launch/substitutions/local_substitution.py",
            "ros2/launch/substitutions/python_expression.py",
            "tools/topic_echo.py",  # of who types it
        },
        "exec": {
            "dataclass.py",
            "nodes/program.py",
            "ros2/python_file.py",
        },  # the first: the methods of our own classes
    }


def test_python_m_imports_from_the_working_folder_and_a_safe_path_does_not():
    Path("yaml.py").write_text("open('ran', 'w'); raise SystemExit(3)")
    for flags, runs in ((["-P"], False), ([], True)):
        subprocess.run([sys.executable, *flags, "-m", "drake_twin.check", ROVER], capture_output=True, check=False)
        assert ran() == runs


# What is read

BOMB = "<!DOCTYPE l [" + "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10 if n else "a" * 16}">' for n in range(10))
SECRET = '<!DOCTYPE l [<!ENTITY x SYSTEM "secret">]>'


@pytest.mark.parametrize("more", [XACRO, ""])
def test_entities_that_multiply_are_refused(more, capsys):
    assert check([robot(name="&a9;", before=BOMB + "]>", more=more)]) == 1
    assert "amplification" in capsys.readouterr().out


@pytest.mark.parametrize("more", [XACRO, ""])
def test_external_entities_and_includes_of_xml_are_not_read(more, capsys):
    Path("secret").write_text("SECRET")
    robot("&x;", before=SECRET, more=more)
    check(["r.urdf", "--json", "a.json"])
    robot('<xi:include href="secret" parse="text" xmlns:xi="http://www.w3.org/2001/XInclude"/>', more=more)
    check(["r.urdf", "--json", "b.json"])
    assert "SECRET" not in capsys.readouterr().out + "".join(file.read_text() for file in Path().glob("*.json"))


@pytest.mark.parametrize("body", ["&a9;", "&x;"])
def test_entities_of_collada_are_not_read(body):
    Path("secret").write_text("0 0 0")
    Path("m.dae").write_text(
        f'{BOMB}<!ENTITY x SYSTEM "secret">]><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"'
        f' version="1.4.1"><asset><contributor><comments>{body}</comments></contributor></asset></COLLADA>'
    )
    twin = TwinBuilder().robot("r", robot('<visual><geometry><mesh filename="m.dae"/></geometry></visual>')).build()
    assert any(re.search(r"Entity 'x' not defined|amplification", finding.what) for finding in twin.findings)


@pytest.mark.parametrize("address", ["http://127.0.0.1:9/m.stl", "ftp://127.0.0.1/m.stl"])
def test_no_address_of_the_network_is_fetched(address):
    twin = (
        TwinBuilder().robot("r", robot(f'<visual><geometry><mesh filename="{address}"/></geometry></visual>')).build()
    )
    assert any("unknown scheme" in finding.what for finding in twin.findings)


def test_a_file_may_name_every_file_that_the_user_can_read(folder):
    (folder / "elsewhere").mkdir()
    (folder / "elsewhere" / "secret.yaml").write_text("SECRET")
    robot(name="l${xacro.load_yaml('elsewhere/../elsewhere/secret.yaml')}_$(env PATH)", more=XACRO)
    (name,) = TwinBuilder().robot("r", "r.urdf").build().built.plans[0].description.links
    assert name == f"lSECRET_{os.environ['PATH']}"


# What listens


@pytest.mark.skipif(not os.path.exists("/proc/net/tcp"), reason="asks Linux")
@pytest.mark.parametrize("name", [None, "zenoh", "foxglove"], ids=["headless", "zenoh", "foxglove"])
def test_a_twin_listens_at_nothing_and_a_wire_on_the_loopback_address(name):
    if name is not None:
        pytest.importorskip(name)
    port = None if name is None else free_port()
    twin = TwinBuilder().robot("r", robot()).build()
    before = set(ports_of([os.getpid()]))
    with twin:
        wire = opened(name, port)
        found = set(ports_of([os.getpid()])) - before
        if wire is not None:
            wire.close()
    own = [item for item in sorted(found) if item.number == port]
    assert [item.address for item in own] == (["127.0.0.1"] if port else [])
    beside = [item.address for item in found if item.number != port]
    assert len(beside) == (name == "foxglove")  # the SDK's server, behind the door
    assert all(address.startswith("127.") and address != "127.0.0.1" for address in beside)


def opened(name, port):
    if name == "zenoh":
        from drake_twin.wires.zenoh_wire import ZenohWire

        return ZenohWire(port=port)
    if name == "foxglove":
        from drake_twin.wires.foxglove_wire import FoxgloveWire

        return FoxgloveWire(port=port)
    return None


def test_dds_hears_the_loopback_interface_only():
    pytest.importorskip("cyclonedds")
    from drake_twin.wires.dds_wire import DdsWire

    def own_sockets():
        found = {}
        for number in map(int, os.listdir("/proc/self/fd")):
            with suppress(OSError), socket.socket(fileno=os.dup(number)) as own:
                if own.type == socket.SOCK_DGRAM:
                    device = own.getsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, 16).rstrip(b"\0")
                    found[os.readlink(f"/proc/self/fd/{number}")] = own.getsockname()[0], device
        return found

    before = own_sockets()
    wire = DdsWire(domain=77)
    opened = [place for name, place in own_sockets().items() if name not in before]
    wire.close()
    assert ("0.0.0.0", b"lo") in opened
    assert all(device == b"lo" or address == "127.0.0.1" for address, device in opened)


@pytest.mark.parametrize(
    ("origin", "answers"),
    [
        (None, True),  # a program
        ("https://app.foxglove.dev", True),
        ("file://", True),  # Foxglove's desktop application
        ("http://localhost:8080", True),  # which is named here
        ("http://evil.example", False),
        ("http://127.0.0.1:18766", False),
        ("https://app.foxglove.dev.evil.example", False),
        ("null", False),  # a file in a browser, or a frame without an origin
    ],
)
def test_foxglove_answers_its_own_pages_and_programs_and_no_page_of_another_site(origin, answers):
    pytest.importorskip("foxglove")
    aiohttp = pytest.importorskip("aiohttp")
    from drake_twin.wires.foxglove_wire import FoxgloveWire

    async def first_words(port):
        async with aiohttp.ClientSession() as session:
            address = f"http://127.0.0.1:{port}"
            try:
                headers = {} if origin is None else {"Origin": origin}
                async with session.ws_connect(address, protocols=["foxglove.sdk.v1"], headers=headers) as socket:
                    return (await socket.receive(timeout=10)).data
            except aiohttp.WSServerHandshakeError as error:
                return str(error.status)

    wire = FoxgloveWire(port=18766, origins=["http://localhost:8080"])
    said = asyncio.run(first_words(18766))
    wire.close()
    assert ("serverInfo" in said) if answers else said == "403"


# What is written


def test_a_run_writes_into_the_cache_and_the_named_files_alone(folder):
    cache, temporary, here = folder / "cache", folder / "tmp", folder / "here"
    for each in (temporary, here):
        each.mkdir()
    environment = {"PATH": os.environ["PATH"], "HOME": str(folder / "home"), "XDG_CACHE_HOME": str(cache)}
    environment |= {"TMPDIR": str(temporary), "PYTHONPATH": str(PACKAGE.parent), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-m", "drake_twin.run", "rover_gazebo", "main.launch.xml", *MOMENT]
    done = subprocess.run(command, cwd=here, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert {path.name for path in cache.glob("*/*")} <= {"launch", "meshes", "mesh_checksums", "page", "share"}
    assert {path.name for path in folder.iterdir()} == {"cache", "tmp", "here"}
    assert list(temporary.iterdir()) == list(here.iterdir()) == []


@pytest.mark.skipif(sys.platform != "linux" or os.getuid() != 0, reason="needs namespaces of Linux")
def test_without_network_and_home_on_a_read_only_file_system_a_run_is_the_same(folder):
    tmp = "/tmp"
    script = f"""
        mount --make-rprivate / || exit 77
        mounts=$(awk '{{print $5}}' /proc/self/mountinfo | sort -u | grep -v ^/dev)
        for m in $mounts; do mount -o remount,ro,bind $m 2>/dev/null; done
        mount -t tmpfs -o noexec,nosuid,nodev,size=512m tmpfs {tmp} || exit 77
        ! touch {Path.home()}/x 2>/dev/null || exit 77
        cd /
        exec setpriv --bounding-set=-all --inh-caps=-all --no-new-privs {sys.executable} -P -m drake_twin.run \
            --robots 2 --headless --duration 0.1
    """
    environment = {"PATH": os.environ["PATH"], "HOME": "/nonexistent", "LANG": "C", "PYTHONPATH": str(PACKAGE.parent)}
    command = ["unshare", "-n", "-m", "sh", "-c", script]
    inside = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if inside.returncode in (1, 77) and "drake_twin" not in inside.stderr:
        pytest.skip(f"no namespaces here: {inside.stderr.strip()}")
    assert inside.returncode == 0, inside.stderr
    outside = subprocess.run(
        [sys.executable, "-m", "drake_twin.run", "--robots", "2", "--headless", "--duration", "0.1"],
        env=environment | {"HOME": str(folder)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert inside.stdout.split()[-1] == outside.stdout.split()[-1]  # the state's hash
