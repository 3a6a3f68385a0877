// Histories: panels of curves over time. A cursor across all panels follows the player, and moves it.
const MARGIN = { l: 62, r: 12, t: 8, b: 42 };
const BINS = 800; // spans of time of a drawn curve; least and greatest of each are drawn
const COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#B8860B", "#56B4E9", "#7A5FD0", "#8C8C8C"];
const DARK = ["#5AB4F0", "#FF9250", "#3DD6A3", "#F0A6CC", "#E6C04A", "#9AD4FF", "#B3A0FF", "#B0B0B0"];
const CONFIG = { displayModeBar: false, responsive: true, doubleClick: false, showTips: false };

async function tableOf(packed) {
  const bytes = new Uint8Array(await unpack(packed.values)), count = packed.names.length * packed.rows;
  const mixed = new Uint8Array(4 * count);
  for (let i = 0; i < count; i++) for (let k = 0; k < 4; k++) mixed[4 * i + k] = bytes[k * count + i];
  const values = new Float32Array(mixed.buffer), time = new Float64Array(await unpack(packed.time));
  const columns = { time_s: time };
  packed.names.forEach((name, i) => (columns[name] = values.subarray(i * packed.rows, (i + 1) * packed.rows)));
  return columns;
}

function csvOf(columns) {
  const names = Object.keys(columns), rows = columns.time_s.length, lines = [names.join(",")];
  for (let i = 0; i < rows; i++) {
    lines.push(names.map((n) => (n === "time_s" ? columns[n][i] : Number(columns[n][i].toPrecision(7)))).join(","));
  }
  return lines.join("\n") + "\n";
}

function valuesOf(curve, columns, factor) {
  const time = columns.time_s, sum = new Float64Array(time.length);
  for (const [name, weight] of curve.terms) columns[name].forEach((value, i) => (sum[i] += weight * factor * value));
  if (curve.integral) {
    let work = 0, before = sum[0];
    for (let i = 0; i < sum.length; i++) {
      const now = sum[i];
      if (i) work += 0.5 * (now + before) * (time[i] - time[i - 1]);
      before = now;
      sum[i] = work;
    }
  }
  const first = curve.start ? sum[0] : 0;
  return first ? sum.map((value) => value - first) : sum;
}

// Rows that draw the same curve between two times: ends, least and greatest of each span.
function rowsToDraw(time, values, from, to) {
  const low = Math.max(0, clampIndex(time, from)), high = Math.min(time.length - 1, clampIndex(time, to) + 1);
  const count = high - low + 1, rows = [];
  if (count <= 4 * BINS) {
    for (let i = low; i <= high; i++) rows.push(i);
    return rows;
  }
  for (let bin = 0; bin < BINS; bin++) {
    const begin = low + Math.floor((bin * count) / BINS), end = low + Math.floor(((bin + 1) * count) / BINS);
    let least = begin, most = begin;
    for (let i = begin; i < end; i++) {
      if (values[i] < values[least]) least = i;
      if (values[i] > values[most]) most = i;
    }
    rows.push(...new Set([begin, Math.min(least, most), Math.max(least, most), end - 1]));
  }
  return rows;
}

const isDark = () => matchMedia("(prefers-color-scheme: dark)").matches;
const colourOf = (i) => (isDark() ? DARK : COLOURS)[i % COLOURS.length];
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function look(title, vertical) {
  const axis = { color: css("--soft"), gridcolor: css("--line"), zeroline: false, ticks: "outside", tickcolor: css("--line"), ticklen: 4 };
  return {
    margin: MARGIN, height: 200, showlegend: false, hovermode: false,
    dragmode: matchMedia("(pointer: coarse)").matches ? false : "zoom",
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
    font: { color: css("--soft"), size: 12, family: "system-ui, sans-serif" },
    xaxis: { ...axis, title: { text: title, standoff: 2 } }, yaxis: { ...axis, fixedrange: true, title: vertical || "", nticks: 6 },
  };
}

class Panel {
  constructor(spec, columns, all) {
    this.spec = spec;
    this.columns = columns;
    this.all = all;
    this.time = columns.time_s;
    this.curves = spec.curves.map((curve) => valuesOf(curve, columns, spec.unit.factor));
    this.runs = spec.curves.map((curve, c) => (data.runs ? runOf(curve.terms[0][0], ".") : c)); // of several runs each has its colour
    this.range = [this.time[0], this.time[this.time.length - 1]];
    this.plot = make("div", { class: "plot" });
    this.cursor = make("div", { class: "cursor" });
    this.cursor.hidden = Boolean(spec.along);
    this.readings = spec.curves.map((curve, i) => {
      const value = make("b", {}, "");
      const key = make("span", { class: "key" }, make("i", {}), curve.label + " ", value);
      key.style.setProperty("--tone", colourOf(this.runs[i]));
      return { key, value };
    });
    const head = make("div", { class: "head" }, make("h3", {}, spec.unit.name ? `${spec.title} (${spec.unit.name})` : spec.title));
    head.append(...this.readings.map((reading) => reading.key));
    this.element = make("div", { class: "panel" }, head, make("div", { class: "frame" }, this.plot, this.cursor));
    this.plot.addEventListener("pointermove", (event) => this.point(event));
    this.plot.addEventListener("pointerdown", (event) => this.point(event));
  }

  traces() {
    return this.curves.map((values, c) => {
      const rows = rowsToDraw(this.time, values, ...this.range);
      const x = this.spec.along ? this.along(c) : this.time;
      const factor = this.spec.along ? this.depthUnit()[1] : 1;
      return {
        x: rows.map((i) => x[i] * factor), y: rows.map((i) => values[i]), mode: "lines", type: "scatter",
        line: { color: colourOf(this.runs[c]), width: 1.6 }, visible: this.visible(c),
      };
    });
  }

  along(c) { // what a curve is drawn over
    return this.columns[this.spec.curves[c].along || this.spec.along];
  }

  depthUnit() { // its name and factor, by the greatest depth
    const most = this.curves.reduce((sofar, _, c) => this.along(c).reduce((m, x) => Math.max(m, Math.abs(x) || 0), sofar), 0);
    return [["m", 1], ["mm", 1e3], ["µm", 1e6]].find(([, factor]) => factor * most >= 1) || ["nm", 1e9];
  }

  visible(c) {
    return !(data.runs && shown.hidden.has(this.runs[c]));
  }

  draw() {
    if (this.drawn) return;
    this.drawn = true;
    const along = this.spec.along;
    const layout = look(along ? `depth (${this.depthUnit()[0]})` : "time (s)");
    if (along) layout.xaxis.fixedrange = true;
    else layout.xaxis.range = [...this.range];
    const traces = this.traces();
    if (along) traces.push({ x: [], y: [], mode: "markers", marker: { color: css("--ink"), size: 9 } });
    Plotly.newPlot(this.plot, traces, layout, CONFIG);
    if (!along) {
      this.plot.on("plotly_relayout", (change) => {
        if ("xaxis.range[0]" in change) this.all.zoom([change["xaxis.range[0]"], change["xaxis.range[1]"]]);
      });
      this.plot.on("plotly_doubleclick", () => this.all.zoom(null));
    }
    this.show(clock.time);
  }

  zoom(range) {
    if (this.spec.along) return;
    this.range = range || [this.time[0], this.time[this.time.length - 1]];
    if (!this.drawn) return;
    const traces = this.traces();
    const layout = look("time (s)");
    layout.xaxis.range = [...this.range];
    Plotly.react(this.plot, traces, layout, CONFIG);
    this.show(clock.time);
  }

  repaint() {
    this.readings.forEach((reading, i) => reading.key.style.setProperty("--tone", colourOf(this.runs[i])));
    if (!this.drawn) return;
    if (this.spec.along) {
      Plotly.purge(this.plot);
      this.drawn = false;
      this.draw();
    } else this.zoom(this.range);
  }

  point(event) { // the time under the pointer
    if (this.spec.along || !this.drawn) return;
    const box = this.plot.getBoundingClientRect();
    const share = (event.clientX - box.left - MARGIN.l) / (box.width - MARGIN.l - MARGIN.r);
    if (share >= -0.02 && share <= 1.02) setTime(mix(this.range[0], this.range[1], share));
  }

  show(time) {
    const [i, share] = between(this.time, time), next = Math.min(i + 1, this.time.length - 1);
    this.curves.forEach((values, c) => (this.readings[c].value.textContent = number(mix(values[i], values[next], share))));
    if (!this.drawn) return;
    if (this.spec.along) {
      const seen = this.curves.map((_, c) => c).filter((c) => this.visible(c));
      const factor = this.depthUnit()[1], x = seen.map((c) => factor * mix(this.along(c)[i], this.along(c)[next], share));
      const y = seen.map((c) => mix(this.curves[c][i], this.curves[c][next], share));
      Plotly.restyle(this.plot, { x: [x], y: [y] }, [this.curves.length]);
      return;
    }
    const where = (time - this.range[0]) / (this.range[1] - this.range[0]);
    this.cursor.hidden = !(where >= 0 && where <= 1);
    this.cursor.style.left = `calc(${MARGIN.l}px + (100% - ${MARGIN.l + MARGIN.r}px) * ${where})`;
  }
}

function histories(columns) {
  const all = {
    panels: [],
    visible: new Set(),
    zoom(range) {
      for (const panel of all.panels) panel.zoom(range);
    },
  };
  const watch = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      const panel = all.panels.find((candidate) => candidate.element === entry.target);
      if (!panel) continue;
      if (entry.isIntersecting) {
        all.visible.add(panel);
        panel.draw();
        panel.show(clock.time);
      } else all.visible.delete(panel);
    }
  }, { rootMargin: "300px" });
  const add = (spec, place) => {
    const panel = new Panel(spec, columns, all);
    all.panels.push(panel);
    place.append(panel.element);
    watch.observe(panel.element);
    return panel;
  };
  for (const group of data.groups) {
    const place = $(`#group-${group.name} .live`);
    if (place) group.panels.forEach((panel) => add(panel, place));
  }
  chosen(columns, add, all, watch);
  clock.listeners.push((time) => all.visible.forEach((panel) => panel.show(time)));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => all.panels.forEach((panel) => panel.repaint()));
  shown.listeners.push(() => all.panels.forEach((panel) => panel.repaint()));
  $("[data-do=unzoom]").addEventListener("click", () => all.zoom(null));
}

// Any column, as its own panel.
function chosen(columns, add, all, watch) {
  const select = $("#column");
  if (!select) return;
  for (const [name] of data.columns) select.append(make("option", { value: name }, name));
  let panel = null;
  select.addEventListener("change", () => {
    if (panel) {
      watch.unobserve(panel.element);
      all.panels.splice(all.panels.indexOf(panel), 1);
      all.visible.delete(panel);
      panel.element.remove();
      panel = null;
    }
    if (!select.value) return;
    const [, label] = data.columns.find(([name]) => name === select.value);
    const curves = (data.runs || [{ name: label }])
      .map((run) => ({ label: run.name, terms: [[run.key ? `${run.key}.${select.value}` : select.value, 1]] }))
      .filter((curve) => curve.terms[0][0] in columns);
    panel = add({ title: select.value, unit: { name: "SI or deg", factor: 1 }, along: "", curves }, $("#chosen"));
    panel.range = all.panels.length > 1 ? [...all.panels[0].range] : panel.range;
  });
}
