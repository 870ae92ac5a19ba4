// Where the disk is at a time, on straight lines between the keyframes of a page.
function diskPoses(data) {
  "use strict";
  const { times, columns, shape } = data;
  return (t) => {
    let low = 0, high = times.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) low = middle; else high = middle;
    }
    const part = (t - times[low]) / (times[high] - times[low] || 1);
    const mix = (name) => columns[name][low] + part * (columns[name][high] - columns[name][low]);
    const q = ["qw", "qx", "qy", "qz"].map(mix), length = Math.hypot(...q);
    const [w, x, y, z] = q.map((value) => value / length);
    const centre = ["x", "y", "z"].map(mix);
    const ex = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)];
    const ey = [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)];
    const ez = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)];
    const level = Math.hypot(ez[0], ez[1]);
    return {
      centre, ex, ey, ez,
      contact: [mix("contactX"), mix("contactY"), 0],
      spin: mix("spin"),
      beta: Math.atan2(level, ez[2]),
      gamma: level > 1e-3 ? Math.atan2(ex[2], ey[2]) : null,
      lift: shape.cog[0] * ex[2], // of the centre of gravity over the centre
      placed: ([a, b, c = 0]) => // a plate's points have no z
        centre.map((value, k) => value + a * ex[k] + b * ey[k] + c * ez[k]),
    };
  };
}

// Closed hull of points of a picture.
function hullOf(points) {
  "use strict";
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const turn = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  const side = (all) => all.reduce((kept, point) => {
    while (kept.length > 1 && turn(...kept.slice(-2), point) <= 0) kept.pop();
    kept.push(point);
    return kept;
  }, []);
  return [...side(sorted), ...side(sorted.reverse())];
}

// Plays a motion of the disk in an element; returns a function that gives it another one.
function diskPlayer(root, data) {
  "use strict";
  const find = (selector) => root.querySelector(selector);
  const LOOK = {{ look|data|safe }}; // said once, for all pictures, in body.py
  const scene = find(".scene canvas"), strip = find(".strip");
  const camera = { azimuth: LOOK.azimuth, elevation: 0.3, zoom: 1 };
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const minus = (a, b) => a.map((value, k) => value - b[k]);
  let pose, begin, end;
  const inMm = (length) => // a small disk's with more places
    (1e3 * length).toFixed(Math.max(1, 2 - Math.floor(Math.log10(1e3 * data.radius))));

  // ---- The picture ------------------------------------------------------------------------

  function pencil() { // in CSS pixels, whatever the screen's resolution
    const sharp = window.devicePixelRatio || 1;
    const width = scene.clientWidth, height = scene.clientHeight;
    scene.width = Math.round(width * sharp);
    scene.height = Math.round(height * sharp);
    const pen = scene.getContext("2d");
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    return [pen, width, height];
  }

  function projection(target, distance, width, height) {
    const ca = Math.cos(camera.azimuth), sa = Math.sin(camera.azimuth);
    const ce = Math.cos(camera.elevation), se = Math.sin(camera.elevation);
    const toEye = [ce * ca, ce * sa, se], across = [-sa, ca, 0], up = [-se * ca, -se * sa, ce];
    const focal = camera.zoom * 2.5 * Math.min(height, 0.85 * width);
    const project = (point) => {
      const arm = minus(point, target), scale = focal / (distance - dot(arm, toEye));
      return [width / 2 + scale * dot(arm, across), 0.52 * height - scale * dot(arm, up)];
    };
    return [project, target.map((value, k) => value + distance * toEye[k])];
  }

  function drawScene(t) {
    const [pen, width, height] = pencil();
    const now = pose(t), { centre, placed } = now, R = data.radius, table = LOOK.reach * R;
    const target = [centre[0], centre[1], Math.max(LOOK.height * R, centre[2] - (1 - LOOK.height) * R)];
    const [project, eye] = projection(target, 9 * R, width, height);

    const { area, heavy, masses, lines, solid, cog } = data.shape;
    const trace = (points, hull) => {
      const seen = points.map(project);
      pen.beginPath();
      (hull ? hullOf(seen) : seen).forEach((point) => pen.lineTo(...point));
    };
    const fill = (points, colour, hull) => {
      trace(points, hull);
      pen.fillStyle = colour;
      pen.fill();
    };
    const stroke = (points, colour, thickness, hull) => {
      trace(points, hull);
      pen.strokeStyle = colour;
      pen.lineWidth = thickness;
      pen.stroke();
    };
    const mark = (point, size, colour, edge) => {
      pen.beginPath();
      pen.arc(...project(point), size, 0, 2 * Math.PI);
      pen.fillStyle = colour;
      pen.fill();
      pen.strokeStyle = edge;
      pen.lineWidth = 1.5;
      pen.stroke();
    };

    // The table, its grid, the shadow and the path of the contact point; the disk hides them.
    fill(Array.from({ length: 73 }, (_, k) => k * Math.PI / 36).map((angle) =>
      [target[0] + table * Math.cos(angle), target[1] + table * Math.sin(angle), 0]), LOOK.table);
    const cell = LOOK.cell * R;
    for (const axis of [0, 1]) {
      for (let k = Math.ceil((target[axis] - table) / cell); k * cell < target[axis] + table; k++) {
        const half = Math.sqrt(table ** 2 - (k * cell - target[axis]) ** 2);
        const ends = [-half, half].map((side) => [k * cell, target[1 - axis] + side]);
        stroke(ends.map((end) => [end[axis], end[1 - axis], 0]), LOOK.grid, 1);
      }
    }
    fill(area.map(placed).map(([x, y]) => [x, y, 0]), LOOK.shadow, solid);
    const { contactX, contactY } = data.columns;
    stroke([...data.times.flatMap((each, i) =>
      each > t - LOOK.trail && each < t ? [[contactX[i], contactY[i], 0]] : []), now.contact],
      LOOK.path, 2);

    const front = solid || dot(now.ez, minus(eye, centre)) > 0;
    const [bright, dark] = front ? LOOK.front : LOOK.back;
    [[[area], bright], [heavy, dark], [masses, LOOK.ink]].forEach(([outlines, colour]) =>
      outlines.forEach((outline) => fill(outline.map(placed), colour, solid)));
    if (solid) stroke(area.map(placed), dark, 1.5, solid);
    const faces = (p) => !solid || dot(minus(p, centre), minus(eye, centre)) >= R * R;
    lines.map((line) => line.map(placed)).forEach((line) => line.slice(1).forEach((point, k) => {
      if (faces(point) && faces(line[k])) stroke([line[k], point], dark, 1.5);
    }));
    mark(now.contact, 3, LOOK.path, LOOK.path);
    mark(placed(data.shape.mark), 5, "#fff", LOOK.ink);
    mark(placed(cog), 4.5, "#000", "#fff");
    const [x, y] = project(centre);
    pen.strokeStyle = LOOK.ink;
    pen.lineWidth = 1.2;
    pen.stroke(new Path2D(`M ${x - 6} ${y} h 12 M ${x} ${y - 6} v 12`));

    find(".readout").innerText = [
      `t = ${t.toFixed(3)} s`,
      `β = ${now.beta.toFixed(2)} rad (${(now.beta * 180 / Math.PI).toFixed(0)}°)`,
      `γ = ${now.gamma === null ? "–" : `${now.gamma.toFixed(2)} rad`}`,
      `spin ${now.spin.toFixed(1).replace(/^-0\.0$/, "0.0")} rad/s`,
      `COG ${inMm(centre[2] + now.lift)} mm high,`,
      `${inMm(Math.abs(now.lift))} mm ${now.lift < 0 ? "below" : "above"} the centre`,
    ].join("\n");
  }

  // ---- The strip: inclination and height of the centre of gravity over time ---------------

  const part = (t) => (t - begin) / (end - begin || 1);

  function drawStrip() { // once per motion; a line moves over it
    const poses = data.times.map(pose);
    const strips = [
      ["β in rad", (beta) => beta.toFixed(2), [["#222", (p) => p.beta]]],
      ["height of the COG in mm (grey: of the centre)", inMm,
        [["#999", (p) => p.centre[2]], ["#222", (p) => p.centre[2] + p.lift]]],
    ];
    strip.innerHTML = strips.map(([title, named, curves]) => {
      const values = curves.map(([, value]) => poses.map(value)), all = values.flat();
      const low = all.reduce((a, b) => Math.min(a, b)), high = all.reduce((a, b) => Math.max(a, b));
      const lines = curves.map(([colour], k) => `<polyline stroke="${colour}" points="${
        values[k].map((value, i) => `${1e3 * part(data.times[i])},${
          100 * (high - value) / (high - low || 1)}`).join(" ")}"/>`);
      return `<p>${title}, from ${named(low)} to ${named(high)}</p>` +
        `<svg viewBox="0 0 1000 100" preserveAspectRatio="none">${lines.join("")}` +
        '<line y2="100" stroke="#d00000"/></svg>';
    }).join("");
  }

  // ---- Controls ---------------------------------------------------------------------------

  const play = find(".play"), slider = find(".time"), speed = find(".speed");
  let time, playing = false, last = null;

  function show(t) {
    time = Math.min(end, Math.max(begin, t));
    slider.value = time;
    slider.setAttribute("aria-valuetext", `${time.toFixed(2)} seconds`);
    strip.querySelectorAll("line").forEach((line) =>
      ["x1", "x2"].forEach((side) => line.setAttribute(side, 1e3 * part(time))));
    drawScene(time);
  }

  const rate = () => speed.value ? +speed.value : time < data.slowUntil ? data.slow : 1;

  function step(now) {
    if (!playing) return;
    if (last !== null) show(time + rate() * Math.min(0.1, (now - last) / 1000));
    last = now;
    if (time >= end) toggle(); else requestAnimationFrame(step);
  }

  function toggle() {
    playing = !playing;
    play.textContent = playing ? "Pause" : "Play";
    last = null;
    if (!playing) return;
    if (time >= end) time = begin;
    requestAnimationFrame(step);
  }

  function zoom(factor) {
    camera.zoom = Math.min(4, Math.max(0.5, camera.zoom * factor));
    show(time);
  }

  function orbit(across, up) {
    camera.azimuth += across;
    camera.elevation = Math.min(1.5, Math.max(0.04, camera.elevation + up));
    show(time);
  }

  function load(motion, t) {
    data = motion;
    pose = diskPoses(data);
    [begin, end] = [data.times[0], data.times[data.times.length - 1]];
    [slider.min, slider.max] = [begin, end];
    drawStrip();
    show(t ?? begin);
  }

  const asked = /^#t=(\d*\.?\d+)$/.exec(location.hash); // page.html#t=0.4 shows that instant
  load(data, asked && +asked[1]);
  const named = (value) => value < 1 ? `1/${+(1 / value).toPrecision(3)}` : `${value}×`;
  const choices = new Set([0.02, 0.05, 0.1, 0.2, 0.5, 1, ...(end - begin > 5 ? [2, 5] : [])]);
  if (data.speed) choices.add(data.speed);
  [...choices].sort((a, b) => a - b).forEach((value) => speed.add(new Option(named(value), value)));
  if (data.slowUntil !== null) speed.add(new Option(`${named(data.slow)}, then 1×`, ""), 0);
  speed.value = data.speed ?? "";
  data.marks.forEach(([name, when]) => {
    const jump = document.createElement("button");
    jump.type = "button";
    jump.textContent = `${name} ${when.toFixed(2)} s`;
    jump.addEventListener("click", () => show(when));
    find(".jumps").append(jump);
  });

  play.addEventListener("click", toggle);
  slider.addEventListener("input", () => show(+slider.value));
  const [closer, farther] = root.querySelectorAll(".zoom button");
  closer.addEventListener("click", () => zoom(1.25));
  farther.addEventListener("click", () => zoom(0.8));
  scene.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return; // a plain wheel scrolls the page
    event.preventDefault();
    zoom(Math.exp(-0.003 * event.deltaY));
  }, { passive: false });
  let from;
  scene.addEventListener("pointerdown", (event) => {
    scene.setPointerCapture(event.pointerId);
    from = event;
  });
  scene.addEventListener("pointermove", (event) => {
    if (!scene.hasPointerCapture(event.pointerId)) return;
    orbit(-0.008 * (event.clientX - from.clientX), 0.006 * (event.clientY - from.clientY));
    from = event;
  });
  const keys = {
    " ": toggle,
    ArrowLeft: () => show(time - 0.1 * rate()),
    ArrowRight: () => show(time + 0.1 * rate()),
    ArrowUp: () => orbit(0, 0.05),
    ArrowDown: () => orbit(0, -0.05),
    "+": () => zoom(1.25),
    "-": () => zoom(0.8),
  };
  root.addEventListener("keydown", (event) => {
    const known = event.target === scene || (event.target === slider && event.key === " ");
    if (!known || !(event.key in keys)) return;
    event.preventDefault();
    keys[event.key]();
  });
  new ResizeObserver(() => show(time)).observe(root);

  if ("alone" in root.dataset) {
    scene.focus({ preventScroll: true });
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (!asked && !calm) toggle();
  }
  return load;
}

if (typeof document !== "undefined") { // a test asks for poses alone
  const root = document.currentScript.closest(".disk-player");
  const told = root.querySelector('script[type="application/json"]');
  if (told) diskPlayer(root, JSON.parse(told.textContent));
}
