// SPDX-License-Identifier: MIT
// node test_node.mjs BUILD: the test of the live page without a browser. In BUILD are silt.wasm and
// the programs. Prints sizes, hashes and times of both.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { brotliCompressSync } from 'node:zlib';
import { compileSimulation } from './simulation.js';
import { scenes, withNumbers } from './scenes.js';

const build = process.argv[2];
const maxKilobytes = 265;
let failures = 0;
function check(holds, text) {
  console.log(`${holds ? 'ok  ' : 'FAIL'} ${text}`);
  if (!holds) ++failures;
}

const bytes = readFileSync(`${build}/silt.wasm`);
const size = brotliCompressSync(bytes).length / 1000;
check(size <= maxKilobytes, `silt.wasm has ${(bytes.length / 1000).toFixed(0)} kB, ${size.toFixed(1)} kB by brotli, `
  + `of at most ${maxKilobytes}`);

const silt = await compileSimulation(bytes);
const native = new Map(execFileSync(`${build}/native`, { encoding: 'utf8' }).trim().split('\n')
  .map((line) => line.split(' ')).map(([name, ...rest]) => [name, rest]));

scenes.forEach((scene, k) => {
  const program = execFileSync(`${build}/${scene.name}`, { encoding: 'utf8' }).trim();
  const [hash, nativeTime] = native.get(scene.name);
  const defaults = scene.numbers.map((number) => number.value);
  const end = silt.endOfProgram(k);
  // Until node has compiled the module with all optimisations.
  silt.start(k, defaults);
  silt.stepUntil(end / 2, 2 ** 30);
  silt.start(k, defaults);
  const particles = silt.observe(0).size;
  const begin = process.cpuUsage();
  const steps = silt.stepUntil(end, 2 ** 30);
  const { user, system } = process.cpuUsage(begin);
  const milliseconds = (user + system) / 1000;
  check(silt.hash() === program && hash === program,
    `${scene.name}: program ${program}, scene ${hash}, WebAssembly ${silt.hash()}`);
  console.log(`     ${particles} ${scene.particles}, ${steps} steps for ${end} s; ${(milliseconds / steps).toFixed(4)} ms/step, `
    + `${nativeTime} natively: ${(nativeTime * steps / milliseconds).toFixed(2)} of native speed, `
    + `${(1000 * end / milliseconds).toFixed(2)} of real time`);

  // Gravity turned and turned back before the first step changes no bit.
  silt.start(k, defaults);
  silt.tilt(0.5);
  silt.tilt(0);
  silt.stepUntil(end / 20, 2 ** 30);
  const level = silt.hash();
  silt.start(k, defaults);
  silt.stepUntil(end / 20, 2 ** 30);
  check(silt.hash() === level, `${scene.name}: the same bits without tilt`);

  const text = readFileSync(new URL(`programs/${scene.name}.cpp`, import.meta.url), 'utf8');
  check(withNumbers(text, scene, defaults) === text, `${scene.name}: the program has the numbers of the sliders`);
  check(scene.numbers.every((number, n) => withNumbers(text, scene, defaults.map((value, m) => m === n ? 77 : value))
    .includes(`constexpr double ${number.name} = 77;`)), `${scene.name}: each slider changes the program`);
});

// The ends of the sliders of the landslide run, and so does it when it is tilted: grains among water are
// refused where too few neighbours are left.
const slide = scenes.findIndex((scene) => scene.name === 'landslide');
const slideDefaults = scenes[slide].numbers.map((number) => number.value);
scenes[slide].numbers.forEach((number, n) => {
  for (const end of [number.least, number.most]) {
    let failure = '';
    try {
      silt.start(slide, slideDefaults.map((value, m) => m === n ? end : value));
      silt.tilt(0.5);
      silt.stepUntil(0.6, 2 ** 30);
    } catch (error) {
      failure = error.message;
    }
    check(failure === '', `landslide: ${number.name} = ${end}, tilted ${failure}`);
  }
});

function message(scene, numbers) {
  try {
    silt.start(scene, numbers);
  } catch (error) {
    return error.message;
  }
  return 'no error';
}
check(message(0, [-0.02, 0.4, 0.8, 1e-6]) === 'Tank: spacing = -0.02 must be positive; give a value above 0',
  `refused: ${message(0, [-0.02, 0.4, 0.8, 1e-6])}`);
check(message(1, [0.0125, 0.46, 1.5, 0.5]).includes('restitution = 1.5'), `refused: ${message(1, [0.0125, 0.46, 1.5, 0.5])}`);
check(message(1, [0.0125, 0.46, 0.5, NaN]).includes('not a finite number'), `refused: ${message(1, [0.0125, 0.46, 0.5, NaN])}`);
check(message(1, [0.0125, 0.46, 0.5, 0.5]) === 'no error', 'the next start runs');

process.exitCode = failures > 0 ? 1 : 0;
