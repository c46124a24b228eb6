"use strict";
// Tables that sort, values under the pointer, and a depth slider. The page is whole without this script.

const PREFIXES = { p: 1e-12, n: 1e-9, "µ": 1e-6, m: 1e-3, k: 1e3, M: 1e6, G: 1e9, T: 1e12 };
const POWERS = { "²": 2, "³": 3, "^2": 2, "^3": 3 };

/** The number at the start of a text, in the unit without its prefix; null if there is none. */
function numberIn(text) {
  const found = /^([-−+]?[\d.]+(?:e[-+]?\d+)?)\s*(.*)$/.exec(text.trim());
  if (!found) return /^(infinite|∞)/.test(text.trim()) ? Infinity : null;
  const unit = /^(?:± \S+ )?(p|n|µ|m|k|M|G|T)?(?:Pa|m|N|J|W|Ω|S|s)(?![a-z])(²|³|\^2|\^3)?/.exec(found[2]);
  return Number(found[1].replace("−", "-")) * (PREFIXES[unit?.[1]] || 1) ** (POWERS[unit?.[2]] || 1);
}

function compare(first, second) {
  const [a, b] = [numberIn(first), numberIn(second)];
  if (a !== null && b !== null) return a - b;
  return (a === null) - (b === null) || first.localeCompare(second);
}

/** Buttons in the headings of a table; a second press reverses the order. */
function makeSortable(table) {
  const [head, ...rows] = table.rows;
  if (rows.length < 2 || [...head.cells].some((cell) => cell.tagName !== "TH")) return;
  [...head.cells].forEach((cell, column) => {
    if (!cell.textContent.trim()) return;
    const button = document.createElement("button");
    button.type = "button";
    button.append(...cell.childNodes);
    cell.append(button);
    button.addEventListener("click", () => {
      const rising = cell.getAttribute("aria-sort") !== "ascending";
      for (const each of head.cells) each.removeAttribute("aria-sort");
      cell.setAttribute("aria-sort", rising ? "ascending" : "descending");
      const text = (row) => row.cells[column]?.textContent.trim() ?? "";
      const filled = rows.filter(text);
      filled.sort((a, b) => (rising ? 1 : -1) * compare(text(a), text(b)));
      head.parentNode.append(...filled, ...rows.filter((row) => !text(row)));
    });
  });
}

/** Values of a panel from its packed text; missing ones are NaN. */
async function unpacked(panel) {
  const bytes = Uint8Array.from(atob(panel.data), (sign) => sign.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const raw = new Uint8Array(await new Response(stream).arrayBuffer());
  const values = new Float32Array(raw.length / 2);
  for (let i = 0; i < values.length; i++) {
    const steps = raw[i] + 256 * raw[i + values.length];
    values[i] = steps === 65535 ? NaN : panel.low + panel.step * steps;
  }
  return values;
}

/** A quantity with its value, where `label` is such as "depth (µm)" or "$\sigma_{xx}$ (MPa)". */
function inWords(label, value) {
  const [, name, unit] = /^(.*?)(?: \(([^()]*)\))?$/.exec(label.replace(/[${}\\]/g, "").replace("sigma", "σ"));
  const shown = Number.isNaN(value) ? "none" : Number(value.toPrecision(3));
  return `${name} ${shown}${unit && shown !== "none" ? ` ${unit}` : ""}`;
}

/** The text for a place (u, v) of a panel or of its points, both from 0 to 1; null outside. */
function textAt(panel, u, v) {
  const [x, y, label] = panel.labels;
  if (panel.points) {
    const away = ([a, b]) => Math.hypot(a - u, b - v);
    const near = panel.points.reduce((best, each) => (away(each) < away(best) ? each : best));
    return away(near) < 0.03 ? `${inWords(x, near[2])}, ${inWords(y, near[3])}` : null;
  }
  const [left, top, right, bottom] = panel.box;
  const [a, b] = [(u - left) / (right - left), (v - top) / (bottom - top)];
  if (!(a >= 0 && a < 1 && b >= 0 && b < 1) || !panel.values) return null;
  const value = panel.values[Math.floor(b * panel.shape[0]) * panel.shape[1] + Math.floor(a * panel.shape[1])];
  const at = [panel.x[0] + a * (panel.x[1] - panel.x[0]), panel.y[0] + b * (panel.y[1] - panel.y[0])];
  return `${inWords(label, value)} at ${inWords(x, at[0])}, ${inWords(y, at[1])}`;
}

const read = document.createElement("div");
read.className = "read";
read.hidden = true;

/** Show the value under the pointer, over an element whose panels `panelsOf` gives. */
function makeReadable(element, panelsOf) {
  element.addEventListener("pointermove", async (event) => {
    const panels = await panelsOf();
    const edge = element.getBoundingClientRect();
    const [u, v] = [(event.clientX - edge.left) / edge.width, (event.clientY - edge.top) / edge.height];
    const text = panels.map((panel) => textAt(panel, u, v)).find((each) => each);
    read.hidden = !text;
    read.textContent = text ?? "";
    read.style.left = `${Math.max(0, Math.min(event.clientX + 12, innerWidth - read.offsetWidth - 4))}px`;
    read.style.top = `${Math.max(0, event.clientY - read.offsetHeight - 10)}px`;
  });
  element.addEventListener("pointerleave", () => (read.hidden = true));
}

/** The panels of a picture, unpacked when they are first asked for. */
function panelsIn(script) {
  let found = null;
  return () => (found ??= (async () => {
    const panels = JSON.parse(script.textContent);
    for (const panel of panels) if (panel.data) panel.values = await unpacked(panel);
    return panels;
  })());
}

async function makeSlider(figure, script) {
  const found = JSON.parse(script.textContent);
  const [canvas, input, output] = ["canvas", "input", "output"].map((name) => figure.querySelector(name));
  for (const plane of found.planes) plane.values = await unpacked(plane);
  const colours = found.colours.map((text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16)));
  const [low, high] = found.ends;
  const [first, last] = figure.querySelectorAll(".scale span");
  const unit = /\(([^()]*)\)$/.exec(found.labels[2])?.[1] ?? "";
  [first.textContent, last.textContent] = [low, high].map((end) => `${Number(end.toPrecision(3))} ${unit}`);
  figure.querySelector(".scale i").style.background = `linear-gradient(90deg, ${found.colours})`;
  const draw = () => {
    const plane = found.planes[input.value];
    const [rows, columns] = plane.shape;
    const image = new ImageData(columns, rows);
    plane.values.forEach((value, node) => {
      const place = Math.min(1, Math.max(0, (value - low) / (high - low || 1))) * (colours.length - 1);
      const below = Math.min(Math.floor(place), colours.length - 2);
      const mixed = colours[below].map((tone, i) => tone + (place - below) * (colours[below + 1][i] - tone));
      image.data.set([...mixed, 255], 4 * node);
    });
    [canvas.width, canvas.height] = [columns, rows];
    canvas.getContext("2d").putImageData(image, 0, 0);
    output.textContent = input.ariaValueText = found.depths[input.value];
    canvas.ariaLabel = `${found.name} at depth ${found.depths[input.value]}`;
  };
  canvas.style.aspectRatio = Math.abs((found.x[1] - found.x[0]) / (found.y[1] - found.y[0]));
  const whole = { box: [0, 0, 1, 1], labels: found.labels, x: found.x, y: found.y };
  makeReadable(canvas, () => [{ ...whole, ...found.planes[input.value] }]);
  input.addEventListener("input", draw);
  draw();
  figure.hidden = false;
}

document.body.append(read);
document.querySelectorAll("table").forEach(makeSortable);
if (globalThis.DecompressionStream) {
  for (const script of document.querySelectorAll('figure > script[type="application/json"]')) {
    const figure = script.parentNode;
    if (figure.matches(".depths")) makeSlider(figure, script);
    else makeReadable(figure.querySelector("img"), panelsIn(script));
  }
}
