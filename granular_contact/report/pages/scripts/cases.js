// Sweeps, searches and fits: any number of the rows against any other, with a third as colour.
function caseChart() {
  const place = $("#cases-chart .plot"), told = $("#cases-chart output");
  const [x, y, tone] = ["x", "y", "tone"].map((name) => $(`#cases-${name}`));
  data.cases.columns.forEach((column, i) => {
    for (const select of [x, y, tone]) select.append(make("option", { value: i }, column.label));
  });
  x.value = data.cases.x;
  y.value = data.cases.y;
  const draw = () => {
    const [a, b] = [data.cases.columns[x.value], data.cases.columns[y.value]];
    const c = tone.value === "" ? null : data.cases.columns[tone.value];
    const marker = { size: 8, opacity: 0.8, color: colourOf(0) };
    if (c) {
      const bar = { title: { text: c.label, side: "right" }, thickness: 12, outlinewidth: 0 };
      Object.assign(marker, { color: c.values, colorscale: "Viridis", showscale: true, colorbar: bar });
    }
    const layout = look(a.label, { text: b.label });
    Object.assign(layout, { height: 380, hovermode: "closest" });
    const text = data.cases.names.map((name, i) => `${name}: ${number(a.values[i])}, ${number(b.values[i])}`);
    Plotly.react(place, [{ x: a.values, y: b.values, text, hoverinfo: "text", mode: "markers", type: "scatter", marker }], layout, CONFIG);
  };
  for (const select of [x, y, tone]) select.addEventListener("change", draw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  draw();
  place.on("plotly_hover", (event) => {
    const i = event.points[0].pointIndex;
    told.textContent = data.cases.names[i];
  });
}

async function start() {
  offer(Object.entries(data.files || {}));
  if (!data.cases || !(await plotly())) return;
  document.documentElement.classList.add("draws");
  caseChart();
}
start();
