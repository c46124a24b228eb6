// Sends what is typed to the server, and shows what it sends back. All texts from files come escaped.
"use strict";
const root = location.pathname;
const limit = Number(document.currentScript.dataset.limit);
const byId = (id) => document.getElementById(id);
const inputs = () => document.querySelectorAll("[data-key]");
const values = {};
let socket, waiting = {}, timer, wasOpen = false, isAwaited = false;

function connect() {
  socket = new WebSocket(`${location.protocol.replace("http", "ws")}//${location.host}${root}events`);
  socket.onopen = () => { if (wasOpen) location.reload(); wasOpen = true; };
  socket.onmessage = (event) => show(JSON.parse(event.data));
  socket.onclose = () => {
    notice("The connection to asperity app is closed. Start it again; what you typed stays here.");
    setTimeout(connect, 1000);
  };
}

function send(message) { if (socket.readyState === 1) socket.send(JSON.stringify(message)); }
function act(name, value = "") { flush(); send({ do: name, value }); }
function flush() {
  clearTimeout(timer);
  if (Object.keys(waiting).length) send({ set: waiting });
  waiting = {};
}
function notice(text) { const line = document.createElement("p"); line.textContent = text; byId("notice").replaceChildren(line); }

function change(key, value, wait) {
  values[key] = waiting[key] = value;
  arrange();
  clearTimeout(timer);
  timer = setTimeout(flush, wait);
}

// Shows only the fields that the choices and check boxes of the page need.
function arrange() {
  for (const part of document.querySelectorAll("[data-when]")) {
    const [key, wanted] = part.dataset.when.split("=");
    part.hidden = !wanted.split(",").includes(values[key] || "");
  }
  const load = values["choose.load"] || "mean_pressure";
  const hertz = ["hertz_pressure", "force", "mean_pressure", "radius_x", "radius_y", "at"];
  for (const part of document.querySelectorAll("[data-load]")) {
    part.hidden = !(load === "hertz" ? hertz : [load]).includes(part.dataset.load);
  }
}

function fill(key, value) {
  values[key] = value;
  for (const input of document.querySelectorAll(`[data-key="${CSS.escape(key)}"]`)) {
    if (input.type === "checkbox") input.checked = value === "yes";
    else if (input.type === "radio") input.checked = value === input.value || (!value && input.defaultChecked);
    else if (input !== document.activeElement || !waiting[key]) input.value = value;
    if (input.tagName === "TEXTAREA") input.rows = Math.max(1, value.split("\n").length);
  }
}

function show(found) {
  for (const [key, value] of Object.entries(found.values || {})) fill(key, value);
  if (found.values) arrange();
  for (const [id, text] of Object.entries(found.html || {})) {
    const focus = document.activeElement, part = byId(id);
    const name = part.contains(focus) && focus.dataset.do, value = focus && focus.value;
    const open = [...part.querySelectorAll("details")].map((each) => each.open);
    part.innerHTML = text;
    part.querySelectorAll("details").forEach((each, number) => { if (number in open) each.open = open[number]; });
    if (name) [...part.querySelectorAll(`[data-do="${name}"]`)].find((each) => each.type !== "radio" || each.value === value)?.focus();
  }
  if (found.problems) {
    for (const input of inputs()) {
      const text = found.problems[input.dataset.key], line = byId(`wrong-${input.dataset.key}`);
      if (line && line.textContent !== (text || "")) line.textContent = text || "";
      if (line) input.setAttribute("aria-invalid", text ? "true" : "false");
      if (text && line && line.closest("details")) line.closest("details").open = true;
    }
    for (const line of document.querySelectorAll(".doubt")) {
      const key = line.id.replace("doubt-", "");
      const [, sentence, proposed] = found.doubts.find(([option]) => option === key) || [];
      line.textContent = sentence || "";
      if (proposed) {
        const button = document.createElement("button");
        button.type = "button";
        button.textContent = `Set to ${proposed}`;
        button.onclick = () => { byId(key).focus(); fill(key, proposed); change(key, proposed, 0); };
        line.append(button);
      }
      if (sentence && line.closest("details")) line.closest("details").open = true;
    }
    for (const input of document.querySelectorAll("input[data-key]")) {
      input.dataset.proposed ??= input.placeholder;
      input.placeholder = found.constants[input.dataset.key] ? `${found.constants[input.dataset.key]}, of the table` : input.dataset.proposed;
    }
    for (const line of document.querySelectorAll("[data-state]")) line.textContent = found.constants[line.dataset.state] || "";
    document.body.classList.toggle("has-map", found.has_map);
    document.body.dataset.ready = found.ready;
    byId("several").hidden = !found.several;
    enable();
  }
  if (found.progress) {
    const { running, done, passed, stage } = found.progress;
    const left = passed * (1 / done - 1);
    const words = done > 0.02 ? `${(100 * done).toFixed(0)} %, about ${left < 90 ? `${left.toFixed(0)} s` : `${(left / 60).toFixed(0)} min`} left` : "starting";
    const text = running ? `${stage ? `${stage}: ` : ""}${words}` : found.progress.text;
    byId("stop").hidden = byId("progress").hidden = !running;
    byId("progress").value = done || 0;
    byId("progress-text").textContent = text || "";
    const ended = document.body.dataset.running === "true" && !running;
    document.body.dataset.running = running;
    enable();
    if (ended && isAwaited && !text) {
      byId("answer").focus();
      byId("answer").scrollIntoView();
    }
    isAwaited &&= !ended;
  }
  if (found.plane) {
    document.body.classList.toggle("has-answer", "last" in found.plane);
    if ("last" in found.plane) {
      const slider = byId("depth");
      slider.max = found.plane.last;
      if (document.activeElement !== slider || !slider.dataset.moving) slider.value = found.plane.at;
      byId("depth-text").textContent = found.plane.text;
      slider.setAttribute("aria-valuetext", found.plane.text);
    }
  }
  if ("beside" in found) document.body.classList.toggle("has-beside", found.beside);
}
function enable() {  // while it computes the button keeps the focus
  byId("start").disabled = document.body.dataset.ready !== "true";
  byId("start").setAttribute("aria-disabled", document.body.dataset.running === "true");
}

document.addEventListener("input", (event) => {
  const input = event.target, key = input.dataset.key;
  if (input.tagName === "TEXTAREA") input.rows = input.value.split("\n").length;
  if (input.id === "depth") {
    input.dataset.moving = "yes";
    act("depth", input.value);
  } else if (key && input.type === "checkbox") change(key, input.checked ? "yes" : "", 0);
  else if (key) change(key, input.value, ["radio", "select-one"].includes(input.type) ? 0 : 300);
});
document.addEventListener("change", (event) => {
  const input = event.target;
  if (input.id === "depth") delete input.dataset.moving;
  else if (input.dataset.upload) upload(input.files, input.dataset.upload);
  else if (input.dataset.do && input.tagName !== "BUTTON") act(input.dataset.do, input.dataset.line ? `${input.dataset.line}=${input.value}` : input.value);
});
document.addEventListener("click", (event) => {
  const button = event.target.closest("button");
  if (!button) return;
  if (button.dataset.do) act(button.dataset.do, button.value);
  if (button.id === "start") isAwaited = true;
  if (button.dataset.copy) copy(byId(button.dataset.copy), button);
  if (button.id === "open") byId("path-dialog").showModal();
});
byId("path-dialog").addEventListener("close", () => { if (byId("path-dialog").returnValue === "open") act("open", byId("path").value); });

function copy(part, button) {
  const chosen = document.createRange();
  chosen.selectNodeContents(part);
  getSelection().removeAllRanges();
  getSelection().addRange(chosen);
  (navigator.clipboard ? navigator.clipboard.writeText(part.textContent) : Promise.reject()).catch(() => document.execCommand("copy"));
  button.textContent = "Copied";
}

async function upload(files, key = "map.file") {
  const paths = [];
  for (const file of files) {
    const reply = file.size > limit ? null : await fetch(`${root}upload?name=${encodeURIComponent(file.name)}`, { method: "PUT", body: file }).catch(() => null);
    if (!reply || !reply.ok) {
      notice(`${file.name}: not taken; at most ${(limit / 2 ** 20).toFixed(0)} MB can be dropped. Type the path of the file instead.`);
      return;
    }
    paths.push(await reply.text());
  }
  byId("notice").replaceChildren();
  if (paths.length) { fill(key, paths.join("\n")); change(key, paths.join("\n"), 0); }
}
const drop = byId("drop");
document.addEventListener("dragover", (event) => { event.preventDefault(); drop.classList.add("over"); });
document.addEventListener("dragleave", () => drop.classList.remove("over"));
document.addEventListener("drop", (event) => { event.preventDefault(); drop.classList.remove("over"); upload(event.dataTransfer.files); });

// Pictures take the colours of the page.
function colour() {
  const style = getComputedStyle(document.documentElement);
  const [ink, soft] = ["--ink", "--soft"].map((name) => style.getPropertyValue(name).trim());
  for (const picture of Bokeh.documents.flatMap((each) => each.roots())) {
    picture.title.text_color = ink;
    for (const axis of [...picture.below, ...picture.left]) {
      Object.assign(axis, { axis_label_text_color: ink, major_label_text_color: ink, axis_line_color: soft, major_tick_line_color: soft, minor_tick_line_color: soft });
    }
    for (const bar of picture.right) Object.assign(bar, { title_text_color: ink, major_label_text_color: ink });
  }
}
function whenDrawn() { if (window.Bokeh && Bokeh.documents.length) colour(); else setTimeout(whenDrawn, 100); }
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", colour);
arrange();
connect();
whenDrawn();
