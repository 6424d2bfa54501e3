// What a browser keeps of the page for each scenario, robots of these names and files: its shape, filters, the camera.

const STORED = "drake_twin.layout";
const MOST = 40; // scenarios; those that were not seen for longest are forgotten
const EVERYWHERE = ["width", "side", "folded"]; // what a scenario that was never seen begins with, too

// Another program's, or none may be kept.
function stored() {
  try {
    const { last = {}, scenarios = {} } = JSON.parse(localStorage.getItem(STORED)) ?? {};
    return { last: Object(last), scenarios: Object(scenarios) };
  } catch {
    return { last: {}, scenarios: {} };
  }
}

// The scenario that this tab of the browser shows, or, until that is known, the one that it showed last.
function scenario(name) {
  try {
    if (name) sessionStorage.setItem(STORED, name);
    return sessionStorage.getItem(STORED) ?? "";
  } catch {
    return name ?? "";
  }
}

// Name the scenario; return whether it was not known before.
export function isNew(name) {
  const before = scenario();
  return scenario(name) !== before;
}

export function kept() {
  const { last, scenarios } = stored();
  return { ...last, ...scenarios[scenario()] };
}

export function keep(change) {
  const { last, scenarios } = stored();
  const name = scenario();
  const { [name]: own, ...others } = scenarios;
  for (const key of EVERYWHERE) if (key in change) last[key] = change[key];
  const newest = [...Object.entries(others), [name, { ...own, ...change }]].slice(-MOST);
  try {
    localStorage.setItem(STORED, JSON.stringify({ last, scenarios: Object.fromEntries(newest) }));
  } catch {
    // it is as it was at the next visit
  }
}
