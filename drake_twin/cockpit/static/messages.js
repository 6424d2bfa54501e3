// One line with the latest message; pressing it lists all messages, which can be searched, filtered and copied.

import { $, element, setText } from "./dom.js";
import { cursor } from "./time_cursor.js";

const ALL = "all kinds";
const timeOf = (line) => (line.time === null ? "start" : `${line.time.toFixed(2)} s`);
const textOf = (line) => (line.times > 1 ? `${line.text} (${line.times} times)` : line.text);

export class Messages {
  constructor() {
    this.lines = [];
    $("messages-toggle").addEventListener("click", () => {
      const open = $("messages").hidden;
      $("messages").hidden = $("messages-tools").hidden = !open;
      $("messages-toggle").setAttribute("aria-expanded", String(open));
      this.list();
    });
    $("messages-search").addEventListener("input", () => this.list());
    $("messages-level").addEventListener("change", () => this.list());
    $("messages-copy").addEventListener("click", () => this.copy());
    cursor.follow(() => this.showTime());
  }

  get listed() {
    const words = $("messages-search").value.trim().toLowerCase();
    const level = $("messages-level").value;
    return this.lines.filter((line) => [ALL, "", line.level].includes(level) && textOf(line).toLowerCase().includes(words));
  }

  show(lines) {
    this.lines = lines;
    const last = lines.at(-1);
    setText($("message-text"), last ? last.text : "No messages");
    setText($("message-level"), last ? last.level : "");
    $("message-level").dataset.level = last?.level ?? "";
    setText($("message-count"), lines.length > 1 ? `${lines.length} messages` : "");
    const levels = [ALL, ...new Set(lines.map(({ level }) => level))];
    if (levels.join() !== this.levels) {
      this.levels = levels.join();
      const { value } = $("messages-level");
      $("messages-level").replaceChildren(...levels.map((level) => element("option", { value: level, text: level })));
      if (levels.includes(value)) $("messages-level").value = value;
    }
    this.list();
  }

  list() {
    if ($("messages").hidden) return;
    $("messages").replaceChildren(
      ...this.listed.map((line) =>
        element(
          "li",
          {},
          element("span", { class: "level", "data-level": line.level, text: line.level }),
          line.time === null
            ? element("span", { class: "muted", text: timeOf(line) })
            : element("button", { class: "small quiet moment", text: timeOf(line), title: "Show this moment", onclick: () => cursor.seek(line.time, true) }),
          element("span", { text: textOf(line) }),
        ),
      ),
    );
    $("messages").scrollTop = $("messages").scrollHeight;
    this.until = undefined;
    this.showTime();
  }

  // Mark the messages that came after the moment that is shown.
  showTime() {
    if ($("messages").hidden) return;
    const listed = this.listed;
    const until = cursor.shown === null ? listed.length : listed.filter(({ time }) => time === null || time <= cursor.shown + 1e-9).length;
    if (until === this.until) return;
    this.until = until;
    listed.forEach(({ time }, index) => $("messages").children[index]?.classList.toggle("later", cursor.shown !== null && time !== null && time > cursor.shown + 1e-9));
    if (cursor.shown !== null) [...$("messages").children].findLast((row) => !row.matches(".later"))?.scrollIntoView({ block: "nearest" });
  }

  async copy() {
    const text = this.listed.map((line) => `${line.level}\t${timeOf(line)}\t${textOf(line)}`).join("\n");
    try {
      await navigator.clipboard.writeText(text);
      setText($("messages-copy"), "Copied");
    } catch {
      setText($("messages-copy"), "Not allowed"); // by the browser
    }
    setTimeout(() => setText($("messages-copy"), "Copy"), 1500);
  }
}
