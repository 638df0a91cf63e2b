// SPDX-License-Identifier: MIT
// The page: starts the worker, draws what it sends, and passes on what the user changes.
import uPlot from './uPlot.esm.js';
import { Drawing, colourTable, drawBar } from './draw.js';
import { scenes, toText, withNumbers } from './scenes.js';

const budget = 12;         // of the worker for a frame [ms]
const longest = 0.05;      // of a frame [s]: after a pause of the browser nothing is made up for
const maxCurvePoints = 400;
const maxTilt = 60;        // [degrees]

const find = (id) => document.getElementById(id);
const worker = new Worker('worker.js', { type: 'module' });

let scene = 0;             // its number
let values = [];           // those of the sliders
let lastStarted = [];      // those of the last start that was not refused
let isLoaded = false;
let tilt = 0;              // [degrees]
let quantity;
let curve = 'energy';
let isPlaying = true;
let isWaiting = false;     // for a frame of the worker
let key = 0;               // of the last start that was asked for
let shown = null;          // the last frame
let lastAsked = 0;         // [ms]
let drawing;
let plot;
const programs = [];

// --- the worker ----------------------------------------------------------------------------------

const answers = {
  loaded() {
    isLoaded = true;
    for (const id of ['pause', 'step', 'reset', 'copy']) find(id).disabled = false;
    choose(Math.max(0, sceneOfAddress()));
  },
  started(frame) {
    if (frame.key !== key) return;
    isWaiting = false;
    if (!find('failed').hidden) play(true);
    tell(find('refused'), '');
    tell(find('failed'), '');
    lastStarted = values.slice();
    markRefused(false);
    history.times.length = history.kinetic.length = history.potential.length = history.pressure.length = 0;
    pace.length = 0;
    show(frame);
  },
  frame(frame) {
    isWaiting = false;
    if (frame.steps > 0) pace.push({ at: performance.now(), advanced: frame.advanced, steps: frame.steps, spent: frame.spent });
    // A simulation slower than real time need not wait until this frame is drawn.
    if (isPlaying && frame.isLate && !document.hidden) ask();
    show(frame);
  },
  refused({ message, key: of }) {
    if (of !== key) return;
    isWaiting = false;
    tell(find('refused'), message);
    markRefused(true);
  },
  failed({ message }) {
    isWaiting = false;
    play(false);
    tell(find('failed'), message);
  },
  hash({ hash }) {
    hashWanted?.(hash);
    start();
  },
};
worker.onmessage = ({ data }) => answers[data.type](data);
worker.onerror = (event) => tell(find('failed'), `The simulation could not be loaded: ${event.message}`);

function tell(place, message) {
  place.textContent = message;
  place.hidden = message === '';
}

const radians = () => tilt * Math.PI / 180;

function start() {
  isWaiting = true;
  worker.postMessage({ type: 'start', scene, numbers: values, tilt: radians(), quantity: quantity.id, key: ++key });
}

// --- frames --------------------------------------------------------------------------------------

function show(frame) {
  shown = frame;
  record(frame);
  draw();
  describe(frame);
}

function draw() {
  if (!shown || !drawing) return;
  const ink = getComputedStyle(document.documentElement).getPropertyValue('--wall').match(/\w\w/g)
    .map((part) => parseInt(part, 16) / 255);
  drawing.draw(shown, { view: scenes[scene].view, most: quantity.most / (quantity.scale ?? 1), ink, swell: 1.18 });
}

// Asks the worker for the next frame: as much time later as has passed since it was asked before.
function ask() {
  isWaiting = true;
  const now = performance.now();
  const seconds = Math.min(longest, (now - lastAsked) / 1000);
  lastAsked = now;
  worker.postMessage({ type: 'next', seconds, budget });
}
function loop() {
  if (isPlaying && !isWaiting && shown) ask();
  requestAnimationFrame(loop);
}

// Frames of the last second, for the share of real time.
const pace = [];

// "1/6 of real time".
function shareText(share) {
  if (share >= 0.97) return 'real time';
  if (share >= 0.55) return `${share.toFixed(1)} of real time`;
  return `1/${Math.max(2, Math.round(1 / share))} of real time`;
}

let describedAt = 0;
function describe(frame) {
  find('time').textContent = `${frame.time.toFixed(2)} s`;
  const now = performance.now();
  if (now - describedAt < 200 && frame.time > 0 && isPlaying) return;
  describedAt = now;
  find('size').textContent = frame.size.toLocaleString('en-GB');
  const ms = 1000 * frame.timeStep;
  find('timestep').textContent = ms < 0.1 ? `${(1000 * ms).toFixed(1)} µs` : `${ms.toFixed(2)} ms`;
  while (pace.length > 2 && now - pace[0].at > 1500) pace.shift();
  if (!isPlaying) {
    find('share').textContent = 'paused';
  } else if (pace.length > 5 || (pace.length > 1 && pace.at(-1).at - pace[0].at > 1000)) {
    const rest = pace.slice(1);
    const sum = (of) => rest.reduce((all, one) => all + one[of], 0);
    find('share').textContent = shareText(1000 * sum('advanced') / (pace.at(-1).at - pace[0].at));
    const cost = sum('spent') / sum('steps');
    find('cost').textContent = `${cost < 0.1 ? cost.toFixed(3) : cost.toFixed(2)} ms`;
  } else {
    find('share').textContent = '…';
  }
}

// --- curves --------------------------------------------------------------------------------------

const history = { times: [], kinetic: [], potential: [], pressure: [] };
let plottedAt = 0;

function record(frame) {
  if (history.times.length > 0 && frame.time <= history.times.at(-1)) return;
  history.times.push(frame.time);
  history.kinetic.push(frame.kinetic);
  history.potential.push(frame.potential);
  history.pressure.push(frame.pressure / 1000);
  if (history.times.length > 2 * maxCurvePoints) {
    for (const name in history) history[name] = history[name].filter((_, k) => k % 2 === 0);
  }
  const now = performance.now();
  if (now - plottedAt > 100 || frame.time === 0) updatePlot();
}

function updatePlot() {
  plottedAt = performance.now();
  plot?.setData(curve === 'pressure' ? [history.times, history.pressure]
    : [history.times, history.kinetic, history.potential]);
}

function makePlot() {
  plot?.destroy();
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(name).trim();
  const lines = curve === 'pressure' ? [['Pressure', '--accent']]
    : [['Kinetic', '--accent'], ['Potential', '--second']];
  const unit = curve === 'pressure' ? 'kPa' : 'J/m';
  const legend = find('legend');
  legend.replaceChildren(...(lines.length > 1 ? lines : []).map(([name, of]) => {
    const entry = document.createElement('span'), line = document.createElement('i');
    line.style.background = colour(of);
    entry.append(line, name);
    return entry;
  }));
  if (curve === 'pressure') legend.append('Right wall, 5 cm up');
  const width = (texts) => 14 + 7 * Math.max(0, ...texts.map((text) => text.length));  // [pixels], about
  const axis = { stroke: colour('--quiet'), grid: { stroke: colour('--line'), width: 1 }, ticks: { show: false },
    font: '12px system-ui, sans-serif' };
  plot = new uPlot({
    width: find('plot').clientWidth, height: 150, legend: { show: false }, cursor: { show: false }, padding: [8, 8, 0, 0],
    scales: { x: { time: false, range: (_, low, high) => [0, Math.max(0.5, high ?? 0)] } },
    axes: [{ ...axis, size: 26, gap: 4, values: (_, ticks) => ticks.map((tick) => `${tick} s`), space: 60 },
      { ...axis, size: (_, texts) => width(texts ?? []), gap: 6, space: 34,
        values: (_, ticks) => ticks.map((tick) => `${tick.toLocaleString('en-GB')} ${unit}`) }],
    series: [{}, ...lines.map(([label, of]) => ({ label, stroke: colour(of), width: 2, points: { show: false } }))],
  }, [[]], find('plot'));
  updatePlot();
}

// --- what the user changes -----------------------------------------------------------------------

// -1 if it names none.
const sceneOfAddress = () => scenes.findIndex((one) => `#${one.name}` === location.hash);

// Choices of one of several: texts, which one is chosen, and what then happens.
function fillChoice(place, name, texts, chosen, then) {
  place.hidden = texts.length < 2;
  place.replaceChildren(...texts.map((text, k) => {
    const label = document.createElement('label');
    const input = Object.assign(document.createElement('input'), { type: 'radio', name, checked: k === chosen });
    input.addEventListener('change', () => then(k));
    label.append(input, text);
    return label;
  }));
}

function choose(number) {
  scene = number;
  const { text, particles, numbers, quantities, hasGauge, hasSine, name } = scenes[scene];
  values = numbers.map((one) => one.value);
  lastStarted = values.slice();
  tilt = 0;
  [...find('scenes').children].forEach((button, k) => button.setAttribute('aria-pressed', k === scene));
  find('text').textContent = text;
  find('canvas').setAttribute('aria-label', text);
  find('file').textContent = `${name}.cpp`;
  // The frames are in a folder of the name of the scene, which no program may have.
  find('commands').textContent = `g++ -std=c++20 -O3 -ffp-contract=off -I include -I /usr/include/eigen3 \\\n  ${name}.cpp -o program\n./program`;
  tell(find('refused'), '');
  find('kind').textContent = particles[0].toUpperCase() + particles.slice(1);
  find('sine').hidden = !hasSine;
  fillNumbers();
  const setQuantity = (k) => {
    quantity = quantities[k];
    find('most').textContent = `${quantity.most} ${quantity.unit}`;
  };
  setQuantity(0);
  fillChoice(find('quantities'), 'quantity', quantities.map((one) => one.name), 0, (k) => {
    setQuantity(k);
    worker.postMessage({ type: 'colour', quantity: quantity.id });
  });
  curve = 'energy';
  const curves = hasGauge ? ['energy', 'pressure'] : ['energy'];
  fillChoice(find('curves'), 'curve', curves.map((one) => one[0].toUpperCase() + one.slice(1)), 0, (k) => {
    curve = curves[k];
    makePlot();
  });
  makePlot();
  showTilt();
  showProgram();
  play(true);
  start();
}

// A row with a slider and a field, into which any number can be typed.
function numberRow({ label, unit, least, most, step, digits, decades }, value, change) {
  const row = document.createElement('div');
  row.className = 'number';
  const id = `number-${label.toLowerCase().replaceAll(' ', '-')}`;
  const name = Object.assign(document.createElement('label'), { textContent: label, htmlFor: id });
  const field = Object.assign(document.createElement('input'), { type: 'text', inputMode: 'decimal', autocomplete: 'off' });
  field.setAttribute('aria-label', `${label}, any number`);
  const slider = Object.assign(document.createElement('input'), { type: 'range', id, min: least, max: most, step });
  const write = (number) => {
    field.value = decades || digits === undefined ? toText(number) : number.toFixed(digits);
    slider.value = decades ? Math.log10(number) : number;
  };
  write(value);
  slider.addEventListener('input', () => {
    field.value = decades ? toText(Number((10 ** Number(slider.value)).toPrecision(3)))
      : Number(slider.value).toFixed(digits);
    change(Number(field.value));
  });
  field.addEventListener('change', () => {
    const number = field.value.trim() === '' ? NaN : Number(field.value.replace(',', '.'));
    if (Number.isFinite(number)) slider.value = decades ? Math.log10(Math.max(number, 1e-30)) : number;
    change(number);
  });
  field.addEventListener('keydown', (event) => { if (event.key === 'Enter') field.blur(); });
  row.append(name, field, Object.assign(document.createElement('span'), { className: 'unit', textContent: unit }), slider);
  row.write = write;
  return row;
}

let tiltRow;
function fillNumbers() {
  tiltRow = numberRow({ label: 'Tilt of gravity', unit: '°', least: -maxTilt, most: maxTilt, step: 1, digits: 0 }, tilt,
    (value) => Number.isFinite(value) ? setTilt(value) : tiltRow.write(tilt));
  find('numbers').replaceChildren(...scenes[scene].numbers.map((number, k) => numberRow(number, values[k], (value) => {
    values[k] = value;
    showProgram();
    start();
  })), tiltRow);
}

// Marks the fields that were changed since the last start: one of them is the reason.
function markRefused(isRefused) {
  values.forEach((value, k) => {
    const field = find('numbers').children[k].querySelector('input');
    field.setAttribute('aria-invalid', isRefused && !Object.is(value, lastStarted[k]));
  });
}

function setTilt(value) {
  tilt = value;
  showTilt();
  worker.postMessage({ type: 'tilt', angle: radians() });
}
function showTilt() {
  find('gravity').querySelector('svg').style.transform = `rotate(${-tilt}deg)`;
  find('level').hidden = tilt === 0;
}

function play(should) {
  isPlaying = should;
  if (isPlaying) tell(find('failed'), '');
  find('pause').textContent = isPlaying ? 'Pause' : 'Play';
  lastAsked = performance.now();
  pace.length = 0;
  if (shown) { describedAt = 0; describe(shown); }
}
function step() {
  if (!shown) return;
  play(false);
  if (isWaiting) return;
  isWaiting = true;
  worker.postMessage({ type: 'step' });
}

// --- the program ---------------------------------------------------------------------------------

const words = /(\/\/[^\n]*)|("[^"\n]*"|<[a-z_/.]+>)|\b(int|const|constexpr|double|auto|using|namespace|try|catch|return|for|if|continue|struct|static|char)\b|(#include)/g;

// The text as nodes with colours.
function highlighted(text) {
  const nodes = [];
  const element = (name, className, content) => Object.assign(document.createElement(name), { className, textContent: content });
  let end = 0;
  for (const match of text.matchAll(words)) {
    nodes.push(text.slice(end, match.index));
    nodes.push(element('span', match[1] ? 'comment' : match[2] ? 'string' : 'word', match[0]));
    end = match.index + match[0].length;
  }
  nodes.push(text.slice(end));
  return nodes;
}

const programText = () => withNumbers(programs[scene], scenes[scene], values);
function showProgram() {
  if (!programs[scene]) return;
  const nodes = [];
  for (const line of programText().split(/(?<=\n)/)) {
    const [, start, name, value, rest] = line.match(/^(  constexpr double (\w+) = )([^;]+)(;.*\n)$/s) ?? [];
    if (scenes[scene].numbers.some((number) => number.name === name)) {
      nodes.push(...highlighted(start), Object.assign(document.createElement('mark'), { textContent: value }),
        ...highlighted(rest));
    } else {
      nodes.push(...highlighted(line));
    }
  }
  find('code').replaceChildren(...nodes);
}

async function copyProgram() {
  const button = find('copy');
  try {
    await navigator.clipboard.writeText(programText());
    button.textContent = 'Copied';
  } catch {
    getSelection().selectAllChildren(find('code'));
    button.textContent = 'Selected';
  }
  setTimeout(() => { button.textContent = 'Copy'; }, 1500);
}

// --- start ---------------------------------------------------------------------------------------

let hashWanted = null;
// For the test, and for whoever wants to compare: the hash at the end of a scene's program.
window.silt = {
  scenes: scenes.map(({ name }) => name),
  hashAtEnd: (name) => new Promise((resolve) => {
    hashWanted = resolve;
    isWaiting = true;
    const number = scenes.findIndex((one) => one.name === name);
    worker.postMessage({ type: 'hash', scene: number, numbers: scenes[number].numbers.map((one) => one.value) });
  }),
  state: () => shown,
};

find('scenes').replaceChildren(...scenes.map(({ title, method, name }, k) => {
  const button = document.createElement('button');
  button.append(title, Object.assign(document.createElement('small'), { textContent: method }));
  button.addEventListener('click', () => {
    window.history.replaceState(null, '', `#${name}`);
    if (isLoaded) choose(k);
  });
  return button;
}));
find('pause').addEventListener('click', () => play(!isPlaying));
find('step').addEventListener('click', step);
find('reset').addEventListener('click', () => { play(true); start(); });
find('copy').addEventListener('click', copyProgram);
window.addEventListener('hashchange', () => {
  if (isLoaded && sceneOfAddress() >= 0) choose(sceneOfAddress());
});
// Not by the address, which names the scene.
find('to-program').addEventListener('click', (event) => {
  event.preventDefault();
  find('program').focus({ preventScroll: true });
  find('program').scrollIntoView();
});
// By itself, the page is at the root of the server; in the site, below the documentation.
if (new URL('..', location).pathname !== new URL('.', location).pathname) {
  find('home').href = '../';
  find('documentation').hidden = false;
}
find('numbers').addEventListener('submit', (event) => event.preventDefault());

const keys = {
  ' ': () => play(!isPlaying),
  r: () => { play(true); start(); },
  s: step,
  ArrowLeft: () => turn(-5),
  ArrowRight: () => turn(5),
};
function turn(by) {
  const value = Math.max(-maxTilt, Math.min(maxTilt, tilt + by));
  tiltRow.write(value);
  setTilt(value);
}
document.addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (!isLoaded || !Object.hasOwn(keys, event.key)) return;
  const { type, tagName } = event.target;
  const isUsed = type === 'text' || (event.key === ' ' && (tagName === 'BUTTON' || type === 'radio'))
    || (event.key.startsWith('Arrow') && (type === 'range' || type === 'radio' || tagName === 'PRE'));
  if (isUsed) return;
  event.preventDefault();
  keys[event.key]();
});

new ResizeObserver(() => {
  plot?.setSize({ width: find('plot').clientWidth, height: 150 });
  draw();
}).observe(document.querySelector('main'));
const dark = matchMedia('(prefers-color-scheme: dark)');
function paint() {
  drawing.colourBy(colourTable(dark.matches));
  drawBar(find('bar'), colourTable(dark.matches));
  draw();
}
dark.addEventListener('change', () => {
  if (plot) makePlot();
  if (drawing) paint();
});

try {
  drawing = new Drawing(find('canvas'), paint);
  paint();
  await Promise.all(scenes.map(async ({ name }, k) => {
    programs[k] = await (await fetch(`programs/${name}.cpp`)).text();
  }));
  worker.postMessage({ type: 'load', url: 'silt.wasm' });
  requestAnimationFrame(loop);
} catch (error) {
  tell(find('failed'), error.message);
}
