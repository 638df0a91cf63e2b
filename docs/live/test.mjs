// SPDX-License-Identifier: MIT
// node test.mjs BUILD PICTURES: the test of the live page in headless Chromium. In BUILD are site/ and
// the programs; screenshots are written to PICTURES.
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { extname, join, normalize, resolve } from 'node:path';

const [build, pictures] = process.argv.slice(2).map((path) => resolve(path));
const { chromium } = createRequire(`${build}/npm/`)('playwright-core');
const sizes = { laptop: { width: 1280, height: 800 }, phone: { width: 390, height: 844 } };
const waits = { timeout: 60000 };

let failures = 0;
function check(holds, text) {
  console.log(`${holds ? 'ok  ' : 'FAIL'} ${text}`);
  if (!holds) ++failures;
}

const types = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml',
  '.wasm': 'application/wasm', '.cpp': 'text/plain' };
const server = createServer((request, response) => {
  const path = normalize(new URL(request.url, 'http://localhost').pathname).replace(/\/$/, '/index.html');
  try {
    const content = readFileSync(join(build, 'site', path));
    response.writeHead(200, { 'Content-Type': types[extname(path)] ?? 'application/octet-stream' }).end(content);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((done) => { server.listen(0, '127.0.0.1', done); });
const address = `http://127.0.0.1:${server.address().port}/`;

mkdirSync(pictures, { recursive: true });
const browser = await chromium.launch({ executablePath: '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });
const errors = [];

async function open(size, colorScheme, fragment = '') {
  const context = await browser.newContext({ viewport: sizes[size], colorScheme, deviceScaleFactor: size === 'phone' ? 2 : 1 });
  const page = await context.newPage();
  page.setDefaultTimeout(waits.timeout);
  page.on('console', (message) => { if (message.type() === 'error') errors.push(message.text()); });
  page.on('pageerror', (error) => errors.push(error.message));
  const begin = Date.now();
  await page.goto(address + fragment);
  await page.waitForFunction(() => window.silt?.state()?.time > 0, null, waits);
  return { page, seconds: (Date.now() - begin) / 1000 };
}
const state = (page) => page.evaluate(() => {
  const { time, size, particles } = window.silt.state();
  return { time, size, x: particles[0], y: particles[1] };
});
const untilTime = (page, time) => page.waitForFunction((least) => window.silt.state().time > least, time, { timeout: 120000 });

try {
  const { page, seconds } = await open('laptop', 'light');
  console.log(`     first frames after ${seconds.toFixed(1)} s`);
  const first = await state(page);
  await untilTime(page, first.time + 0.1);
  const later = await state(page);
  check(later.time > first.time && (later.x !== first.x || later.y !== first.y), 'the water moves');
  const drawn = await page.locator('#canvas').screenshot();
  check(drawn.length > 10000, 'something is drawn');

  await page.locator('#pause').click();
  await page.waitForTimeout(300);
  const paused = (await state(page)).time;
  await page.waitForTimeout(400);
  check((await state(page)).time === paused, 'pause stops it');
  await page.locator('#step').click();
  await page.waitForFunction((time) => window.silt.state().time > time, paused);
  const stepped = (await state(page)).time - paused;
  check(stepped > 0 && stepped < 0.005, `a step is ${(1000 * stepped).toFixed(2)} ms`);
  await page.locator('body').press('r');
  await page.waitForFunction((time) => window.silt.state().time < time, paused);
  check(true, 'the key r starts it anew');

  // A slider, and the program beside it.
  const before = (await state(page)).size;
  await page.getByRole('slider', { name: 'Particle spacing' }).fill('0.04');
  await page.waitForFunction((size) => window.silt.state().size < size, before);
  check((await page.locator('#code').textContent()).includes('constexpr double spacing = 0.04;'),
    'the slider of the spacing changes particles and program');
  const field = (name) => page.getByLabel(`${name}, any number`);
  const type = async (name, text) => {
    await field(name).fill(text);
    await field(name).press('Enter');
  };
  const marked = () => page.locator('[aria-invalid=true]').evaluateAll((all) => all.map((one) => one.ariaLabel).join());
  for (const [name, text, good, sentence] of [
    ['Width of the column', '3', '0.4', 'the column has 75 spacings, but the tank has 40'],
    ['Particle spacing', '-0.02', '0.04', 'Tank: spacing = -0.02 must be positive; give a value above 0'],
    ['Particle spacing', '0.0001', '0.03', 'more than the 20000 of this page'],
  ]) {
    await type(name, text);
    await page.waitForFunction((part) => document.querySelector('#refused').textContent.includes(part), sentence);
    const said = await page.locator('#refused').textContent();
    check(await page.locator('#refused').isVisible() && await marked() === `${name}, any number`,
      `a value out of range, at ${await marked()}: ${said}`);
    await page.screenshot({ path: `${pictures}/refused.png` });
    await type(name, good);
    await page.locator('#refused').waitFor({ state: 'hidden' });
    await untilTime(page, 0.02);
    check(await marked() === '', `${good} runs`);
  }

  // Gravity along the floor carries the grains there.
  await page.getByRole('button', { name: 'Broken tower' }).click();
  await page.waitForFunction(() => window.silt.state().size === 257);
  await page.getByRole('slider', { name: 'Tilt of gravity' }).fill('45');
  await untilTime(page, 0.3);
  const mean = await page.evaluate(() => {
    const { particles, size } = window.silt.state();
    let sum = 0;
    for (let k = 0; k < particles.length; k += 5) sum += particles[k] / size;
    return sum;
  });
  await type('Tilt of gravity', 'abc');
  const tilted = (await state(page)).time;
  await untilTime(page, tilted + 0.05);
  check(await field('Tilt of gravity').inputValue() === '45', 'a tilt that is not a number changes nothing');
  check(mean > 0.05, `tilted gravity moves the tower by ${mean.toFixed(2)} m in 0.3 s`);
  await page.getByText('Spin', { exact: true }).click();
  check((await page.locator('#most').textContent()).includes('rad/s'), 'colours show the spin');

  // A floor at rest, as in the program.
  await page.evaluate(() => { location.hash = '#vibrating_floor'; });
  await page.waitForFunction(() => document.querySelector('#file').textContent === 'vibrating_floor.cpp');
  await type('Frequency of the floor', '0');
  await page.waitForFunction(() => window.silt.state().walls.length === 12 && window.silt.state().time < 0.1);
  await untilTime(page, 0.5);
  const lowest = await page.evaluate(() => window.silt.state().particles.filter((_, k) => k % 6 === 1)
    .reduce((least, y) => Math.min(least, y)));
  check(lowest > 0, `frequency 0: the lowest grain is at ${lowest.toFixed(3)} m`);

  for (const name of await page.evaluate(() => window.silt.scenes)) {
    const expected = execFileSync(`${build}/${name}`, { encoding: 'utf8' }).trim();
    const found = await page.evaluate((scene) => window.silt.hashAtEnd(scene), name);
    check(found === expected, `${name}: ${found} in Chromium, ${expected} natively`);
  }
  await page.context().close();

  // Pictures of all scenes; the times at which they show most.
  const times = { dam_break: 0.42, tower: 0.45, vibrating_floor: 1, hopper: 1, wave_maker: 2.2, floating_body: 0.5 };
  for (const [size, colours] of [['laptop', 'light'], ['laptop', 'dark'], ['phone', 'light'], ['phone', 'dark']]) {
    for (const [name, time] of Object.entries(times)) {
      const { page: shown } = await open(size, colours, `#${name}`);
      await untilTime(shown, time);
      const pace = await shown.locator('#share').textContent();
      if (size === 'laptop' && colours === 'light') console.log(`     ${name}: ${pace}, drawn by software`);
      await shown.locator('#pause').click();
      await shown.waitForTimeout(300);
      const overflow = await shown.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      if (overflow > 0) check(false, `${name} on a ${size} is ${overflow} pixels too wide`);
      await shown.screenshot({ path: `${pictures}/${name}_${size}_${colours}.png` });
      if (name === 'dam_break') {
        await shown.screenshot({ path: `${pictures}/whole_${size}_${colours}.png`, fullPage: true });
      }
      await shown.context().close();
    }
  }
  check(errors.length === 0, `no error in the console${errors.map((error) => `\n     ${error}`).join('')}`);
} catch (error) {
  check(false, `${error.message}${errors.map((text) => `\n     ${text}`).join('')}`);
} finally {
  await browser.close();
  server.close();
}
process.exitCode = failures > 0 ? 1 : 0;
