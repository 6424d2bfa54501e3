// The one time of the page: the moment that is shown, and the moment that the mouse is over. The timeline says which moment
// is shown; plots and messages show it, too, and ask for another one by `seek`.

class TimeCursor {
  constructor() {
    this.shown = null; // s; null while the present is shown
    this.hovered = null; // s; in a plot or on the timeline
    this.hoverer = null; // where that is
    this.onseek = () => {};
    this.followers = new Set();
  }

  // Call back with each change, until that returns false.
  follow(callback) {
    this.followers.add(callback);
  }

  tell() {
    for (const callback of this.followers) if (callback(this) === false) this.followers.delete(callback);
  }

  show(time) {
    if (time === this.shown) return;
    this.shown = time;
    this.tell();
  }

  hover(time, hoverer) {
    if (time === null && hoverer !== this.hoverer) return; // it is elsewhere already
    if (time === this.hovered && hoverer === this.hoverer) return;
    [this.hovered, this.hoverer] = [time, hoverer];
    this.tell();
  }

  // Show a moment; a twin that runs is paused for it only if somebody `insists`.
  seek(time, insists = false) {
    this.onseek(time, insists);
  }
}

export const cursor = new TimeCursor();
