// A long list whose rows have one height, --row: only those in view, and some around them, are there.

const AROUND = 30; // rows on either side of those in view

export class Rows {
  // `node` scrolls; `make(index)` returns the row at a place of the list.
  constructor(node, make) {
    Object.assign(this, { node, make, count: 0, made: new Map() });
    node.classList.add("rows");
    node.addEventListener("scroll", () => this.fill(), { passive: true });
    new ResizeObserver(() => this.fill()).observe(node);
  }

  get height() {
    return parseFloat(getComputedStyle(this.node).getPropertyValue("--row"));
  }

  // Show a list of so many rows, all made anew.
  show(count) {
    this.count = count;
    this.made.clear();
    this.node.replaceChildren();
    this.fill();
  }

  fill() {
    const { height, node, count } = this;
    const first = Math.max(0, Math.min(Math.floor(node.scrollTop / height), count) - AROUND);
    const last = Math.min(count, Math.ceil((node.scrollTop + node.clientHeight) / height) + AROUND);
    for (const [index, row] of this.made) {
      if ((index >= first && index < last) || row.contains(document.activeElement)) continue;
      row.remove();
      this.made.delete(index);
    }
    let before = null;
    for (let index = last - 1; index >= first; index -= 1) {
      if (!this.made.has(index)) {
        this.made.set(index, this.make(index));
        node.insertBefore(this.made.get(index), before);
      }
      before = this.made.get(index);
    }
    const around = [...this.made.keys()].filter((index) => index < first || index >= last); // the one with the focus
    // Not as paddings of the list, which would be as high as these then.
    node.style.setProperty("--above", `${(first - around.filter((index) => index < first).length) * height}px`);
    node.style.setProperty("--below", `${(count - last - around.filter((index) => index >= last).length) * height}px`);
  }

  // Bring the row at a place into view, and return it.
  bring(index) {
    if (!(index >= 0 && index < this.count)) return null;
    const { node, height } = this;
    const [top, bottom] = [index * height, (index + 1) * height];
    if (top < node.scrollTop) node.scrollTop = top;
    else if (bottom > node.scrollTop + node.clientHeight) node.scrollTop = bottom - node.clientHeight;
    this.fill();
    return this.made.get(index) ?? null;
  }
}
