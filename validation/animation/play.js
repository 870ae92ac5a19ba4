// Motion of the disk for what the sliders say, by the classic Runge-Kutta method.
// `settings` and `equations` come from play.py; `chosen` holds the values of the sliders.
function spunDisk(settings, equations, chosen) {
  "use strict";
  const DURATION = 5, SHOWN = 4e-3; // s that are played, and between two poses that are kept
  const disk = settings.disks[chosen.hole];
  const friction = equations.perSpeed([chosen.coefficient, chosen.smoothing]);
  const derivative = equations.derivative(disk.numbers, {
    sin: Math.sin, cos: Math.cos, sqrt: Math.sqrt, speed: Math.hypot,
    per_speed: (speed) => friction([speed])[0],
  });
  const pose = equations.pose(disk.numbers);
  // A step is at most 1 ms, 1.5 times the time in which friction brakes slip, and what a disk that
  // passes by flat, and turns fast there, takes for a twentieth of a radian.
  const braking = disk.braking * chosen.coefficient / chosen.smoothing;
  const longest = Math.min(1e-3, 1.5 / braking), TURN = 0.05;

  const ahead = (state, rate, time) => state.map((value, k) => value + time * rate[k]);
  function advance(state, a, step) {
    const b = derivative(ahead(state, a, step / 2));
    const c = derivative(ahead(state, b, step / 2)), d = derivative(ahead(state, c, step));
    return state.map((value, k) => value + step / 6 * (a[k] + 2 * (b[k] + c[k]) + d[k]));
  }

  const times = [], columns = Object.fromEntries(settings.columns.map((name) => [name, []]));
  let state = equations.start(disk.numbers)([chosen.beta, settings.gamma, chosen.spin]);
  let ending = "";
  for (let n = 0; n <= Math.round(DURATION / SHOWN) && !ending; n++) {
    times.push(n * SHOWN);
    pose(state).forEach((value, k) => columns[settings.columns[k]].push(value));
    for (let left = SHOWN; left > 1e-9 && !ending;) {
      const rates = derivative(state), step = Math.min(left, longest, TURN / Math.abs(rates[3]));
      // The multiplier of the contact follows the rates: the force of the table on the disk.
      if (!(rates[12] > 0)) ending = "the table would have to hold the disk down";
      else if (!(Math.sin(state[4]) > 0.02)) ending = "the disk lies nearly flat";
      state = advance(state, rates, step);
      left -= step;
    }
  }
  return { disk, times, columns, ending, ...turnedOver(settings, disk.shape, times, columns) };
}

// Since when the centre of gravity is up, whether it has stayed up, and until when, in s.
function turnedOver(settings, shape, times, columns) {
  "use strict";
  const motion = diskPoses({ times, columns, shape }), high = settings.reached * shape.cog[0];
  let over = null, kept = false;
  for (const t of times) {
    const lift = motion(t).lift;
    if (lift < 0 && kept) return { over, kept, until: t };
    if (lift < 0) over = null;
    else if (over === null && high > 0 && lift > high) over = t;
    kept = over !== null && t - over >= settings.staying;
  }
  return { over, kept, until: null };
}

if (typeof document !== "undefined") {
  const settings = JSON.parse(document.getElementById("settings").textContent);
  const inputs = [...document.querySelectorAll(".sliders input")];
  const figure = document.querySelector(".disk-player"), told = document.querySelector(".told");
  let replace = null;

  const spin = () => {
    const chosen = Object.fromEntries(inputs.map((input) => [input.name, +input.value]));
    inputs.forEach((input) => {
      input.closest("label").querySelector("output").textContent = +input.value;
    });
    const found = spunDisk(settings, diskEquations, chosen);
    const { disk, times, columns, ending, over, kept, until } = found;
    const data = { ...disk, times, columns, marks: [], speed: 0.2, slow: 0.1, slowUntil: null };
    if (replace) replace(data); else replace = diskPlayer(figure, data);
    told.textContent = (disk.shape.cog[0] === 0 ? "A disk without eccentricity has no upside." :
      over === null ? "It does not turn over and stay so." :
      !kept ? `Up at ${over.toFixed(2)} s; whether it stays so is not decided.` :
      `Upside down after ${over.toFixed(2)} s${until ? `, until ${until.toFixed(2)} s` : ""}.`) +
      (ending ? ` Ends at ${times[times.length - 1].toFixed(2)} s: ${ending}.` : "");
  };
  inputs.forEach((input) => input.addEventListener("input", spin));
  spin();
}
