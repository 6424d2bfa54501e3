// Play, pause, step, run to, reset; speed and physics step.

import { $, Slider, setIcon, setText } from "./dom.js";
import { Plot } from "./plot.js";

const LOG = { toValue: (position) => 10 ** position, toPosition: (value) => Math.log10(value) };
const ROUND = (value) => Number(value.toPrecision(2));

export class TimeControls {
  constructor(ask) {
    this.ask = ask;
    setIcon($("reset"), "reset");
    setIcon($("step"), "step");
    setIcon($("play"), "play");
    $("play").addEventListener("click", () => this.playOrPause());
    $("step").addEventListener("click", () => this.step());
    $("reset").addEventListener("click", () => ask("Reset"));
    $("run-to").addEventListener("submit", (event) => {
      event.preventDefault();
      const time = $("run-to-time").valueAsNumber;
      if (Number.isFinite(time)) ask("RunTo", { time });
    });
    this.rate = new Slider({
      label: "Speed",
      name: "Real-time rate",
      unit: "× real",
      lower: 0.1,
      upper: 10,
      step: 0.01,
      scale: { ...LOG, snap: ROUND },
      onmove: (rate) => ask("SetRate", { rate }),
    });
    $("rate-row").append(this.rate.node);
    this.timeStep = new Slider({
      label: "Physics step",
      unit: "ms",
      lower: 0.1,
      upper: 20,
      step: 0.01,
      scale: { ...LOG, snap: ROUND },
      onmove: (milliseconds) => ask("SetTimeStep", { seconds: Number((milliseconds / 1000).toPrecision(6)) }),
    });
    $("time-step-row").append(this.timeStep.node);
    this.plot = new Plot({ label: "Real-time factor" });
    $("factor-plot").append(this.plot.node);
  }

  playOrPause() {
    this.ask(this.paused ? "Play" : "Pause");
  }

  step() {
    const count = $("step-count").valueAsNumber;
    if (Number.isInteger(count) && count >= 1) this.ask("Step", { count });
  }

  structure(structure) {
    document.body.classList.toggle("display-only", structure.display_only);
    document.body.classList.toggle("playback", structure.playback);
  }

  state(state) {
    this.paused = state.paused;
    setIcon($("play"), state.paused ? "play" : "pause");
    $("play").setAttribute("aria-label", state.paused ? "Play" : "Pause");
    setText($("time"), `${state.time.toFixed(3)} s`);
    const factor = state.paused ? "paused" : (state.real_time_factor?.toFixed(2) ?? "–");
    setText($("factor"), factor);
    setText($("factor-beside"), factor);
    if (!$("factor-plot").open) this.plot.clear();
    else if (!state.paused && state.real_time_factor != null) this.plot.add(state.time, [state.real_time_factor], ["factor"]);
    this.rate.show(state.rate);
    this.timeStep.show(1000 * state.time_step);
  }
}
