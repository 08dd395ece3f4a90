// SPDX-License-Identifier: Apache-2.0
// The page of a session: connects, draws the newest frame, sends what the hand wants, and what the engineer asks for.
import { si } from '../../io/viewer/format.js';
import { colours } from '../../io/viewer/scene.js';
import { Hand } from './hand.js';
import { kindOf, kinds, modes, readFrame, readMesh, writeCommand } from './messages.js';
import { LiveStage } from './stage.js';

const $ = id => document.getElementById(id);
const commandPeriod = 8, statusPeriod = 1000;  // [ms]
const meshes = new Map(), worker = new Worker('/live_worker.js');
let welcome = null, stage = null, hand = null, newest = null, sequence = 0, sentAt = 0, saidAt = 0, session = null, frameDrawn = 0;
/** What the page has, for tests. */
const live = globalThis.live = { ready: false, frames: 0, frame: null, role: null, parameters: [], events: [], refused: [], saved: null, closed: null };

const send = text => worker.postMessage({ text });
const controls = () => live.role === 'controller';

function element(tag, properties = {}, ...children) {
  const out = Object.assign(document.createElement(tag), properties);
  out.append(...children);
  return out;
}

function begin(message) {
  $('banner').hidden = true;
  $('title').textContent = document.title = message.title;
  live.parameters = message.parameters;
  showParameters();
  if (session === message.session) return;
  [session, welcome] = [message.session, message];
  stage = null;  // until the meshes are there
  live.ready = false;
  live.events = [];
  $('marks').replaceChildren();
}

function build() {
  if (stage || !welcome || welcome.bodies.some(body => body.mesh && !meshes.has(body.mesh))) return;
  stage = new LiveStage($('gl'), welcome, meshes);
  hand = new Hand(stage, $('gl'), () => controls() && live.frame !== null);
  hand.onLetGo = sendCommand;
  Object.assign(live, { ready: true, stage, hand });
  stage.resize();
  new ResizeObserver(() => stage.resize()).observe($('stage'));
  dress();
  let n = 0;
  $('legend').replaceChildren(...welcome.bodies.filter(body => body.mesh).slice(0, 8).map(body => {
    const colour = body.fixed ? colours.fixed : colours.moving[n++ % colours.moving.length];
    const mark = document.createElement('i');
    mark.style.background = `#${colour.toString(16).padStart(6, '0')}`;
    return element('li', {}, mark, body.name);
  }));
}

// ---- what comes

const takers = {
  welcome: begin,
  role: ({ role, free, pages }) => {
    live.role = role;
    if (role !== 'controller') hand?.letGo();
    $('role').textContent = role === 'controller' ? 'in control' : `watching${free ? '' : ', another page is in control'}`;
    $('control').textContent = role === 'controller' ? 'Give up control' : 'Take control';
    $('role').title = `${pages} pages`;
    for (const id of ['letgo', 'pause', 'mark', 'save', 'back', 'time']) $(id).disabled = role !== 'controller';
    for (const input of $('parameters').querySelectorAll('input')) input.disabled = role !== 'controller';
  },
  control_asked: ({ seconds }) => {
    $('banner').hidden = false;
    $('banner').replaceChildren(`Another page asks for control and gets it in ${seconds} s. `, element('button', { textContent: 'Keep it', onclick: () => { send({ kind: 'keep_control' }); $('banner').hidden = true; } }));
    setTimeout(() => { $('banner').hidden = true; }, 1000 * seconds);
  },
  parameters: ({ parameters }) => { live.parameters = parameters; showParameters(); },
  event: event => {
    live.events.push(event);
    const go = element('button', { textContent: `${event.what}: ${event.text}`, onclick: () => { hand.letGo(); send({ kind: 'seek', take: event.take, moment: event.moment }); } });
    $('marks').append(element('li', {}, `take ${event.take}, ${event.moment}: `, go));
    $('marks').scrollTop = $('marks').scrollHeight;
  },
  refused: refusal => { live.refused.push(refusal); say(`${refusal.what} was refused: ${refusal.why}`); showParameters(); },
  saved: saved => { live.saved = saved; say(`saved: ${saved.text}`); },
  closing: ({ why }) => warn(`The session is over: ${why}`),
};

worker.onmessage = ({ data: { bytes, text, closed } }) => {
  if (text) { takers[text.kind]?.(text); build(); return; }
  if (closed) {
    live.closed = closed;
    hand?.letGo();
    if (closed.again) warn('The connection is lost; trying again.');
    else if ($('banner').hidden) warn(`The session is closed${closed.reason ? `: ${closed.reason}` : ''}.`);
    return;
  }
  if (kindOf(bytes) === kinds.frame) newest = bytes;
  if (kindOf(bytes) === kinds.mesh) {
    const mesh = readMesh(bytes);
    meshes.set(mesh.hash, mesh);
    worker.postMessage({ have: [...meshes.keys()] });
    build();
  }
};

function warn(text) { $('banner').hidden = false; $('banner').textContent = text; }
function say(text) { $('status').textContent = text; saidAt = performance.now(); }

// ---- what is shown

function showParameters() {
  if (document.activeElement?.closest('#parameters') && live.parameters.length === $('parameters').children.length) return;
  $('parameters').replaceChildren(...live.parameters.map(({ name, value, what, unit, bound }) => {
    const id = `p-${name}`, input = element('input', { id, type: 'number', step: 'any', value: value ?? '', placeholder: value === null ? 'none' : '', disabled: !controls(), title: `${what}; ${bound}` });
    input.onchange = () => { input.blur(); if (input.value === '') showParameters(); else send({ kind: 'set', name, value: Number(input.value) }); };
    return element('div', { className: 'row' }, element('label', { htmlFor: id, textContent: name, title: what }), input, element('span', { textContent: unit === '-' ? '' : unit }));
  }));
}

const size = values => Math.hypot(...values);
function showFacts(frame) {
  const facts = [['time', si(frame.t, 's', 4)], ['distance', Number.isFinite(frame.distance) ? `at least ${si(frame.distance, 'm')}` : 'far apart'],
    ['hand', `${si(size(frame.pull), 'N')}, ${si(size(frame.torque), 'N m')}${frame.limit ? ' (limit)' : ''}`],
    ['contacts', frame.contacts.length < frame.allContacts ? `${frame.contacts.length} of ${frame.allContacts}` : `${frame.allContacts}`],
    ['state', frame.refused ? 'step refused' : frame.unsolved ? 'not solved' : frame.paused ? 'paused' : frame.held ? 'held' : 'free']];
  $('facts').replaceChildren(...facts.flatMap(([name, text]) => [element('dt', { textContent: name }), element('dd', { textContent: text })]));
  $('largest').replaceChildren(...frame.contacts.slice(0, 5).filter(c => size(c.force) > 0).map(c => element('li', { textContent: si(size(c.force), 'N') })));
  $('pace').textContent = frame.paused ? 'paused' : `${frame.slow.toFixed(2)} \u00d7 real time`;
  $('pace').className = frame.paused ? '' : frame.slow >= 0.98 ? 'good' : frame.slow >= 0.5 ? 'fair' : 'bad';
  $('time').max = frame.ends;
  if (document.activeElement !== $('time') || !frame.paused) $('time').value = frame.moment;
  $('moment').textContent = `take ${frame.take}, tick ${frame.moment} of ${frame.ends}`;
  $('pause').textContent = frame.paused ? 'Go on' : 'Pause';
}

function draw() {
  requestAnimationFrame(draw);
  if (!stage) return;
  if (live.block) { const until = performance.now() + live.block; while (performance.now() < until); }  // a slow page, in tests
  hand.firm = document.querySelector('input[name=grip]:checked').value === 'firm';
  hand.readGamepads();
  if (newest) {
    const frame = readFrame(newest);
    newest = null;
    live.frame = frame;
    live.frames += 1;
    frameDrawn = frame.sequence;
    stage.show(frame, { dots: $('dots').checked, forces: $('forces').checked, log: $('log').checked, near: $('near').checked, trace: $('trace').checked, grip: frame.held && hand.grip });
    showFacts(frame);
    sendCommand();
  }
  stage.render();
  if (performance.now() - saidAt > 4 * statusPeriod) say(!live.frame ? 'waiting' : live.frame.allContacts ? `${live.frame.allContacts} contacts` : 'no contact');
}
// At once where a frame was drawn; between frames as often as the hand moves, up to 125 a second.
function sendCommand() {
  sentAt = performance.now();
  worker.postMessage({ bytes: writeCommand(hand.command(frameDrawn), ++sequence) });
}
setInterval(() => {
  if (hand && live.role && controls() && hand.mode !== modes.none && performance.now() - sentAt >= commandPeriod) sendCommand();
}, commandPeriod);

const dress = () => stage?.dress({ opacity: +$('opacity').value, axis: $('axis').value, depth: +$('depth').value });

// ---- what is asked for

const seek = moment => live.frame && (hand.letGo(), send({ kind: 'seek', take: live.frame.take, moment: Math.max(0, Math.round(moment)) }));
const tickOf = () => live.parameters.find(p => p.name === 'tick')?.value ?? 1e-3;
const actions = {
  pause: () => { if (!live.frame) return; hand.letGo(); send({ kind: 'pause', on: !live.frame.paused }); },
  back: () => live.frame && seek(live.frame.moment - 1 / tickOf()),
  mark: () => {
    if (!live.frame) return;
    const { take, moment } = live.frame, text = prompt('Note', '');  // the session goes on meanwhile
    if (text !== null) send({ kind: 'mark', text, take, moment });
  },
  save: () => { say('saving'); send({ kind: 'save' }); },
  letgo: () => hand?.letGo(),
  control: () => send({ kind: controls() ? 'release' : 'take_control' }),
};
for (const [id, act] of Object.entries(actions)) $(id).onclick = act;
$('time').oninput = () => seek(+$('time').value);
for (const id of ['opacity', 'axis', 'depth']) $(id).oninput = dress;
for (const button of document.querySelectorAll('[data-view]')) button.onclick = () => stage?.look(button.dataset.view);
for (const button of document.querySelectorAll('[data-fit]')) button.onclick = () => stage?.look('iso', button.dataset.fit);
if (navigator.hid) Object.assign($('spacemouse'), { hidden: false, onclick: () => hand?.connectSpaceMouse().then(found => say(found ? 'space mouse connected' : 'no space mouse chosen')) });
addEventListener('keydown', event => {
  if (event.target.closest('input[type=number], input[type=range], select')) return;
  if (event.key === 'Escape') hand?.letGo();
  if (event.ctrlKey && event.key === 'z') { event.preventDefault(); actions.back(); }
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  if (event.key === ' ' && !['BUTTON', 'INPUT'].includes(event.target.tagName)) { event.preventDefault(); actions.pause(); }
  if (event.key === 'm') { event.preventDefault(); actions.mark(); }
  if ('1234'.includes(event.key)) stage?.look({ 1: 'iso', 2: 'x', 3: 'y', 4: 'z' }[event.key]);
});

worker.postMessage({ open: `ws://${location.host}/live`, hello: { kind: 'hello', token: location.hash.slice(1), role: 'controller', have: [] } });
requestAnimationFrame(draw);
