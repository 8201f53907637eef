// Maps whose cells tell their values. The cells of the drawing are its rectangles after the paper's own, one for each value that
// there is, row by row.
"use strict";

acro.map = function (figure) {
  const { labels, x, y, values } = JSON.parse(figure.dataset.map);
  const svg = figure.querySelector("svg");
  const there = values.map((value, index) => (value === null ? -1 : index)).filter((index) => index >= 0);
  const cells = [...svg.querySelectorAll("rect")].slice(1, 1 + there.length);
  const cellOf = new Map(there.map((index, number) => [index, cells[number]]));
  const told = acro.element("p", { class: "reading", role: "status" }, "Point at a cell, or use the arrow keys, for its value.");
  figure.tabIndex = 0;
  figure.setAttribute("role", "group");
  figure.setAttribute("aria-label", `${labels[2]} over ${labels[0]} and ${labels[1]}; arrow keys move from cell to cell`);
  let [at, marked] = [there[0] || 0, null];
  const show = (index) => {
    at = index;
    const [row, column] = [Math.floor(index / x.length), index % x.length];
    if (marked) marked.classList.remove("marked");
    marked = cellOf.get(index) || null;
    if (marked) marked.classList.add("marked");
    told.textContent = `${labels[0]} ${acro.text(x[column])}, ${labels[1]} ${acro.text(y[row])}: ${values[index] === null ? "no value" : `${labels[2]} ${acro.text(values[index])}`}`;
  };
  cellOf.forEach((cell, index) => {
    for (const kind of ["pointerenter", "pointerdown"]) cell.addEventListener(kind, () => show(index));
  });
  figure.addEventListener("keydown", (event) => {
    const [row, column] = [Math.floor(at / x.length), at % x.length];
    const to = { ArrowLeft: [row, column - 1], ArrowRight: [row, column + 1], ArrowUp: [row + 1, column], ArrowDown: [row - 1, column] }[event.key];
    if (!to || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const within = (place, many) => Math.min(Math.max(place, 0), many - 1);
    show(within(to[0], y.length) * x.length + within(to[1], x.length));
  });
  svg.after(told);
};

document.querySelectorAll("figure.map").forEach(acro.map);
