// SPDX-License-Identifier: Apache-2.0
// node scenario.mjs STATION [FOLDER]: starts `STATION`, plays in headless Chromium what an engineer does with the
// bolt and nut, and checks what page and files have. A picture is left in FOLDER. Needs playwright-core (npm ci in
// io/viewer) and chromium; exit code 77 without them, 1 if a fact does not hold.
import { execSync, spawn } from 'node:child_process';
import { existsSync, mkdtempSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';

const [station, folder = mkdtempSync(join(tmpdir(), 'aussois-'))] = process.argv.slice(2);
const skip = why => { console.log(`skipped: ${why}`); process.exit(77); };
const browserPath = process.env.CHROMIUM || (() => { try { return execSync('command -v chromium').toString().trim(); } catch { return ''; } })();
if (!browserPath) skip('no chromium');
const { chromium } = await import(new URL('../../io/viewer/node_modules/playwright-core/index.mjs', import.meta.url).href).catch(() => skip('no playwright-core: npm ci in io/viewer'));

const failures = [];
const must = (fact, truth) => { if (!truth) failures.push(fact); };
function start() {
  const child = spawn(station, ['--builtin', 'bolt_nut', '-o', folder, '--summary', join(folder, 'summary.json')], { stdio: ['ignore', 'pipe', 'inherit'] });
  const lines = createInterface({ input: child.stdout });
  process.on('exit', () => child.kill('SIGKILL'));
  return new Promise(resolve => lines.on('line', line => line.startsWith('http://') ? resolve({ child, address: line }) : console.log(line)));
}
const { child, address } = await start();
const browser = await chromium.launch({ executablePath: browserPath, args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'] });
async function open(scheme = 'light') {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, colorScheme: scheme });
  page.setDefaultTimeout(120000);  // software drawing on a busy machine
  page.on('pageerror', error => failures.push(error.message));
  page.on('console', message => message.type() === 'error' && failures.push(message.text()));
  page.on('request', request => must(`foreign request ${request.url()}`, /^(https?|ws|blob|data):(\/\/127\.0\.0\.1:)?/.test(request.url())));
  await page.goto(address);
  await page.waitForFunction(() => live.ready && live.frames > 3, null, { polling: 100 });
  return page;
}
const until = (page, what, argument) => page.waitForFunction(what, argument, { polling: 100 });

const page = await open();
must('isolated page: fine clock', await page.evaluate(() => crossOriginIsolated));
must('the first page is in control', await page.evaluate(() => live.role === 'controller'));
const viewer = await open('dark');
must('a second page watches', await viewer.evaluate(() => live.role === 'viewer'));

// Grab by the mouse at a point of the nut, and push it across its axis: it hits
await page.bringToFront();
const grip = await page.evaluate(() => {
  const [x, y, z] = live.frame.poses[live.stage.moving], box = live.stage.renderer.domElement.getBoundingClientRect();
  for (let k = 0; k < 400; ++k) {  // a point of the part that the eye sees
    const px = box.left + box.width * (0.3 + 0.4 * (k % 20) / 20), py = box.top + box.height * (0.3 + 0.4 * Math.floor(k / 20) / 20);
    if (live.stage.pick(px, py)) return [px, py];
  }
  return null;
});
must('the part can be hit by the mouse', grip);
await page.mouse.move(...grip);
await page.mouse.down();
await until(page, () => live.frame.held);
await page.mouse.move(grip[0] + 60, grip[1], { steps: 10 });
await until(page, () => live.frame.contacts.some(c => Math.hypot(...c.force) > 0) && Math.hypot(...live.frame.pull) > 0);
must('meshes never touch', await page.evaluate(() => live.frame.distance > 0));
await until(page, () => live.events.some(event => event.what === 'touch'));
await page.screenshot({ path: join(folder, 'held.png') });
await page.mouse.up();
await viewer.evaluate(() => { live.hand.mode = 1; live.hand.grip = [0, 0, 0]; live.hand.target.set(1, 1, 1); });
await page.waitForTimeout(500);
must('a viewer moves nothing', await page.evaluate(() => Math.hypot(...live.frame.poses[live.stage.moving].slice(0, 3)) < 0.1));

// Mark, go back to before the touch, and on by the keyboard
page.once('dialog', dialog => dialog.accept('pushed across'));
await page.keyboard.press('m');
await until(page, () => live.events.some(event => event.text === 'pushed across'));
const touch = await page.evaluate(() => live.events.find(event => event.what === 'touch').moment);
const before = await page.evaluate(() => live.frame.moment);
await page.evaluate(moment => { document.getElementById('time').value = moment; document.getElementById('time').dispatchEvent(new Event('input')); }, Math.max(0, touch - 50));
await until(page, moment => live.frame.paused && live.frame.moment === moment, Math.max(0, touch - 50));
must('going back shows no contact', await page.evaluate(() => live.frame.contacts.every(c => Math.hypot(...c.force) === 0)));
await page.locator('#gl').focus();
await page.keyboard.press('Control+ArrowUp');
await until(page, () => live.frame.take === 1 && live.frame.held);

// Change friction; what cannot be is refused
await page.evaluate(() => { const input = document.getElementById('p-mu'); input.value = '0'; input.dispatchEvent(new Event('change')); });
await until(page, () => live.parameters.find(p => p.name === 'mu').value === 0);
await page.evaluate(() => { const input = document.getElementById('p-mu'); input.value = '-1'; input.dispatchEvent(new Event('change')); });
await until(page, () => live.refused.some(r => r.why.includes('mu = -1')));

// Control changes hands
await viewer.bringToFront();
await viewer.locator('#control').click();
await until(page, () => !document.getElementById('banner').hidden);
await until(viewer, () => live.role === 'controller');
must('the other page watches now', await page.evaluate(() => live.role === 'viewer'));
await viewer.locator('#control').click();
await page.bringToFront();
await page.locator('#control').click();
await until(page, () => live.role === 'controller');

// A page that draws slowly skips frames, and what it draws is new
const skipped = await page.evaluate(() => { live.block = 100; return live.frame.skipped; });
await page.waitForTimeout(3000);
must('frames are skipped for a slow page', await page.evaluate(() => { live.block = 0; return live.frame.skipped; }) > skipped);

// Save, then a browser that dies: the hand lets go, the session goes on, a new page takes control
await page.locator('#gl').focus();
await page.keyboard.press('Control+ArrowUp');
await until(page, () => live.frame.held);
await page.locator('#save').click();
await until(page, () => live.saved);
for (const file of ['run.h5', 'replay.html', 'path.csv']) must(`${file} is saved`, existsSync(join(folder, file)));
await page.close();
await viewer.bringToFront();
await until(viewer, () => !live.frame.held);
const now = await viewer.evaluate(() => live.frame.moment);
await until(viewer, moment => live.frame.moment > moment + 100, now);
await viewer.screenshot({ path: join(folder, 'dark.png') });
const contrast = await viewer.evaluate(() => {
  const rgb = text => text.match(/[\d.]+/g).slice(0, 3).map(Number), light = text => {
    const [r, g, b] = rgb(text).map(x => x / 255).map(x => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const paper = light(getComputedStyle(document.body).backgroundColor);
  return Math.min(...[...document.querySelectorAll('dt, dd, h2, label, .hint, #role, #status')].map(e => {
    const ink = light(getComputedStyle(e).color);
    return (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05);
  }));
});
must(`contrast ${contrast.toFixed(2)} is at least 4.5`, contrast >= 4.5);
await browser.close();
child.kill('SIGINT');
const code = await new Promise(resolve => child.once('close', resolve));
must(`the station ends well, not with ${code}`, code === 0);
must('the session is saved', existsSync(join(folder, 'session.h5')));
console.log(failures.length ? `FAILED\n${failures.join('\n')}` : 'ok');
process.exit(failures.length ? 1 : 0);
