"""Topics of node programs on the page."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

from browser import BROWSER_TESTS, browser, open_tab, show
from conftest import rovers
from nodes.node_runs import script

from drake_twin.services.node_programs import start_nodes

pytestmark = BROWSER_TESTS

NODE = """
from rclpy.qos import DurabilityPolicy, QoSProfile


class My(Node):
    def __init__(self):
        super().__init__("echo")
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.said = self.create_publisher(String, "said", latched)
        self.create_subscription(String, "told", lambda message: self.said.publish(message), 10)
"""


def test_a_message_for_a_node_is_published_and_its_answer_is_shown(show, tmp_path):
    it, tab = show(rovers(1).node(script(tmp_path, "echo.py", NODE)).scenario())
    start_nodes(it.twin)
    open_tab(tab, "ROS")
    tab.locator(".topics-panel summary", has_text="Topics").click()
    said, told = (tab.locator(".topics button", has_text=name) for name in ("/said", "/told"))
    it.frames(lambda: (said.count(), told.count()) == (1, 1))
    told.click()
    form = tab.locator("form.publish")
    it.frames(form.is_visible)
    form.get_by_label("data").fill("from the page")
    form.get_by_role("button", name="Publish").click()
    it.frames(lambda: form.locator("output").inner_text().startswith("Published at "))
    said.click()
    it.frames(lambda: tab.locator(".echo td").first.inner_text() == "from the page")
    it.twin.companions.pop().close()  # the node
