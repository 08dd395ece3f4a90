// SPDX-License-Identifier: Apache-2.0
// What stands in the view of a session: bodies, contacts, forces, the hand, the nearest pair, the trace.
import * as THREE from 'three';
import { Arrows, Stage, colours, makeBody } from '../../io/viewer/scene.js';

const mostContacts = 2000, longestTrace = 4000;

export class LiveStage extends Stage {
  /** `meshes`: by hash, as messages.js reads them. */
  constructor(canvas, welcome, meshes) {
    super(canvas);
    this.moving = welcome.moving;
    this.fixed = welcome.bodies.map(body => body.fixed);
    const none = { vertices: new Float32Array(), faces: new Uint32Array(), wires: new Uint32Array() };
    const known = welcome.bodies.map(body => meshes.get(body.mesh) ?? none);
    const run = {  // as a run of the replay
      body_mesh: welcome.bodies.map((body, i) => (body.mesh ? i : -1)), body_fixed: this.fixed.map(Number), body_dilation: this.fixed.map(() => 0),
      array: name => { const [, i, part] = name.match(/^mesh(\d+)\.(.*)$/); return known[i][part].slice(); },
    };
    let n = 0;
    this.bodies = welcome.bodies.map((body, i) => {
      const group = makeBody(run, i, body.fixed ? colours.fixed : colours.moving[n++ % colours.moving.length]);
      this.scene.add(group);
      return group;
    });
    this.local = this.bodies.map(group => new THREE.Box3().setFromObject(group));
    this.size = this.local[this.moving].getSize(new THREE.Vector3()).length() || 1;
    const ball = new THREE.SphereGeometry(0.008 * this.size, 12, 8);
    this.dots = new THREE.InstancedMesh(ball, new THREE.MeshBasicMaterial({ transparent: true, depthTest: false }), mostContacts);
    this.dots.setColorAt(0, new THREE.Color());
    this.dots.frustumCulled = false;
    this.dots.renderOrder = 4;
    this.forces = new Arrows(mostContacts, colours.force);
    this.pull = new Arrows(1, 0x2a62b8);
    this.grip = new THREE.Mesh(new THREE.SphereGeometry(0.014 * this.size, 16, 12), new THREE.MeshBasicMaterial({ color: 0x2a62b8, depthTest: false, transparent: true, opacity: 0.8 }));
    this.grip.renderOrder = 5;
    const line = (colour, points) => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * points), 3));
      const out = new THREE.Line(geometry, new THREE.LineBasicMaterial({ color: colour, depthTest: false, transparent: true }));
      out.frustumCulled = false;
      return out;
    };
    this.near = line(0xb5480d, 2);
    this.trace = line(0x5c6878, longestTrace);
    this.traced = 0;
    this.scene.add(this.dots, this.forces, this.pull, this.grip, this.near, this.trace);
    this.ray = new THREE.Raycaster();
  }

  show(frame, { dots, forces, log, near, trace, grip }) {
    frame.poses.forEach(([x, y, z, qx, qy, qz, qw], i) => {
      this.bodies[i]?.position.set(x, y, z);
      this.bodies[i]?.quaternion.set(qx, qy, qz, qw);
    });
    if (!this.aimed) { this.measure(); this.aim('iso', this.movingBox()); this.aimed = true; }
    const largest = Math.max(1e-12, ...frame.contacts.map(c => Math.hypot(...c.force)), Math.hypot(...frame.pull));
    this.scaleOfForces = largest;
    const length = newton => 0.35 * this.size * (log ? Math.max(0, 1 + Math.log10(newton / largest) / 4) : newton / largest);
    const from = new THREE.Vector3(), direction = new THREE.Vector3(), matrix = new THREE.Matrix4(), colour = new THREE.Color(), width = 0.004 * this.size;
    this.dots.visible = dots;
    this.forces.visible = forces;
    this.forces.begin();
    frame.contacts.forEach((c, i) => {
      from.fromArray(c.point);
      this.dots.setMatrixAt(i, matrix.makeTranslation(from.x, from.y, from.z));
      this.dots.setColorAt(i, colour.set(c.gap < 0 ? colours.overlap : colours.open));
      const sign = c.a === this.moving ? 1 : -1, newton = Math.hypot(...c.force);
      if (newton > 0) this.forces.put(from, direction.fromArray(c.force).multiplyScalar(sign / newton), length(newton), width);
    });
    this.forces.end();
    this.dots.count = frame.contacts.length;
    this.dots.instanceMatrix.needsUpdate = this.dots.instanceColor.needsUpdate = true;
    const newton = Math.hypot(...frame.pull);
    this.grip.visible = Boolean(grip);
    this.pull.begin();
    if (grip) {
      this.grip.position.copy(this.bodies[this.moving].localToWorld(from.fromArray(grip)));
      if (newton > 0) this.pull.put(this.grip.position, direction.fromArray(frame.pull).divideScalar(newton), length(newton), width);
    }
    this.pull.end();
    this.near.visible = near && frame.contacts.length > 0;
    if (this.near.visible) this.drawLine(this.near, [...frame.nearA, ...frame.nearB]);
    this.trace.visible = trace;
    this.addToTrace(frame);
  }

  drawLine(line, values) {
    line.geometry.attributes.position.array.set(values);
    line.geometry.attributes.position.needsUpdate = true;
    line.geometry.setDrawRange(0, values.length / 3);
  }
  addToTrace(frame) {
    const [x, y, z] = frame.poses[this.moving], at = this.trace.geometry.attributes.position;
    if (frame.take !== this.tracedTake || frame.moment < this.tracedMoment) this.traced = 0;
    [this.tracedTake, this.tracedMoment] = [frame.take, frame.moment];
    const last = this.traced - 1;
    if (last >= 0 && Math.hypot(at.getX(last) - x, at.getY(last) - y, at.getZ(last) - z) < 1e-3 * this.size) return;
    if (this.traced >= longestTrace) { at.array.copyWithin(0, 3 * longestTrace / 2); this.traced = longestTrace / 2; }
    at.setXYZ(this.traced++, x, y, z);
    at.needsUpdate = true;
    this.trace.geometry.setDrawRange(0, this.traced);
  }

  measure() {
    this.wholeBox.makeEmpty();
    this.bodies.forEach((group, i) => { group.updateMatrixWorld(true); if (!this.local[i].isEmpty()) this.wholeBox.union(this.local[i].clone().applyMatrix4(group.matrixWorld)); });
    this.wholeBox.expandByScalar(0.5 * this.size);
  }
  movingBox() {
    const group = this.bodies[this.moving];
    group.updateMatrixWorld(true);
    return this.local[this.moving].clone().applyMatrix4(group.matrixWorld).expandByScalar(0.2 * this.size);
  }
  look(view, fit = 'moving') { this.measure(); this.aim(view, fit === 'all' ? this.wholeBox : this.movingBox()); }

  dress({ opacity, axis, depth }) {
    if (axis) this.cutAt(axis, depth);
    this.bodies.forEach((group, i) => {
      const ghost = this.fixed[i] && opacity < 1, cut = axis && this.fixed[i];
      group.visible = !this.fixed[i] || opacity > 0;
      for (const part of group.children) {
        part.material.clippingPlanes = cut ? [this.plane] : null;
        if (part.name === 'inside') part.visible = Boolean(cut) && !ghost;
        if (part.name !== 'skin') continue;
        Object.assign(part.material, { transparent: ghost, opacity: ghost ? opacity : 1, depthWrite: !ghost, side: ghost || cut ? THREE.FrontSide : THREE.DoubleSide });
        part.material.needsUpdate = true;
      }
    });
  }

  aimRay(x, y) {
    const box = this.renderer.domElement.getBoundingClientRect();
    this.ray.setFromCamera(new THREE.Vector2(2 * (x - box.left) / box.width - 1, 1 - 2 * (y - box.top) / box.height), this.camera);
  }
  /** Where a click hits the moving part: its point in the world and in the frame of the mesh. */
  pick(x, y) {
    this.aimRay(x, y);
    const group = this.bodies[this.moving];
    const [hit] = this.ray.intersectObjects(group.children.filter(part => part.name === 'skin'));
    return hit && { world: hit.point.clone(), local: group.worldToLocal(hit.point.clone()).toArray() };
  }
  /** Where a click hits the plane through a point that faces the camera. */
  onPlane(x, y, through) {
    this.aimRay(x, y);
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(new THREE.Vector3()), through);
    return this.ray.ray.intersectPlane(plane, new THREE.Vector3());
  }
  /** A point of the world on the page. */
  onPage(point) {
    const box = this.renderer.domElement.getBoundingClientRect(), p = new THREE.Vector3(...point).project(this.camera);
    return [box.left + (p.x + 1) / 2 * box.width, box.top + (1 - p.y) / 2 * box.height];
  }
}
