// The encounter from above. Everything is drawn from the rows of one frame; nothing is interpolated.
const METRES_ACROSS = 84; // of the scene, before zooming
const LEAST_PERSON_PX = 4;

function colours() {
  const style = getComputedStyle(document.documentElement);
  return (name) => style.getPropertyValue("--" + name).trim();
}

// A canvas as sharp as the screen; returns its context in CSS pixels.
function prepared(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const [columns, rows] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== columns || canvas.height !== rows) {
    canvas.width = columns;
    canvas.height = rows;
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

// Distance of a pedestrian's disc from the ego's rectangle.
function surfaceDistance(ego, person) {
  const [cos, sin] = [Math.cos(ego.heading), Math.sin(ego.heading)];
  const [dx, dy] = [person.x - ego.x, person.y - ego.y];
  const along = Math.max(Math.abs(dx * cos + dy * sin) - ego.length / 2, 0);
  const across = Math.max(Math.abs(dy * cos - dx * sin) - ego.width / 2, 0);
  return Math.max(Math.hypot(along, across) - person.radius, 0);
}

// Directions from the ego's centre in which a relative velocity leads to contact; null while they touch.
function collisionCone(ego, person) {
  const middle = Math.atan2(person.y - ego.y, person.x - ego.x);
  let [low, high] = [Infinity, -Infinity];
  for (const [a, b] of [[1, 1], [1, -1], [-1, 1], [-1, -1]]) {
    const [u, v] = [(a * ego.length) / 2, (b * ego.width) / 2];
    const x = person.x - ego.x + u * Math.cos(ego.heading) - v * Math.sin(ego.heading);
    const y = person.y - ego.y + u * Math.sin(ego.heading) + v * Math.cos(ego.heading);
    const away = Math.hypot(x, y);
    if (away <= person.radius) return null;
    const turn = Math.atan2(y, x) - middle;
    const angle = Math.atan2(Math.sin(turn), Math.cos(turn));
    const spread = Math.asin(person.radius / away);
    low = Math.min(low, angle - spread);
    high = Math.max(high, angle + spread);
  }
  return high - low < Math.PI ? [middle + low, middle + high] : null;
}

function drawScene(canvas, frame, data, view) {
  const { context: c, width, height } = prepared(canvas);
  const colour = colours();
  const scale = (view.zoom * width) / METRES_ACROSS;
  const ego = frame.ego;
  // The ego drives to the right; the middle is half way to the pedestrian, or ahead where there is none.
  const [cos, sin] = [Math.cos(view.heading), Math.sin(view.heading)];
  const to = frame.met
    ? { x: frame.met.x - ego.x, y: frame.met.y - ego.y }
    : { x: 40 * Math.cos(ego.heading), y: 40 * Math.sin(ego.heading) };
  const share = 0.5 * Math.min(1, 56 / Math.max(Math.hypot(to.x, to.y), 1e-6));
  const [middleX, middleY] = [ego.x + share * to.x, ego.y + share * to.y];

  c.save();
  c.translate(width / 2, height / 2);
  c.scale(scale, -scale);
  c.rotate(-view.heading);
  c.translate(-middleX, -middleY);
  const pixel = 1 / scale;

  const trace = (at, closed) => {
    c.beginPath();
    for (let i = 0; i < at.length; i += 2) c.lineTo(at[i], at[i + 1]);
    if (closed) c.closePath();
  };
  drawMap(c, data.map, colour, trace, pixel);

  drawSignals(c, frame.signals, colour, pixel);
  for (const one of frame.vehicles) drawCar(c, one, colour("scene-vehicle"), pixel, "");
  if (view.layers.overlay && frame.plan) drawOverlay(c, frame.plan, colour("scene-overlay"), trace, pixel);
  if (view.layers.plan && frame.plan) drawPlan(c, frame.plan, colour("scene-ego"), trace, pixel);
  if (view.layers.cone && frame.met) drawCone(c, ego, frame.met, colour("scene-cone"), pixel);
  drawCar(c, ego, colour("scene-ego"), pixel, colour("surface"));
  for (const one of frame.persons) {
    c.beginPath();
    c.arc(one.x, one.y, Math.max(one.radius, LEAST_PERSON_PX * pixel), 0, 2 * Math.PI);
    c.fillStyle = one.met ? colour("scene-met") : colour("scene-person");
    c.fill();
    c.lineWidth = 1.5 * pixel;
    c.strokeStyle = colour("surface");
    c.stroke();
    if (one.met) {
      c.beginPath();
      c.arc(one.x, one.y, Math.max(one.radius, LEAST_PERSON_PX * pixel) + 5 * pixel, 0, 2 * Math.PI);
      c.strokeStyle = colour("scene-met");
      c.lineWidth = 2 * pixel;
      c.stroke();
    }
  }
  c.restore();

  // Texts stand upright, in pixels.
  const place = (x, y) => [
    width / 2 + scale * ((x - middleX) * cos + (y - middleY) * sin),
    height / 2 - scale * ((y - middleY) * cos - (x - middleX) * sin),
  ];
  c.font = "12px " + colour("body");
  if (view.layers.overlay && frame.plan) {
    for (const one of frame.plan.overlay) {
      (one.label || []).forEach((text, i) => {
        const [x, y] = place(one.at[2 * i], one.at[2 * i + 1]);
        label(c, text, x + 9, y + 16, colour("scene-overlay"), colour("surface"));
      });
    }
  }
  const bar = 10 * scale;
  c.fillStyle = colour("ink");
  c.fillRect(14, height - 16, bar, 3);
  label(c, "10 m", 14, height - 22, colour("ink"), "");
  drawNorth(c, 30, 34, view.heading, colour("ink"), colour("surface"));
}

// An arrow to the north of a scene that is turned so that the ego drives to the right.
function drawNorth(c, x, y, heading, ink, ground) {
  const [toX, toY] = [Math.sin(heading), -Math.cos(heading)];
  c.globalAlpha = 0.8;
  c.fillStyle = ground;
  c.beginPath();
  c.arc(x, y, 22, 0, 2 * Math.PI);
  c.fill();
  c.globalAlpha = 1;
  c.fillStyle = ink;
  c.beginPath();
  c.moveTo(x + 11 * toX, y + 11 * toY);
  c.lineTo(x - 9 * toX + 5 * toY, y - 9 * toY - 5 * toX);
  c.lineTo(x - 5 * toX, y - 5 * toY);
  c.lineTo(x - 9 * toX - 5 * toY, y - 9 * toY + 5 * toX);
  c.closePath();
  c.fill();
  c.textAlign = "center";
  c.textBaseline = "middle";
  c.fillText("N", x + 17 * toX, y + 17 * toY);
  c.textAlign = "start";
  c.textBaseline = "alphabetic";
}

function label(c, text, x, y, ink, ground) {
  if (ground) {
    c.globalAlpha = 0.8;
    c.fillStyle = ground;
    c.fillRect(x - 3, y - 12, c.measureText(text).width + 6, 16);
    c.globalAlpha = 1;
  }
  c.fillStyle = ink;
  c.fillText(text, x, y);
}

function drawMap(c, areas, colour, trace, pixel) {
  c.lineCap = "butt";
  c.lineJoin = "round";
  const fill = (kind, name) => {
    for (const area of areas) {
      if (area.kind !== kind) continue;
      trace(area.at, true);
      c.fillStyle = colour(name);
      c.fill();
    }
  };
  const stroke = (kind, name, width) => {
    for (const area of areas) {
      if (area.kind !== kind) continue;
      trace(area.at, false);
      c.lineWidth = Math.max(width(area.width_m), pixel);
      c.strokeStyle = colour(name);
      c.stroke();
    }
  };
  fill("junction", "scene-road");
  stroke("inner_lane", "scene-road", (width) => width + 0.3);
  fill("walkingarea", "scene-walk");
  // Lanes with a margin left free: what shows between two of them is the line.
  stroke("sidewalk", "scene-edge", (width) => width);
  stroke("sidewalk", "scene-walk", (width) => width - 2 * Math.max(0.1, pixel));
  stroke("lane", "scene-line", (width) => width);
  stroke("lane", "scene-road", (width) => width - Math.max(0.14, pixel));
  for (const area of areas) {
    if (area.kind !== "crossing") continue;
    trace(area.at, false);
    if (area.crossing_kind === "zebra") {
      c.setLineDash([0.5, 0.5]);
      c.lineWidth = area.width_m;
      c.strokeStyle = colour("scene-line");
      c.stroke();
      c.setLineDash([]);
    } else {
      // Two lines beside the way: whole where signals decide, broken where nothing is painted.
      c.strokeStyle = colour("scene-line");
      c.globalAlpha = 0.35;
      c.lineWidth = area.width_m;
      c.stroke();
      c.globalAlpha = 1;
      const from = area.at.slice(0, 2), to = area.at.slice(-2);
      const length = Math.hypot(to[0] - from[0], to[1] - from[1]) || 1;
      const [nx, ny] = [-(to[1] - from[1]) / length, (to[0] - from[0]) / length];
      if (area.crossing_kind !== "signal") c.setLineDash([0.6, 0.6]);
      for (const side of [-0.5, 0.5]) {
        trace(area.at.map((v, i) => v + side * area.width_m * (i % 2 ? ny : nx)), false);
        c.lineWidth = Math.max(0.12, pixel);
        c.stroke();
      }
      c.setLineDash([]);
    }
  }
}

// Lights: lamps at both ends of a crossing for its pedestrians, a bar where the ego's own stop line is.
function drawSignals(c, signals, colour, pixel) {
  for (const one of signals.crossings) {
    for (const [x, y] of [one.at.slice(0, 2), one.at.slice(-2)]) {
      c.beginPath();
      c.arc(x, y, Math.max(0.7, 5 * pixel), 0, 2 * Math.PI);
      c.fillStyle = colour("signal-" + one.state);
      c.fill();
      c.lineWidth = 1.5 * pixel;
      c.strokeStyle = colour("ink");
      c.stroke();
    }
  }
  const ahead = signals.ahead;
  if (!ahead) return;
  const [dx, dy] = [-1.6 * Math.sin(ahead.heading), 1.6 * Math.cos(ahead.heading)];
  for (const [name, width] of [["ink", 0.9], ["signal-" + ahead.state, 0.6]]) {
    c.beginPath();
    c.moveTo(ahead.x - dx, ahead.y - dy);
    c.lineTo(ahead.x + dx, ahead.y + dy);
    c.lineWidth = Math.max(width, (name === "ink" ? 5 : 3) * pixel);
    c.strokeStyle = colour(name);
    c.stroke();
  }
}

function drawCar(c, car, fill, pixel, nose) {
  c.save();
  c.translate(car.x, car.y);
  c.rotate(car.heading);
  c.beginPath();
  c.roundRect(-car.length / 2, -car.width / 2, car.length, car.width, 0.3);
  c.fillStyle = fill;
  c.fill();
  if (nose) {
    c.beginPath();
    c.moveTo(car.length / 2 - 0.4, 0);
    c.lineTo(car.length / 2 - 1.5, 0.55);
    c.lineTo(car.length / 2 - 1.5, -0.55);
    c.closePath();
    c.fillStyle = nose;
    c.fill();
  }
  c.restore();
}

function drawCone(c, ego, person, colour, pixel) {
  const cone = collisionCone(ego, person);
  if (!cone) return;
  const far = 1.15 * Math.hypot(person.x - ego.x, person.y - ego.y) + 3;
  c.beginPath();
  c.moveTo(ego.x, ego.y);
  c.arc(ego.x, ego.y, far, cone[0], cone[1]);
  c.closePath();
  c.globalAlpha = 0.16;
  c.fillStyle = colour;
  c.fill();
  c.globalAlpha = 0.8;
  c.lineWidth = pixel;
  c.strokeStyle = colour;
  c.stroke();
  c.globalAlpha = 1;
  const x = ego.speed * Math.cos(ego.heading) - person.xSpeed;
  const y = ego.speed * Math.sin(ego.heading) - person.ySpeed;
  const length = Math.hypot(x, y);
  if (length < 0.2) return;
  const [tipX, tipY] = [ego.x + x, ego.y + y];
  const turn = Math.atan2(y, x);
  c.beginPath();
  c.moveTo(ego.x, ego.y);
  c.lineTo(tipX, tipY);
  for (const side of [2.7, -2.7]) {
    c.moveTo(tipX, tipY);
    c.lineTo(tipX + 8 * pixel * Math.cos(turn + side), tipY + 8 * pixel * Math.sin(turn + side));
  }
  c.lineWidth = 2 * pixel;
  c.stroke();
}

function drawOverlay(c, plan, colour, trace, pixel) {
  c.strokeStyle = colour;
  c.fillStyle = colour;
  for (const one of plan.overlay) {
    if (one.kind === "points") {
      c.lineWidth = 2 * pixel;
      const size = 6 * pixel;
      for (let i = 0; i < one.at.length; i += 2) {
        c.beginPath();
        for (const [u, v] of [[1, 1], [1, -1]]) {
          c.moveTo(one.at[i] - u * size, one.at[i + 1] - v * size);
          c.lineTo(one.at[i] + u * size, one.at[i + 1] + v * size);
        }
        c.stroke();
      }
      continue;
    }
    trace(one.at, one.kind === "outline");
    if (one.kind === "outline") {
      c.globalAlpha = 0.18;
      c.fill();
    }
    c.globalAlpha = one.name.startsWith("candidate") ? 0.45 : 0.9;
    c.lineWidth = 1.3 * pixel;
    c.stroke();
    c.globalAlpha = 1;
  }
}

function drawPlan(c, plan, colour, trace, pixel) {
  trace(plan.at, false);
  c.strokeStyle = colour;
  c.lineWidth = 2.5 * pixel;
  c.stroke();
  c.fillStyle = colour;
  let next = 1;
  plan.horizon_s.forEach((time, i) => {
    if (time + 1e-9 < next) return;
    next = Math.floor(time + 1e-9) + 1;
    c.beginPath();
    c.arc(plan.at[2 * i], plan.at[2 * i + 1], 3.5 * pixel, 0, 2 * Math.PI);
    c.fill();
  });
}
