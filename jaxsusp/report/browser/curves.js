// Curves along the time with their limits, each in a canvas, and one cursor through all of them.

const ROOM = { left: 46, right: 10, top: 8, bottom: 18 };

/** What a panel shows from bottom to top: all values and limits, but of distances the near ones. */
function rangeOf(curve) {
  let low = Infinity, high = -Infinity, nearest = -Infinity;
  for (let i = 0; i < curve.times.length; i++) {
    let least = Infinity;
    for (const { values } of curve.lines) {
      if (!Number.isFinite(values[i])) continue;
      low = Math.min(low, values[i]);
      high = Math.max(high, values[i]);
      least = Math.min(least, values[i]);
    }
    if (Number.isFinite(least)) nearest = Math.max(nearest, least);
  }
  const bounds = [curve.limits, ...curve.lines.map((line) => line.limits)].flat().filter((each) => each !== null);
  if (curve.limits[0] !== null && curve.limits[1] === null) high = Math.min(high, 1.6 * nearest);
  low = Math.min(low, ...bounds);
  high = Math.max(high, ...bounds);
  if (!(high > low)) [low, high] = Number.isFinite(low) ? [low - 1, low + 1] : [0, 1];
  const room = 0.06 * (high - low);
  return [low - room, high + room];
}

class Panel {
  constructor(curve, seek) {
    Object.assign(this, { curve, seek, range: rangeOf(curve) });
    this.element = document.createElement("figure");
    this.element.className = curve.still ? "curve still" : "curve";
    const caption = document.createElement("figcaption");
    const name = document.createElement("strong");
    name.textContent = `${curve.name} (${curve.unit})${curve.still ? ", which stays" : ""}`;
    caption.append(name);
    this.values = curve.lines.map((line) => {
      const item = document.createElement("span"), swatch = document.createElement("i"), value = document.createElement("b");
      swatch.style.borderTopColor = line.color;
      if (line.dash) swatch.style.borderTopStyle = line.dash.startsWith("2") ? "dotted" : "dashed";
      item.append(swatch, `${line.name} `, value);
      caption.append(item);
      return value;
    });
    this.plot = document.createElement("div");
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", this.inWords());
    this.cursor = document.createElement("div");
    this.cursor.className = "cursor";
    this.plot.append(this.canvas, this.cursor);
    this.element.append(caption, this.plot);
    for (const name of ["pointerdown", "pointermove"])
      this.plot.addEventListener(name, (event) => {
        if (name === "pointermove" && !(event.buttons & 1)) return;
        const x = event.clientX - this.plot.getBoundingClientRect().left;
        this.seek(((x - ROOM.left) / this.width) * this.duration);
      });
  }

  inWords() {
    const { curve } = this, [low, high] = curve.limits;
    const all = curve.lines.flatMap((line) => [...line.values]).filter(Number.isFinite);
    const limit = [low === null ? "" : `at least ${inWords(low)}`, high === null ? "" : `at most ${inWords(high)}`].filter(Boolean);
    const range = all.length ? `from ${inWords(Math.min(...all))} to ${inWords(Math.max(...all))} ${curve.unit}` : "no values";
    return `${curve.name} over time, ${range}${limit.length ? `; allowed: ${limit.join(", ")} ${curve.unit}` : ""}`;
  }

  /** Draws all but the cursor. others: the same curve of other tracks, pale in their colours. */
  draw(duration, others, tight) {
    const ratio = Math.min(devicePixelRatio, 2), { canvas, curve } = this;
    const wide = this.plot.clientWidth, tall = this.plot.clientHeight;
    if (!wide) return;
    Object.assign(this, { duration, width: wide - ROOM.left - ROOM.right, height: tall - ROOM.top - ROOM.bottom });
    canvas.width = wide * ratio;
    canvas.height = tall * ratio;
    const pen = canvas.getContext("2d"), theme = themeColors();
    pen.scale(ratio, ratio);
    const [low, high] = this.range;
    this.x = (time) => ROOM.left + (this.width * time) / duration;
    const y = (value) => ROOM.top + this.height * (1 - (value - low) / (high - low));
    this.scales(pen, theme, y);
    pen.save();
    pen.beginPath();
    pen.rect(ROOM.left, ROOM.top - 2, this.width, this.height + 4);
    pen.clip();
    this.limits(pen, theme, y);
    for (const { curve: other, color } of others)
      for (const line of other.lines) this.line(pen, other.times, line.values, y, color, line.dash, 1, 0.55);
    for (const line of curve.lines) this.line(pen, curve.times, line.values, y, line.color, line.dash, 1.7, 1);
    if (tight) {
      pen.setLineDash([2, 3]);
      pen.strokeStyle = BEYOND;
      pen.beginPath();
      pen.moveTo(this.x(tight.time), ROOM.top);
      pen.lineTo(this.x(tight.time), ROOM.top + this.height);
      pen.stroke();
    }
    pen.restore();
  }

  scales(pen, theme, y) {
    pen.font = "11px system-ui, sans-serif";
    pen.fillStyle = theme.quiet;
    pen.strokeStyle = theme.faint;
    pen.lineWidth = 1;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    const digits = (step) => Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const vertical = ticksBetween(...this.range, 4), level = ticksBetween(0, this.duration, this.width < 260 ? 4 : 8);
    pen.beginPath();
    for (const value of vertical.values) {
      const at = Math.round(y(value)) + 0.5;
      pen.moveTo(ROOM.left, at);
      pen.lineTo(ROOM.left + this.width, at);
      pen.fillText(fixed(value, digits(vertical.step)), ROOM.left - 6, at);
    }
    pen.stroke();
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const time of level.values)
      pen.fillText(`${time.toFixed(digits(level.step))}${time === 0 ? " s" : ""}`, this.x(time), ROOM.top + this.height + 5);
  }

  limits(pen, theme, y) {
    pen.lineWidth = 1.3;
    const drawn = new Set();
    for (const line of this.curve.lines)
      line.limits.forEach((bound, side) => {
        if (bound === null || drawn.has(`${side} ${bound}`)) return;
        drawn.add(`${side} ${bound}`);
        const own = line.limits !== this.curve.limits && this.curve.limits.every((each) => each === null);
        const at = y(bound), edge = side ? ROOM.top : ROOM.top + this.height;
        pen.setLineDash([]);
        pen.fillStyle = theme.warning;
        pen.globalAlpha = own ? 0 : 0.1;
        pen.fillRect(ROOM.left, Math.min(at, edge) - 4, this.width, Math.abs(at - edge) + 4);
        pen.globalAlpha = 1;
        pen.setLineDash([6, 4]);
        pen.strokeStyle = own ? line.color : theme.warning;
        pen.beginPath();
        pen.moveTo(ROOM.left, at);
        pen.lineTo(ROOM.left + this.width, at);
        pen.stroke();
      });
    pen.setLineDash([]);
  }

  line(pen, times, values, y, color, dash, width, alpha) {
    pen.strokeStyle = color;
    pen.lineWidth = width;
    pen.globalAlpha = alpha;
    pen.setLineDash(dash ? dash.split(" ").map(Number) : []);
    pen.beginPath();
    let open = false;
    for (let i = 0; i < times.length; i++) {
      if (!Number.isFinite(values[i])) { open = false; continue; }
      if (open) pen.lineTo(this.x(times[i]), y(values[i]));
      else pen.moveTo(this.x(times[i]), y(values[i]));
      open = true;
    }
    pen.stroke();
    pen.globalAlpha = 1;
    pen.setLineDash([]);
  }

  /** Moves the cursor and tells the values there. */
  point(time) {
    if (this.x) this.cursor.style.transform = `translateX(${this.x(time).toFixed(1)}px)`;
    this.curve.lines.forEach((line, i) => {
      const value = valueAt(this.curve, line, time), [low, high] = line.limits;
      this.values[i].textContent = inWords(value);
      this.values[i].classList.toggle("broken", (low !== null && value < low - 1e-6) || (high !== null && value > high + 1e-6));
    });
  }
}

class Curves {
  constructor(element, seek) {
    Object.assign(this, { element, seek, panels: [] });
    new ResizeObserver(() => this.draw()).observe(element);
  }

  /** The curves of a track, with those of others beside it. */
  put(track, others) {
    for (const panel of this.panels) panel.element.remove();
    Object.assign(this, { track, others });
    this.panels = track.curves.map((curve) => new Panel(curve, this.seek));
    this.element.append(...this.panels.map((panel) => panel.element));
    this.element.hidden = !this.panels.length;
    this.draw();
  }

  draw() {
    if (!this.track) return;
    for (const panel of this.panels) {
      const beside = this.others.flatMap((other) => other.curves
        .filter((curve) => curve.name === panel.curve.name)
        .map((curve) => ({ curve, color: other.color })));
      panel.draw(this.track.duration || 1, beside, this.track.tightest);
    }
    this.point(this.time || 0);
  }

  point(time) {
    this.time = time;
    for (const panel of this.panels) panel.point(time);
  }
}
