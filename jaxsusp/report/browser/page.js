// The page: what is shown, at which time, and how it is asked for.

class Page {
  constructor(content) {
    this.find = (id) => document.getElementById(id);
    this.scenes = content.scenes;
    this.tracks = content.tracks.map((record, i) => new Track(record, i));
    this.notes = content.notes;
    Object.assign(this, { time: 0, playing: false, beside: new Set(), script: 0 });
    try {
      this.stage = new Stage(this.find("view"), this.find("labels"));
      this.stage.pointed = (name) => { this.named = name; this.tell(); };
    } catch (error) { // no WebGL: curves and limits are still there
      this.find("no-view").hidden = false;
      console.warn(error.message);
    }
    this.curves = new Curves(this.find("curves"), (time) => this.seek(time));
    for (const name of ["warning", "regions", "route"]) this.stage?.hidden.add(name);
    this.listen();
    this.enter(0);
  }

  /** Shows another scene, with the first track in it. */
  enter(number) {
    this.scene = this.scenes[number];
    this.here = this.tracks.filter((track) => track.scene === number);
    this.find("title").textContent = this.scene.name;
    const standing = this.here.length && this.here.every((track) => track.times.length === 1);
    this.beside = new Set(standing ? this.here.slice(1) : []);
    if (this.stage) {
      const { hidden } = this.stage;
      for (const who of Object.keys(this.scene.bodies)) if (!this.known?.has(who)) hidden.add(`shadow ${who}`);
      this.known = new Set([...(this.known || []), ...Object.keys(this.scene.bodies)]);
      if (!this.scene.payload) for (const name of ["regions", "route"]) hidden.delete(name);
      this.stage.build(this.scene);
      listLayers(this.find("layers").querySelector("fieldset"), this.stage, (name, on) => this.layer(name, on));
    }
    this.choose(this.here[0] || null);
    this.stage?.see();
  }

  /** Shows a track; what was beside stays beside. */
  choose(track) {
    this.track = track;
    this.beside.delete(track);
    this.find("runs").hidden = !track;
    this.find("transport").hidden = !track || track.times.length === 1;
    this.find("scale").hidden = !track;
    const verdict = this.find("verdict");
    verdict.textContent = track ? VERDICTS[track.verdict] : "";
    verdict.className = track ? verdictClass(track) : "";
    listSentences(this.find("notes"), [...this.scene.notes, ...(this.scene.regions ? [this.scene.regions.told] : []), ...this.notes]);
    this.find("curves").hidden = !track;
    if (!track) {
      this.find("reasons").hidden = this.find("limits").hidden = true;
      this.stage?.put([]);
      this.tell();
      return;
    }
    listSentences(this.find("reasons"), track.reasons);
    listLimits(this.find("limits"), track, (time) => this.seek(time));
    this.clock(track);
    this.arrange();
  }

  /** The slider and what belongs to it, for the length of a track. */
  clock(track) {
    const slider = this.find("time"), tight = track.tightest;
    slider.max = track.duration;
    slider.step = track.duration / (track.times.length - 1 || 1);
    const mark = this.find("mark"), button = this.find("tightest");
    mark.hidden = button.hidden = !tight;
    if (!tight) return;
    mark.style.left = `${(100 * tight.time) / track.duration}%`;
    button.textContent = `Tightest: ${tight.time.toFixed(1)} s`;
    button.title = `${tight.limit}: ${tight.value}, allowed ${tight.allowed}${tight.of ? ` (${tight.of})` : ""}`;
  }

  /** Draws the chosen track and those beside it. */
  arrange() {
    const beside = this.here.filter((track) => this.beside.has(track));
    listTracks(this.find("runs"), this.here, this.track, this.beside,
      (track) => this.choose(track), (track, on) => this.accompany(track, on));
    this.stage?.put([this.track, ...beside]);
    this.curves.put(this.track, beside);
    this.seek(Math.min(this.time, this.track.duration));
  }

  accompany(track, on) {
    if (on) this.beside.add(track);
    else this.beside.delete(track);
    this.arrange();
  }

  /** Goes to a time (s). */
  seek(time) {
    if (!this.track) return;
    const before = performance.now();
    this.time = Math.max(0, Math.min(this.track.duration, time));
    this.find("time").value = this.time;
    this.find("time").setAttribute("aria-valuetext", `${this.time.toFixed(1)} s`);
    this.stage ? this.stage.pose(this.time) : this.track.at(this.time);
    this.curves.point(this.time);
    this.tell();
    this.script = performance.now() - before;
  }

  /** Where the load is, in words. */
  tell() {
    const { frame } = this.scene, parts = [];
    if (this.track) {
      const place = worldOf(frame, this.track.now.position).map((each) => fixed(each, frame.decimals + 1));
      parts.push(`load at (${place.join(", ")}) m`);
      this.find("clock").textContent = `${this.time.toFixed(1)} of ${+this.track.duration.toFixed(1)} s`;
      const low = this.scene.tension[0], high = this.scene.tension[1];
      this.find("scale-low").textContent = `${inWords(low)} N`;
      this.find("scale-high").textContent = `${inWords(high)} N`;
    }
    if (this.named) parts.push(this.named);
    this.find("readout").textContent = parts.join(" · ");
  }

  play(on = !this.playing) {
    if (on === this.playing || !this.track || this.track.times.length === 1) return;
    this.playing = on;
    const button = this.find("play");
    button.classList.toggle("playing", on);
    button.setAttribute("aria-label", on ? "Pause" : "Play");
    if (!on) return;
    if (this.time >= this.track.duration) this.seek(0);
    let last = performance.now();
    const step = (now) => {
      if (!this.playing) return;
      this.seek(this.time + Math.max(0, (now - last) / 1000) * Number(this.find("speed").value));
      last = now;
      if (this.time >= this.track.duration) this.play(false);
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  layer(name, on) {
    this.stage?.show(name, on);
    const box = document.querySelector(`#layers input[value="${name}"]`);
    if (box) box.checked = on;
  }

  toTightest() {
    const tight = this.track?.tightest;
    if (!tight) return;
    this.play(false);
    this.seek(tight.time);
  }

  listen() {
    const choice = this.find("scene");
    choice.append(...this.scenes.map((scene, i) => made("option", { value: i, textContent: scene.name })));
    this.find("scene-choice").hidden = this.scenes.length < 2;
    this.find("title").hidden = this.scenes.length > 1;
    choice.addEventListener("change", () => { this.play(false); this.enter(Number(choice.value)); });
    this.find("time").addEventListener("input", (event) => { this.play(false); this.seek(Number(event.target.value)); });
    this.find("play").addEventListener("click", () => this.play());
    this.find("tightest").addEventListener("click", () => this.toTightest());
    for (const button of document.querySelectorAll("#views button"))
      button.addEventListener("click", () => this.view(button.dataset.view));
    addEventListener("keydown", (event) => this.key(event));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.repaint());
  }

  view(name) {
    if (name === "fit") return this.stage?.see();
    const eye = { top: [-Math.PI / 2, STEEPEST], front: [-Math.PI / 2, 0.06], side: [0, 0.06] }[name];
    this.stage?.fit(...eye);
  }

  /** Keys of the whole page; fields keep those that they know. */
  key(event) {
    const field = event.target.closest?.("input, select, button, summary");
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = this.track ? this.track.duration / 200 : 0;
    const turns = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    const actions = {
      " ": () => this.play(), t: () => this.toTightest(),
      ArrowRight: () => this.seek(this.time + step), ArrowLeft: () => this.seek(this.time - step),
      Home: () => this.seek(0), End: () => this.seek(this.track ? this.track.duration : 0),
      "+": () => this.stage?.orbit.zoom(0.9), "=": () => this.stage?.orbit.zoom(0.9), "-": () => this.stage?.orbit.zoom(1.1),
    };
    if (event.shiftKey && turns[event.key] && (!field || field.type === "checkbox" || field.localName === "button"))
      this.stage?.orbit.turn(...turns[event.key]);
    else {
      const known = field && (field.localName === "select" || field.localName === "button" || field.localName === "summary"
        ? " " === event.key || field.localName === "select" : field.type === "range" ? event.key !== " " && event.key !== "t" : event.key === " " || event.key.startsWith("Arrow"));
      if (known || !actions[event.key]) return;
      actions[event.key]();
    }
    event.preventDefault();
  }

  /** Colours anew, when light turns to dark. */
  repaint() {
    const { orbit } = this.stage || {};
    this.stage?.build(this.scene);
    this.arrange();
    orbit?.place();
  }
}

const VERDICTS = {
  feasible: "Feasible: every limit is kept, and it is proved clear at every instant",
  infeasible: "Infeasible",
  clear: "Clear at the samples of its search; not proved",
  "violates limits": "Violates limits at the samples of its search",
  inadmissible: "Start or goal is no place for the load",
  "no plan": "No plan: load and cables at start and goal",
};

const page = new Page(JSON.parse(document.getElementById("data").textContent));

/** What tests and other scripts may ask for. */
window.jaxsusp = {
  get state() {
    const { track, scene, time, playing } = page;
    return {
      scene: scene.name, track: track && track.name, time, playing,
      load: track && worldOf(scene.frame, track.now.position),
      beside: [...page.beside].map((each) => each.name),
      hidden: page.stage ? [...page.stage.hidden] : [],
    };
  },
  seek: (time) => page.seek(time),
  layer: (name, on) => page.layer(name, on),
  get frames() { return page.stage ? page.stage.frames : 0; },
  get script() { return page.script; },
  get calls() { return page.stage ? page.stage.renderer.info.render.calls : 0; },
};
