// SPDX-License-Identifier: Apache-2.0
// npm ci in io/viewer, then node build.mjs: live.js + stage.js + ... + three.js -> dist/, plain ASCII, committed and
// embedded in the library. dist/built.txt holds digests of the sources and of what was built, which the house test
// `live_page_is_built` checks.
import { build } from '../../io/viewer/node_modules/esbuild/lib/main.js';
import { createHash } from 'node:crypto';
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';

const here = name => new URL(name, import.meta.url);
const text = name => readFileSync(here(name), 'utf8');
const shared = ['format.js', 'scene.js', 'package-lock.json'].map(name => `../../io/viewer/${name}`);

const bundle = async (entry, notice) => {
  const out = await build({ entryPoints: [here(entry).pathname], bundle: true, minify: true, write: false, format: 'esm', target: 'es2022',
    charset: 'ascii', legalComments: 'none', nodePaths: [here('../../io/viewer/node_modules').pathname] });
  return `// SPDX-License-Identifier: Apache-2.0\n${notice}${out.outputFiles[0].text}`;
};
const notice = `/* three.js\n${text('../../io/viewer/LICENSE.three.txt').trim().replaceAll('\u00a9', '(c)')}\n*/\n`;
const built = {
  'live.html': text('live.html'), 'live.css': text('live.css'),
  'live.js': await bundle('live.js', notice), 'live_worker.js': await bundle('live_worker.js', ''),
};
const digest = createHash('sha256');
const add = (name, content) => digest.update(name + '\0').update(content).update('\0');
for (const name of [...readdirSync(here('.')).filter(name => /\.(js|mjs|css|html)$/.test(name)).sort(), ...shared]) add(name, text(name));
const sources = digest.digest('hex'), own = createHash('sha256');
for (const [name, content] of Object.entries(built)) {
  const stray = content.search(/[^\x00-\x7f]/);
  if (stray >= 0) throw new Error(`${name}: not ASCII at ${stray}: ${content.slice(stray, stray + 20)}`);
  own.update(name + '\0').update(content).update('\0');
  writeFileSync(here(`dist/${name}`), content);
  console.log(`${name} ${(content.length / 1024).toFixed(0)} KiB`);
}
writeFileSync(here('dist/built.txt'), `sources ${sources}\nbuilt ${own.digest('hex')}\n`);
