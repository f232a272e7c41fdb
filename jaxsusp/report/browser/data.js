"use strict";
// The data of the page: arrays out of base64, and where everything is at a time.

/** Array packed by packing.py → {shape, data}. */
function unpack({ shape, base64 }) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return { shape, data: new Float32Array(bytes.buffer) };
}

/** Index i and share s of a time between times[i] and times[i + 1]. */
function locate(times, time) {
  let low = 0, high = times.length - 1;
  if (!(time > times[0]) || high === 0) return [0, 0];
  if (time >= times[high]) return [high - 1, 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return [low, (time - times[low]) / (times[high] - times[low])];
}

/** One thing that moves, with rows of arrays between which it is interpolated. */
class Track {
  constructor(record, number) {
    Object.assign(this, record);
    this.number = number;
    for (const name of ["times", "position", "turn", "ends", "chains", "tensions"])
      this[name] = unpack(record[name]);
    this.times = this.times.data;
    this.duration = this.times[this.times.length - 1];
    this.cables = this.ends.shape[1];
    for (const curve of this.curves) {
      curve.times = unpack(curve.times).data;
      for (const line of curve.lines) line.values = unpack(line.values).data;
    }
    this.now = {
      position: new Float32Array(3), turn: new Float32Array(4),
      ends: new Float32Array(3 * this.cables), chains: new Float32Array(12 * this.cables),
      tensions: new Float32Array(this.cables),
    };
  }

  /** Everything at a time (s); the same arrays every time. */
  at(time) {
    const [i, share] = locate(this.times, time);
    for (const name in this.now) blend(this[name], i, share, this.now[name]);
    return this.now;
  }

  /** The tightest moment, if there is one. */
  get tightest() {
    const first = this.limits[0];
    return first && first.tight !== null && first.time !== null ? first : null;
  }
}

/** Row i of an array and a share of the way to the next one; of one row always that. */
function blend(array, i, share, out) {
  const rows = array.shape[0], width = out.length;
  const here = Math.min(i, rows - 1) * width, there = Math.min(i + 1, rows - 1) * width;
  for (let j = 0; j < width; j++) {
    const from = array.data[here + j];
    out[j] = from + share * (array.data[there + j] - from);
  }
}

/** Value of a line of a curve at a time. */
function valueAt(curve, line, time) {
  if (curve.times.length === 1) return line.values[0];
  const [i, share] = locate(curve.times, time);
  return line.values[i] + share * (line.values[i + 1] - line.values[i]);
}

/** Metres in the world, of a place in own units; in double precision. */
function worldOf(frame, place) {
  return [0, 1, 2].map((i) => frame.origin[i] + frame.length * place[i]);
}

/** A number to four significant digits or so, with a real minus. */
function inWords(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const digits = size >= 1000 ? 0 : size >= 100 ? 1 : size >= 1 ? 2 : 3;
  return fixed(value, digits);
}

/** A number with so many decimals and a real minus, but for nothing. */
function fixed(value, digits) {
  return value.toFixed(digits).replace(/^-(?=0\.?0*$)/, "").replace("-", "−");
}
