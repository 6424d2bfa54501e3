// One line with the latest message; pressing it lists all messages.

import { $, element, setText } from "./dom.js";

export class Messages {
  constructor() {
    $("messages-toggle").addEventListener("click", () => {
      const open = $("messages").hidden;
      $("messages").hidden = !open;
      $("messages-toggle").setAttribute("aria-expanded", String(open));
      $("messages").scrollTop = $("messages").scrollHeight;
    });
  }

  show(lines) {
    const last = lines.at(-1);
    setText($("message-text"), last ? last.text : "No messages");
    setText($("message-level"), last ? last.level : "");
    $("message-level").dataset.level = last?.level ?? "";
    setText($("message-count"), lines.length > 1 ? `${lines.length} messages` : "");
    $("messages").replaceChildren(
      ...lines.map((line) =>
        element(
          "li",
          {},
          element("span", { class: "level", "data-level": line.level, text: line.level }),
          element("span", { class: "muted", text: line.time === null ? "start" : `${line.time.toFixed(2)} s` }),
          element("span", { text: line.times > 1 ? `${line.text} (${line.times} times)` : line.text }),
        ),
      ),
    );
    $("messages").scrollTop = $("messages").scrollHeight;
  }
}
