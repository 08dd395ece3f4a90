// SPDX-License-Identifier: Apache-2.0
// What stands in the 3D view: bodies, contacts, normals, forces, the path of the moving bodies. Metres, z up.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { toCreasedNormals } from 'three/addons/utils/BufferGeometryUtils.js';

export const colours = {
  fixed: 0xa9b4c2, moving: [0xe3a12f, 0x4c9a78, 0x8b6fc0, 0xc96a4a, 0x4a8fb5],
  open: 0x1769d2, overlap: 0xd4261c, normal: 0x1f8a5b, force: 0xc2185b,
};
const sharpEdge = 28;         // [deg] faces that meet at a larger angle get an edge line and separate normals
const smoothLimit = 400000;   // triangles; larger meshes are shaded flat and without edge lines
const up = new THREE.Vector3(0, 1, 0);

const heatStops = [0x440154, 0x3b528b, 0x21918c, 0x5ec962, 0xfde725].map(hex => new THREE.Color(hex));
export const heatColours = heatStops.map(colour => `#${colour.getHexString()}`);
/** The colour of a share of the largest value, dark to bright; grey for what is no number. */
function heat(share, colour) {
  if (!Number.isFinite(share)) return colour.set(0x808080);
  const at = Math.min(Math.max(share, 0), 1) * (heatStops.length - 1), i = Math.min(Math.floor(at), heatStops.length - 2);
  return colour.lerpColors(heatStops[i], heatStops[i + 1], at - i);
}

/** Instanced arrows of equal width; lengths change, heads do not. */
export class Arrows extends THREE.Group {
  constructor(count, colour) {
    super();
    const material = new THREE.MeshBasicMaterial({ color: colour, depthTest: false, transparent: true, opacity: 0.9 });
    const shaft = new THREE.CylinderGeometry(1, 1, 1, 8).translate(0, 0.5, 0);
    const head = new THREE.ConeGeometry(2.6, 7, 12).translate(0, -3.5, 0);
    this.shaft = new THREE.InstancedMesh(shaft, material, count);
    this.head = new THREE.InstancedMesh(head, material, count);
    for (const mesh of [this.shaft, this.head]) { mesh.frustumCulled = false; mesh.renderOrder = 3; this.add(mesh); }
    this.turn = new THREE.Quaternion();
    this.matrix4 = new THREE.Matrix4();
    this.tip = new THREE.Vector3();
    this.size = new THREE.Vector3();
  }
  begin() { this.shaft.count = 0; }
  put(from, direction, length, width) {
    if (!(length > 0)) return;
    const i = this.shaft.count++, head = Math.min(width, length / 9);
    this.turn.setFromUnitVectors(up, direction);
    this.tip.copy(direction).multiplyScalar(length).add(from);
    this.shaft.setMatrixAt(i, this.matrix4.compose(from, this.turn, this.size.set(width, length - 6 * head, width)));
    this.head.setMatrixAt(i, this.matrix4.compose(this.tip, this.turn, this.size.setScalar(head)));
  }
  end() {
    this.head.count = this.shaft.count;
    this.shaft.instanceMatrix.needsUpdate = this.head.instanceMatrix.needsUpdate = true;
  }
}

/** One mesh of the run as lines, surfaces and dilated points and wires. */
export function makeBody(run, index, colour) {
  const group = new THREE.Group();
  const mesh = run.body_mesh[index];
  if (mesh < 0) return group;
  const vertices = run.array(`mesh${mesh}.vertices`), faces = run.array(`mesh${mesh}.faces`), wires = run.array(`mesh${mesh}.wires`);
  const fixed = run.body_fixed[index] === 1;
  if (faces.length) {
    const indexed = new THREE.BufferGeometry();
    indexed.setAttribute('position', new THREE.BufferAttribute(vertices, 3));
    indexed.setIndex(new THREE.BufferAttribute(new Uint32Array(faces), 1));
    const smooth = faces.length / 3 <= smoothLimit;
    const geometry = smooth ? toCreasedNormals(indexed, sharpEdge * Math.PI / 180) : indexed;
    const skin = new THREE.MeshStandardMaterial({ color: colour, roughness: 0.55, metalness: 0.15, side: THREE.DoubleSide, flatShading: !smooth,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    const inside = new THREE.MeshBasicMaterial({ color: new THREE.Color(colour).multiplyScalar(0.55), side: THREE.BackSide });
    group.add(Object.assign(new THREE.Mesh(geometry, skin), { name: 'skin' }));
    group.add(Object.assign(new THREE.Mesh(geometry, inside), { name: 'inside', visible: false }));
    if (smooth) {
      const line = new THREE.LineBasicMaterial({ color: 0x1c2430, transparent: true, opacity: fixed ? 0.35 : 0.6 });
      group.add(Object.assign(new THREE.LineSegments(new THREE.EdgesGeometry(indexed, sharpEdge), line), { name: 'edges' }));
    }
  }
  const radius = run.body_dilation[index], used = new Set([...faces, ...wires]);
  const material = new THREE.MeshStandardMaterial({ color: colour, roughness: 0.55, metalness: 0.15 });
  const at = i => new THREE.Vector3().fromArray(vertices, 3 * i);
  if (radius > 0) {
    const ball = new THREE.SphereGeometry(radius, 24, 16);
    for (let i = 0; i < vertices.length / 3; ++i)
      if (!used.has(i)) group.add(Object.assign(new THREE.Mesh(ball, material), { name: 'skin' }).translateX(vertices[3 * i]).translateY(vertices[3 * i + 1]).translateZ(vertices[3 * i + 2]));
    for (let i = 0; i < wires.length; i += 2) {
      const a = at(wires[i]), b = at(wires[i + 1]), along = b.clone().sub(a);
      const tube = new THREE.Mesh(new THREE.CapsuleGeometry(radius, along.length(), 6, 16), material);
      tube.position.copy(a).add(b).multiplyScalar(0.5);
      tube.quaternion.setFromUnitVectors(up, along.normalize());
      group.add(Object.assign(tube, { name: 'skin' }));
    }
  } else if (wires.length) {
    const lines = new THREE.BufferGeometry().setFromPoints([...wires].map(at));
    group.add(new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ color: colour })));
  }
  return group;
}

/** Wires as tubes of a radius, with balls where they meet; `follow` puts them where the vertices are. */
function makeTubes(position, wires, radius, material) {
  const ends = [...new Set(wires)];
  const tubes = new THREE.InstancedMesh(new THREE.CylinderGeometry(radius, radius, 1, 20, 1, true), material, wires.length / 2);
  const balls = new THREE.InstancedMesh(new THREE.SphereGeometry(radius, 20, 12), material, ends.length);
  const at = i => new THREE.Vector3().fromBufferAttribute(position, i), turn = new THREE.Quaternion(), one = new THREE.Vector3(1, 1, 1);
  const follow = () => {
    for (let i = 0; i < tubes.count; ++i) {
      const a = at(wires[2 * i]), along = at(wires[2 * i + 1]).sub(a), length = along.length();
      turn.setFromUnitVectors(up, along.clone().divideScalar(length || 1));
      tubes.setMatrixAt(i, new THREE.Matrix4().compose(a.addScaledVector(along, 0.5), turn, new THREE.Vector3(1, length, 1)));
    }
    ends.forEach((v, i) => balls.setMatrixAt(i, new THREE.Matrix4().compose(at(v), turn.identity(), one)));
    tubes.instanceMatrix.needsUpdate = balls.instanceMatrix.needsUpdate = true;
  };
  const paint = shareOf => {
    const colour = new THREE.Color();
    for (let i = 0; i < tubes.count; ++i) tubes.setColorAt(i, heat((shareOf(wires[2 * i]) + shareOf(wires[2 * i + 1])) / 2, colour));
    ends.forEach((v, i) => balls.setColorAt(i, heat(shareOf(v), colour)));
    tubes.instanceColor.needsUpdate = balls.instanceColor.needsUpdate = true;
  };
  const plain = () => { tubes.instanceColor = balls.instanceColor = null; };
  follow();
  return { meshes: [tubes, balls].map(mesh => Object.assign(mesh, { name: 'skin', frustumCulled: false })), follow, paint, plain };
}

/** A body that deforms: flat faces, and wires that are tubes where the body has a dilation. `paint(shareOf)` colours it by a
    number of each vertex, `paint()` as a whole. */
function makeDeforming(run, index, colour) {
  const group = new THREE.Group(), mesh = run.body_mesh[index], radius = run.body_dilation[index];
  const position = new THREE.BufferAttribute(run.array(`mesh${mesh}.vertices`).slice(), 3);
  const shades = new THREE.BufferAttribute(new Float32Array(3 * position.count), 3);
  const over = items => new THREE.BufferGeometry().setAttribute('position', position).setAttribute('color', shades)
    .setIndex(new THREE.BufferAttribute(new Uint32Array(items), 1));
  const faces = run.array(`mesh${mesh}.faces`), wires = run.array(`mesh${mesh}.wires`);
  let tubes = null;
  if (faces.length) {
    const skin = new THREE.MeshStandardMaterial({ color: colour, roughness: 0.55, metalness: 0.15, side: THREE.DoubleSide, flatShading: true });
    group.add(Object.assign(new THREE.Mesh(over(faces), skin), { name: 'skin', frustumCulled: false }));
  }
  if (wires.length && radius > 0) {
    tubes = makeTubes(position, wires, radius, new THREE.MeshStandardMaterial({ color: colour, roughness: 0.55, metalness: 0.15 }));
    group.add(...tubes.meshes);
    group.follow = tubes.follow;
  } else if (wires.length) {
    group.add(Object.assign(new THREE.LineSegments(over(wires), new THREE.LineBasicMaterial({ color: colour })), { frustumCulled: false }));
  }
  group.paint = shareOf => {
    for (const part of group.children) {
      part.material.color.set(shareOf ? 0xffffff : colour);
      if (!part.isInstancedMesh) part.material.vertexColors = Boolean(shareOf);
      part.material.needsUpdate = true;
    }
    if (!shareOf) { tubes?.plain(); return; }
    const shade = new THREE.Color();
    for (let i = 0; i < position.count; ++i) heat(shareOf(i), shade).toArray(shades.array, 3 * i);
    shades.needsUpdate = true;
    tubes?.paint(shareOf);
  };
  group.positions = position;
  return group;
}

/** The three axes of the world, drawn small in the corner. */
function makeTriad() {
  const scene = new THREE.Scene();
  [[1, 0, 0, 'x', '#c62828'], [0, 1, 0, 'y', '#2e7d32'], [0, 0, 1, 'z', '#1565c0']].forEach(([x, y, z, name, colour]) => {
    const axis = new THREE.Vector3(x, y, z);
    scene.add(new THREE.ArrowHelper(axis, new THREE.Vector3(), 0.8, colour, 0.24, 0.14));
    const canvas = Object.assign(document.createElement('canvas'), { width: 64, height: 64 }), g = canvas.getContext('2d');
    Object.assign(g, { font: '600 44px system-ui, sans-serif', fillStyle: colour, textAlign: 'center', textBaseline: 'middle' });
    g.fillText(name, 32, 32);
    const label = new THREE.Sprite(new THREE.SpriteMaterial({ map: new THREE.CanvasTexture(canvas), depthTest: false }));
    label.position.copy(axis);
    label.scale.setScalar(0.42);
    scene.add(label);
  });
  return scene;
}

/** Renderer, camera, lamp and triad; what stands in it says `wholeBox`. */
export class Stage {
  constructor(canvas) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.localClippingEnabled = true;
    this.renderer.autoClear = false;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.001, 1000);
    this.camera.up.set(0, 0, 1);
    this.scene.add(this.camera, new THREE.HemisphereLight(0xffffff, 0x8f9aa8, 1.7));
    const lamp = new THREE.DirectionalLight(0xffffff, 2.0);
    lamp.position.set(-0.6, 0.9, 1);
    this.camera.add(lamp);  // light comes over the left shoulder, wherever one looks from
    this.orbit = new OrbitControls(this.camera, canvas);
    this.triad = makeTriad();
    this.triadCamera = new THREE.OrthographicCamera(-1.4, 1.4, 1.4, -1.4, 0.1, 10);
    this.triadCamera.up.set(0, 0, 1);
    this.plane = new THREE.Plane();
    this.wholeBox = new THREE.Box3();
  }

  /** Looks from `view` so that the box fills the canvas. */
  aim(view, box) {
    const radius = 0.5 * box.getSize(new THREE.Vector3()).length();
    const direction = { iso: [0.62, -0.86, 0.55], x: [1, 0, 0], y: [0, -1, 0], z: [0, -1e-4, 1] }[view];
    const narrow = Math.min(1, this.camera.aspect);
    box.getCenter(this.orbit.target);
    const distance = 1.02 * radius / Math.sin(0.5 * this.camera.fov * Math.PI / 180) / narrow;
    this.camera.position.fromArray(direction).normalize().multiplyScalar(distance).add(this.orbit.target);
    this.orbit.update();
  }

  /** The section plane across axis "+x" ... "-z" at a share of the whole box. */
  cutAt(axis, depth) {
    const normal = new THREE.Vector3().setComponent('xyz'.indexOf(axis[1]), axis[0] === '+' ? -1 : 1);
    const { min, max } = this.wholeBox, lo = min.dot(normal), hi = max.dot(normal);
    this.plane.set(normal, -(lo + depth * (hi - lo)));
  }

  resize() {
    const { clientWidth, clientHeight } = this.renderer.domElement;
    this.renderer.setPixelRatio(devicePixelRatio);
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / Math.max(1, clientHeight);
    this.camera.updateProjectionMatrix();
  }

  render() {
    this.orbit.update();
    const distance = this.camera.position.distanceTo(this.orbit.target), reach = this.wholeBox.getSize(new THREE.Vector3()).length();
    this.camera.near = Math.max(1e-3 * distance, distance - 4 * reach);
    this.camera.far = distance + 4 * reach;
    this.camera.updateProjectionMatrix();
    this.renderer.clear();
    this.renderer.render(this.scene, this.camera);

    const side = 84;
    this.triadCamera.position.copy(this.camera.position).sub(this.orbit.target).setLength(4);
    this.triadCamera.lookAt(0, 0, 0);
    this.renderer.setViewport(6, 6, side, side);
    this.renderer.clearDepth();
    this.renderer.render(this.triad, this.triadCamera);
    this.renderer.setViewport(0, 0, this.renderer.domElement.clientWidth, this.renderer.domElement.clientHeight);
  }
}

export class Scene extends Stage {
  constructor(canvas, run) {
    super(canvas);
    this.run = run;

    const counts = { moving: 0 };
    this.bodies = run.body_mesh.map((_, i) => {
      const make = run.body_moving_vertices[i] ? makeDeforming : makeBody;
      const group = make(run, i, run.body_fixed[i] ? colours.fixed : colours.moving[counts.moving++ % colours.moving.length]);
      this.scene.add(group);
      return group;
    });
    this.pose = run.array('pose');
    this.vertices = run.array('vertices');
    let moving = 0;
    this.firstVertex = run.body_moving_vertices.map(count => (moving += count) - count);
    this.movingVertices = moving;
    this.measureFields();
    this.offset = run.array('contact.offset');
    this.measure();

    let most = 1;
    for (let k = 0; k < run.frames; ++k) most = Math.max(most, this.offset[k + 1] - this.offset[k]);
    this.dots = new THREE.InstancedMesh(new THREE.SphereGeometry(1, 16, 12),
      new THREE.MeshBasicMaterial({ transparent: true }), most);
    this.dots.setColorAt(0, new THREE.Color());
    // The same behind surfaces, pale: which side of a part a contact is on can be seen
    this.ghosts = new THREE.InstancedMesh(this.dots.geometry, new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.25, depthTest: false }), most);
    this.ghosts.instanceMatrix = this.dots.instanceMatrix;
    this.ghosts.instanceColor = this.dots.instanceColor;
    this.ghosts.frustumCulled = false;
    this.ghosts.renderOrder = 3;
    this.dots.frustumCulled = false;
    this.dots.renderOrder = 4;
    this.normals = new Arrows(most, colours.normal);
    this.forces = new Arrows(most, colours.force);
    this.paths = new THREE.Group();
    this.bodies.forEach((group, i) => run.body_fixed[i] || !group.children.length || this.paths.add(this.makePath(i)));
    this.scene.add(this.dots, this.ghosts, this.normals, this.forces, this.paths);
    this.forceUnit = 0.3 * this.size / this.largeForce();
    this.options = { dots: true, normals: false, forces: true, scale: 1, dotSize: 1, opacity: 0.4, section: null };
    this.frame = 0;
  }

  place(group, index, frame) {
    const at = 7 * (frame * this.bodies.length + index);
    group.position.fromArray(this.pose, at);
    group.quaternion.fromArray(this.pose, at + 3);
    if (!group.positions) return;
    const first = 3 * (frame * this.movingVertices + this.firstVertex[index]);
    group.positions.array.set(this.vertices.subarray(first, first + group.positions.array.length));
    group.positions.needsUpdate = true;
    group.follow?.();
  }

  /** Where the values of each body's field begin in a frame, and the largest of all values of one name. */
  measureFields() {
    const { run } = this, name = run.body_field ?? [];
    let width = 0;
    this.firstValue = name.map((what, i) => (what ? (width += run.body_moving_vertices[i]) - run.body_moving_vertices[i] : -1));
    this.fieldWidth = width;
    this.fields = new Map();
    const values = run.array('field');
    name.forEach((what, i) => {
      if (!what) return;
      const field = this.fields.get(what) ?? { unit: run.body_field_unit[i], largest: 0 };
      for (let k = 0; k < run.frames; ++k)
        for (let v = 0, at = k * width + this.firstValue[i]; v < run.body_moving_vertices[i]; ++v)
          if (values[at + v] > field.largest) field.largest = values[at + v];
      this.fields.set(what, field);
    });
  }

  /** Colours the bodies that have a field by it, or as a whole. */
  paint(frame, byField) {
    const values = this.run.array('field');
    this.bodies.forEach((group, i) => {
      if (!(this.firstValue[i] >= 0)) return;
      const first = frame * this.fieldWidth + this.firstValue[i], { largest } = this.fields.get(this.run.body_field[i]);
      if (byField) group.paint(v => (largest > 0 ? values[first + v] / largest : 0));
      else if (group.painted) group.paint();
      group.painted = byField;
    });
  }

  /** Of a body, seen from itself: over so many frames if it deforms. */
  localBox(group, index, frames = this.run.frames) {
    const box = new THREE.Box3().setFromObject(group), x = new THREE.Vector3();
    for (let k = 0; group.positions && k < frames; ++k)
      for (let i = 0, at = 3 * (k * this.movingVertices + this.firstVertex[index]); i < group.positions.array.length; i += 3)
        box.expandByPoint(x.fromArray(this.vertices, at + i));
    return box;
  }

  makePath(index) {
    const points = [];
    for (let k = 0; k < this.run.frames; ++k) points.push(new THREE.Vector3().fromArray(this.pose, 7 * (k * this.bodies.length + index)));
    return new THREE.Line(new THREE.BufferGeometry().setFromPoints(points),
      new THREE.LineBasicMaterial({ color: 0x1c2430, transparent: true, opacity: 0.45 }));
  }

  /** Boxes of the moving bodies over the whole run and of everything. */
  measure() {
    this.movingBox = new THREE.Box3();
    this.laid = this.bodies.map((group, i) => this.localBox(group, i, 1));  // before any frame is shown
    const local = this.bodies.map((group, i) => this.localBox(group, i)), here = new THREE.Box3();
    for (let k = 0; k < this.run.frames; k += Math.max(1, Math.floor(this.run.frames / 60)))
      this.bodies.forEach((group, i) => {
        this.place(group, i, k);
        group.updateMatrixWorld(true);
        here.copy(local[i]).applyMatrix4(group.matrixWorld);
        if (local[i].isEmpty()) return;
        this.wholeBox.union(here);
        if (!this.run.body_fixed[i]) this.movingBox.union(here);
      });
    const sizes = local.map((box, i) => (box.isEmpty() || this.run.body_fixed[i] ? 0 : box.getSize(new THREE.Vector3()).length()));
    if (this.wholeBox.isEmpty()) this.wholeBox.set(new THREE.Vector3(-1, -1, -1), new THREE.Vector3(1, 1, 1));
    if (this.movingBox.isEmpty()) this.movingBox.copy(this.wholeBox);
    this.size = Math.max(...sizes) || this.wholeBox.getSize(new THREE.Vector3()).length();  // of the largest moving part [m]
  }

  /** A force that most contacts stay below [N]: the 98th percentile. */
  largeForce() {
    const f = this.run.array('contact.force'), norms = [];
    for (let i = 0; i < f.length; i += 3) { const n = Math.hypot(f[i], f[i + 1], f[i + 2]); if (n > 0) norms.push(n); }
    norms.sort((a, b) => a - b);
    return norms.length ? norms[Math.floor(0.98 * (norms.length - 1))] : 1;
  }

  /** Looks from `view` at the moving part's way, or at everything; a huge fixed part does not shrink the moving one. */
  look(view = 'iso', fit = 'moving') {
    const box = fit === 'all' ? this.wholeBox : this.movingBox.clone().expandByScalar(0.15 * this.size).intersect(this.wholeBox);
    this.aim(view, box);
  }

  /** Applies opacity of the fixed bodies, edge lines and the section plane. */
  dress({ opacity, edges, path, axis, cut, depth }) {
    this.paths.visible = path;
    if (axis) this.cutAt(axis, depth);
    this.bodies.forEach((group, i) => {
      const fixed = this.run.body_fixed[i] === 1, sectioned = axis && (cut === 'all' || fixed);
      const ghost = fixed && opacity < 1;
      group.visible = !fixed || opacity > 0;
      for (const part of group.children) {
        part.material.clippingPlanes = sectioned ? [this.plane] : null;
        if (part.name === 'edges') part.visible = edges;
        if (part.name === 'inside') part.visible = Boolean(sectioned) && !ghost;
        if (part.name === 'skin') {
          Object.assign(part.material, { transparent: ghost, opacity: ghost ? opacity : 1, depthWrite: !ghost,
            side: ghost || sectioned ? THREE.FrontSide : THREE.DoubleSide });
          part.material.needsUpdate = true;
        }
      }
    });
  }

  show(frame, { dots, normals, forces, scale, dotSize, load }) {
    const before = this.followed();
    this.frame = frame;
    this.bodies.forEach((group, i) => this.place(group, i, frame));
    this.paint(frame, load);
    if (this.follow) {
      const moved = this.followed().sub(before);
      this.camera.position.add(moved);
      this.orbit.target.add(moved);
    }
    Object.assign(this.dots, { visible: dots });
    Object.assign(this.ghosts, { visible: dots });
    Object.assign(this.normals, { visible: normals });
    Object.assign(this.forces, { visible: forces });
    const point = this.run.array('contact.point'), normal = this.run.array('contact.normal'), force = this.run.array('contact.force'), gap = this.run.array('contact.gap');
    const first = this.offset[frame], count = this.offset[frame + 1] - first, radius = 0.011 * this.size * dotSize, width = 0.0045 * this.size;
    const from = new THREE.Vector3(), direction = new THREE.Vector3(), matrix = new THREE.Matrix4(), colour = new THREE.Color();
    this.normals.begin();
    this.forces.begin();
    for (let i = 0; i < count; ++i) {
      const c = first + i;
      from.fromArray(point, 3 * c);
      this.dots.setMatrixAt(i, matrix.makeScale(radius, radius, radius).setPosition(from));
      this.dots.setColorAt(i, colour.set(gap[c] < 0 ? colours.overlap : colours.open));
      this.normals.put(from, direction.fromArray(normal, 3 * c), 0.14 * this.size, 0.6 * width);
      direction.fromArray(force, 3 * c);
      const newton = direction.length();
      if (newton > 0) this.forces.put(from, direction.divideScalar(newton), this.forceUnit * scale * newton, width);
    }
    this.dots.count = this.ghosts.count = count;
    this.dots.instanceMatrix.needsUpdate = this.dots.instanceColor.needsUpdate = true;
    this.normals.end();
    this.forces.end();
  }

  followed() {
    const i = this.run.body_fixed.indexOf(0);
    return i < 0 ? new THREE.Vector3() : this.bodies[i].position.clone();
  }
}
