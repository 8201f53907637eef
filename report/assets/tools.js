// Small tools of the scripts of a page: elements, numbers as text, colours, downloads.
"use strict";

// An element with attributes and children.
acro.element = function (tag, attributes, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (typeof value === "function") made[name] = value; else if (value !== false && value != null) made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
};

// The shortest text that reads back as the same double; a dash where there is none.
acro.text = (value) => (value == null ? "–" : String(value));

// The same to seven digits, for eyes.
acro.rounded = (value) => (typeof value === "number" && Number.isFinite(value) ? String(Number(value.toPrecision(7))) : acro.text(value));

// A label that fits on an axis.
acro.fits = (label, most) => (label.length > most ? label.slice(0, most - 1) + "…" : label);

// Labels of an axis with as many decimals as its steps ask for.
acro.ticks = function (values, step) {
  const largest = Math.max(...values.map(Math.abs));
  if (largest >= 1e6 || (step < 1e-5 && step > 0)) return values.map((value) => (value === 0 ? "0" : value.toExponential(1)));
  let decimals = 0;
  while (decimals < 6 && Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6 * step * 10 ** decimals) decimals++;
  return values.map((value) => (value === 0 ? "0" : value.toFixed(decimals)));
};

// A colour of the page's style.
acro.colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

// Calls back when colours change: by the reader's choice of light or dark, and around printing, which is always light.
acro.onColours = function (call) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", call);
  const paper = (on) => () => { document.documentElement.classList.toggle("on-paper", on); call(); };
  addEventListener("beforeprint", paper(true));
  addEventListener("afterprint", paper(false));
};

// Offers text as a file.
acro.download = function (text, name, type) {
  const address = URL.createObjectURL(new Blob([text], { type }));
  acro.element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
};

// A title as a file's name.
acro.fileName = (title) => title.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "") || "graph";
