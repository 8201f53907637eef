// The clock of the page: moves pictures and cursors through the runs; play, pause, steps, speed.
"use strict";

// What a run of the page's data can tell.
acro.run = function (data) {
  const run = { ...data, times: acro.column(data.over) };
  run.row = (time) => acro.rowAt(run.times, time);
  run.part = (name, row) => (name in run.parts ? acro.column(run.parts[name])[row] : null);
  // Between two rows the straight line; what was not recorded is null.
  run.at = function (name, time) {
    if (!(name in run.parts) || time == null) return null;
    const values = acro.column(run.parts[name]);
    const row = run.row(time);
    const next = Math.min(row + 1, run.times.length - 1);
    if (next === row || values[row] == null || values[next] == null) return values[row];
    const share = Math.max(0, (time - run.times[row]) / (run.times[next] - run.times[row]));
    return values[row] + Math.min(1, share) * (values[next] - values[row]);
  };
  run.torqueName = "tau_applied" in run.parts ? "tau_applied" : "tau";
  run.largest = acro.largestTorque(run);
  return run;
};

// The last row at or before a time; the first one before all.
acro.rowAt = function (times, time) {
  let [low, high] = [0, times.length - 1];
  const late = time + 1e-9;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= late) low = middle; else high = middle - 1;
  }
  return low;
};

// The largest torque before the links touch, which is what arrows are measured by.
acro.largestTorque = function (run) {
  if (!(run.torqueName in run.parts)) return 0;
  const torque = acro.column(run.parts[run.torqueName]);
  const touched = "contact" in run.parts ? acro.column(run.parts.contact) : null;
  let largest = 0;
  for (let row = 0; row < torque.length && !(touched && touched[row]); row++) largest = Math.max(largest, Math.abs(torque[row] || 0));
  return largest;
};

acro.view = function () {
  const runs = acro.data("view").runs.map(acro.run);
  const stages = [...document.querySelectorAll(".stage")];
  const element = (id) => document.getElementById(id);
  const [clock, now, play] = [element("clock"), element("now"), element("play")];
  const state = { time: 0, playing: false, speed: 1, last: 0, inside: false };
  const first = Math.min(...runs.map((run) => run.times[0]));
  const end = Math.max(...runs.map((run) => run.times[run.times.length - 1]));
  [clock.min, clock.max, state.time] = [first, end, first];

  const draw = function () {
    runs.forEach((run, index) => {
      const [scene, camera] = [stages[index].querySelector(".scene"), stages[index].querySelector(".camera")];
      const row = run.row(state.time);
      if (scene) {
        const at = { q1: run.at("q1", state.time), q2: run.at("q2", state.time), z: run.part("z", row), z_desired: run.part("z_desired", row), torque: run.part(run.torqueName, row), largest: run.largest };
        acro.drawScene(scene, run.machine, at);
      }
      if (camera) acro.drawCamera(camera, stages[index].querySelector(".of-camera"), run, row, draw);
    });
    clock.value = state.time;
    clock.setAttribute("aria-valuetext", state.time.toFixed(3) + " seconds");
    now.textContent = "t = " + state.time.toFixed(3) + " s";
    if (!state.inside) for (const { plot } of acro.graphs) plot.setCursor({ left: plot.valToPos(state.time, "x"), top: 0 }, true, false);
  };
  const go = (time) => { state.time = Math.max(first, Math.min(end, time)); draw(); };
  const pause = (playing) => { state.playing = playing; play.textContent = playing ? "Pause" : "Play"; play.setAttribute("aria-label", playing ? "Pause" : "Play"); };
  const tick = function (at) {
    if (!state.playing) return;
    go(state.time + Math.min(0.25, (at - state.last) / 1000) * state.speed);
    state.last = at;
    if (state.time >= end) pause(false); else requestAnimationFrame(tick);
  };
  play.onclick = function () {
    if (state.time >= end) state.time = first;
    pause(!state.playing);
    state.last = performance.now();
    if (state.playing) requestAnimationFrame(tick);
  };
  const step = (way) => () => { pause(false); go(acro.nextFrame(runs, state.time, way)); };
  element("back").onclick = step(-1);
  element("on").onclick = step(1);
  element("speed").onchange = (event) => { state.speed = Number(event.target.value); };
  clock.oninput = () => { pause(false); go(Number(clock.value)); };
  acro.picker(element("add"), runs, () => { follow(acro.graphs[acro.graphs.length - 1]); draw(); });

  // Over a graph the cursor is the reader's; a click sets the clock there.
  const follow = function ({ plot }) {
    plot.over.addEventListener("mouseenter", () => { state.inside = true; });
    plot.over.addEventListener("mouseleave", () => { state.inside = false; draw(); });
    plot.over.addEventListener("click", () => { if (plot.cursor.idx != null && !plot.select.width) go(plot.data[0][plot.cursor.idx]); });
  };
  const ready = () => { acro.graphs.forEach(follow); draw(); };
  if (document.documentElement.hasAttribute("data-graphs")) ready(); else document.addEventListener("graphs-drawn", ready);
  addEventListener("keydown", (event) => {
    if (event.target !== document.body || event.ctrlKey || event.metaKey || event.altKey) return;
    const keys = { " ": play.onclick, ArrowLeft: step(-1), ArrowRight: step(1) };
    if (keys[event.key]) { keys[event.key](); event.preventDefault(); }
  });
  acro.onColours(draw);
  new ResizeObserver(draw).observe(document.querySelector(".stages"));
  draw();
  acro.clock = { state, go };
};

// The time at which the next picture came, or the one before; without a camera the next row.
acro.nextFrame = function (runs, time, way) {
  const run = runs[0];
  const row = run.row(time);
  const frames = "frame_index" in run.parts ? acro.column(run.parts.frame_index) : null;
  let next = row + way;
  if (frames) {
    while (next > 0 && next < frames.length - 1 && frames[next] === frames[row]) next += way;
    // Back to where the picture came, not to where it went.
    if (way < 0) while (next > 0 && frames[next - 1] === frames[next]) next--;
  }
  return run.times[Math.max(0, Math.min(run.times.length - 1, next))];
};

// Adds a graph of any column that the reader chooses.
acro.picker = function (select, runs, added) {
  const names = [...new Set(runs.flatMap((run) => run.signals.map(([name]) => name)))].sort();
  for (const name of names) select.append(acro.element("option", { value: name }, name));
  select.onchange = function () {
    const name = select.value;
    select.value = "";
    if (!name) return;
    const tables = runs.map((run) => [run, run.signals.find(([known]) => known === name)]).filter(([, found]) => found);
    const joined = uPlot.join(tables.map(([run, found]) => [run.times, acro.column(found[1])]));
    const lines = tables.map(([run], index) => ({ label: runs.length > 1 ? `${name} (${run.letter})` : name, style: index ? "dashed" : "solid", held: tables[index][1][2], column: index + 1 }));
    const figure = acro.element("figure", { class: "live" });
    document.querySelector(".signals .row").append(figure);
    acro.graph(figure, { title: name, x: "time in s", y: name, over: 0, lines }, (number) => joined[number]);
    added();
  };
};

acro.view();
