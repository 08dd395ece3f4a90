// SPDX-License-Identifier: Apache-2.0
// Curves over time with a cursor. A curve is drawn once per size; only the cursor moves.
import { si } from './format.js';

const left = 8, right = 8, top = 17, bottom = 5;

class Plot {
  /** curves: [{name, colour, time, y, now}]; `now` holds the exact values at the frames, for the text at the cursor. */
  constructor(parent, title, unit, curves, { log = false, text = x => si(x, unit), seek }) {
    Object.assign(this, { title, curves, log, text });
    this.canvas = parent.appendChild(document.createElement('canvas'));
    this.canvas.setAttribute('aria-label', `${title} over time`);
    this.still = document.createElement('canvas');
    const y = log ? v => (v > 0 ? Math.log10(v) : NaN) : v => v;
    this.value = y;
    let lo = Infinity, hi = -Infinity;
    for (const curve of curves) for (const v of curve.y) {
      const f = y(v);
      if (Number.isFinite(f)) { lo = Math.min(lo, f); hi = Math.max(hi, f); }
    }
    this.extremes = log ? [10 ** lo, 10 ** hi] : [lo, hi];
    const margin = hi > lo ? 0.06 * (hi - lo) : Math.max(Math.abs(hi), 1e-12);
    Object.assign(this, { lo: lo - margin, hi: hi + margin });
    const time = curves[0].time;
    Object.assign(this, { t0: time[0], t1: time[time.length - 1] });
    const drag = e => {
      const x = (e.offsetX - left) / (this.canvas.clientWidth - left - right);
      seek(this.t0 + Math.min(1, Math.max(0, x)) * (this.t1 - this.t0));
    };
    this.canvas.onpointerdown = e => { this.canvas.setPointerCapture(e.pointerId); drag(e); };
    this.canvas.onpointermove = e => e.buttons && drag(e);
  }

  x(t) { return left + (this.width - left - right) * (this.t1 > this.t0 ? (t - this.t0) / (this.t1 - this.t0) : 0.5); }
  y(f) { return top + (this.height - top - bottom) * (1 - (f - this.lo) / (this.hi - this.lo)); }

  resize() {
    const ratio = devicePixelRatio, { clientWidth, clientHeight } = this.canvas;
    Object.assign(this, { width: clientWidth, height: clientHeight });
    for (const canvas of [this.canvas, this.still]) {
      canvas.width = clientWidth * ratio;
      canvas.height = clientHeight * ratio;
    }
    const g = this.still.getContext('2d');
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.fillStyle = '#f6f8fa';
    g.fillRect(left, top, this.width - left - right, this.height - top - bottom);
    if (!this.log && this.lo < 0 && this.hi > 0) {
      g.strokeStyle = '#c3cad3';
      g.beginPath(); g.moveTo(left, this.y(0)); g.lineTo(this.width - right, this.y(0)); g.stroke();
    }
    g.lineWidth = 1.3;
    g.lineJoin = 'round';
    for (const curve of this.curves) {
      g.strokeStyle = curve.colour;
      g.beginPath();
      let pen = false;
      for (let i = 0; i < curve.y.length; ++i) {
        const f = this.value(curve.y[i]);
        if (!Number.isFinite(f)) { pen = false; continue; }
        const px = this.x(curve.time[i]), py = this.y(f);
        if (pen) g.lineTo(px, py); else { g.moveTo(px, py); g.lineTo(px + 0.01, py); }
        pen = true;
      }
      g.stroke();
    }
    g.font = '11px system-ui, sans-serif';
    g.textAlign = 'right';
    const label = (text, y) => {  // on a ground of its own, so that no curve runs through it
      const width = g.measureText(text).width;
      g.fillStyle = '#f6f8fae6';
      g.fillRect(this.width - right - 6 - width, y - 10, width + 4, 13);
      g.fillStyle = '#5c6878';
      g.fillText(text, this.width - right - 4, y);
    };
    label(this.text(this.extremes[1]), top + 12);
    if (this.extremes[0] !== this.extremes[1]) label(this.text(this.extremes[0]), this.height - bottom - 4);
  }

  draw(frame, time) {
    const g = this.canvas.getContext('2d'), ratio = devicePixelRatio;
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.clearRect(0, 0, this.canvas.width, this.canvas.height);
    g.drawImage(this.still, 0, 0);
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.font = '600 11px system-ui, sans-serif';
    g.fillStyle = '#1c2430';
    g.fillText(this.title, left, 12);
    let x = left + g.measureText(this.title).width + 12;
    g.font = '11px system-ui, sans-serif';
    for (const curve of this.curves) {
      const label = `${curve.name ? curve.name + ' ' : ''}${this.text(curve.now[frame])}`;
      g.fillStyle = curve.colour;
      g.fillText(label, x, 12);
      x += g.measureText(label).width + 12;
    }
    g.strokeStyle = '#1c2430';
    g.lineWidth = 1;
    g.beginPath(); g.moveTo(this.x(time), top); g.lineTo(this.x(time), this.height - bottom); g.stroke();
  }
}

export class Plots {
  constructor(parent, run, seek) {
    const time = run.array('curve.time');
    const curve = (quantity, colour, name = '') =>
      ({ name, colour, time, y: run.array(`curve.${quantity}`), now: run.array(`frame.${quantity}`) });
    const power = x => Number.isFinite(x) && x > 0 ? x.toExponential(1) : '0';
    const wanted = [
      ['force', 'N', [curve('coupling', '#2a62b8', 'pull'), curve('contact_force', '#c2185b', 'contacts')]],
      ['smallest gap', 'm', [curve('min_gap', '#1f8a5b')]],
      ['energy', 'J', [curve('kinetic', '#b26a00', 'kinetic'), curve('total', '#5c6878', 'total')]],
      ['residual', '', [curve('residual', '#6a4fb3')], { log: true, text: power }],
    ];
    this.parent = parent;
    this.make = (title, unit, curves, how) => new Plot(parent, title, unit, curves, { ...how, seek });
    const tells = c => c.y.some(v => Number.isFinite(v) && v !== 0);  // of a run without coupling, no pull
    this.plots = time.length < 2 ? [] : wanted.map(([title, unit, curves, how]) => [title, unit, curves.filter(tells), how])
      .filter(([, , curves]) => curves.length).map(entry => this.make(...entry));
    this.gauges = time.length < 2 ? [] : (run.gauge_name ?? []).map((name, i) => ({ name, curve: curve(`gauge${i}`, '#8a5a44') }))
      .filter(({ curve }) => tells(curve));
  }
  /** Draws the gauge as the last plot; -1: none. */
  choose(i) {
    if (this.chosen) this.plots.pop().canvas.remove();
    this.chosen = i >= 0;
    if (this.chosen) this.plots.push(this.make(this.gauges[i].name, '', [this.gauges[i].curve]));
  }
  resize() { for (const plot of this.plots) plot.resize(); }
  draw(frame, time) { for (const plot of this.plots) plot.draw(frame, time); }
}
