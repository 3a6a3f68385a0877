// The player: play, scrub, speed, moments; in the plane it moves the parts of the drawing.
const SECONDS = [...Array(16).keys()].flatMap((k) => [1, 2, 5].map((digit) => Number(`${digit}e${k - 12}`)));

function controls(motion) {
  const place = $("#player .controls");
  const play = $("[data-do=play]", place), slider = $("input[type=range]", place), output = $("output", place);
  const pace = $("select", place);
  const lasts = clock.end - clock.start || 1;
  const unit = lasts < 1 ? ["ms", 1e3] : ["s", 1];
  const paces = SECONDS.filter((rate) => lasts / rate > 0.5 && lasts / rate < 300);
  const usual = paces.reduce((a, b) => (Math.abs(Math.log(lasts / b / 6)) < Math.abs(Math.log(lasts / a / 6)) ? b : a));
  for (const rate of paces) {
    const label = rate === 1 ? "real time" : rate < 1 ? `${Math.round(1 / rate)} times slower` : `${rate} times faster`;
    pace.append(make("option", rate === usual ? { value: rate, selected: "" } : { value: rate }, label));
  }
  slider.min = clock.start;
  slider.max = clock.end;
  slider.step = "any";
  let last = null; // of the pictures drawn while it plays
  const step = (now) => {
    if (last === null) return;
    setTime(clock.time + ((now - last) / 1000) * pace.value);
    last = now;
    if (clock.time >= clock.end) pause();
    else requestAnimationFrame(step);
  };
  const pause = () => {
    last = null;
    play.textContent = "▶ Play";
  };
  play.addEventListener("click", () => {
    if (last !== null) return pause();
    if (clock.time >= clock.end) setTime(clock.start);
    last = performance.now();
    play.textContent = "❚❚ Pause";
    requestAnimationFrame(step);
  });
  slider.addEventListener("input", () => {
    pause();
    setTime(Number(slider.value));
  });
  clock.listeners.push((time) => {
    slider.value = time;
    const digits = Math.max(0, 4 - Math.ceil(Math.log10(lasts * unit[1])));
    const text = `${(time * unit[1]).toFixed(digits)} ${unit[0]}`;
    output.textContent = text;
    slider.setAttribute("aria-valuetext", text);
  });
  for (const [name, time] of Object.entries(data.moments || {})) {
    const button = make("button", { type: "button" }, name);
    button.addEventListener("click", () => {
      pause();
      setTime(time);
    });
    $(".moments", place).append(button);
  }
}

// Corners of an arrow for a force (N) at a point, y upward; px: the length of a pixel.
function arrow([x, y], [fx, fy], factor, px, longest) {
  const size = Math.hypot(fx, fy), length = Math.min(size * factor, longest);
  if (!(length > 2 * px)) return "";
  const [ux, uy] = [fx / size, fy / size];
  const head = Math.min(13 * px, 0.7 * length), shaft = (2.2 * px * head) / (13 * px), wing = 0.45 * head;
  const corners = [
    [0, shaft], [length - head, shaft], [length - head, wing], [length, 0],
    [length - head, -wing], [length - head, -shaft], [0, -shaft],
  ];
  return "M" + corners.map(([a, b]) => `${x + a * ux - b * uy} ${y + a * uy + b * ux}`).join("L") + "Z";
}

function drawing(motion, stage) {
  const svg = $("#stage"), world = $(".world", svg);
  const parts = $$(".part", world), arrows = $(".forces", world);
  const forces = Object.entries(motion.forces).map(([name, history]) => [history, arrows.appendChild(
    document.createElementNS("http://www.w3.org/2000/svg", "path")), runOf(name, ": ")]);
  const key = $(".key path", svg);
  if (key) key.setAttribute("d", arrow([22, stage.height - 22], [Number(key.dataset.px), 0], 1, 1, Infinity));
  const view = { scale: 1, left: stage.left, top: stage.top };
  const follow = $("#follow"), withForces = $("#with-forces");
  const middle = (i, share) => { // of the mechanism, along x
    const x = motion.poses[i].map((pose, part) => mix(pose[0], motion.poses[i + 1 < motion.poses.length ? i + 1 : i][part][0], share));
    return (Math.min(...x) + Math.max(...x)) / 2;
  };
  const start = middle(0, 0);
  function place() {
    const [i, share] = between(motion.time_s, clock.time);
    const shift = follow && follow.checked ? middle(i, share) - start : 0;
    world.setAttribute("transform",
      `scale(${view.scale} ${-view.scale}) translate(${-view.left - shift} ${-view.top})`);
    const ruler = $(".ruler", svg);
    ruler.setAttribute("transform", `translate(${stage.width - 24} ${stage.height - 20}) scale(${view.scale} 1)`);
  }
  function show(time) {
    const [i, share] = between(motion.time_s, time), next = Math.min(i + 1, motion.poses.length - 1);
    parts.forEach((part, p) => {
      const line = motion.bent[p];
      if (line) {
        const points = line[i].map(([x, y], k) => `${mix(x, line[next][k][0], share)} ${mix(y, line[next][k][1], share)}`);
        part.setAttribute("d", "M" + points.join("L"));
        return;
      }
      const [a, b] = [motion.poses[i][p], motion.poses[next][p]];
      const turn = (mix(a[2], b[2], share) * 180) / Math.PI;
      part.setAttribute("transform", `translate(${mix(a[0], b[0], share)} ${mix(a[1], b[1], share)}) rotate(${turn})`);
    });
    for (const [history, path, run] of forces) {
      const at = history.point_m, force = history.force_N;
      const [a, b] = [force[i], force[next]], on = [a, b].map(([x, y]) => x !== 0 || y !== 0);
      const from = on[0] ? at[i] : at[next], to = on[1] ? at[next] : at[i];
      const point = [mix(from[0], to[0], share), mix(from[1], to[1], share)];
      const vector = [mix(a[0], b[0], share), mix(a[1], b[1], share)];
      const visible = withForces.checked && !shown.hidden.has(run) && (on[0] || on[1]);
      path.setAttribute("d", visible ? arrow(point, vector, stage.arrow, 1 / view.scale, stage.longest) : "");
    }
    place();
  }
  function zoom(factor, x = stage.width / 2, y = stage.height / 2) { // about a point of the drawing (px)
    const scale = Math.min(Math.max(view.scale * factor, 0.5), 100);
    view.left += x / view.scale - x / scale;
    view.top -= y / view.scale - y / scale;
    view.scale = scale;
    show(clock.time);
  }
  $("[data-do=in]").addEventListener("click", () => zoom(1.5));
  $("[data-do=out]").addEventListener("click", () => zoom(1 / 1.5));
  const fit = () => {
    Object.assign(view, { scale: 1, left: stage.left, top: stage.top });
    show(clock.time);
  };
  $("[data-do=fit]").addEventListener("click", fit);
  svg.addEventListener("dblclick", fit);
  const px = () => stage.width / svg.getBoundingClientRect().width;
  svg.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return; // else the page is scrolled
    event.preventDefault();
    const box = svg.getBoundingClientRect();
    zoom(Math.exp(-event.deltaY / 200), (event.clientX - box.left) * px(), (event.clientY - box.top) * px());
  }, { passive: false });
  let grabbed = null;
  svg.addEventListener("pointerdown", (event) => {
    grabbed = [event.clientX, event.clientY];
    svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", (event) => {
    if (!grabbed) return;
    view.left -= ((event.clientX - grabbed[0]) * px()) / view.scale;
    view.top += ((event.clientY - grabbed[1]) * px()) / view.scale;
    grabbed = [event.clientX, event.clientY];
    show(clock.time);
  });
  for (const end of ["pointerup", "pointercancel"]) svg.addEventListener(end, () => (grabbed = null));
  for (const box of [follow, withForces]) if (box) box.addEventListener("change", () => show(clock.time));
  clock.listeners.push(show);
}
