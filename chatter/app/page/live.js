"use strict";
// Sliders, requests and what is hovered and clicked; drawing is in draw.js.
const el = id => document.getElementById(id);
const page = Math.random().toString(36).slice(2, 12);
const STEPS = 1000;
let sliders = [], values = {}, diagram = null, plot = null, simulated = null;

async function ask(path, body, signal) {
  const answer = await fetch(path, {
    method: "POST", headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ page, values: moved(), ...body }), signal,
  });
  if (answer.ok) return answer;
  const refusal = await answer.json();
  const error = new Error(refusal.errors.join("\n"));
  error.superseded = answer.status === 409;
  throw error;
}

function moved() {
  return Object.fromEntries(sliders.filter(p => values[p.path] !== p.value).map(p => [p.path, values[p.path]]));
}

function showErrors(text) { el("errors").hidden = !text; el("errors").textContent = text || ""; }

// --- sliders -------------------------------------------------------------------------------
function position(p, value) {
  const part = p.logarithmic ? Math.log(value / p.low) / Math.log(p.high / p.low) : (value - p.low) / (p.high - p.low);
  return Math.round(part * STEPS);
}

function valueAt(p, place) {
  const part = place / STEPS;
  const value = p.logarithmic ? p.low * (p.high / p.low) ** part : p.low + part * (p.high - p.low);
  return p.whole ? Math.round(value) : Number(value.toPrecision(4));
}

function clamp(p, value) { return Math.min(p.high, Math.max(p.low, p.whole ? Math.round(value) : value)); }

function makeSliders() {
  const box = el("sliders");
  let group = null;
  for (const p of sliders) {
    if (p.group !== group) {
      group = p.group;
      box.append(Object.assign(document.createElement("h2"), { textContent: group }));
    }
    const row = Object.assign(document.createElement("div"), { className: "slider", title: p.path });
    const id = "value-" + p.path.replace(/\W/g, "-");
    const label = Object.assign(document.createElement("label"), { textContent: p.label, htmlFor: id });
    const number = Object.assign(document.createElement("input"), { type: "number", id, step: "any", min: p.low, max: p.high });
    const unit = Object.assign(document.createElement("span"), { className: "unit", textContent: p.unit.replace("um", "µm").replace("^3", "³") });
    const range = Object.assign(document.createElement("input"), { type: "range", min: 0, max: STEPS, step: 1 });
    if (p.whole) Object.assign(range, { min: p.low, max: p.high });
    range.setAttribute("aria-label", `${p.group}: ${p.label}`);
    range.dataset.path = p.path;
    p.show = () => {
      number.value = Number(values[p.path].toPrecision(5));
      range.value = p.whole ? values[p.path] : position(p, values[p.path]);
      row.classList.toggle("moved", values[p.path] !== p.value);
    };
    range.addEventListener("input", () => set(p, p.whole ? Number(range.value) : valueAt(p, Number(range.value))));
    range.addEventListener("dblclick", () => set(p, p.value));
    number.addEventListener("change", () => {
      const given = Number(number.value);
      set(p, number.value !== "" && Number.isFinite(given) ? clamp(p, given) : values[p.path]);
    });
    row.append(label, number, unit, range);
    box.append(row);
    p.show();
  }
}

function set(p, value) {
  values[p.path] = clamp(p, value);
  p.show();
  changed();
}

// --- the diagram: a coarse answer at once, a fine one when nothing moves -------------------
let busy = null, waiting = false;

function changed() {
  if (!sliders.length) return;
  if (simulated) { simulated.colour = "#9aa5b1"; el("simulation").style.opacity = 0.5; }
  // a coarse answer is nearly there; a fine one is given up
  if (busy && busy.stage === "coarse") { waiting = true; return; }
  if (busy) busy.stop.abort();
  compute("coarse");
}

async function compute(stage) {
  const mine = busy = { stage, stop: new AbortController() };
  waiting = false;
  const started = performance.now();
  let failed = false;
  try {
    const answer = await (await ask("diagram", { stage }, mine.stop.signal)).json();
    if (busy !== mine) return;
    diagram = answer;
    showErrors("");
    redraw();
    el("status").textContent = `${stage}: ${Math.round(performance.now() - started)} ms`;
    document.body.dataset.stage = stage;
    document.body.dataset.milliseconds = Math.round(performance.now() - started);
  } catch (error) {
    if (busy !== mine || error.name === "AbortError") return;
    failed = true;
    if (!error.superseded) showErrors(error instanceof TypeError ? "The program that serves this page has ended." : error.message);
  }
  busy = null;
  if (waiting) compute("coarse");
  else if (stage === "coarse" && !failed) compute("fine");
}

function redraw() {
  if (!diagram) return;
  plot = drawLobes(el("lobes"), diagram, simulated);
  drawFrequency(el("frequency"), diagram);
  if (simulated && simulated.revolutions) drawMotion(el("motion"), simulated);
  const at = diagram.operating, low = diagram.lowest;
  const limit = at.critical_depth_mm === null ? "none found" : `${at.critical_depth_mm.toPrecision(4)} mm`;
  const removal = at.spindle_speed_rpm * at.axial_depth_mm * diagram.removal_rate_per_mm_rpm;
  el("facts").replaceChildren(
    fact(at.stable ? "stable" : "chatter", `at ${at.spindle_speed_rpm.toFixed(0)} rpm, ${at.axial_depth_mm.toPrecision(3)} mm`, at.stable ? "stable" : "chatter"),
    fact(limit, "limit depth at this speed"),
    fact(low.depth_mm === null ? "none found" : `${low.depth_mm.toPrecision(4)} mm`, low.depth_mm === null ? "lowest limit" : `lowest limit, at ${low.spindle_speed_rpm.toFixed(0)} rpm`),
    fact(`${removal.toPrecision(3)} cm³/min`, "removal rate"),
  );
  el("notes").replaceChildren(...diagram.notes.map(note => Object.assign(document.createElement("li"), { textContent: note })));
}

function fact(value, label, kind) {
  const box = Object.assign(document.createElement("div"), { className: kind || "" });
  box.append(Object.assign(document.createElement("b"), { textContent: value }), Object.assign(document.createElement("small"), { textContent: label }));
  return box;
}

// --- hover and click -----------------------------------------------------------------------
function nearest(speed) {
  const speeds = diagram.spindle_speed_rpm;
  const place = (speed - speeds[0]) / (speeds[speeds.length - 1] - speeds[0]) * (speeds.length - 1);
  return Math.min(speeds.length - 1, Math.max(0, Math.round(place)));
}

el("lobes").addEventListener("mousemove", event => {
  const tip = el("tip");
  tip.hidden = !plot || !plot.holds(event.offsetX, event.offsetY);
  if (tip.hidden) return;
  const speed = plot.valueX(event.offsetX), depth = plot.valueY(event.offsetY), i = nearest(speed);
  const crossings = diagram.crossings_mm[i], unstable = crossings.filter(c => c < depth).length % 2 === 1;
  // a coarse diagram knows it at every third speed
  const near = [0, -1, 1, -2, 2].map(k => diagram.chatter_frequency_Hz[i + k]);
  const frequency = crossings.length ? near.find(value => value !== null && value !== undefined) ?? null : null;
  tip.textContent = `${speed.toFixed(0)} rpm, ${depth.toPrecision(3)} mm: ${unstable ? "chatter" : "stable"}\n`
    + (crossings.length ? `limit ${crossings[0].toPrecision(4)} mm` : "no limit found")
    + (frequency === null ? "" : `\nchatter frequency ${frequency.toFixed(1)} Hz (${diagram.bifurcation[i].replace("hopf", "Hopf")})`);
  const left = event.offsetX > plot.width - 250;
  tip.style.left = left ? "" : `${event.offsetX + 14}px`;
  tip.style.right = left ? `${plot.width - event.offsetX + 14}px` : "";
  tip.style.top = `${Math.min(event.offsetY + 12, plot.height - 70)}px`;
});
el("lobes").addEventListener("mouseleave", () => { el("tip").hidden = true; });

el("lobes").addEventListener("click", async event => {
  if (!plot || !plot.holds(event.offsetX, event.offsetY)) return;
  const point = {
    spindle_speed_rpm: Number(plot.valueX(event.offsetX).toPrecision(6)),
    axial_depth_mm: Math.max(Number(plot.valueY(event.offsetY).toPrecision(5)), 1e-4),
  };
  const mine = simulated = point;
  const title = el("simulation-title"), text = el("simulation-text");
  el("simulation").hidden = false; el("simulation").style.opacity = 1;
  title.className = "";
  title.textContent = `Simulating ${point.spindle_speed_rpm.toFixed(0)} rpm, ${point.axial_depth_mm.toPrecision(3)} mm ...`;
  text.textContent = "";
  redraw();
  try {
    const answer = await (await ask("simulation", point)).json();
    if (simulated !== mine) return;
    simulated = { ...answer, colour: answer.verdict === "stable" ? GREEN : answer.verdict === "chatter" ? RED : INK };
    title.className = answer.verdict;
    const frequency = answer.chatter_frequency_Hz === null ? "" : ` at ${answer.chatter_frequency_Hz.toFixed(1)} Hz`;
    title.textContent = `Simulated: ${answer.verdict}${frequency}, at ${answer.spindle_speed_rpm.toFixed(0)} rpm and ${answer.axial_depth_mm.toPrecision(3)} mm`;
    const reason = answer.reason.charAt(0).toUpperCase() + answer.reason.slice(1);
    text.textContent = `${reason}. Peak force ${answer.peak_resultant_N.toPrecision(3)} N, mean power ${answer.mean_power_W.toPrecision(3)} W. `
      + `Band: range of the motion; dots: once per revolution. ${answer.seconds.toFixed(2)} s.`;
  } catch (error) {
    if (simulated !== mine || error.superseded) return;
    title.className = "chatter";
    title.textContent = "Not simulated";
    text.textContent = error.message;
  }
  redraw();
  el("simulation").scrollIntoView({ block: "nearest", behavior: "smooth" });
  document.body.dataset.simulated = title.textContent;
});

// --- buttons -------------------------------------------------------------------------------
el("reset").addEventListener("click", () => {
  for (const p of sliders) { values[p.path] = p.value; p.show(); }
  showErrors("");
  changed();
});

el("save").addEventListener("click", async () => {
  try {
    const text = await (await ask("case", {})).blob();
    const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(text), download: document.body.dataset.name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  } catch (error) { showErrors(error.message); }
});

window.addEventListener("resize", redraw);

async function start() {
  const answer = await (await fetch("setup")).json();
  sliders = answer.sliders;
  for (const p of sliders) values[p.path] = p.value;
  el("title").textContent = answer.title;
  document.title = `${answer.title} - chatter`;
  el("method").textContent = `stability by ${answer.method}`;
  document.body.dataset.name = answer.name;
  makeSliders();
  compute("coarse");
}
start().catch(error => showErrors(String(error.message || error)));
