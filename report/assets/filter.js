// Tables that a reader can narrow: a field for words, and a button for each mark of the rows.
"use strict";

acro.filter = function (host) {
  const rows = [...host.querySelectorAll("tbody tr")].map((row) => ({ row, marks: row.dataset.marks.split("\u001f"), text: row.textContent.toLowerCase() }));
  const what = host.dataset.what;
  const chosen = new Set();
  const field = acro.element("input", { type: "search", "aria-label": `Find in ${what}`, placeholder: "find words" });
  const count = acro.element("span", { role: "status" });
  const groups = (rows[0] ? rows[0].marks : []).map((_, kind) => {
    const names = [...new Set(rows.map((row) => row.marks[kind]))];
    const buttons = names.map((name) => {
      const many = rows.filter((row) => row.marks[kind] === name).length;
      const key = kind + name;
      return acro.element("button", { type: "button", "aria-pressed": "false", onclick: (event) => {
        if (!chosen.delete(key)) chosen.add(key);
        event.currentTarget.setAttribute("aria-pressed", String(chosen.has(key)));
        show();
      } }, `${name} (${many})`);
    });
    return names.length > 1 ? acro.element("span", { class: "marks" }, ...buttons) : "";
  });
  // Of each kind of mark those that are chosen, or all if none is.
  const fits = (row) => row.marks.every((name, kind) => chosen.has(kind + name) || ![...chosen].some((key) => key[0] === String(kind)));
  const show = () => {
    const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const row of rows) {
      const is = fits(row) && words.every((word) => row.text.includes(word));
      row.row.hidden = !is;
      shown += is;
    }
    count.textContent = shown === rows.length ? `all ${rows.length} ${what}` : `${shown} of ${rows.length} ${what}`;
  };
  field.addEventListener("input", show);
  // An address that names a row shows it, whatever is chosen.
  const named = () => {
    const row = rows.find(({ row }) => row.id && row.id === decodeURIComponent(location.hash.slice(1)));
    if (!row || !row.row.hidden) return;
    row.row.hidden = false;
    row.row.scrollIntoView();
  };
  addEventListener("hashchange", named);
  host.prepend(acro.element("div", { class: "narrow" }, field, ...groups, count));
  show();
};

document.querySelectorAll(".filtered").forEach(acro.filter);
