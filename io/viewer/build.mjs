// SPDX-License-Identifier: Apache-2.0
// npm install && npm run build: page.html + page.css + main.js + three.js -> dist/template.html, one plain ASCII file that
// is committed and embedded in the library. Building Aussois needs no node; changing the page does. It carries digests
// of what it was built from and of itself, which the house test `viewer_is_built` checks.
import { build } from 'esbuild';
import { createHash } from 'node:crypto';
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';

const here = name => new URL(name, import.meta.url);
const text = name => readFileSync(here(name), 'utf8');

const bundled = await build({
  entryPoints: [here('main.js').pathname],
  bundle: true, minify: true, write: false,
  format: 'esm', target: 'es2022', charset: 'ascii', legalComments: 'none',
});
const script = bundled.outputFiles[0].text.replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--').trim();
const notice = text('LICENSE.three.txt').trim().replaceAll('\u00a9', '(c)');

const sources = readdirSync(here('.')).filter(name => /\.(js|mjs|css|html|txt)$|^package(-lock)?\.json$/.test(name)).sort();
const digest = sources.reduce((sha, name) => sha.update(name + '\0').update(text(name)).update('\0'), createHash('sha256')).digest('hex');

const plain = text('page.html')
  .replace('/*STYLE*/', () => text('page.css').trim())
  .replace('/*SCRIPT*/', () => `/* three.js\n${notice}\n*/\n${script}`);
const own = createHash('sha256').update(plain).digest('hex');
const page = plain.replace('<head>', () => `<head>\n<!-- built from sources ${digest}, page ${own} -->`);
const stray = page.search(/[^\x00-\x7f]/);
if (stray >= 0) throw new Error(`not ASCII at ${stray}: ${page.slice(stray, stray + 20)}`);
writeFileSync(here('dist/template.html'), page);
console.log(`template.html ${(page.length / 1024).toFixed(0)} KiB`);
