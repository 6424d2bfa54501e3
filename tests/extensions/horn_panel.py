"""A panel of somebody else's, in one file: a button that counts."""

from drake_twin.cockpit.panel import panel

SCRIPT = """
export default class {
  constructor(ask) {
    this.node = document.createElement("button");
    this.node.addEventListener("click", () => ask({ honk: 1 }));
  }
  state({ honks }) {
    this.node.textContent = `Honk (${honks})`;
  }
}
"""


@panel("horn", SCRIPT)
class Horn:
    def __init__(self, twin):
        self._honks = 0

    def state(self):
        return {"honks": self._honks}

    def ask(self, data):
        self._honks += data["honk"]
