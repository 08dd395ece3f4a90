// SPDX-License-Identifier: Apache-2.0
// The replay page: decode the run, build scene and plots, connect the controls. A picture of a part (part.js) comes in the
// same page.
import { readRun } from './data.js';
import { power, si } from './format.js';
import { startPart } from './part.js';
import { Plots } from './plots.js';
import { Scene, colours, heatColours } from './scene.js';

const $ = id => document.getElementById(id);

const isSome = values => values.some(x => Number.isFinite(x) && x !== 0);
const pushes = run => isSome(run.array('contact.force'));

// Of the free axes of a joint, in order (mechanics/joint.hpp).
const jointAxes = { revolute: ['rad'], prismatic: ['m'], cylindrical: ['m', 'rad'], universal: ['rad', 'rad'], planar: ['m', 'm', 'rad'], screw: ['rad'] };
/** A row per joint: where it is along its free axes, what it holds, and what stops, friction and motors do. */
function makeJoints(run) {
  const names = run.joint_name ?? [], table = $('joints');
  if (!names.length) return () => {};
  const row = texts => {
    const line = document.createElement('tr');
    line.append(...texts.map(text => Object.assign(document.createElement('td'), { textContent: text })));
    return line;
  };
  const three = (name, i) => [...run.array(name).slice(3 * i, 3 * i + 3)];
  return frame => table.replaceChildren(row(['joint', 'at', 'holds', 'on its axes']), ...names.map((name, j) => {
    const at = frame * names.length + j, axes = jointAxes[run.joint_kind[j]] ?? [];
    const list = (values, unit) => axes.map((axis, i) => si(values[i], unit(axis))).join(', ') || '\u2013';
    return row([`${name} (${run.joint_kind[j]})`, list(three('joint.coordinate', at), axis => axis),
      `${si(run.array('joint.force')[at], 'N')}, ${si(run.array('joint.torque')[at], 'N m')}`,
      list(three('joint.effort', at), axis => axis === 'm' ? 'N' : 'N m')]);
  }));
}

function describe(run, scene) {
  const hex = colour => `#${colour.toString(16).padStart(6, '0')}`;
  const entry = (colour, text, kind = '') => {
    const line = $('legend').appendChild(document.createElement('div')), mark = line.appendChild(document.createElement('i'));
    mark.style.background = hex(colour);
    mark.className = kind;
    line.append(text);
  };
  run.body_name.forEach((name, i) => {
    const size = scene.laid[i].isEmpty() ? [] : scene.laid[i].getSize(scene.camera.position.clone()).toArray().filter(x => x > 0);
    const skin = scene.bodies[i].children.find(part => part.name === 'skin');
    const box = size.length ? `  ${size.map(x => si(x, 'm')).join(' \u00d7 ')}` : '';
    if (run.body_name.length <= 8) entry(skin?.material.color.getHex() ?? 0x888888, `${name}${run.body_fixed[i] ? ' (fixed)' : ''}${box}`);
  });
  if (run.array('contact.gap').length) {
    entry(colours.open, 'contact, gap \u2265 0; pale behind a surface');
    entry(colours.overlap, 'contact, gap < 0');
    if (pushes(run)) entry(colours.force, 'contact force on the moving part', 'bar');
    entry(colours.normal, 'contact normal', 'bar');
  }
  for (const [what, { unit, largest }] of scene.fields) {
    const line = $('loads').appendChild(document.createElement('div')), bar = document.createElement('i');
    bar.style.background = `linear-gradient(to right, ${heatColours.join(', ')})`;
    line.append('0 ', bar, ` ${unit === '-' ? largest.toPrecision(3) : si(largest, unit)}, ${what}`);
  }
  $('title').textContent = run.title || 'Aussois replay';
  $('subtitle').textContent = run.command_line;
  $('subtitle').title = `${run.command_line}\n${run.build}`;
  if (run.frames < run.recorded) $('note').textContent = `${run.frames} of ${run.recorded} recorded steps shown; curves keep every peak`;
}

function start(run) {
  const scene = new Scene($('gl'), run), time = run.array('frame.time'), value = name => run.array(`frame.${name}`);
  const last = run.frames - 1, duration = time[last] - time[0];
  let frame = 0, playing = false, clock = time[0];

  const frameAt = t => {  // the last frame that is not later than t
    let lo = 0, hi = last;
    while (lo < hi) { const mid = (lo + hi + 1) >> 1; if (time[mid] <= t) lo = mid; else hi = mid - 1; }
    return lo;
  };
  const joints = makeJoints(run), pulls = isSome(value('coupling'));
  const plots = new Plots($('plots'), run, t => { clock = t; show(frameAt(t)); });
  const contactsOf = () => ({ dots: $('dots').checked, normals: $('normals').checked, forces: $('forces').checked,
    scale: 10 ** $('scale').value, dotSize: 10 ** ($('size').value / 2), load: $('load').checked });

  function show(k) {
    frame = Math.max(0, Math.min(last, k));
    $('loads').hidden = !$('load').checked;
    scene.show(frame, contactsOf());
    plots.draw(frame, time[frame]);
    joints(frame);
    $('time').value = frame;
    const found = [['contacts', value('contacts')[frame]], ['smallest gap', si(value('min_gap')[frame], 'm')]];
    const facts = last === 0 ? found : [['t', si(time[frame], 's', 4)], ['step', run.step[frame]], ['h', si(value('h')[frame], 's')], ...found,
      ...(pulls ? [['pull', si(value('coupling')[frame], 'N')]] : []), ['contacts push', si(value('contact_force')[frame], 'N')],
      ['kinetic energy', si(value('kinetic')[frame], 'J')], ['sweeps', value('iterations')[frame]], ['residual', power(value('residual')[frame])]];
    $('info').replaceChildren(...facts.map(([name, text]) => {
      const fact = document.createElement('div'), label = document.createElement('span'), number = document.createElement('b');
      label.textContent = `${name} `;
      number.textContent = text;
      fact.append(label, number);
      return fact;
    }));
  }
  function play(on) {
    playing = on;
    $('play').textContent = on ? 'Pause' : 'Play';
    if (on && frame === last) show(0);
    clock = time[frame];
  }
  const dress = () => scene.dress({ opacity: +$('opacity').value, edges: $('edges').checked, path: $('path').checked,
    axis: $('axis').value, cut: $('cut').value, depth: +$('depth').value });
  const secondsPerSecond = () => ({ real: 1, slow: 0.1 })[$('speed').value] ?? duration / +$('speed').value;

  $('time').max = last;
  $('time').oninput = e => { clock = time[+e.target.value]; show(+e.target.value); };
  $('play').onclick = () => play(!playing);
  for (const id of ['dots', 'normals', 'forces', 'load', 'scale', 'size']) $(id).oninput = () => show(frame);
  for (const id of ['opacity', 'edges', 'path', 'axis', 'cut', 'depth']) $(id).oninput = dress;
  $('follow').onchange = e => { scene.follow = e.target.checked; };
  for (const button of document.querySelectorAll('[data-view]')) button.onclick = () => scene.look(button.dataset.view);
  for (const button of document.querySelectorAll('[data-fit]')) button.onclick = () => scene.look('iso', button.dataset.fit);
  const press = selector => () => document.querySelector(selector).click();
  const keys = { ' ': () => play(!playing), ArrowRight: () => show(frame + 1), ArrowLeft: () => show(frame - 1),
    PageDown: () => show(frame + 25), PageUp: () => show(frame - 25), Home: () => show(0), End: () => show(last),
    1: press('[data-view=iso]'), 2: press('[data-view=x]'), 3: press('[data-view=y]'), 4: press('[data-view=z]'),
    m: press('[data-fit=moving]'), a: press('[data-fit=all]'), n: press('#normals'), f: press('#forces'), c: press('#dots'), l: press('#load') };
  addEventListener('keydown', e => {
    const action = keys[e.key];
    if (!action || e.ctrlKey || e.metaKey || e.altKey || e.target.tagName === 'SELECT') return;
    e.preventDefault();
    if (e.target.tagName !== 'INPUT' || e.target.type !== 'checkbox' || e.key !== ' ') action();
  });
  const resize = () => { scene.resize(); plots.resize(); plots.draw(frame, time[frame]); };
  addEventListener('resize', resize);

  plots.gauges.forEach(({ name }, i) => $('gauge').add(new Option(name, i)));
  $('gauges').hidden = !plots.gauges.length;
  $('gauge').onchange = e => { plots.choose(+e.target.value); plots.resize(); plots.draw(frame, time[frame]); };
  document.querySelector('footer').hidden = last === 0 && !$('note').textContent;  // nothing to play
  if (!pushes(run)) for (const id of ['forces', 'scale']) $(id).parentElement.hidden = true;
  $('load').parentElement.hidden = !scene.fields.size;
  describe(run, scene);
  dress();
  joints(0);
  resize();
  scene.look();
  show(0);
  let before = performance.now();
  scene.renderer.setAnimationLoop(now => {
    if (playing) {
      clock += (now - before) / 1000 * secondsPerSecond();
      const k = frameAt(clock);
      if (k !== frame) show(k);
      if (k === last) play(false);
    }
    before = now;
    scene.render();
  });
  scene.render();
  globalThis.replay = { run, scene, show, play };
}

try {
  const run = await readRun($('run'));
  if (run.kind === 'part') startPart(run);
  else start(run);
  $('message').textContent = '';
  document.title = run.kind === 'part' ? `${run.title} \u2013 Aussois` : `${run.title || 'run'} \u2013 Aussois replay`;
  document.body.dataset.ready = 'yes';
} catch (error) {
  $('message').textContent = `This page cannot be shown: ${error.message}. It needs a browser of 2023 or later with WebGL 2.`;
  throw error;
}
