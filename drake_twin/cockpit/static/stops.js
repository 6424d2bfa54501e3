// Emergency stops that the twin has not confirmed yet; their buttons are red until it does.

const PATIENCE = 1000; // ms

export class Stops {
  constructor(onchange) {
    this.onchange = onchange;
    this.asked = new Map(); // robot → time of the request (ms)
  }

  ask(robot) {
    if (!this.asked.has(robot)) this.asked.set(robot, performance.now());
    this.onchange();
  }

  state(robots) {
    for (const robot of this.asked.keys()) if (!(robot in robots) || robots[robot].stopped) this.asked.delete(robot);
    this.onchange();
  }

  isWaiting(robot) {
    return robot === undefined ? this.asked.size > 0 : this.asked.has(robot);
  }

  get unconfirmed() {
    const now = performance.now();
    return [...this.asked].filter(([, since]) => now - since > PATIENCE).map(([robot]) => robot);
  }
}
