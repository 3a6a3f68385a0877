// The page of a run.
async function start() {
  const files = Object.entries(data.files || {});
  const motion = data.motion;
  if (motion) {
    [clock.start, clock.end] = [motion.time_s[0], motion.time_s[motion.time_s.length - 1]];
    controls(motion);
    if (data.stage) drawing(motion, data.stage);
    setTime(data.stage ? motion.time_s[$("#stage").dataset.shown] : data.moments.deepest || clock.start);
  }
  if (!data.table || !window.DecompressionStream) return offer(files);
  const columns = await tableOf(data.table);
  offer([["timeseries.csv", () => csvOf(columns)], ...files]);
  if (!motion) [clock.start, clock.end] = [columns.time_s[0], columns.time_s[columns.time_s.length - 1]];
  if (!(await plotly())) return;
  document.documentElement.classList.add("draws");
  histories(columns);
  if (motion && !data.stage) new SpacePlayer(motion, columns);
  if (!motion) setTime(clock.end);
}
start();
