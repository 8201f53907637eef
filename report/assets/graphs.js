// Draws the page's graphs with uPlot: one cursor and one zoom for all over the same axis, values in the legend.
"use strict";
acro.graphs = []; // {plot, description} in the order of the page

// Draws a description (report/src/live/mod.rs) into a figure; `columns` answers a column by its number.
acro.graph = function (figure, described, columns, height) {
  const over = columns(described.over);
  const data = [over, ...described.lines.map((line) => columns(line.column))];
  const whole = described.x_range || acro.whole(described, over);
  described.link = [described.x, ...whole].join("|");
  const host = acro.element("div", { class: "plot", tabindex: 0, role: "group", "aria-label": acro.described(described) });
  const reset = acro.element("button", { type: "button", hidden: "", onclick: () => plot.setScale("x", { min: whole[0], max: whole[1] }) }, "Whole range");
  const head = acro.element("div", { class: "graph-head" }, acro.element("h3", {}, described.title), reset);
  const still = figure.querySelector("noscript");
  if (still) head.append(acro.saver(still, described));
  figure.prepend(head);
  if (described.event) head.after(acro.element("p", { class: "graph-event" }, "┊ " + described.event[1]));
  if (still) still.before(host); else figure.append(host);
  const state = { whole, isWhole: true, reset };
  const plot = new uPlot(acro.options(described, data, state, host, height), data, host);
  if (plot.scales.x.min !== whole[0] || plot.scales.x.max !== whole[1]) plot.setScale("x", { min: whole[0], max: whole[1] });
  plot.over.tabIndex = -1;
  const fit = () => {
    if (host.clientWidth > 0 && host.clientWidth !== plot.width) plot.setSize({ width: host.clientWidth, height: acro.height(host, height) });
  };
  new ResizeObserver(fit).observe(host);
  host.addEventListener("keydown", (event) => acro.key(event, plot, whole));
  acro.touch(plot);
  acro.graphs.push({ plot, described, host, fit });
  return plot;
};

// What "all" is: of all graphs of the page over the same axis, since they are linked. A graph of a part leaves those out that are more than
// twice as long: it would be empty for the most of it.
acro.whole = function (described, over) {
  const like = ((acro.packed && acro.packed.graphs) || []).filter((graph) => graph.x === described.x && !graph.x_range);
  const columns = [over, ...new Set(like.map((graph) => graph.over))].map((column) => (typeof column === "number" ? acro.column(column) : column));
  const ends = columns.map((column) => [column[0], column[column.length - 1]]);
  const near = ends.filter((end) => end[1] - end[0] <= 2 * (ends[0][1] - ends[0][0]));
  return [Math.min(...near.map((end) => end[0])), Math.max(...near.map((end) => end[1]))];
};

acro.height = (host, height) => height || (host.clientWidth < 480 ? 240 : 300);

acro.described = (graph) =>
  `${graph.title}: ${graph.lines.map((line) => line.label).join(", ")} over ${graph.x}. Arrow keys move the cursor, plus and minus zoom, 0 shows all.`;

// The button that hands out the graph as SVG, which stands on the page for readers without scripts.
acro.saver = (still, described) =>
  acro.element("button", { type: "button", "aria-label": `Save ${described.title} as SVG`, onclick: () => acro.download(still.textContent, acro.fileName(described.title) + ".svg", "image/svg+xml") }, "SVG");

acro.options = function (described, data, state, host, height) {
  const ink = () => acro.colour("ink");
  const axis = {
    stroke: ink, font: "13px system-ui, sans-serif", labelFont: "13px system-ui, sans-serif", labelGap: 2, labelSize: 20,
    grid: { stroke: () => acro.colour("grid"), width: 1 }, ticks: { stroke: () => acro.colour("grid"), width: 1, size: 4 },
    values: (_, splits, __, ___, step) => acro.ticks(splits, step),
  };
  const wide = (_, labels) => Math.max(40, 7.6 * Math.max(0, ...(labels || []).map((label) => label.length)) + 12);
  return {
    width: host.clientWidth || 300, height: acro.height(host, height),
    scales: {
      x: { time: false, distr: described.x_log ? 3 : 1, range: (_, low, high) => { state.isWhole = low <= state.whole[0] && high >= state.whole[1]; return [low, high]; } },
      y: { range: (_, low, high) => acro.fitted(described, state, low, high) },
    },
    axes: [{ ...axis, ...(described.x_log && { values: (_, splits) => splits.map((split) => (split == null ? "" : acro.rounded(split))) }), label: acro.fits(described.x, 44), size: 28 }, { ...axis, label: acro.fits(described.y, 28), size: wide }],
    series: [{ label: described.x, value: (_, value) => acro.rounded(value) }, ...described.lines.map((line, number) => acro.series(line, number, data[0].length))],
    legend: { markers: { width: 2, stroke: (_, line) => (line ? `var(--line${(line - 1) % 6})` : "transparent"), dash: (_, line) => acro.dashes(described.lines[line - 1]) } },
    cursor: {
      x: true, y: false, drag: { x: true, y: false, dist: 6 }, points: { size: 6 },
      sync: { key: described.link, scales: ["x", null] },
      dataIdx: (_, line, row) => acro.nearest(data[line], row),
    },
    hooks: {
      setScale: [(plot, scale) => { if (scale === "x") { acro.link(plot, described); state.reset.hidden = state.isWhole; } }],
      setLegend: [acro.exact],
      draw: [(plot) => { if (described.event) acro.upright(plot, described.event[0]); }],
    },
  };
};

// Every digit of the values in the legend, for whom seven are too few: as an attribute.
acro.exact = function (plot) {
  plot.root.querySelectorAll(".u-value").forEach((cell, line) => {
    const row = plot.legend.idxs[line];
    cell.dataset.exact = row == null ? "" : acro.text(plot.data[line][row]);
  });
};

acro.dashes = (line) => ({ dashed: "dashed", dotted: "dotted", dots: "dotted", crosses: "dotted" })[line && line.style] || "solid";

acro.series = function (line, number, rows) {
  const colour = () => acro.colour("line" + (number % 6));
  const made = { label: line.label, stroke: colour, width: 1.5, value: (_, value) => acro.rounded(value), points: { show: false } };
  if (line.held) made.paths = uPlot.paths.stepped({ align: 1 });
  if (line.style === "dashed") made.dash = [7, 4];
  if (line.style === "dotted") made.dash = [2, 3];
  if (line.style === "dots" || line.style === "crosses") {
    made.paths = () => null;
    // A few dots are seen as well as many.
    made.points = { show: true, size: rows > 80 ? 4 : 7, stroke: colour, fill: line.style === "dots" ? colour : null };
  }
  return made;
};

// The vertical range: before a failure as long as all of the time is shown, else what the visible part needs.
acro.fitted = function (described, state, low, high) {
  if (described.y_range && state.isWhole) return described.y_range;
  if (low == null || high == null) return [0, 1];
  const margin = high > low ? 0.06 * (high - low) : 0.5 * Math.max(Math.abs(high), 1e-3);
  return [low - margin, high + margin];
};

// The row nearest to this one in which a line has a point.
acro.nearest = function (values, row) {
  if (!values || values[row] !== undefined) return row;
  for (let away = 1; away < values.length; away++) {
    if (row - away >= 0 && values[row - away] != null) return row - away;
    if (row + away < values.length && values[row + away] != null) return row + away;
  }
  return row;
};

// All graphs over the same part of an axis show the same of it.
acro.link = function (plot, described) {
  const { min, max } = plot.scales.x;
  for (const other of acro.graphs) {
    const scale = other.plot.scales.x;
    if (other.plot !== plot && other.described.link === described.link && (scale.min !== min || scale.max !== max)) other.plot.setScale("x", { min, max });
  }
};

// An upright line where something happened.
acro.upright = function (plot, at) {
  const { min, max } = plot.scales.x;
  if (at < min || at > max) return;
  const x = Math.round(plot.valToPos(at, "x", true));
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.strokeStyle = acro.colour("event");
  ctx.lineWidth = devicePixelRatio;
  ctx.setLineDash([2 * devicePixelRatio, 4 * devicePixelRatio]);
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
};

// Puts the cursor on a row, there and in all linked graphs.
acro.point = (plot, row) => plot.setCursor({ left: plot.valToPos(plot.data[0][row], "x"), top: 0 }, true, true);

acro.key = function (event, plot, whole) {
  const { min, max } = plot.scales.x;
  const last = plot.data[0].length - 1;
  const row = plot.cursor.idx == null ? plot.valToIdx(min) : plot.cursor.idx;
  const far = event.shiftKey ? Math.max(1, Math.round((plot.valToIdx(max) - plot.valToIdx(min)) / 20)) : 1;
  const zoom = (share) => {
    const middle = plot.data[0][row];
    plot.setScale("x", { min: Math.max(whole[0], middle - (middle - min) * share), max: Math.min(whole[1], middle + (max - middle) * share) });
  };
  const keys = {
    ArrowLeft: () => acro.point(plot, Math.max(0, row - far)), ArrowRight: () => acro.point(plot, Math.min(last, row + far)),
    Home: () => acro.point(plot, plot.valToIdx(min)), End: () => acro.point(plot, plot.valToIdx(max)),
    "+": () => zoom(0.5), "-": () => zoom(2), 0: () => plot.setScale("x", { min: whole[0], max: whole[1] }), Escape: () => plot.setScale("x", { min: whole[0], max: whole[1] }),
  };
  if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
  keys[event.key]();
  event.preventDefault();
};

// A finger moves the cursor; the page scrolls up and down as ever.
acro.touch = function (plot) {
  const move = (event) => {
    if (event.pointerType !== "touch") return;
    const box = plot.over.getBoundingClientRect();
    plot.setCursor({ left: event.clientX - box.left, top: 0 }, true, true);
  };
  plot.over.addEventListener("pointerdown", move);
  plot.over.addEventListener("pointermove", move);
};

// A column of the page by its number, unpacked once.
acro.column = function (number) {
  if (!acro.packed) [acro.packed, acro.unpacked] = [acro.data("graphs"), new Map()];
  if (!acro.unpacked.has(number)) acro.unpacked.set(number, acro.unpack(acro.packed.columns[number]));
  return acro.unpacked.get(number);
};

// Draws all graphs of the page, the first at once, the others when the browser has shown it.
acro.drawAll = function () {
  const figures = [...document.querySelectorAll("figure[data-graph]")];
  if (figures.length > 0) {
    const words = "Drag over a graph to zoom, double click for the whole range. The values below a graph are those of the data at the cursor, to seven digits.";
    (figures[0].closest(".row") || figures[0]).before(acro.element("p", { class: "graph-hint" }, words));
    acro.column(0);
  }
  const next = () => {
    const figure = figures.shift();
    if (!figure) {
      document.documentElement.setAttribute("data-graphs", "drawn");
      document.dispatchEvent(new Event("graphs-drawn"));
      return;
    }
    acro.graph(figure, acro.packed.graphs[Number(figure.dataset.graph)], acro.column);
    performance.mark("graph-" + figure.dataset.graph);
    setTimeout(next);
  };
  next();
  // A page is printed before an observer is called: what was as wide as a screen would be cut.
  acro.onColours(() => { for (const { plot, fit } of acro.graphs) { fit(); plot.redraw(true, true); } });
};

acro.drawAll();
