// The time that is shown: playing, seeking, speed.
import { page } from './data.js';

const SPEEDS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 1000];
const PASS = 9; // s that a pass takes, unless the real speed takes 2 to 30 s

export class Clock {
  constructor() {
    this.end = Math.max(...page.runs.map(run => run.end));
    this.t = 0;
    this.playing = false;
    this.touched = true; // something has changed since the last frame
    this.speeds = SPEEDS;
    const off = speed => Math.abs(Math.log(this.end / speed / PASS));
    const real = this.end >= 2 && this.end <= 30;
    this.speed = real ? 1 : SPEEDS.reduce((a, b) => (off(b) < off(a) ? b : a));
    this.digits = Math.max(0, Math.min(4, 3 - Math.floor(Math.log10(this.end || 1))));
    this.onPlay = () => {};
    this.onEnd = null; // at the end of a recorded pass
  }

  touch() {
    this.touched = true;
  }

  seek(t) {
    this.t = Math.min(this.end, Math.max(0, t));
    this.touch();
  }

  play(on) {
    this.playing = on;
    if (on && this.t >= this.end) this.t = 0;
    this.last = performance.now();
    this.onPlay(on);
  }

  /** Seek and stay there. */
  halt(t) {
    this.play(false);
    this.seek(t);
  }

  faster(by) {
    const i = SPEEDS.indexOf(this.speed) + by;
    this.speed = SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, i))];
  }

  nextEvent() {
    const next = page.events.find(event => event.t > this.t + 1e-9);
    if (next) this.halt(next.t);
  }

  /** Advance to the time `now` of a frame, in ms; after the end a pass begins again. */
  advance(now) {
    if (!this.playing) return;
    this.t += ((now - this.last) / 1000) * this.speed;
    this.last = now;
    this.touch();
    if (this.t < this.end) return;
    this.t = this.onEnd ? this.end : 0;
    if (this.onEnd) {
      this.play(false);
      this.onEnd();
    }
  }
}
