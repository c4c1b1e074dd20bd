"use strict";
// Drawing on canvases: axes, lobes, chatter frequencies, motion.
const BLUE = "#0072b2", RED = "#d55e00", GREEN = "#009e73", GREY = "#5d6b7a", INK = "#1d2733";
const STABLE = "#e8f3ee", UNSTABLE = "#f6e3d8", GRID = "#dde3e9";
const MARGIN = { left: 66, right: 28, top: 12, bottom: 44 };

function niceStep(span, most) {
  const rough = span / most, power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 2.5, 5, 10].map(k => k * power).find(step => step >= rough * 0.999);
}

function ticks(low, high, most) {
  const step = niceStep(high - low, most), found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return found;
}

function tickText(value, step) {
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return value.toFixed(Math.min(digits + (step / 10 ** -digits % 1 > 0.01 ? 1 : 0), 6));
}

// A plot with linear axes; x and y turn values into pixels.
class Plot {
  constructor(canvas, xs, ys, xLabel, yLabel) {
    const ratio = window.devicePixelRatio || 1;
    this.width = canvas.clientWidth; this.height = canvas.clientHeight;
    canvas.width = Math.round(this.width * ratio); canvas.height = Math.round(this.height * ratio);
    this.pen = canvas.getContext("2d");
    this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.xs = xs; this.ys = ys; this.xLabel = xLabel; this.yLabel = yLabel;
    this.right = this.width - MARGIN.right; this.bottom = this.height - MARGIN.bottom;
  }
  x(value) { return MARGIN.left + (value - this.xs[0]) / (this.xs[1] - this.xs[0]) * (this.right - MARGIN.left); }
  y(value) { return this.bottom - (value - this.ys[0]) / (this.ys[1] - this.ys[0]) * (this.bottom - MARGIN.top); }
  valueX(pixel) { return this.xs[0] + (pixel - MARGIN.left) / (this.right - MARGIN.left) * (this.xs[1] - this.xs[0]); }
  valueY(pixel) { return this.ys[0] + (this.bottom - pixel) / (this.bottom - MARGIN.top) * (this.ys[1] - this.ys[0]); }
  holds(px, py) { return px >= MARGIN.left && px <= this.right && py >= MARGIN.top && py <= this.bottom; }
  ground(colour) {
    this.pen.fillStyle = colour;
    this.pen.fillRect(MARGIN.left, MARGIN.top, this.right - MARGIN.left, this.bottom - MARGIN.top);
  }
  inside(draw) {
    this.pen.save();
    this.pen.beginPath();
    this.pen.rect(MARGIN.left, MARGIN.top, this.right - MARGIN.left, this.bottom - MARGIN.top);
    this.pen.clip();
    draw(this.pen);
    this.pen.restore();
  }
  axes() {
    const pen = this.pen;
    const across = ticks(...this.xs, Math.max(3, (this.right - MARGIN.left) / 90));
    const up = ticks(...this.ys, Math.max(2, (this.bottom - MARGIN.top) / 42));
    pen.lineWidth = 1; pen.strokeStyle = GRID; pen.fillStyle = GREY; pen.font = "12px system-ui, sans-serif";
    pen.globalAlpha = 0.75;
    for (const value of across) this.line(this.x(value), MARGIN.top, this.x(value), this.bottom);
    for (const value of up) this.line(MARGIN.left, this.y(value), this.right, this.y(value));
    pen.globalAlpha = 1;
    pen.textAlign = "center"; pen.textBaseline = "top";
    for (const value of across) pen.fillText(tickText(value, across[1] - across[0] || 1), this.x(value), this.bottom + 6);
    pen.textAlign = "right"; pen.textBaseline = "middle";
    for (const value of up) pen.fillText(tickText(value, up[1] - up[0] || 1), MARGIN.left - 7, this.y(value));
    pen.strokeStyle = GREY;
    this.line(MARGIN.left, MARGIN.top, MARGIN.left, this.bottom);
    this.line(MARGIN.left, this.bottom, this.right, this.bottom);
    pen.fillStyle = INK; pen.font = "13px system-ui, sans-serif"; pen.textAlign = "center";
    pen.textBaseline = "bottom";
    pen.fillText(this.xLabel, (MARGIN.left + this.right) / 2, this.height - 5);
    pen.save();
    pen.translate(15, (MARGIN.top + this.bottom) / 2); pen.rotate(-Math.PI / 2);
    pen.textBaseline = "middle";
    pen.fillText(this.yLabel, 0, 0);
    pen.restore();
  }
  line(x1, y1, x2, y2) {
    this.pen.beginPath(); this.pen.moveTo(x1, y1); this.pen.lineTo(x2, y2); this.pen.stroke();
  }
  disc(x, y, radius, fill, stroke) {
    const pen = this.pen;
    pen.beginPath(); pen.arc(x, y, radius, 0, 2 * Math.PI);
    if (fill) { pen.fillStyle = fill; pen.fill(); }
    if (stroke) { pen.strokeStyle = stroke; pen.lineWidth = 2; pen.stroke(); }
  }
}

// Unstable intervals of depth at a speed: pairs of crossings, the last open above.
function intervals(crossings, top) {
  const found = [];
  for (let k = 0; k < crossings.length; k += 2) found.push([crossings[k], k + 1 < crossings.length ? crossings[k + 1] : top]);
  return found;
}

function drawLobes(canvas, answer, simulated) {
  const speeds = answer.spindle_speed_rpm, top = answer.max_axial_depth_mm;
  const plot = new Plot(canvas, [speeds[0], speeds[speeds.length - 1]], [0, top], "spindle speed [rpm]", "axial depth [mm]");
  plot.ground(STABLE);
  const above = top * 1.1;
  plot.inside(pen => {
    pen.fillStyle = UNSTABLE;
    for (let i = 0; i + 1 < speeds.length; i++) fillBetween(plot, answer, i, above);
  });
  plot.axes();
  plot.inside(pen => {
    pen.lineWidth = 1.8; pen.lineCap = "round";
    for (let i = 0; i + 1 < speeds.length; i++) edgesBetween(plot, answer, i);
    const at = answer.operating;
    plot.disc(plot.x(at.spindle_speed_rpm), plot.y(at.axial_depth_mm), 6, at.stable ? GREEN : RED, "#fff");
    if (simulated) plot.disc(plot.x(simulated.spindle_speed_rpm), plot.y(simulated.axial_depth_mm), 7, null, simulated.colour || INK);
  });
  return plot;
}

function fillBetween(plot, answer, i, above) {
  const pen = plot.pen, speeds = answer.spindle_speed_rpm;
  const a = answer.crossings_mm[i], b = answer.crossings_mm[i + 1];
  const x0 = plot.x(speeds[i]), x1 = plot.x(speeds[i + 1]), middle = (x0 + x1) / 2;
  if (a.length === b.length) {
    const right = intervals(b, above);
    intervals(a, above).forEach(([low, high], k) => {
      pen.beginPath();
      pen.moveTo(x0, plot.y(low)); pen.lineTo(x1 + 0.6, plot.y(right[k][0]));
      pen.lineTo(x1 + 0.6, plot.y(right[k][1])); pen.lineTo(x0, plot.y(high)); pen.fill();
    });
    return;
  }
  // intervals begin, end or join between the two speeds: nobody knows where
  for (const [crossings, from, to] of [[a, x0, middle], [b, middle, x1]])
    for (const [low, high] of intervals(crossings, above))
      pen.fillRect(from, plot.y(high), to - from + 0.6, plot.y(low) - plot.y(high));
}

function edgesBetween(plot, answer, i) {
  const a = answer.crossings_mm[i], b = answer.crossings_mm[i + 1], speeds = answer.spindle_speed_rpm;
  if (a.length !== b.length && Math.min(a.length, b.length) === 0) {
    // the edge of a lobe, or the end of one at the top of the diagram, somewhere between the two
    const [deep, x] = a.length ? [a[0], plot.x(speeds[i])] : [b[0], plot.x(speeds[i + 1])];
    const middle = (plot.x(speeds[i]) + plot.x(speeds[i + 1])) / 2;
    plot.pen.strokeStyle = answer.bifurcation[a.length ? i : i + 1] === "flip" ? RED : BLUE;
    plot.line(x, plot.y(deep), middle, plot.y(deep));
    plot.line(middle, plot.y(deep), middle, plot.y(answer.max_axial_depth_mm));
    return;
  }
  const same = a.length === b.length ? a.length : 1;
  for (let k = 0; k < same; k++) {
    const flip = k === 0 && answer.bifurcation[i] === "flip" && answer.bifurcation[i + 1] === "flip";
    plot.pen.strokeStyle = flip ? RED : BLUE;
    plot.line(plot.x(speeds[i]), plot.y(a[k]), plot.x(speeds[i + 1]), plot.y(b[k]));
  }
}

function drawFrequency(canvas, answer) {
  const speeds = answer.spindle_speed_rpm, frequencies = answer.chatter_frequency_Hz;
  const known = frequencies.filter(value => value !== null);
  let low = known.length ? Math.min(...known) : 0, high = known.length ? Math.max(...known) : 1;
  const room = Math.max(0.12 * (high - low), 0.02 * high);
  low = Math.max(0, low - room); high += room;
  const plot = new Plot(canvas, [speeds[0], speeds[speeds.length - 1]], [low, high], "spindle speed [rpm]", "frequency [Hz]");
  plot.axes();
  plot.inside(pen => {
    pen.setLineDash([2, 3]); pen.strokeStyle = GREY; pen.lineWidth = 1;
    for (const natural of answer.natural_frequencies_Hz) plot.line(MARGIN.left, plot.y(natural), plot.right, plot.y(natural));
    pen.setLineDash([]);
    frequencies.forEach((value, i) => {
      if (value !== null) plot.disc(plot.x(speeds[i]), plot.y(value), 2, answer.bifurcation[i] === "flip" ? RED : BLUE);
    });
  });
  return plot;
}

function drawMotion(canvas, answer) {
  const revolutions = answer.revolutions, last = revolutions.length - 1;
  const high = Math.max(...answer.highest_um), low = Math.min(...answer.lowest_um), room = 0.06 * (high - low) || 1;
  const plot = new Plot(canvas, [0, revolutions[last]], [low - room, high + room], "revolutions of the spindle", `displacement ${answer.direction} [µm]`);
  plot.axes();
  plot.inside(pen => {
    pen.fillStyle = "#9cc4de";
    pen.beginPath();
    pen.moveTo(plot.x(revolutions[0]), plot.y(answer.highest_um[0]));
    for (let i = 1; i <= last; i++) pen.lineTo(plot.x(revolutions[i]), plot.y(answer.highest_um[i]));
    for (let i = last; i >= 0; i--) pen.lineTo(plot.x(revolutions[i]), plot.y(answer.lowest_um[i]));
    pen.closePath(); pen.fill(); pen.strokeStyle = BLUE; pen.lineWidth = 0.6; pen.stroke();
    answer.once_per_revolution.revolutions.forEach((at, i) => plot.disc(plot.x(at), plot.y(answer.once_per_revolution.um[i]), 1.9, RED));
  });
}
