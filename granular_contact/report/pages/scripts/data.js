// What pages with histories share: numbers in words, packed data, the instant that is shown.
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

// Plotly's script, which is run once it is unpacked; whether there is one.
async function plotly() {
  const packed = $("#plotly");
  if (!packed || !window.DecompressionStream) return false;
  const script = make("script");
  script.textContent = new TextDecoder().decode(await unpack(packed.textContent));
  packed.remove();
  document.head.append(script);
  return Boolean(window.Plotly);
}

// The instant that all of the page shows: listeners are called with it.
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

// Where a time lies among others: index before it, and share of the way to the next.
function between(times, time) {
  if (times.length < 2) return [0, 0];
  const i = clampIndex(times, time);
  const share = (time - times[i]) / (times[i + 1] - times[i]);
  return [i, Math.min(Math.max(share, 0), 1)];
}
const mix = (a, b, share) => a + (b - a) * share;


// Several runs on one page: which are shown, and in which colours.
const shown = { hidden: new Set(), listeners: [] };
const runOf = (name, between) => (data.runs || []).findIndex((run) => name.startsWith(run[between === ": " ? "name" : "key"] + between));
function chooseRuns() {
  const paint = () => {
    for (const one of $$("[data-run]")) {
      one.style.setProperty("--tone", colourOf(Number(one.dataset.run)));
      if (one.classList.contains("part")) one.style.display = shown.hidden.has(Number(one.dataset.run)) ? "none" : "";
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
