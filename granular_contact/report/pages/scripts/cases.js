// Sweeps, searches and fits: any number of the rows against any other, with a third as colour.
function caseChart() {
  const place = $("#cases-chart .plot"), output = $("#cases-chart output");
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
    const traces = [{ x: a.values, y: b.values, text, hoverinfo: "text", mode: "markers", type: "scatter", marker }];
    if (data.cases.joined && +x.value === data.cases.x) {
      const order = a.values.map((_, i) => i).filter((i) => a.values[i] !== null && b.values[i] !== null);
      order.sort((i, k) => a.values[i] - a.values[k]);
      const [along, upward] = [a, b].map((column) => order.map((i) => column.values[i]));
      const line = { color: colourOf(0), width: 1 };
      traces.push({ x: along, y: upward, hoverinfo: "skip", mode: "lines", type: "scatter", line, showlegend: false });
    }
    Plotly.react(place, traces, layout, CONFIG);
  };
  // What is pointed at, in the chart or in the table of cases, is marked in both.
  const rows = new Map($$("tbody tr").map((row) => [row.cells[0].textContent, row]));
  const point = (i) => {
    for (const row of $$("tr.pointed")) row.classList.remove("pointed");
    const row = i === null ? null : rows.get(data.cases.names[i].replace(/^run /, ""));
    if (row) row.classList.add("pointed");
    output.textContent = i === null ? "" : data.cases.names[i];
    const sizes = data.cases.names.map((_, k) => (k === i ? 16 : 8));
    Plotly.restyle(place, { "marker.size": [i === null ? 8 : sizes] }, [0]);
  };
  data.cases.names.forEach((name, i) => {
    const row = rows.get(name.replace(/^run /, ""));
    if (!row) return;
    row.addEventListener("pointerenter", () => point(i));
    row.addEventListener("pointerleave", () => point(null));
  });
  for (const select of [x, y, tone]) select.addEventListener("change", draw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  draw();
  place.on("plotly_hover", (event) => point(event.points[0].pointIndex));
}
