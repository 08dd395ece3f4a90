// SPDX-License-Identifier: Apache-2.0
// The binary messages of doc/live_protocol.md.
export const kinds = { frame: 1, command: 2, mesh: 3 };
export const flags = { held: 1, paused: 2, refused: 4, unsolved: 8, limit: 16 };
export const modes = { none: 0, pose: 1, twist: 2 };

export const kindOf = bytes => new DataView(bytes).getUint16(0, true);

export function readFrame(bytes) {
  const view = new DataView(bytes), f32 = (at, n) => new Float32Array(bytes, at, n);
  const bodies = view.getUint32(96, true), shown = view.getUint32(100, true), flag = view.getUint32(36, true);
  const contacts = [];
  for (let i = 0, at = 128 + 28 * bodies; i < shown; ++i, at += 44) {
    const [px, py, pz, nx, ny, nz, fx, fy, fz, gap] = f32(at, 10);
    contacts.push({ point: [px, py, pz], normal: [nx, ny, nz], force: [fx, fy, fz], gap, a: view.getUint16(at + 40, true), b: view.getUint16(at + 42, true) });
  }
  return {
    sequence: Number(view.getBigUint64(8, true)), t: view.getFloat64(16, true), moment: Number(view.getBigInt64(24, true)),
    take: view.getUint32(32, true), held: Boolean(flag & flags.held), paused: Boolean(flag & flags.paused), refused: Boolean(flag & flags.refused),
    unsolved: Boolean(flag & flags.unsolved), limit: Boolean(flag & flags.limit), slow: view.getFloat32(40, true), distance: view.getFloat32(44, true),
    nearA: [...f32(48, 3)], nearB: [...f32(60, 3)], pull: [...f32(72, 3)], torque: [...f32(84, 3)],
    allContacts: view.getUint32(104, true), skipped: Number(view.getBigUint64(112, true)), ends: Number(view.getBigInt64(120, true)),
    poses: Array.from({ length: bodies }, (_, i) => f32(128 + 28 * i, 7)), contacts,
  };
}

export function readMesh(bytes) {
  const view = new DataView(bytes), vertices = view.getUint32(24, true), faces = view.getUint32(28, true), wires = view.getUint32(32, true);
  return { hash: view.getBigUint64(16, true).toString(), vertices: new Float32Array(bytes, 64, 3 * vertices),
    faces: new Uint32Array(bytes, 64 + 12 * vertices, 3 * faces), wires: new Uint32Array(bytes, 64 + 12 * (vertices + faces), 2 * wires) };
}

/** values: x y z qx qy qz qw of the grip, or vx vy vz wx wy wz. */
export function writeCommand({ mode, firm = true, drawn = 0, values = [], grip = [0, 0, 0] }, sequence) {
  const view = new DataView(new ArrayBuffer(120));
  view.setUint16(0, kinds.command, true);
  view.setUint16(2, 1, true);
  view.setUint32(4, 120, true);
  view.setBigUint64(8, BigInt(sequence), true);
  view.setUint32(16, mode, true);
  view.setUint32(20, firm ? 1 : 0, true);
  view.setBigUint64(24, BigInt(drawn), true);
  values.forEach((x, i) => view.setFloat64(32 + 8 * i, x, true));
  if (mode === modes.none) view.setFloat64(32 + 48, 1, true);
  grip.forEach((x, i) => view.setFloat64(88 + 8 * i, x, true));
  return view.buffer;
}
