// SPDX-License-Identifier: Apache-2.0
// The picture of a part (io/part_html.cpp): layers of surfaces, lines and points, each with its colours and a switch.
import * as THREE from 'three';
import { Stage } from './scene.js';

const $ = id => document.getElementById(id);
const hex = colour => `#${colour.toString(16).padStart(6, '0')}`;

/** One colour per item, repeated for its corners. */
function colours(items, corners) {
  const rgb = new Float32Array(3 * corners * items.length), colour = new THREE.Color();
  items.forEach((value, i) => {
    colour.setHex(value);
    for (let k = 0; k < corners; ++k) colour.toArray(rgb, 3 * (corners * i + k));
  });
  return new THREE.BufferAttribute(rgb, 3);
}

function makeSurface(run, i) {
  const indexed = new THREE.BufferGeometry();
  indexed.setAttribute('position', new THREE.BufferAttribute(run.array(`surface${i}.vertices`), 3));
  indexed.setIndex(new THREE.BufferAttribute(new Uint32Array(run.array(`surface${i}.faces`)), 1));
  const geometry = indexed.toNonIndexed(), opacity = run.surface_opacity[i], ghost = opacity < 1;
  geometry.setAttribute('color', colours(run.array(`surface${i}.colour`), 3));
  return new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.6, metalness: 0.05, flatShading: true,
    side: ghost ? THREE.FrontSide : THREE.DoubleSide, transparent: ghost, opacity, depthWrite: !ghost,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
}

function makeLines(run, i) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(run.array(`lines${i}.ends`), 3));
  geometry.setAttribute('color', colours(run.array(`lines${i}.colour`), 2));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: true }));
}

function makePoints(run, i) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(run.array(`points${i}.at`), 3));
  geometry.setAttribute('color', colours(run.array(`points${i}.colour`), 1));
  return new THREE.Points(geometry, new THREE.PointsMaterial({ vertexColors: true, size: 5, sizeAttenuation: false }));
}

const element = (parent, kind, text = '') => Object.assign(parent.appendChild(document.createElement(kind)), { textContent: text });

function addSwitch(parent, object, name, shown) {
  object.visible = shown;
  const label = element(parent, 'label'), box = element(label, 'input');
  Object.assign(box, { type: 'checkbox', checked: shown, onchange: () => { object.visible = box.checked; } });
  box.dataset.layer = name;
  label.append(name);
}

export function startPart(run) {
  const stage = new Stage($('gl'));
  document.body.classList.add('part');
  const aside = document.querySelector('aside'), section = $('axis').parentElement;
  $('cut').remove();
  section.remove();
  aside.replaceChildren();
  for (const unused of [document.querySelector('footer'), $('info'), $('follow').parentElement]) unused.remove();
  for (const button of document.querySelectorAll('[data-fit]')) button.remove();

  const layers = element(aside, 'div');
  layers.className = 'layers';
  element(layers, 'h2', 'show');
  const add = (names, shown, make) => names.forEach((name, i) => {
    const object = make(run, i);
    stage.scene.add(object);
    addSwitch(layers, object, name, shown[i] === 1);
    stage.wholeBox.expandByObject(object);
  });
  add(run.surface_name, run.surface_shown, makeSurface);
  add(run.lines_name, run.lines_shown, makeLines);
  add(run.points_name, run.points_shown, makePoints);
  layers.append(section);
  const cut = () => {
    if ($('axis').value) stage.cutAt($('axis').value, +$('depth').value);
    stage.scene.traverse(object => { if (object.material) object.material.clippingPlanes = $('axis').value ? [stage.plane] : null; });
  };
  $('axis').onchange = $('depth').oninput = cut;

  const facts = element(aside, 'table');
  run.fact_name.forEach((name, i) => {
    const row = element(facts, 'tr');
    element(row, 'td', name);
    element(row, 'td', run.fact_text[i]);
  });
  run.legend_text.forEach((text, i) => {
    const line = element($('legend'), 'div'), mark = element(line, 'i');
    mark.style.background = hex(run.legend_colour[i]);
    line.append(text);
  });
  $('title').textContent = run.title;
  $('subtitle').textContent = run.command_line;
  $('subtitle').title = `${run.command_line}\n${run.build}`;

  for (const button of document.querySelectorAll('[data-view]')) button.onclick = () => stage.aim(button.dataset.view, stage.wholeBox);
  addEventListener('keydown', e => {
    const view = ['iso', 'x', 'y', 'z'][+e.key - 1];
    if (view && !e.ctrlKey && !e.metaKey && !e.altKey) stage.aim(view, stage.wholeBox);
  });
  addEventListener('resize', () => stage.resize());
  stage.resize();
  stage.aim('iso', stage.wholeBox);
  stage.renderer.setAnimationLoop(() => stage.render());
  stage.render();
  globalThis.replay = { run, scene: stage, show() {}, play() {} };
}
