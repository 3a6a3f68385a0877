// The player in space: bodies as meshes, the ground, forces and the path, drawn by plotly; turned and zoomed by the pointer.
const TONES = ["#8fb3cd", "#e0a66b", "#9cc4a0", "#c9a3c7", "#d8c56a", "#a7b5be"];

// Points (flat) of a part at a pose x, y, z, quaternion w, x, y, z.
function placed(points, [px, py, pz, w, x, y, z]) {
  const out = [[], [], []];
  const r = [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
  for (const [a, b, c] of points) {
    out[0].push(px + r[0][0] * a + r[0][1] * b + r[0][2] * c);
    out[1].push(py + r[1][0] * a + r[1][1] * b + r[1][2] * c);
    out[2].push(pz + r[2][0] * a + r[2][1] * b + r[2][2] * c);
  }
  return out;
}

// The pose between two others: straight, and turned the shorter way.
function posed(a, b, share) {
  const dot = a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6], sign = dot < 0 ? -1 : 1;
  const pose = a.map((value, i) => mix(value, i < 3 ? b[i] : sign * b[i], share));
  const size = Math.hypot(pose[3], pose[4], pose[5], pose[6]);
  for (let i = 3; i < 7; i++) pose[i] /= size;
  return pose;
}

const VIEWS = {
  oblique: { eye: { x: 1.1, y: -1.82, z: 0.8 }, center: { x: 0, y: 0, z: -0.06 }, up: { x: 0, y: 0, z: 1 }, projection: { type: "perspective" } },
  side: { eye: { x: 0, y: -1.7, z: 0 }, up: { x: 0, y: 0, z: 1 }, projection: { type: "orthographic" } },
  front: { eye: { x: 1.7, y: 0, z: 0 }, up: { x: 0, y: 0, z: 1 }, projection: { type: "orthographic" } },
  top: { eye: { x: 0, y: 0, z: 1.7 }, up: { x: 0, y: 1, z: 0 }, projection: { type: "orthographic" } },
};

class SpacePlayer {
  constructor(motion, columns) {
    this.motion = motion;
    this.plot = $("#space");
    this.plot.style.height = `${Math.min(560, Math.round(0.8 * this.plot.clientWidth) + 40)}px`;
    this.box = this.extent();
    this.contain();
    this.bodies = motion.parts.map((_, i) => i);
    const mesh = motion.parts.map((part, i) => {
      const [x, y, z] = placed(part.points_m, motion.poses[0][i]);
      const [a, b, c] = [0, 1, 2].map((k) => part.faces.map((face) => face[k]));
      return {
        type: "mesh3d", x, y, z, i: a, j: b, k: c, color: this.tone(part, i), flatshading: true, name: part.name,
        hoverinfo: "name", lighting: { ambient: 0.6, diffuse: 0.6, specular: 0.1, facenormalsepsilon: 0, vertexnormalsepsilon: 0 },
        lightposition: { x: 3e4, y: -5e4, z: 8e4 }, // far away; facets of a millimetre are no degenerate ones
      };
    });
    shown.listeners.push(() => {
      const seen = motion.parts.map((part) => !shown.hidden.has(runOf(part.name, ": ")));
      Plotly.restyle(this.plot, { visible: seen }, this.bodies);
    });
    this.lines = mesh.length;
    const force = css("--force");
    const still = { hoverinfo: "skip", showlegend: false };
    const traces = [
      ...mesh,
      { type: "scatter3d", mode: "lines", x: [], y: [], z: [], line: { color: force, width: 6 }, ...still },
      { type: "scatter3d", mode: "markers", x: [], y: [], z: [], marker: { color: force, size: 3.5, symbol: "diamond" }, ...still },
    ];
    const path = this.path(columns);
    if (path) traces.push({ type: "scatter3d", mode: "lines", ...path, line: { color: css("--accent"), width: 2 }, ...still });
    if (motion.ground) {
      const [x, y, z] = motion.ground, tone = css("--sand");
      const plain = { highlight: false };
      traces.push({
        type: "surface", x, y, z, colorscale: [[0, tone], [1, tone]], showscale: false, opacity: 0.72,
        lighting: { ambient: 1, diffuse: 0, specular: 0 }, contours: { x: plain, y: plain, z: plain }, ...still,
      });
    }
    traces.push(...this.bedding(still));
    Plotly.newPlot(this.plot, traces, this.layout(), { displayModeBar: false, responsive: true, scrollZoom: "gl3d" });
    for (const [name, camera] of Object.entries(VIEWS)) {
      const button = make("button", { type: "button" }, name);
      button.addEventListener("click", () => Plotly.relayout(this.plot, { "scene.camera": camera }));
      $(".moments").append(button);
    }
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => Plotly.relayout(this.plot, this.layout()));
    $("#with-forces").addEventListener("change", () => this.show(clock.time));
    clock.listeners.push((time) => this.show(time));
    this.show(clock.time);
  }

  // Layers, floor and walls of the bed, in the colours of the player of the plane.
  bedding(still) {
    const { bedding, ground } = this.motion;
    if (!bedding || !ground) return [];
    const [x, y, z] = ground, plain = { highlight: false };
    const ends = (values) => [values[0], values[values.length - 1]];
    const sheet = (x, y, z, tone, opacity, name) => ({
      type: "surface", x, y, z, name, colorscale: [[0, tone], [1, tone]], showscale: false, opacity,
      lighting: { ambient: 1, diffuse: 0, specular: 0 }, contours: { x: plain, y: plain, z: plain }, ...still,
    });
    const level = (height) => [[height, height], [height, height]];
    const sheets = bedding.layers_m.map((depth) =>
      sheet(x, y, z.map((row) => row.map((height) => height - depth)), css("--sand-edge"), 0.35, "layer"));
    const { floor_m: floor } = bedding;
    if (floor !== null) sheets.push(sheet(ends(x), ends(y), level(floor), css("--floor"), 0.9, "floor"));
    const heights = z.flat(), top = Math.max(...heights);
    const low = floor ?? Math.min(...heights) - 0.25 * this.box.size;
    bedding.walls.forEach(([axis, place]) => {
      const across = [[place, place], [place, place]];
      const [a, b] = ends(axis === 0 ? y : x), along = [[a, b], [a, b]], up = [[low, low], [top, top]];
      sheets.push(sheet(...(axis === 0 ? [across, along] : [along, across]), up, css("--floor"), 0.3, "wall"));
    });
    return sheets;
  }

  tone(part, i) { // of several runs each has its colour
    return data.runs ? colourOf(runOf(part.name, ": ")) : TONES[i % TONES.length];
  }

  extent() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const { poses, parts, ground, bedding } = this.motion;
    for (const k of [0, Math.floor(poses.length / 3), Math.floor((2 * poses.length) / 3), poses.length - 1]) {
      parts.forEach((part, i) => placed(part.points_m, poses[k][i]).forEach((values, axis) => {
        for (const value of values) {
          if (value < low[axis]) low[axis] = value;
          if (value > high[axis]) high[axis] = value;
        }
      }));
    }
    const size = Math.max(...high.map((value, axis) => value - low[axis]));
    if (ground) {
      const heights = ground[2].flat();
      low[2] = Math.min(low[2], Math.min(...heights));
      high[2] = Math.max(high[2], Math.max(...heights));
      [0, 1].forEach((axis) => {
        low[axis] = Math.min(low[axis], ground[axis][0]);
        high[axis] = Math.max(high[axis], ground[axis][ground[axis].length - 1]);
      });
    }
    if (bedding && bedding.floor_m !== null && bedding.floor_m > low[2] - size) low[2] = Math.min(low[2], bedding.floor_m);
    return { low, high, size };
  }

  // Room for the ends of all arrows.
  contain() {
    this.motion.time_s.forEach((_, i) => {
      const [, ends] = this.arrows(i, i, 0);
      ends.forEach((values, axis) => values.forEach((value) => {
        this.box.low[axis] = Math.min(this.box.low[axis], value);
        this.box.high[axis] = Math.max(this.box.high[axis], value);
      }));
    });
  }

  layout() {
    const { low, high, size } = this.box, spans = high.map((value, axis) => value - low[axis] + 0.1 * size);
    const [x, y, z] = spans.map((span) => (1.75 * span) / Math.hypot(...spans)); // one scale for all: `data` would take that of the first traces
    const axis = (name, i) => ({
      title: { text: `${name} (m)` }, range: [low[i] - 0.05 * size, high[i] + 0.05 * size], color: css("--soft"),
      gridcolor: css("--line"), backgroundcolor: css("--sky"), showbackground: i === 2, zeroline: false, nticks: 5, showspikes: false,
    });
    return {
      margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false,
      paper_bgcolor: "rgba(0,0,0,0)", font: { color: css("--soft"), size: 11 }, uirevision: "kept",
      scene: { xaxis: axis("x", 0), yaxis: axis("y", 1), zaxis: axis("z", 2), aspectmode: "manual", aspectratio: { x, y, z }, camera: VIEWS.oblique, dragmode: "turntable" },
    };
  }

  path(columns) {
    if (data.runs) return null;
    const first = Object.keys(columns).find((name) => name.endsWith("_vx_m_s")), of = first ? first.slice(0, -7) : "tip";
    if (!columns[`${of}_z_m`]) return null;
    const rows = columns.time_s.length, step = Math.max(1, Math.floor(rows / 400)), path = { x: [], y: [], z: [] };
    for (let i = 0; i < rows; i += step) for (const axis of "xyz") path[axis].push(columns[`${of}_${axis}_m`][i]);
    return path;
  }

  // Lines of all forces, with gaps between them, and their ends.
  arrows(i, next, share) {
    const line = [[], [], []], end = [[], [], []];
    if (!$("#with-forces").checked) return [line, end];
    for (const [name, history] of Object.entries(this.motion.forces)) {
      if (shown.hidden.has(runOf(name, ": "))) continue;
      const point = history.point_m[i].map((value, k) => mix(value, history.point_m[next][k], share));
      const force = history.force_N[i].map((value, k) => mix(value, history.force_N[next][k], share));
      const size = Math.hypot(...force), length = Math.min(size * this.scale(), 0.4 * this.box.size);
      if (!(length > 0.01 * this.box.size)) continue;
      for (let k = 0; k < 3; k++) {
        const tip = point[k] + (force[k] / size) * length;
        line[k].push(point[k], tip, null);
        end[k].push(tip);
      }
    }
    return [line, end];
  }

  scale() { // length (m) of an arrow per N: the force that a tenth of all exceed is a fifth of the size
    if (this.perNewton === undefined) {
      const sizes = Object.values(this.motion.forces).flatMap((history) => history.force_N.map((force) => Math.hypot(...force)));
      const positive = sizes.filter((size) => size > 0).sort((a, b) => a - b);
      this.perNewton = positive.length ? (0.2 * this.box.size) / positive[Math.floor(0.9 * (positive.length - 1))] : 0;
    }
    return this.perNewton;
  }

  show(time) {
    this.wanted = time;
    if (!this.busy) this.redraw();
  }

  async redraw() { // as often as the machine can: instants that come while it draws are left out
    this.busy = true;
    while (this.wanted !== undefined) {
      const time = this.wanted;
      this.wanted = undefined;
      const { motion } = this, [i, share] = between(motion.time_s, time), next = Math.min(i + 1, motion.poses.length - 1);
      const places = motion.parts.map((part, p) => placed(part.points_m, posed(motion.poses[i][p], motion.poses[next][p], share)));
      const all = [...places, ...this.arrows(i, next, share)];
      await Plotly.restyle(this.plot, { x: all.map((points) => points[0]), y: all.map((points) => points[1]), z: all.map((points) => points[2]) },
        [...this.bodies, this.lines, this.lines + 1]);
      await new Promise(requestAnimationFrame);
    }
    this.busy = false;
  }
}
