// SPDX-License-Identifier: Apache-2.0
// The blob that io/html_page.cpp pastes into the page: base64(gzip(u32 n, JSON of n bytes, arrays of 4-byte numbers)).

/** Returns the JSON header with `array(name)`, a Float32Array or Int32Array. */
export async function readRun(element) {
  const packed = Uint8Array.from(atob(element.textContent.trim()), c => c.charCodeAt(0));
  element.textContent = '';
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  const bytes = await new Response(stream).arrayBuffer();
  const length = new Uint32Array(bytes, 0, 1)[0];
  const run = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  const arrays = new Map();
  let at = 4 + length;
  for (const entry of run.arrays) {
    const [, name, type, count] = entry.match(/^(.*):(f32|i32):(\d+)$/);
    arrays.set(name, new (type === 'f32' ? Float32Array : Int32Array)(bytes, at, +count));
    at += 4 * count;
  }
  return { ...run, frames: run.step?.length ?? 0, array: name => arrays.get(name) };
}
