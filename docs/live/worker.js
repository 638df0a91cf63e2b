// SPDX-License-Identifier: MIT
// Runs the simulation beside the page, so that the page never waits for it.
import { compileSimulation } from './simulation.js';

let silt;             // undefined after a trap, until the next start
let bytes;            // of the module
let quantity = 0;
let costPerStep = 1;  // [ms], about

// Steps for at most `budget` [ms] and until the time `until` [s].
function run(until, budget) {
  const begin = performance.now();
  let steps = 0, spent = 0;
  while (spent < budget && silt.time < until * (1 - 1e-12)) {
    const most = Math.max(1, Math.floor(Math.min(3, budget - spent) / costPerStep));
    const before = performance.now();
    const made = silt.stepUntil(until, most);
    if (made === 0) break;
    steps += made;
    const now = performance.now();
    // Clocks of browsers are coarse.
    costPerStep = Math.max(0.002, 0.7 * costPerStep + 0.3 * (now - before) / made);
    spent = now - begin;
  }
  return { steps, spent };
}

function reply(type, more = {}) {
  const state = silt.observe(quantity);
  postMessage({ type, ...state, ...more }, [state.particles.buffer, state.walls.buffer]);
}

const orders = {
  async load({ url }) {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`${url} is missing: ${answer.status}`);
    bytes = await answer.arrayBuffer();
    silt = await compileSimulation(bytes);
    postMessage({ type: 'loaded' });
  },
  async start({ scene, numbers, tilt, key }) {
    try {
      const started = silt ?? await compileSimulation(bytes);
      started.start(scene, numbers);
      silt = started;
    } catch (error) {
      if (isTrap(error)) throw error;
      postMessage({ type: 'refused', message: error.message, key });
      return;
    }
    costPerStep = 1;
    silt.tilt(tilt);
    reply('started', { key });
  },
  tilt({ angle }) { silt.tilt(angle); },
  colour(order) {
    quantity = order.quantity;
    reply('frame', { steps: 0, spent: 0 });
  },
  // A frame later: as much time as has passed, if the budget [ms] suffices.
  next({ seconds, budget }) {
    const before = silt.time;
    const done = run(before + seconds, budget);
    const advanced = silt.time - before;
    reply('frame', { ...done, advanced, isLate: advanced < seconds });
  },
  step() {
    const before = silt.time;
    const done = { steps: silt.stepUntil(Infinity, 1), spent: 0 };
    reply('frame', { ...done, advanced: silt.time - before });
  },
  // The hash at the end of the program of a scene; the scene must be started anew afterwards.
  hash({ scene, numbers }) {
    silt.start(scene, numbers);
    silt.stepUntil(silt.endOfProgram(scene), 2 ** 30);
    postMessage({ type: 'hash', hash: silt.hash() });
  },
};

// After a trap, such as that of a lack of memory, the state of the module is not defined: the next start
// compiles a new one.
const isTrap = (error) => error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
let reason;  // the message of the last trap

async function obey(order) {
  try {
    if (order.quantity !== undefined) quantity = order.quantity;
    if (!silt && order.type !== 'load' && order.type !== 'start') throw new Error(reason);
    await orders[order.type](order);
  } catch (error) {
    if (isTrap(error)) {
      silt = undefined;
      reason = `The simulation has stopped (${error.message}); change a number or press Reset to start it anew`;
    }
    postMessage({ type: 'failed', message: isTrap(error) ? reason : error.message });
  }
}

// One order after the other, also while a module is compiled.
let last = Promise.resolve();
onmessage = ({ data }) => { last = last.then(() => obey(data)); };
