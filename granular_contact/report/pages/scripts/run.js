// A page with histories, a motion or a chart: of a run, of several, of many.
async function start() {
  const files = Object.entries(data.files || {});
  const motion = data.motion;
  if (motion) {
    [clock.start, clock.end] = [motion.time_s[0], motion.time_s[motion.time_s.length - 1]];
    controls(motion);
    if (data.stage) drawing(motion, data.stage);
    setTime(data.stage ? motion.time_s[$("#stage").dataset.shown] : data.moments.deepest || clock.start);
  }
  if (!window.DecompressionStream) return offer(files);
  const columns = data.table ? await tableOf(data.table) : null;
  const name = data.table_name === undefined ? "timeseries.csv" : data.table_name;
  offer(columns && name && !(name in (data.files || {})) ? [[name, () => csvOf(columns)], ...files] : files);
  if (columns && !motion) [clock.start, clock.end] = [columns.time_s[0], columns.time_s[columns.time_s.length - 1]];
  if (!(await plotly())) return;
  document.documentElement.classList.add("draws");
  if (data.runs) chooseRuns();
  if (columns) histories(columns);
  if (motion && !data.stage) new SpacePlayer(motion, columns);
  if (columns && !motion) setTime(clock.end);
  if (data.cases) caseChart();
}
start();
