// The replay: which recorded row is shown, how it moves on, and what is said of it.
const part = (id) => document.getElementById(id);
const dialog = part("replay");
const [scene, traces] = [part("replay-scene"), part("replay-traces")];
const quiet = window.matchMedia("(prefers-reduced-motion: reduce)");
const stored = new Map(); // key -> data, as files have brought it
const waiting = new Map(); // key -> what to do with it
const PLAN_LASTS_S = 1.0; // a plan is shown until the next one, but not longer than this, as in films
let data = null;
let row = null;
let index = 0;
let moment = 0;
let heading = 0;
let zoom = 1;
let playing = false;
let owed = 0; // simulated seconds not yet shown
let before = 0; // wall clock of the last picture [ms]
let said = -Infinity;

window.cosimReplayData = (key, content) => {
  stored.set(key, content);
  const then = waiting.get(key);
  waiting.delete(key);
  if (then) then();
};

function openReplay(which) {
  row = which;
  const key = row.dataset.key;
  pause();
  part("replay-problem").hidden = true;
  if (!dialog.open) dialog.showModal();
  history.replaceState(null, "", "#replay=" + encodeURIComponent(key));
  if (stored.has(key)) {
    begin(key);
    return;
  }
  waiting.clear();
  waiting.set(key, () => begin(key));
  const script = document.createElement("script");
  script.src = `${REPLAYS}/${encodeURIComponent(key)}.js`;
  script.onerror = () => {
    part("replay-body").hidden = true;
    part("replay-problem").hidden = false;
    part("replay-problem").textContent =
      `The data of this replay is missing: ${script.src.split("/").slice(-3).join("/")} beside report.html. ` +
      "Run cosim report to write it again.";
  };
  document.head.append(script);
}

function begin(key) {
  if (row.dataset.key !== key) return; // another one was asked for meanwhile
  data = stored.get(key);
  part("replay-body").hidden = false;
  moment = Number(row.dataset.moment);
  heading = data.ego.heading_rad[frameAt(moment)];
  zoom = 1;
  const met = data.encounter_id !== null; // a moment of an ego is no encounter
  part("replay-title").textContent =
    `${row.dataset.controller} · ${data.scenario_id} · seed ${data.seed} · ` +
    (met ? `encounter ${data.encounter_id}` : `ego ${data.ego_id} at ${moment.toFixed(1)} s`);
  part("replay-source").textContent =
    `Rows of ${row.dataset.folder}: ` +
    (!met
      ? `egos.parquet (ego_id ${data.ego_id}), neighbours.parquet, plans.parquet.`
      : EGOS
      ? `egos.parquet (ego_id ${data.ego_id}), neighbours.parquet (pedestrian with object_id ${data.ped_id}), ` +
        `plans.parquet; encounters.csv, encounter_id ${data.encounter_id}.`
      : `traffic.parquet (vehicle with object_id ${data.ego_id}, pedestrian with object_id ${data.ped_id}); ` +
        `traffic_encounters.csv, traffic_encounter_id ${data.encounter_id}.`);
  part("replay-scrub").max = String(data.time_s.length - 1);
  const names = new Set(data.plans.flatMap((plan) => plan.overlay.map((one) => one.name)));
  part("overlay-names").textContent = names.size ? ": " + [...names].join(", ") : ": nothing";
  const rows = replayableRows();
  const at = rows.indexOf(row);
  part("replay-previous").disabled = at <= 0;
  part("replay-next").disabled = at < 0 || at === rows.length - 1;
  if (quiet.matches) {
    show(frameAt(moment));
  } else {
    show(frameAt(moment - 4));
    play();
  }
}

// The recorded row nearest to a time.
function frameAt(time) {
  let best = 0;
  data.time_s.forEach((one, i) => {
    if (Math.abs(one - time) < Math.abs(data.time_s[best] - time)) best = i;
  });
  return best;
}

// What the recorded rows of one instant hold, as it is drawn.
function frameOf(i) {
  const ego = data.ego;
  const angle = ego.heading_rad[i];
  const half = ego.length_m / 2;
  const frame = {
    ego: {
      x: ego.front_x_m[i] - half * Math.cos(angle),
      y: ego.front_y_m[i] - half * Math.sin(angle),
      heading: angle,
      speed: ego.speed_mps[i],
      length: ego.length_m,
      width: ego.width_m,
    },
    vehicles: [],
    persons: [],
    met: null,
    plan: null,
    signals: signalsAt(i),
  };
  for (const one of data.objects) {
    const at = i - one.first;
    if (at < 0 || at >= one.x_m.length || one.x_m[at] === null) continue;
    if (one.kind === "vehicle") {
      const turn = one.heading_rad[at];
      const back = one.length_m / 2;
      frame.vehicles.push({
        x: one.x_m[at] - back * Math.cos(turn),
        y: one.y_m[at] - back * Math.sin(turn),
        heading: turn,
        length: one.length_m,
        width: one.width_m,
      });
    } else {
      const person = {
        id: one.id,
        x: one.x_m[at],
        y: one.y_m[at],
        xSpeed: one.x_speed_mps[at],
        ySpeed: one.y_speed_mps[at],
        radius: one.length_m / 2,
        phase: textAt(one.phase, at),
        met: Boolean(one.met),
      };
      frame.persons.push(person);
      if (person.met) frame.met = person;
    }
  }
  // Of an ego that no longer plans a path, no old plan stays on the map.
  for (const plan of data.plans) {
    const age = data.time_s[i] - plan.time_s;
    if (age >= -1e-6) frame.plan = age <= PLAN_LASTS_S + 1e-6 ? plan : null;
  }
  return frame;
}

// What is known of lights at an instant; those of crossings from the pedestrians there.
function signalsAt(i) {
  const found = { crossings: [], ahead: null };
  for (const area of data.map) {
    const states = area.kind === "crossing" && data.crossing_signals[area.name];
    if (states && states[i] !== null) found.crossings.push({ at: area.at, state: ["green", "red"][states[i]] });
  }
  const own = data.signal_ahead;
  if (own && own.state[i] !== null && own.x_m[i] !== null) {
    const away = Math.hypot(own.x_m[i] - data.ego.front_x_m[i], own.y_m[i] - data.ego.front_y_m[i]);
    // The stop line lies across the way to it; near it, across the ego's own direction.
    const heading =
      away > 8
        ? Math.atan2(own.y_m[i] - data.ego.front_y_m[i], own.x_m[i] - data.ego.front_x_m[i])
        : data.ego.heading_rad[i];
    found.ahead = { x: own.x_m[i], y: own.y_m[i], heading, state: own.state[i] };
  }
  return found;
}

function nearest(frame) {
  let best = null;
  for (const person of frame.persons) {
    const away = surfaceDistance(frame.ego, person);
    if (best === null || away < best) best = away;
  }
  return best;
}

function show(i) {
  index = Math.min(Math.max(i, 0), data.time_s.length - 1);
  const frame = frameOf(index);
  const layers = { plan: part("layer-plan").checked, overlay: part("layer-overlay").checked, cone: part("layer-cone").checked };
  drawScene(scene, frame, data, { zoom, heading, layers });
  drawTraces(traces, data, index, moment);
  const scrub = part("replay-scrub");
  scrub.value = String(index);
  scrub.setAttribute("aria-valuetext", `${data.time_s[index].toFixed(2)} seconds`);
  writeReadout(frame);
  const now = performance.now();
  if (!playing || now - said > 2000) {
    said = now;
    const away = nearest(frame);
    part("replay-summary").textContent =
      `At ${data.time_s[index].toFixed(2)} s the ego drives ${data.ego.speed_mps[index].toFixed(1)} m/s; ` +
      (away === null ? "no pedestrian is near." : `the nearest pedestrian is ${away.toFixed(1)} m away.`);
  }
}

function writeReadout(frame) {
  const fixed = (value, unit, digits = 2) => (value === null ? "–" : `${value.toFixed(digits)} ${unit}`);
  const lines = [
    ["time", fixed(data.time_s[index], "s")],
    ["speed", fixed(data.ego.speed_mps[index], "m/s")],
    ["acceleration", fixed(data.ego.acceleration_mps2[index], "m/s²")],
    ["distance", fixed(data.distance_m[index], "m")],
    ["TTC", fixed(data.ttc_s[index], "s")],
    ["light ahead", data.signal_ahead ? data.signal_ahead.state[index] || "–" : "–"],
    ["pedestrian", data.ped_id === null ? "–" : frame.met ? frame.met.phase || "on the road" : "not there"],
    ["decision", decisionText(data, index)],
    ["because of", textAt(data.ego.because, index) || "–"],
    ["solver", solverText(data, index)],
  ];
  const list = part("replay-readout");
  if (list.children.length !== lines.length) {
    list.replaceChildren(
      ...lines.map(([name]) => {
        const group = document.createElement("div");
        const term = document.createElement("dt");
        term.textContent = name;
        group.append(term, document.createElement("dd"));
        return group;
      }),
    );
  }
  lines.forEach(([, value], i) => (list.children[i].lastChild.textContent = value));
}

function play() {
  if (!data || playing) return;
  if (index >= data.time_s.length - 1) show(0);
  playing = true;
  owed = 0;
  before = performance.now();
  part("replay-play").textContent = "Pause";
  requestAnimationFrame(advance);
}

function pause() {
  playing = false;
  part("replay-play").textContent = "Play";
}

function stop() {
  pause();
  if (data) show(index); // says what is shown
}

function advance(now) {
  if (!playing) return;
  owed += (Math.max(0, now - before) / 1000) * Number(part("replay-speed").value);
  before = now;
  let next = index;
  while (next + 1 < data.time_s.length && data.time_s[next + 1] - data.time_s[next] <= owed) {
    owed -= data.time_s[next + 1] - data.time_s[next];
    next += 1;
  }
  if (next !== index) show(next);
  if (next >= data.time_s.length - 1) stop();
  else requestAnimationFrame(advance);
}

function step(count) {
  pause();
  show(index + count);
}

function seek(time) {
  pause();
  show(frameAt(time));
}

function changeSpeed(by) {
  const select = part("replay-speed");
  select.selectedIndex = Math.min(Math.max(select.selectedIndex + by, 0), select.options.length - 1);
}

function changeZoom(factor) {
  zoom = Math.min(Math.max(zoom * factor, 0.4), 6);
  if (data) show(index);
}

function openBeside(by) {
  const rows = replayableRows();
  const other = rows[rows.indexOf(row) + by];
  if (other) openReplay(other);
}

part("replay-play").addEventListener("click", () => (playing ? stop() : play()));
part("replay-back").addEventListener("click", () => step(-1));
part("replay-forward").addEventListener("click", () => step(1));
part("replay-moment").addEventListener("click", () => seek(moment));
part("replay-scrub").addEventListener("input", (event) => {
  pause();
  show(Number(event.target.value));
});
part("replay-close").addEventListener("click", () => dialog.close());
part("replay-previous").addEventListener("click", () => openBeside(-1));
part("replay-next").addEventListener("click", () => openBeside(1));
part("zoom-in").addEventListener("click", () => changeZoom(1.3));
part("zoom-out").addEventListener("click", () => changeZoom(1 / 1.3));
for (const name of ["plan", "overlay", "cone"]) {
  part("layer-" + name).addEventListener("change", () => data && show(index));
}
scene.addEventListener("wheel", (event) => {
  event.preventDefault();
  changeZoom(event.deltaY < 0 ? 1.15 : 1 / 1.15);
});
traces.addEventListener("pointerdown", (event) => {
  traces.setPointerCapture(event.pointerId);
  seek(timeAt(traces, data, event.clientX));
});
traces.addEventListener("pointermove", (event) => {
  if (event.buttons) seek(timeAt(traces, data, event.clientX));
});
dialog.addEventListener("close", () => {
  pause();
  history.replaceState(null, "", location.pathname + location.search);
  const button = row && (row.matches("a") ? row : row.querySelector("button.open"));
  if (button) button.focus();
});
dialog.addEventListener("keydown", (event) => {
  if (!data || event.ctrlKey || event.metaKey || event.altKey) return;
  const kind = event.target.tagName;
  if (kind === "SELECT" && event.key !== "+" && event.key !== "-") return; // the list's own keys
  const acts = {
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    Home: () => step(-data.time_s.length),
    End: () => step(data.time_s.length),
    "+": () => changeSpeed(1),
    "-": () => changeSpeed(-1),
  };
  if (kind !== "BUTTON" && event.target.type !== "checkbox") acts[" "] = () => (playing ? stop() : play());
  const act = acts[event.key];
  if (!act) return;
  event.preventDefault();
  act();
});
window.addEventListener("resize", () => dialog.open && data && show(index));
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => dialog.open && data && show(index));

// What is shown now, in the names of the recorded columns; for tests and for the curious.
window.cosimReplay = {
  state() {
    if (!data) return null;
    const ego = data.ego;
    const frame = frameOf(index);
    const column = (name) => ego[name][index];
    return {
      key: row.dataset.key,
      index,
      frames: data.time_s.length,
      playing,
      speed: Number(part("replay-speed").value),
      time_s: data.time_s[index],
      ego: {
        front_x_m: column("front_x_m"),
        front_y_m: column("front_y_m"),
        heading_rad: column("heading_rad"),
        speed_mps: column("speed_mps"),
        acceleration_mps2: column("acceleration_mps2"),
        rule: textAt(ego.rule, index),
        manoeuvre: textAt(ego.manoeuvre, index),
        because: textAt(ego.because, index),
        plan_status: textAt(ego.plan_status, index),
        solved: column("solved"),
      },
      pedestrian: frame.met ? { object_id: frame.met.id, x_m: frame.met.x, y_m: frame.met.y } : null,
      distance_m: data.distance_m[index],
      ttc_s: data.ttc_s[index],
      nearest_m: nearest(frame),
      vehicles: frame.vehicles.length,
      pedestrians: frame.persons.length,
      plan_time_s: frame.plan ? frame.plan.time_s : null,
    };
  },
  seek,
  step,
  play,
  pause: stop,
};
