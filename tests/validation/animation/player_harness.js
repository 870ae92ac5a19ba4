// Runs the player of a page in Node: node player_harness.js PAGE TIME...
// Prints its poses at some times, and what it draws when it is opened at each of them, and the hull of its body's area.
"use strict";
const page = require("fs").readFileSync(process.argv[2], "utf-8");
const part = (kind) => new RegExp(`<script${kind}>(.*?)</script>`, "s").exec(page)[1];
const text = part(' type="application/json"'), code = part("");
const { Script, createContext } = require("vm");

// Whatever the player asks of a page: numbers where it calculates, elements everywhere else.
const numbers = { clientWidth: 400, clientHeight: 300, width: 0, height: 0, devicePixelRatio: 1 };
function element(drawn) {
  const known = { textContent: text, dataset: {}, value: "" };
  return new Proxy(function () {}, {
    get: (_, name) => {
      if (name in known) return known[name];
      if (name in numbers) return numbers[name];
      if (name === Symbol.iterator) return function* () { yield element(drawn); yield element(drawn); };
      if (name === Symbol.toPrimitive) return () => 0;
      if (name === "getContext") return () => pen(drawn);
      return element(drawn);
    },
    set: (_, name, value) => { known[name] = value; return true; },
    apply: () => element(drawn),
  });
}
function pen(drawn) {
  const set = {};
  return new Proxy({}, {
    get: (_, name) => (...numbers_) => {
      if (numbers_.some((each) => typeof each === "number" && !Number.isFinite(each))) {
        throw new Error(`${String(name)} of ${numbers_}`);
      }
      if (name === "fill") drawn.push(set.fillStyle);
    },
    set: (_, name, value) => { set[name] = value; return true; },
  });
}

const bare = createContext({});
new Script(code).runInContext(bare);
const pose = new Script("diskPoses").runInContext(bare)(JSON.parse(text));
const area = JSON.parse(text).shape.area.map(([x, y]) => [x, y]);
const hull = new Script("hullOf").runInContext(bare)(area);
const found = process.argv.slice(3).map((each) => {
  const drawn = [];
  const document = element(drawn);
  const window = { devicePixelRatio: 1, matchMedia: () => ({ matches: true }) };
  const scope = { document, window, location: { hash: `#t=${each}` }, ...window,
    Option: function () {}, Path2D: function () {}, ResizeObserver: class { observe() {} }, requestAnimationFrame() {} };
  new Script(code).runInContext(createContext(scope));
  return { ...pose(+each), drawn, hull };
});
console.log(JSON.stringify(found));
