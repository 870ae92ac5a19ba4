// Integrates the motion of the page on which the disk is spun: node play_harness.js PAGE CHOSEN
"use strict";
const page = require("fs").readFileSync(process.argv[2], "utf-8");
const settings = /<script type="application\/json" id="settings">(.*?)<\/script>/s.exec(page)[1];
const { Script, createContext } = require("vm");
const scope = createContext({});
const code = [...page.matchAll(/<script>(.*?)<\/script>/gs)].map((each) => each[1]).join("\n");
new Script(`${code}\nvar found = (settings, chosen) => spunDisk(settings, diskEquations, chosen);`)
  .runInContext(scope);
console.log(JSON.stringify(scope.found(JSON.parse(settings), JSON.parse(process.argv[3]))));
