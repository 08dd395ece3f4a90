// SPDX-License-Identifier: Apache-2.0
// What the hand wants: by pointer, keys, gamepad or space mouse. A pose of the grip, or a twist; nothing when it lets go.
import * as THREE from 'three';
import { modes } from './messages.js';

const deadZone = 0.05, padSpeed = 0.05, padSpin = 1;  // of a stick, full: [m/s], [rad/s]
const keyAxes = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0], PageUp: [0, 0, -1], PageDown: [0, 0, 1] };
/** Zero in the dead zone, then a cubic. */
export const response = x => (Math.abs(x) < deadZone ? 0 : (Math.sign(x) * (Math.abs(x) - deadZone) / (1 - deadZone)) ** 3);

export class Hand {
  constructor(stage, canvas, mayMove) {
    Object.assign(this, { stage, canvas, mayMove, mode: modes.none, grip: null, target: new THREE.Vector3(), turn: new THREE.Quaternion(), twist: null, firm: true, keys: new Set() });
    canvas.addEventListener('pointerdown', event => this.press(event), true);
    canvas.addEventListener('pointermove', event => this.drag(event));
    canvas.addEventListener('pointerup', () => this.endDrag());
    canvas.addEventListener('pointercancel', () => this.letGo());
    canvas.addEventListener('wheel', event => this.wheel(event), { passive: false, capture: true });
    canvas.addEventListener('keydown', event => this.key(event));
    canvas.addEventListener('keyup', event => this.keys.delete(event.key.toLowerCase()));
    addEventListener('blur', () => this.letGo());
    document.addEventListener('visibilitychange', () => document.hidden && this.letGo());
  }

  get group() { return this.stage.bodies[this.stage.moving]; }

  grab(world, local) {
    this.mode = modes.pose;
    this.grip = local;
    this.target.copy(world);
    this.turn.copy(this.group.quaternion);
  }
  letGo() {
    this.mode = modes.none;
    this.grip = this.twist = null;
    this.dragging = false;
    this.keys.clear();
    this.stage.orbit.enabled = true;
    this.onLetGo?.();
  }

  press(event) {
    if (event.button !== 0 || !this.mayMove()) return;
    const hit = this.stage.pick(event.clientX, event.clientY);
    if (!hit) return;
    event.stopPropagation();
    this.stage.orbit.enabled = false;
    this.canvas.setPointerCapture(event.pointerId);
    this.grab(hit.world, hit.local);
    this.dragging = true;
    this.at = [event.clientX, event.clientY];
  }
  drag(event) {
    if (!this.dragging) return;
    const part = event.altKey ? 0.1 : 1, [x, y] = this.at;
    this.at = [event.clientX, event.clientY];
    if (event.shiftKey) {
      const axis = (i, angle) => new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3().setFromMatrixColumn(this.stage.camera.matrixWorld, i), angle);
      this.turn.premultiply(axis(1, part * 0.008 * (event.clientX - x))).premultiply(axis(0, part * 0.008 * (event.clientY - y)));
      return;
    }
    const from = this.stage.onPlane(x, y, this.target), to = this.stage.onPlane(event.clientX, event.clientY, this.target);
    if (from && to) this.target.addScaledVector(to.sub(from), part);
  }
  endDrag() {
    this.dragging = false;
    this.stage.orbit.enabled = true;  // it goes on holding, until it lets go
  }
  wheel(event) {
    if (this.mode !== modes.pose || !this.dragging) return;
    event.preventDefault();
    event.stopPropagation();
    this.target.addScaledVector(this.stage.camera.getWorldDirection(new THREE.Vector3()), -2e-5 * this.stage.size * (event.altKey ? 0.1 : 1) * event.deltaY);
  }
  key(event) {
    if (event.key === 'Escape') { this.letGo(); return; }
    this.keys.add(event.key.toLowerCase());
    const axis = keyAxes[event.key];
    if (!axis || !this.mayMove()) return;
    event.preventDefault();
    if (this.mode !== modes.pose) {
      const local = this.stage.local[this.stage.moving].getCenter(new THREE.Vector3());
      this.grab(this.group.localToWorld(local.clone()), local.toArray());
    }
    const part = event.ctrlKey ? 0.1 : event.shiftKey ? 10 : 1, along = new THREE.Vector3(...axis).transformDirection(this.stage.camera.matrixWorld);
    if (this.keys.has('r')) this.turn.premultiply(new THREE.Quaternion().setFromAxisAngle(along, part * Math.PI / 180));
    else this.target.addScaledVector(along, 1e-3 * part);
  }

  /** Speeds along and about the axes of the camera, each in [-1, 1]. */
  push(values) {
    const bent = values.map(response);
    if (bent.every(x => x === 0)) {
      if (this.twist) { this.twist = null; this.grab(this.group.localToWorld(new THREE.Vector3(...this.grip)), this.grip); }
      return;
    }
    if (!this.mayMove()) return;
    const turn = ([x, y, z], size) => new THREE.Vector3(x, y, z).transformDirection(this.stage.camera.matrixWorld).multiplyScalar(size * Math.hypot(x, y, z));
    this.grip ??= this.stage.local[this.stage.moving].getCenter(new THREE.Vector3()).toArray();
    this.mode = modes.twist;
    this.twist = [...(Math.hypot(...bent.slice(0, 3)) ? turn(bent.slice(0, 3), padSpeed) : [0, 0, 0]), ...(Math.hypot(...bent.slice(3)) ? turn(bent.slice(3), padSpin) : [0, 0, 0])];
  }
  readGamepads() {
    const pad = [...navigator.getGamepads()].find(Boolean);
    if (!pad) return;
    const moves = [...pad.axes, ...pad.buttons.slice(4, 8).map(b => b.value)].some(x => response(x) !== 0);
    if (!moves && !this.padMoved) return;  // at rest it leaves the hand to others
    this.padMoved = moves;
    const [x = 0, y = 0, rx = 0, ry = 0] = pad.axes, button = i => pad.buttons[i]?.value ?? 0;
    this.push([x, -y, button(6) - button(7), -ry, rx, button(4) - button(5)]);
    if (pad.buttons[1]?.pressed) this.letGo();
  }
  /** 3Dconnexion's reports: 1 translation, 2 rotation, both as three numbers within 350; or six in report 1. */
  async connectSpaceMouse() {
    const [device] = await navigator.hid.requestDevice({ filters: [{ vendorId: 0x256f }, { vendorId: 0x046d }] });
    if (!device) return false;
    if (!device.opened) await device.open();
    const now = [0, 0, 0, 0, 0, 0], axes = [1, -1, -1];  // right, up, towards
    device.oninputreport = ({ reportId, data }) => {
      const first = reportId === 2 ? 3 : 0, count = reportId > 2 ? 0 : Math.min(6 - first, data.byteLength >> 1);
      for (let i = 0; i < count; ++i) now[first + i] = data.getInt16(2 * i, true) / 350;
      const [x, y, z, rx, ry, rz] = now;
      this.push([axes[0] * x, axes[1] * z, -axes[2] * y, axes[0] * rx, axes[1] * rz, -axes[2] * ry]);
    };
    return true;
  }

  command(drawn) {
    if (this.mode === modes.none) return { mode: modes.none, drawn };
    const values = this.mode === modes.twist ? this.twist : [...this.target.toArray(), ...this.turn.toArray()];
    return { mode: this.mode, firm: this.firm, drawn, values, grip: this.grip };
  }
}
