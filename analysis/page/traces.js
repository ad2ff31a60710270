// Speed, acceleration, distance, TTC, decision and solver status over time, with one cursor.
const TTC_SHOWN_S = 8;
const MARGIN = { left: 8, right: 8, top: 4, axis: 18 };

function panels(data) {
  const capped = data.ttc_s.map((value) => (value === null ? null : Math.min(value, TTC_SHOWN_S)));
  return [
    { name: "speed", unit: "m/s", values: data.ego.speed_mps, low: 0, colour: "series-1" },
    { name: "acceleration", unit: "m/s²", values: data.ego.acceleration_mps2, colour: "series-3" },
    { name: "distance", unit: "m", values: data.distance_m, low: 0, colour: "series-4" },
    { name: "TTC", unit: "s", values: capped, shown: data.ttc_s, low: 0, high: TTC_SHOWN_S, colour: "series-2" },
  ];
}

function decisionText(data, i) {
  const text = (name) => textAt(data.ego[name], i);
  const [rule, manoeuvre] = [text("rule"), text("manoeuvre")];
  if (data.ego.handed_back[i]) return "handed back to SUMO";
  if (!rule && !manoeuvre) return data.ego.planned[i] ? "no rule" : "no plan";
  return [rule, manoeuvre].filter(Boolean).join(", ");
}

function solverText(data, i) {
  if (!data.ego.planned[i]) return "no plan";
  const status = textAt(data.ego.plan_status, i) || "ok";
  return data.ego.solved[i] ? status : `not solved (${status})`;
}

function textAt(column, i) {
  const code = column.codes[i];
  return code < 0 ? "" : column.texts[code];
}

function timeAt(canvas, data, clientX) {
  const box = canvas.getBoundingClientRect();
  const share = (clientX - box.left - MARGIN.left) / (box.width - MARGIN.left - MARGIN.right);
  const [first, last] = [data.time_s[0], data.time_s[data.time_s.length - 1]];
  return first + Math.min(1, Math.max(0, share)) * (last - first);
}

function drawTraces(canvas, data, index, moment) {
  const { context: c, width, height } = prepared(canvas);
  const colour = colours();
  const times = data.time_s;
  const [first, last] = [times[0], times[times.length - 1]];
  const inner = width - MARGIN.left - MARGIN.right;
  const x = (time) => MARGIN.left + (inner * (time - first)) / Math.max(last - first, 1e-9);
  const band = 34;
  const each = (height - MARGIN.top - MARGIN.axis - 2 * band) / 4;
  c.font = "12px " + colour("body");
  c.textBaseline = "alphabetic";

  panels(data).forEach((panel, i) => drawPanel(c, panel, data, index, x, MARGIN.top + i * each, each, colour, inner));
  const below = MARGIN.top + 4 * each;
  drawBand(c, "decision", data, decisionText, index, x, below, band, colour, inner);
  drawBand(c, "solver", data, solverText, index, x, below + band, band, colour, inner);

  // Axis of time, the worst moment and the cursor.
  const floor = height - MARGIN.axis;
  c.fillStyle = colour("muted");
  const spacing = niceStep((last - first) / 5);
  c.textAlign = "center";
  for (let time = Math.ceil(first / spacing) * spacing; time <= last; time += spacing) {
    const at = x(time);
    if (at > MARGIN.left + 12 && at < width - 34) c.fillText(String(Number(time.toFixed(2))), at, floor + 14);
  }
  c.textAlign = "right";
  c.fillText("t [s]", width - MARGIN.right, floor + 14);
  c.textAlign = "left";
  c.setLineDash([2, 3]);
  vertical(c, x(moment), MARGIN.top, floor, colour("muted"), 1);
  c.setLineDash([]);
  vertical(c, x(times[index]), MARGIN.top, floor, colour("ink"), 1.5);
}

function niceStep(about) {
  const power = 10 ** Math.floor(Math.log10(Math.max(about, 1e-3)));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= about);
}

function vertical(c, x, top, bottom, colour, width) {
  c.beginPath();
  c.moveTo(x, top);
  c.lineTo(x, bottom);
  c.strokeStyle = colour;
  c.lineWidth = width;
  c.stroke();
}

function drawPanel(c, panel, data, index, x, top, size, colour, inner) {
  const known = panel.values.filter((value) => value !== null);
  let low = panel.low ?? Math.min(-1, ...known);
  let high = panel.high ?? Math.max(1, ...known);
  if (high - low < 1e-9) high = low + 1;
  const [head, foot] = [top + 18, top + size - 6];
  const y = (value) => foot - ((foot - head) * (value - low)) / (high - low);
  c.strokeStyle = colour("grid");
  c.lineWidth = 1;
  for (const value of low < 0 ? [low, 0, high] : [low, high]) {
    c.beginPath();
    c.moveTo(MARGIN.left, y(value));
    c.lineTo(MARGIN.left + inner, y(value));
    c.stroke();
  }
  c.fillStyle = colour("ink");
  c.fillText(panel.name, MARGIN.left, top + 13);
  const offset = c.measureText(panel.name + " ").width;
  c.fillStyle = colour("muted");
  const ends = `${low < 0 ? low.toFixed(1) + " … " : "0 … "}${high.toFixed(high < 10 ? 1 : 0)} ${panel.unit}`;
  c.fillText(ends, MARGIN.left + offset + 4, top + 13);
  const now = (panel.shown || panel.values)[index];
  c.textAlign = "right";
  c.fillStyle = colour(panel.colour);
  c.fillText(now === null ? "–" : `${now.toFixed(2)} ${panel.unit}`, MARGIN.left + inner, top + 13);
  c.textAlign = "left";
  c.beginPath();
  let down = false;
  panel.values.forEach((value, i) => {
    if (value === null) {
      down = false;
      return;
    }
    if (down) c.lineTo(x(data.time_s[i]), y(value));
    else c.moveTo(x(data.time_s[i]), y(value));
    down = true;
  });
  c.strokeStyle = colour(panel.colour);
  c.lineWidth = 1.8;
  c.lineJoin = "round";
  c.stroke();
  if (now !== null) {
    c.beginPath();
    c.arc(x(data.time_s[index]), y(panel.values[index]), 3.5, 0, 2 * Math.PI);
    c.fillStyle = colour(panel.colour);
    c.fill();
  }
}

// A strip with one colour for each text; the text of now stands above it.
function drawBand(c, name, data, textOf, index, x, top, size, colour, inner) {
  const texts = data.time_s.map((_, i) => textOf(data, i));
  const different = [...new Set(texts)].filter((text) => text !== "no plan" && text !== "no rule");
  const fill = (text) => {
    const at = different.indexOf(text);
    return at < 0 ? colour("grid") : colour(`series-${[1, 5, 4, 2, 6, 3][at % 6]}`);
  };
  c.fillStyle = colour("ink");
  c.fillText(name, MARGIN.left, top + 13);
  c.textAlign = "right";
  c.fillStyle = fill(texts[index]) === colour("grid") ? colour("muted") : fill(texts[index]);
  c.fillText(texts[index], MARGIN.left + inner, top + 13);
  c.textAlign = "left";
  let start = 0;
  for (let i = 1; i <= texts.length; i += 1) {
    if (i < texts.length && texts[i] === texts[start]) continue;
    const end = Math.min(i, texts.length - 1);
    c.fillStyle = fill(texts[start]);
    c.fillRect(x(data.time_s[start]), top + 18, Math.max(x(data.time_s[end]) - x(data.time_s[start]), 1), size - 24);
    start = i;
  }
}
