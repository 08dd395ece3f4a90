// SPDX-License-Identifier: Apache-2.0
// node shot.mjs REPLAY.html OUT.png [frame] [script]: opens the page in headless Chromium without a network, runs
// `script` in it, saves a picture, plays one second. Exit code 1 if the page reports an error or asks for anything.
import { execSync } from 'node:child_process';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const [file, out, frame = '0', script = ''] = process.argv.slice(2);
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM || execSync('command -v chromium').toString().trim(),
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
const errors = [];
page.on('pageerror', error => errors.push(error.message));
page.on('console', message => message.type() === 'error' && errors.push(message.text()));
page.on('request', request => /^(file|data|blob):/.test(request.url()) || errors.push(`fetches ${request.url()}`));
await page.goto(pathToFileURL(resolve(file)).href);
await page.waitForFunction(() => document.body.dataset.ready === 'yes', null, { timeout: 60000 }).catch(error => errors.push(error.message));
if (!errors.length) {
  await page.evaluate(([k, code]) => { replay.show(k); if (code) new Function(code)(); }, [+frame, script]);
  await page.waitForTimeout(400);
  await page.screenshot({ path: out });
  if (await page.locator('#play').isVisible()) await page.locator('#play').click();
  await page.waitForTimeout(1000);
  const { frames, cost } = await page.evaluate(() => {
    const begin = performance.now();
    for (let k = 0; k < 100; ++k) replay.show(k % Math.max(1, replay.run.frames));
    return { frames: replay.run.frames, cost: (performance.now() - begin) / 100 };
  });
  console.log(`${frames} frames; frame change ${cost.toFixed(2)} ms`);
}
console.log(errors.length ? `ERRORS\n${errors.join('\n')}` : 'no page error');
await browser.close();
process.exit(errors.length ? 1 : 0);
