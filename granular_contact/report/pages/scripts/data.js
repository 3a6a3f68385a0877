// Shared by pages with histories: numbers as text, packed data, the instant that is shown.
const number = (value) => {
  if (value === null || !isFinite(value)) return "–";
  const size = Math.abs(value);
  return (size && (size < 1e-3 || size >= 1e5) ? value.toExponential(2) : value.toPrecision(4)).replace(/-/g, "−");
};

// Packed bytes: base64, zlib.
async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return (await new Response(stream).arrayBuffer());
}

// Unpack and run Plotly's script; return whether the page contains it.
async function plotly() {
  const packed = $("#plotly");
  if (!packed || !window.DecompressionStream) return false;
  const script = make("script");
  script.textContent = new TextDecoder().decode(await unpack(packed.textContent));
  packed.remove();
  document.head.append(script);
  return Boolean(window.Plotly);
}

// The instant that the whole page shows; listeners are called with it.
const clock = { time: 0, start: 0, end: 0, listeners: [] };
function setTime(time) {
  clock.time = Math.min(Math.max(time, clock.start), clock.end);
  for (const listener of clock.listeners) listener(clock.time);
}

const clampIndex = (times, time) => {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  return low;
};

// Position of a time in a rising list of times: index before it, and share of the way to the next.
function between(times, time) {
  if (times.length < 2) return [0, 0];
  const i = clampIndex(times, time);
  const share = (time - times[i]) / (times[i + 1] - times[i]);
  return [i, Math.min(Math.max(share, 0), 1)];
}
const mix = (a, b, share) => a + (b - a) * share;


// Runs on a page of several runs: which of them are hidden, and their colours.
const shown = { hidden: new Set(), listeners: [] };
const runOf = (name, between) => (data.runs || []).findIndex((run) => name.startsWith(run[between === ": " ? "name" : "key"] + between));
function chooseRuns() {
  const paint = () => {
    for (const element of $$("[data-run]")) {
      element.style.setProperty("--tone", colourOf(Number(element.dataset.run)));
      if (element.classList.contains("part")) element.style.display = shown.hidden.has(Number(element.dataset.run)) ? "none" : "";
    }
  };
  for (const label of $$("#runs label")) {
    const run = Number(label.dataset.run);
    $("input", label).addEventListener("change", (event) => {
      shown.hidden[event.target.checked ? "delete" : "add"](run);
      paint();
      for (const listener of shown.listeners) listener();
      setTime(clock.time);
    });
  }
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);
  paint();
}
