// Sliders for the coefficients of a lens: the fields of the page, each times its coefficient, added up and drawn.
"use strict";

acro.lens = function (host) {
  const data = acro.data("lens-data");
  const fields = data.fields.map(([name, u, v]) => ({ name, u: acro.column(u), v: acro.column(v) }));
  const place = (index) => data.reach * ((2 * index) / (data.points - 1) - 1);
  const part = (name, attributes) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return made;
  };
  const side = 1.3;
  const picture = part("svg", { viewBox: `${-side} ${-side} ${2 * side} ${2 * side}`, role: "img", class: "lens-picture" });
  const [ideal, seen, arrows] = ["ideal", "seen", "arrows"].map((name) => part("path", { class: name }));
  picture.append(part("path", { class: "frame", d: "M-1 -1h2v2h-2z" }), ideal, seen, arrows);
  const told = acro.element("p", { role: "status" });
  const sliders = fields.map(({ name }) => {
    const shown = acro.element("output", {}, "0");
    const range = acro.element("input", { type: "range", min: -data.most, max: data.most, step: 0.002, value: 0, "aria-label": name, oninput: () => draw() });
    return { range, shown, line: acro.element("label", {}, acro.element("b", {}, name), range, shown) };
  });
  const choose = (values) => { values.forEach((value, index) => { sliders[index].range.value = value; }); draw(); };
  const buttons = [["No distortion", fields.map(() => 0)], ...data.lenses].map(([words, values]) =>
    acro.element("button", { type: "button", onclick: () => choose(values) }, words));

  const at = (row, column, values) => {
    const index = row * data.points + column;
    return ["u", "v"].map((axis) => fields.reduce((sum, field, number) => sum + values[number] * field[axis][index], 0));
  };
  const text = (x, y) => `${x.toFixed(4)} ${(-y).toFixed(4)}`;
  const lines = (values) => {
    let path = "";
    for (let line = 0; line < data.points; line += 2)
      for (const across of [false, true])
        for (let step = 0; step < data.points; step++) {
          const [row, column] = across ? [step, line] : [line, step];
          const [du, dv] = at(row, column, values);
          path += (step ? "L" : "M") + text(place(column) + du, place(row) + dv);
        }
    return path;
  };
  const arrow = (u, v, du, dv) => {
    const length = Math.hypot(du, dv);
    if (length < 1e-4) return "";
    const barb = Math.min(0.4 * length, 0.03) / length;
    const [x, y] = [u + du, v + dv];
    const end = (turn) => text(x - barb * (Math.cos(turn) * du - Math.sin(turn) * dv), y - barb * (Math.sin(turn) * du + Math.cos(turn) * dv));
    return `M${text(u, v)}L${text(x, y)}L${end(0.5)}M${text(x, y)}L${end(-0.5)}`;
  };
  const draw = () => {
    const values = sliders.map(({ range }) => Number(range.value));
    sliders.forEach(({ shown }, index) => { shown.textContent = values[index].toFixed(3); });
    let [path, most] = ["", 0];
    for (let row = 0; row < data.points; row++)
      for (let column = 0; column < data.points; column++) {
        const [du, dv] = at(row, column, values);
        most = Math.max(most, Math.hypot(du, dv));
        if (row % 2 === 0 && column % 2 === 0) path += arrow(place(column), place(row), du, dv);
      }
    seen.setAttribute("d", lines(values));
    arrows.setAttribute("d", path);
    told.textContent = `Largest displacement: ${most.toFixed(4)} image units, ${(most * data.pixels).toFixed(1)} pixels.`;
    picture.setAttribute("aria-label", `A square grid behind a lens with ${fields.map(({ name }, index) => `${name} = ${values[index]}`).join(", ")}. ${told.textContent}`);
  };
  ideal.setAttribute("d", lines(fields.map(() => 0)));
  host.append(acro.element("div", { class: "lens-choice" }, ...sliders.map(({ line }) => line), acro.element("div", { class: "lens-buttons" }, ...buttons), told), picture);
  // Something to see at once.
  choose(data.lenses[0][1]);
};

acro.lens(document.getElementById("lens"));
