// What a page has been given of a motion: times and columns.
function diskMotion(data) {
  "use strict";
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const times = Float64Array.from(new Float32Array(bytes(data.times)), (t) => t + data.begin);
  const count = times.length;
  const integers = new Uint16Array(bytes(data.columns));
  const column = {};
  Object.keys(data.low).forEach((name, k) => {
    column[name] = Float64Array.from(
      integers.subarray(k * count, (k + 1) * count), (n) => data.low[name] + data.step[name] * n);
  });
  return diskPoses(data.shape, times, column);
}

// The same with the keyframe before a time, and poses.
function diskPoses(shape, times, column) {
  "use strict";
  const count = times.length;

  function before(t) { // index of the last keyframe that is not after t and has a successor
    let low = 0, high = count - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) low = middle; else high = middle;
    }
    return low;
  }

  function pose(t) {
    const i = before(t), span = times[i + 1] - times[i];
    const part = span > 0 ? (t - times[i]) / span : 0;
    const mix = (name, sign = 1) =>
      column[name][i] + part * (sign * column[name][i + 1] - column[name][i]);
    const names = ["qw", "qx", "qy", "qz"];
    // Quaternions of opposite sign are the same attitude: take the shorter way round.
    const near = names.reduce((sum, q) => sum + column[q][i] * column[q][i + 1], 0);
    const q = names.map((name) => mix(name, near < 0 ? -1 : 1));
    const length = Math.hypot(...q);
    const [w, x, y, z] = q.map((value) => value / length);
    const result = {
      centre: [mix("x"), mix("y"), mix("z")],
      contact: [mix("contactX"), mix("contactY"), 0],
      spin: mix("spin"),
      ex: [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
      ey: [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
      ez: [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    };
    result.beta = Math.atan2(Math.hypot(result.ez[0], result.ez[1]), result.ez[2]);
    result.gamma = Math.sin(result.beta) > 1e-3 ? Math.atan2(result.ex[2], result.ey[2]) : null;
    result.inPlane = ([x, y, z = 0]) => result.centre.map( // a plate's points have no z
      (value, k) => value + x * result.ex[k] + y * result.ey[k] + z * result.ez[k]);
    result.height = result.inPlane(shape.cog)[2];
    return result;
  }

  return { times, column, before, pose };
}

// Plays a motion of the disk in an element; returns a function that gives it another one.
function diskPlayer(root, data, motion) {
  "use strict";
  const find = (selector) => root.querySelector(selector);
  const COLOUR = {
    front: ["#8cc6ee", "#0b5c97"], back: ["#f7cf86", "#b85300"], // light half, heavy half
    table: "#f3f3f0", grid: "#d9d9d4", path: "#00795b", ink: "#222", faint: "#767676",
  };
  const TRAIL = 0.5; // seconds of the contact point's path that are shown
  let times, column, before, pose, count, begin, end;

  // ---- The picture ------------------------------------------------------------------------

  const scene = find(".scene canvas"), strip = find(".strip");
  let R, TABLE, DISTANCE;
  const camera = { azimuth: -1.25, elevation: 0.3, zoom: 1 };
  const range = (values) => values.reduce((r, v) => [Math.min(r[0], v), Math.max(r[1], v)],
    [Infinity, -Infinity]);
  let left, right, near, far, follows;
  const nice = (size) => {
    const power = 10 ** Math.floor(Math.log10(size));
    return power * [1, 2, 5, 10].find((step) => step * power >= 0.999 * size);
  };
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  function fit(canvas) { // context in CSS pixels, whatever the screen's resolution
    const sharp = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    canvas.width = Math.round(width * sharp);
    canvas.height = Math.round(height * sharp);
    const pen = canvas.getContext("2d");
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    return [pen, width, height];
  }

  function projection(target, width, height) {
    const ca = Math.cos(camera.azimuth), sa = Math.sin(camera.azimuth);
    const ce = Math.cos(camera.elevation), se = Math.sin(camera.elevation);
    const toEye = [ce * ca, ce * sa, se], across = [-sa, ca, 0], up = [-se * ca, -se * sa, ce];
    const focal = camera.zoom * 2.5 * Math.min(height, 0.85 * width);
    const project = (point) => {
      const arm = [point[0] - target[0], point[1] - target[1], point[2] - target[2]];
      const scale = focal / (DISTANCE - dot(arm, toEye));
      return [width / 2 + scale * dot(arm, across), 0.52 * height - scale * dot(arm, up)];
    };
    return { project, eye: target.map((value, k) => value + DISTANCE * toEye[k]) };
  }

  function drawScene(t) {
    const [pen, width, height] = fit(scene);
    const now = pose(t), { centre, ez, inPlane } = now;
    const target = [...(follows ? centre.slice(0, 2) : [(left + right) / 2, (near + far) / 2]),
      0.75 * R];
    const { project, eye } = projection(target, width, height);

    const trace = (points) => points.forEach((point, k) =>
      k ? pen.lineTo(...project(point)) : pen.moveTo(...project(point)));
    const fill = (outlines, colour) => { // where one outline lies within another, there is a hole
      if (!outlines.length) return;
      pen.beginPath();
      outlines.forEach(trace);
      pen.fillStyle = colour;
      pen.fill("evenodd");
    };
    const stroke = (points, colour, thickness) => {
      pen.beginPath();
      trace(points);
      pen.strokeStyle = colour;
      pen.lineWidth = thickness;
      pen.stroke();
    };
    const face = data.shape.face.map((outline) => outline.map(inPlane));
    const lines = data.shape.lines.map((line) => line.map(inPlane));
    const fillHull = (points, colour) => { // what a solid covers in the picture
      if (!points.length) return;
      const sorted = points.map(project).sort((a, b) => a[0] - b[0] || a[1] - b[1]);
      const half = (ordered) => ordered.reduce((kept, p) => {
        const left = () => {
          const [a, b] = kept.slice(-2);
          return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) <= 0;
        };
        while (kept.length > 1 && left()) kept.pop();
        kept.push(p);
        return kept;
      }, []);
      pen.beginPath();
      [...half(sorted), ...half(sorted.reverse())].forEach((p, k) =>
        k ? pen.lineTo(...p) : pen.moveTo(...p));
      pen.fillStyle = colour;
      pen.fill();
    };
    const mark = (point, size, colour, edge) => {
      pen.beginPath();
      pen.arc(...project(point), size, 0, 2 * Math.PI);
      pen.fillStyle = colour;
      pen.fill();
      if (edge) { pen.strokeStyle = edge; pen.lineWidth = 1.5; pen.stroke(); }
    };

    // The table, its grid, the shadow and the path of the contact point; the disk hides them.
    fill([Array.from({ length: 73 }, (_, k) => k * Math.PI / 36).map((angle) =>
      [target[0] + TABLE * Math.cos(angle), target[1] + TABLE * Math.sin(angle), 0])], COLOUR.table);
    const cell = nice(0.4 * R);
    for (let axis = 0; axis < 2; axis++) {
      for (let k = Math.ceil((target[axis] - TABLE) / cell); k * cell < target[axis] + TABLE; k++) {
        const half = Math.sqrt(TABLE ** 2 - (k * cell - target[axis]) ** 2);
        const ends = [-half, half].map((side) => {
          const point = [0, 0, 0];
          point[axis] = k * cell;
          point[1 - axis] = target[1 - axis] + side;
          return point;
        });
        stroke(ends, COLOUR.grid, 1);
      }
    }
    const SHADOW = "rgba(0, 0, 0, 0.13)", down = ([x, y]) => [x, y, 0];
    fill(face.map((outline) => outline.map(down)), SHADOW);
    fillHull(lines.flat().map(down), SHADOW);
    let previous = pose(Math.max(begin, t - TRAIL)).contact;
    for (let i = before(Math.max(begin, t - TRAIL)) + 1; i < count && times[i] < t; i++) {
      pen.globalAlpha = Math.max(0.05, 1 - (t - times[i]) / TRAIL);
      const point = [column.contactX[i], column.contactY[i], 0];
      stroke([previous, point], COLOUR.path, 2);
      previous = point;
    }
    pen.globalAlpha = 1;
    stroke([previous, now.contact], COLOUR.path, 2);

    const seen = dot(ez, eye) > dot(ez, centre) ? COLOUR.front : COLOUR.back;
    fill(face, seen[0]);
    fill(data.shape.heavy.map((outline) => outline.map(inPlane)), seen[1]);
    if (face.length) stroke(face[0], seen[1], 2.5);
    face.slice(1).forEach((outline) => stroke(outline, seen[1], 1));
    data.shape.masses.forEach((outline) => fill([outline.map(inPlane)], COLOUR.ink));
    fillHull(lines.flat(), COLOUR.front[0]);
    const faces = (p) => dot(p.map((value, k) => value - centre[k]),
      eye.map((value, k) => value - centre[k])) >= R * R;
    lines.forEach((line) => line.slice(1).forEach((point, k) => {
      if (faces(point) && faces(line[k])) stroke([line[k], point], COLOUR.front[1], 1);
    }));
    mark(now.contact, 3, COLOUR.path);
    mark(inPlane(data.shape.mark), 5, "#fff", COLOUR.ink);
    const middle = project(centre);
    mark(inPlane(data.shape.cog), 4.5, "#000", "#fff");
    pen.strokeStyle = COLOUR.ink;
    pen.lineWidth = 1.2;
    pen.beginPath();
    pen.moveTo(middle[0] - 6, middle[1]); pen.lineTo(middle[0] + 6, middle[1]);
    pen.moveTo(middle[0], middle[1] - 6); pen.lineTo(middle[0], middle[1] + 6);
    pen.stroke();

    const lift = 1e3 * (now.height - centre[2]);
    find(".readout").replaceChildren(...[
      `t = ${t.toFixed(3)} s`,
      `β = ${now.beta.toFixed(2)} rad (${(now.beta * 180 / Math.PI).toFixed(0)}°)`,
      `γ = ${now.gamma === null ? "–" : `${now.gamma.toFixed(2)} rad`}`,
      `spin ${now.spin.toFixed(1).replace(/^-0\.0$/, "0.0")} rad/s`,
      `COG ${(1e3 * now.height).toFixed(1)} mm high,`,
      `${Math.abs(lift).toFixed(1)} mm ${lift < 0 ? "below" : "above"} the centre`,
    ].map((text) => {
      const line = document.createElement("span");
      line.textContent = text;
      return line;
    }));
  }

  // ---- The strip: inclination and height of the centre of gravity over time ---------------

  let curves;
  const LEFT = 56, RIGHT = 16;
  const along = (t, width) => LEFT + (t - begin) / (end - begin) * (width - LEFT - RIGHT);
  const background = document.createElement("canvas");

  function drawCurves() { // once per size; the cursor is drawn over it in every frame
    const [, width, height] = fit(strip);
    background.width = strip.width;
    background.height = strip.height;
    const pen = background.getContext("2d");
    pen.scale(strip.width / width, strip.height / height);
    pen.font = "12px system-ui, sans-serif";
    const top = 16, band = (height - top - 18) / 2;
    const rows = [["β in rad", [["beta", COLOUR.ink]]],
      ["COG in mm (grey: centre)", [["centre", "#999"], ["height", COLOUR.ink]]]];
    rows.forEach(([title, lines], row) => {
      const upper = top + row * band + 14, lower = top + (row + 1) * band - 4;
      const all = lines.map(([name]) => range(curves[name]));
      const low = Math.min(...all.map((r) => r[0])), high = Math.max(...all.map((r) => r[1]));
      const level = (value) => lower - (value - low) / (high - low || 1) * (lower - upper);
      pen.fillStyle = COLOUR.faint;
      pen.textAlign = "left";
      pen.fillText(title, LEFT, upper - 4);
      pen.textAlign = "right";
      pen.fillText(high.toFixed(row ? 1 : 2), LEFT - 5, upper + 6);
      pen.fillText(low.toFixed(row ? 1 : 2), LEFT - 5, lower + 3);
      lines.forEach(([name, colour]) => {
        pen.beginPath();
        times.forEach((t, i) => pen.lineTo(along(t, width), level(curves[name][i])));
        pen.strokeStyle = colour;
        pen.lineWidth = 1.3;
        pen.stroke();
      });
    });
    const tick = nice((end - begin) / (width / 90));
    pen.textAlign = "center";
    pen.fillStyle = COLOUR.faint;
    for (let k = Math.ceil(begin / tick - 1e-9); k * tick <= end + 1e-9; k++) {
      const text = `${+(k * tick).toPrecision(6)}${(k + 1) * tick > end ? " s" : ""}`;
      pen.fillText(text, along(k * tick, width), height - 4);
    }
    let free = 0; // names of phases only where there is room
    data.marks.forEach(([name, time]) => {
      const x = along(time, width), room = pen.measureText(name).width;
      pen.fillStyle = "#0072b2";
      pen.fillRect(x, top - 2, 1, height - top - 16);
      const start = Math.min(x - 2, width - room);
      if (start < free) return;
      pen.textAlign = "left";
      pen.fillText(name, start, 11);
      free = start + room + 8;
    });
  }

  function drawStrip(t) {
    const pen = strip.getContext("2d"), width = strip.clientWidth;
    pen.save();
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, strip.width, strip.height);
    if (background.width) pen.drawImage(background, 0, 0);
    pen.restore();
    pen.fillStyle = "#d00000";
    pen.fillRect(along(t, width) - 1, 14, 2, strip.clientHeight - 32);
  }

  // ---- Controls ---------------------------------------------------------------------------

  const play = find(".play"), slider = find(".time"), speed = find(".speed");
  let time = begin, playing = false, last = null;

  function show(t) {
    time = Math.min(end, Math.max(begin, t));
    slider.value = time;
    slider.setAttribute("aria-valuetext", `${time.toFixed(2)} seconds`);
    drawScene(time);
    drawStrip(time);
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

  // ---- A motion ---------------------------------------------------------------------------

  function load(about, played) {
    data = about;
    ({ times, column, before, pose } = played);
    count = times.length;
    [begin, end] = [times[0], times[count - 1]];
    R = data.radius;
    [TABLE, DISTANCE] = [3 * R, 9 * R];
    [left, right] = range(column.x);
    [near, far] = range(column.y);
    follows = Math.max(right - left, far - near) > 1.5 * R; // a disk that rolls away
    curves = { beta: [], height: [], centre: [] };
    times.forEach((t) => {
      const { beta, height, centre } = pose(t);
      curves.beta.push(beta);
      curves.height.push(1e3 * height);
      curves.centre.push(1e3 * centre[2]);
    });
    slider.min = begin;
    slider.max = end;
    drawCurves();
  }

  const named = (value) => value < 1 ? `1/${+(1 / value).toPrecision(3)}` : `${value}×`;
  load(data, motion);
  const choices = [0.02, 0.05, 0.1, 0.2, 0.5, 1];
  if (end - begin > 5) choices.push(2, 5);
  if (data.speed && !choices.includes(data.speed)) choices.push(data.speed);
  choices.sort((a, b) => a - b).forEach((value) => speed.add(new Option(named(value), value)));
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
  const drag = (canvas, move) => { // calls move with the event and the way since the last one
    let from = null;
    const moved = (event) => {
      move(event, event.clientX - from[0], event.clientY - from[1]);
      from = [event.clientX, event.clientY];
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      from = [event.clientX, event.clientY];
      moved(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) moved(event);
    });
  };
  drag(scene, (event, across, down) => orbit(-0.008 * across, 0.006 * down));
  drag(strip, (event) => {
    const part = (event.offsetX - LEFT) / (strip.clientWidth - LEFT - RIGHT);
    show(begin + part * (end - begin));
  });
  root.addEventListener("keydown", (event) => {
    if (event.target !== scene && !(event.target === slider && event.key === " ")) return;
    const action = {
      " ": toggle,
      ArrowLeft: () => show(time - 0.1 * rate()),
      ArrowRight: () => show(time + 0.1 * rate()),
      ArrowUp: () => orbit(0, 0.05),
      ArrowDown: () => orbit(0, -0.05),
      "+": () => zoom(1.25),
      "-": () => zoom(0.8),
    }[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
  new ResizeObserver(() => { drawCurves(); show(time); }).observe(root);

  const asked = /^#t=(\d*\.?\d+)$/.exec(location.hash); // page.html#t=0.4 shows that instant
  show(asked ? +asked[1] : begin);
  if ("alone" in root.dataset) {
    scene.focus({ preventScroll: true });
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (!asked && !calm) toggle();
  }
  return (about, played) => { load(about, played); show(begin); };
}

if (typeof document !== "undefined") { // a test asks for poses alone
  const root = document.currentScript.closest(".disk-player");
  const told = root.querySelector('script[type="application/json"]');
  if (told) {
    const data = JSON.parse(told.textContent);
    diskPlayer(root, data, diskMotion(data));
  }
}
