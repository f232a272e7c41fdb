// The scene: what stands still by layers, what moves, labels, and drawing only when asked.

/** Colours of things from the style sheet, which knows light and dark. */
function themeColors() {
  const style = getComputedStyle(document.documentElement);
  const names = ["paper", "ink", "quiet", "faint", "stone", "edge", "load", "arm", "joint", "free", "shadow", "warning", "shade", "route"];
  return Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

class Stage {
  constructor(canvas, labels) {
    Object.assign(this, { canvas, labels, frames: 0, tags: [], systems: [], hidden: new Set() });
    const probe = document.createElement("canvas").getContext("webgl2");
    const info = probe && probe.getExtension("WEBGL_debug_renderer_info");
    const name = info ? probe.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
    this.soft = /swiftshader|llvmpipe|software|basic render/i.test(name); // drawn by the processor
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.soft });
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.1, 100);
    this.camera.up.set(0, 0, 1);
    this.world = new THREE.Scene();
    this.sun = new THREE.DirectionalLight("#ffffff", 0.62);
    this.world.add(new THREE.HemisphereLight("#ffffff", "#9a9a92", 0.62), this.sun, this.sun.target);
    this.theme = themeColors();
    this.layers = new Map();
    this.orbit = new Orbit(this.camera, canvas, () => this.ask());
    this.ray = new THREE.Raycaster();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    canvas.addEventListener("pointermove", (event) => this.point(event));
    canvas.addEventListener("pointerleave", () => this.point(null));
    canvas.addEventListener("webglcontextrestored", () => this.ask());
  }

  /** Everything that stands still in a scene, each kind in a layer that can be switched. */
  build(data) {
    for (const group of this.layers.values()) freed(group);
    this.layers.clear();
    this.clearTags();
    Object.assign(this, { data, theme: themeColors(), ticks: [] });
    this.world.background = new THREE.Color(this.theme.paper);
    this.ground();
    this.room();
    this.obstacles();
    if (data.regions) this.regions(data.regions);
    for (const [who, body] of Object.entries(data.bodies)) this.shadows(who, body);
    this.places();
    this.resize();
  }

  layer(name, ...objects) {
    if (!this.layers.has(name)) this.layers.set(name, new THREE.Group());
    const group = this.layers.get(name);
    group.add(...objects);
    this.world.add(group);
    group.visible = !this.hidden.has(name);
    return group;
  }

  show(name, visible) {
    if (visible) this.hidden.delete(name);
    else this.hidden.add(name);
    if (this.layers.has(name)) this.layers.get(name).visible = visible;
    for (const system of this.systems)
      if (system.groups[name]) system.groups[name].visible = visible;
    this.ask();
  }

  translucent(color, opacity) {
    return new THREE.MeshBasicMaterial({ color, transparent: true, opacity, depthWrite: false });
  }

  lines(color, opacity = 1) {
    return new THREE.LineBasicMaterial({ color, transparent: opacity < 1, opacity, depthWrite: opacity === 1 });
  }

  /** Floor with a grid at round metres of the world, and their numbers. */
  ground() {
    const { data, theme } = this, { frame, floor } = data, pairs = [];
    const [low, high] = data.workspace;
    for (const axis of [0, 1, 2]) {
      const from = (axis === 2 ? floor : low[axis]);
      const world = (own) => frame.origin[axis] + frame.length * own - frame.anchor[axis];
      const own = (metres) => (metres + frame.anchor[axis] - frame.origin[axis]) / frame.length;
      const { values, step } = ticksBetween(world(from), world(high[axis]), axis === 2 ? 4 : 6);
      if (axis === 0) this.step = step;
      for (const metres of values) {
        const at = own(metres), text = String(+metres.toPrecision(6)).replace("-", "−");
        if (axis < 2) {
          const ends = [[0, 0, floor], [0, 0, floor]];
          ends.forEach((end, side) => { end[axis] = at; end[1 - axis] = [low, high][side][1 - axis]; });
          pairs.push(ends);
        }
        this.ticks.push({ axis, at, tag: this.tag(text, [0, 0, 0], "tick") });
      }
      const away = frame.anchor[axis];
      const name = `${"xyz"[axis]}${away ? ` ${away > 0 ? "−" : "+"} ${Math.abs(away)}` : ""} (m)`;
      this.ticks.push({ axis, at: null, tag: this.tag(name, [0, 0, 0], "tick axis") });
    }
    const grid = new THREE.LineSegments(linesOf(pairs), this.lines(theme.faint));
    const plane = new THREE.Mesh(
      new THREE.PlaneGeometry(high[0] - low[0], high[1] - low[1]),
      new THREE.MeshBasicMaterial({ color: theme.faint, transparent: true, opacity: 0.28, side: THREE.DoubleSide, depthWrite: false }));
    plane.position.set((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, floor - 0.004);
    plane.renderOrder = -1;
    this.layer("ground", grid, plane);
  }

  room() {
    const look = this.lines(this.theme.quiet, 0.55);
    this.layer("workspace", new THREE.LineSegments(linesOf(boxEdges(this.data.workspace)), look));
  }

  obstacles() {
    const { data, theme } = this;
    if (!data.obstacles.length) return;
    const shapes = data.obstacles.map((each) => obstacleShape(each));
    const starts = [];
    let faces = 0;
    for (const shape of shapes) {
      starts.push(faces);
      faces += (shape.index ? shape.index.count : shape.getAttribute("position").count) / 3;
    }
    this.stones = new THREE.Mesh(merged(shapes), new THREE.MeshLambertMaterial({
      color: theme.stone, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
    this.stones.userData.starts = starts;
    this.layer("obstacles", this.stones, new THREE.LineSegments(edgesOf(shapes), this.lines(theme.edge)));
    const meshes = data.obstacles.filter((each) => each.kind === "mesh");
    if (meshes.length) { // a box that stands for a mesh is crossed out, so that nobody takes it for one
      const pairs = meshes.flatMap(({ center, size, yaw }) => {
        const cos = Math.cos(yaw), sin = Math.sin(yaw), up = center[2] + size[2] / 2 + 0.003;
        const corner = (x, y) => [
          center[0] + (cos * x * size[0] - sin * y * size[1]) / 2,
          center[1] + (sin * x * size[0] + cos * y * size[1]) / 2, up];
        return [[corner(-1, -1), corner(1, 1)], [corner(-1, 1), corner(1, -1)]];
      });
      this.layer("obstacles", new THREE.LineSegments(linesOf(pairs), this.lines(theme.edge)));
    }
    const wide = data.obstacles.map((each) => obstacleShape(each, data.clearance));
    this.layer("warning", new THREE.Mesh(merged(wide), this.translucent(theme.warning, 0.16)),
      new THREE.LineSegments(edgesOf(wide), this.lines(theme.warning, 0.6)));
  }

  regions({ triangles, edges, route }) {
    const { theme } = this;
    this.layer("regions", new THREE.Mesh(geometryOf(triangles), this.translucent(theme.free, 0.04)),
      new THREE.LineSegments(geometryOf(edges), this.lines(theme.free, 0.16)));
    if (!route) return;
    const { shape, data } = unpack(route), rods = [];
    const matrix = new THREE.Matrix4();
    for (let i = 0; i + 1 < shape[0]; i++)
      rods.push(ROD.clone().applyMatrix4(spanned(matrix, ...data.slice(3 * i, 3 * i + 6), 0.02)));
    this.layer("route", new THREE.Mesh(merged(rods), new THREE.MeshLambertMaterial({ color: theme.route })));
  }

  shadows(who, { triangles, edges }) {
    const cable = /^cable (\d+)$/.exec(who);
    const color = cable ? this.data.colors[cable[1] - 1] || this.theme.shadow : this.theme.shadow;
    this.layer(`shadow ${who}`, new THREE.Mesh(geometryOf(triangles), this.translucent(color, 0.1)),
      new THREE.LineSegments(geometryOf(edges), this.lines(color, 0.35)));
  }

  /** Start, goal and the names of the cables' ends. */
  places() {
    const { data, theme } = this;
    for (const name of ["start", "goal"]) {
      if (!data[name]) continue;
      const ring = new THREE.Mesh(RING, new THREE.MeshBasicMaterial({ color: theme.ink }));
      ring.scale.setScalar(1.25 * (data.payload ? data.payload.radius : 0.1));
      ring.position.fromArray(data[name]);
      this.layer("path", ring);
      this.tag(name, data[name], "place", 20);
    }
    this.names = data.robots.map((_, k) => this.tag(`P${k + 1}`, [0, 0, 0], "end", -16));
    this.tight = this.tag("", [0, 0, 0], "tight", -18);
    this.knob = new THREE.Mesh(BALL, new THREE.MeshBasicMaterial({ color: BEYOND, depthTest: false }));
    this.knob.scale.setScalar(0.075);
    this.knob.renderOrder = 5;
    this.layer("path", this.knob);
  }

  /** The tracks that are shown: the first as it is, the others pale beside it. */
  put(tracks) {
    for (const system of this.systems) system.dispose();
    this.systems = this.data.payload ? tracks.map((track, i) => new System(track, this, i > 0)) : [];
    for (const system of this.systems)
      for (const [name, group] of Object.entries(system.groups)) {
        group.visible = !this.hidden.has(name);
        this.world.add(group);
      }
    const tight = tracks.length ? tracks[0].tightest : null;
    this.knob.visible = this.tight.shown = Boolean(tight);
    if (tight) {
      this.knob.position.fromArray(tracks[0].at(tight.time).position);
      this.knob.position.toArray(this.tight.at);
      this.tight.element.textContent = "tightest";
    }
  }

  pose(time) {
    for (const system of this.systems) system.pose(time);
    const [first] = this.systems;
    if (first) this.names.forEach((tag, k) => {
      for (let i = 0; i < 3; i++) tag.at[i] = first.track.now.ends[3 * k + i];
    });
    this.ask();
  }

  /** The best view of the load's way, or of the way between start and goal. */
  see() {
    const [first] = this.systems, way = [], { start, goal } = this.data;
    if (first && first.track.times.length > 1) {
      const { data, shape } = first.track.position, step = Math.max(1, Math.floor(shape[0] / 25));
      for (let i = 0; i < shape[0]; i += step) way.push(new THREE.Vector3().fromArray(data, 3 * i));
    } else if (start && goal)
      for (let i = 0; i <= 12; i++) way.push(new THREE.Vector3(...start).lerp(new THREE.Vector3(...goal), i / 12));
    const boxes = this.data.obstacles.map((each) =>
      new THREE.Box3().setFromBufferAttribute(obstacleShape(each).getAttribute("position")));
    this.fit(...(way.length ? this.orbit.best(way, boxes) : []));
  }

  fit(azimuth, elevation) {
    const box = new THREE.Box3(...this.data.workspace.map((corner) => new THREE.Vector3(...corner)));
    const points = boxEdges([box.min.toArray(), box.max.toArray()]).flat().map((each) => new THREE.Vector3(...each));
    for (const system of this.systems) points.push(...system.extent);
    this.orbit.fit(points, azimuth, elevation);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setPixelRatio(this.soft ? 1 : Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.size = [width, height];
    this.ask();
  }

  /** Draw with the next frame. */
  ask() {
    if (this.asked) return;
    this.asked = requestAnimationFrame(() => { this.asked = 0; this.draw(); });
  }

  draw() {
    if (!this.data || !this.size) return;
    this.sun.position.copy(this.camera.position).addScaledVector(this.camera.up, this.orbit.distance / 2);
    this.sun.target.position.copy(this.orbit.target);
    this.sun.target.updateMatrixWorld();
    this.renderer.render(this.world, this.camera);
    this.label();
    this.frames += 1;
  }

  tag(text, at, kind, below = 0) {
    const element = document.createElement("span");
    element.textContent = text;
    element.className = kind;
    this.labels.append(element);
    const found = { element, at: [...at], below, shown: true };
    this.tags.push(found);
    return found;
  }

  clearTags() {
    this.tags = [];
    this.labels.replaceChildren();
  }

  /** Moves the labels to where their places are in the picture. */
  label() {
    if (this.hidden.has("labels")) { this.labels.hidden = true; return; }
    this.labels.hidden = false;
    this.number();
    const [width, height] = this.size;
    for (const { element, at, below, shown } of this.tags) {
      PLACE.fromArray(at).project(this.camera);
      const seen = shown && Math.abs(PLACE.x) < 1.02 && Math.abs(PLACE.y) < 1.02 && PLACE.z < 1;
      element.hidden = !seen;
      if (!seen) continue;
      const x = ((PLACE.x + 1) / 2) * width, y = ((1 - PLACE.y) / 2) * height + below;
      element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
    }
  }

  /** Numbers stand along the two edges of the floor next to the viewer, and up the left one. */
  number() {
    const { towards } = this.orbit, [low, high] = this.data.workspace, floor = this.data.floor;
    const near = [0, 1].map((i) => (towards[i ? "y" : "x"] > 0 ? high[i] : low[i]));
    const out = [0, 1].map((i) => Math.sign(near[i] - (low[i] + high[i]) / 2));
    const pixel = (2 * this.orbit.distance * Math.tan((this.camera.fov * Math.PI) / 360)) / this.size[1];
    const gap = 20 * pixel;
    const right = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const corners = [low, high].flatMap((a) => [low, high].map((b) => [a[0], b[1]]));
    const left = corners.reduce((a, b) => (a[0] * right.x + a[1] * right.y < b[0] * right.x + b[1] * right.y ? a : b));
    for (const { axis, at, tag } of this.ticks) {
      const named = at === null, far = named ? 1.8 + 0.17 * tag.element.textContent.length : 1;
      const middle = (low[axis] + high[axis]) / 2;
      if (axis === 2) tag.at = [left[0] - right.x * gap, left[1] - right.y * gap, named ? high[2] + gap : at];
      else {
        tag.at = [0, 0, floor];
        tag.at[axis] = named ? middle : at;
        tag.at[1 - axis] = near[1 - axis] + far * gap * out[1 - axis];
      }
      tag.shown = !this.hidden.has("ground") && (axis === 2 ? towards.z < 0.95 : true);
    }
  }

  /** The name of the obstacle under the pointer. */
  point(event) {
    if (!this.data || !this.data.obstacles.length || this.hidden.has("obstacles")) return;
    let name = "";
    if (event && !event.buttons) {
      const box = this.canvas.getBoundingClientRect();
      POINTER.set(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height);
      this.ray.setFromCamera(POINTER, this.camera);
      const [hit] = this.ray.intersectObject(this.stones);
      if (hit) {
        const { starts } = this.stones.userData;
        const i = starts.findLastIndex((start) => start <= hit.faceIndex);
        const { name: own, kind, stands } = this.data.obstacles[i];
        name = kind === "hull" ? `${own} (mesh, ${stands})` : kind === "mesh" ? `${own} (mesh, as its box)` : own === kind ? own : `${own} (${kind})`;
      }
    }
    this.canvas.title = name;
    this.pointed(name);
  }

  pointed() {}
}
const PLACE = new THREE.Vector3();
const POINTER = new THREE.Vector2();
