// Motion of the disk for what the sliders say, by the classic Runge-Kutta method.
// `settings` and `equations` come from play.py; `chosen` holds the values of the sliders in SI units.
function spunDisk(settings, equations, chosen) {
  "use strict";
  const distances = settings.disks.map((_, k) => settings.holes[k]);
  const nearest = distances.reduce((best, distance, k) =>
    Math.abs(distance - chosen.hole_distance) < Math.abs(distances[best] - chosen.hole_distance)
      ? k : best, 0);
  const disk = settings.disks[nearest];
  const friction = equations.perSpeed([chosen.coefficient, chosen.smoothing]);
  const functions = {
    sin: Math.sin, cos: Math.cos, sqrt: Math.sqrt, speed: Math.hypot,
    per_speed: (speed) => friction([speed])[0],
  };
  const derivative = equations.derivative(disk.numbers, functions);
  const pose = equations.pose(disk.numbers);
  const braking = disk.braking * chosen.coefficient / chosen.smoothing;
  const parts = Math.ceil(settings.shown / Math.min(settings.step, settings.stable / braking));
  const step = settings.shown / parts;

  const ahead = (state, rate, time) => state.map((value, k) => value + time * rate[k]);
  function advance(state) {
    const a = derivative(state), b = derivative(ahead(state, a, step / 2));
    const c = derivative(ahead(state, b, step / 2)), d = derivative(ahead(state, c, step));
    return state.map((value, k) => value + step / 6 * (a[k] + 2 * (b[k] + c[k]) + d[k]));
  }

  const times = [], column = Object.fromEntries(settings.columns.map((name) => [name, []]));
  const keep = (time, state) => {
    times.push(time);
    pose(state).forEach((value, k) => column[settings.columns[k]].push(value));
  };
  let state = equations.start(disk.numbers)([chosen.beta, settings.gamma, chosen.spin]);
  let ending = "";
  keep(0, state);
  for (let n = 1; n <= Math.round(settings.duration / settings.shown); n++) {
    for (let k = 0; k < parts; k++) state = advance(state);
    // The multiplier of the contact follows the derivative: the force of the table on the disk.
    if (!(derivative(state)[12] > 0)) { ending = "the table would have to hold the disk down"; break; }
    if (!(Math.sin(state[4]) > 0.02)) { ending = "the disk lies nearly flat"; break; }
    keep(n * settings.shown, state);
  }
  return { disk, times, column, ending };
}

if (typeof document !== "undefined") {
  const settings = JSON.parse(document.getElementById("settings").textContent);
  const inputs = [...document.querySelectorAll(".sliders input")];
  const figure = document.querySelector(".disk-player"), told = document.querySelector(".told");
  let replace = null;

  const spin = () => {
    const chosen = Object.fromEntries(inputs.map((input) => [input.name, +input.value]));
    inputs.forEach((input) => {
      const shown = +(input.dataset.factor * input.value).toPrecision(3);
      input.closest("label").querySelector("output").textContent = shown;
    });
    const { disk, times, column, ending } = spunDisk(settings, diskEquations, chosen);
    const about = { radius: disk.radius, shape: disk.shape, marks: [], speed: 0.2, slow: 0.1,
      slowUntil: null };
    const motion = diskPoses(disk.shape, times, column);
    if (replace) replace(about, motion); else replace = diskPlayer(figure, about, motion);
    const heights = times.map((t) => motion.pose(t)).map(({ height, centre }) => height - centre[2]);
    const e = disk.shape.cog[0], over = heights.findIndex((height) => height > 0.9 * e);
    told.textContent = (e === 0 ? "A disk without eccentricity has no upside." : over < 0 ?
      "It does not turn over." : `Upside down after ${times[over].toFixed(2)} s.`) +
      (ending ? ` Ends at ${times[times.length - 1].toFixed(2)} s: ${ending}.` : "");
  };
  inputs.forEach((input) => input.addEventListener("input", spin));
  spin();
}
