// Who looks: an eye on a sphere around a point, z up; mouse, fingers and keys move it.

const STEEPEST = Math.PI / 2 - 1e-3;

class Orbit {
  /** camera: perspective; element: what is dragged on; changed: called after every move. */
  constructor(camera, element, changed) {
    Object.assign(this, { camera, element, changed });
    this.target = new THREE.Vector3();
    this.azimuth = -0.9;
    this.elevation = 0.42;
    this.distance = 20;
    this.pointers = new Map();
    element.addEventListener("pointerdown", (event) => this.down(event));
    element.addEventListener("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"])
      element.addEventListener(name, (event) => this.pointers.delete(event.pointerId));
    element.addEventListener("contextmenu", (event) => event.preventDefault());
    element.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), 120) * 0.0014));
    }, { passive: false });
  }

  down(event) {
    this.element.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }

  move(event) {
    const last = this.pointers.get(event.pointerId);
    if (!last) return;
    const dx = event.clientX - last.x, dy = event.clientY - last.y;
    const before = this.spread();
    last.x = event.clientX;
    last.y = event.clientY;
    if (this.pointers.size > 1) {
      this.pan(dx / 2, dy / 2);
      if (before) this.zoom(before / this.spread());
    } else if (event.buttons & 6 || event.shiftKey) this.pan(dx, dy);
    else this.turn(-0.006 * dx, 0.006 * dy);
  }

  /** Distance of two fingers, in pixels. */
  spread() {
    const [one, other] = this.pointers.values();
    return other ? Math.hypot(one.x - other.x, one.y - other.y) : 0;
  }

  turn(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation = Math.max(-0.3, Math.min(STEEPEST, this.elevation + elevation));
    this.place();
  }

  zoom(factor) {
    this.distance = Math.max(this.nearest, Math.min(this.farthest, this.distance * factor));
    this.place();
  }

  pan(dx, dy) {
    const size = 2 * this.distance * Math.tan((this.camera.fov * Math.PI) / 360);
    const pixel = size / this.element.clientHeight;
    const axes = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
    this.camera.matrix.extractBasis(...axes);
    this.target.addScaledVector(axes[0], -dx * pixel).addScaledVector(axes[1], dy * pixel);
    this.place();
  }

  /** Look along a direction at all of some points. */
  fit(points, azimuth = this.azimuth, elevation = this.elevation) {
    Object.assign(this, { azimuth, elevation });
    const box = new THREE.Box3().setFromPoints(points);
    box.getCenter(this.target);
    this.distance = 1;
    this.nearest = 1e-3;
    this.farthest = 1e6;
    this.place();
    const axes = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
    this.camera.matrixWorld.extractBasis(...axes);
    const half = Math.tan((this.camera.fov * Math.PI) / 360);
    const wide = half * this.camera.aspect;
    let farthest = 0, low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    const offset = new THREE.Vector3();
    for (let pass = 0; pass < 2; pass++) {
      for (const point of points) {
        offset.subVectors(point, this.target);
        const [right, up, near] = axes.map((axis) => offset.dot(axis));
        low = [Math.min(low[0], right), Math.min(low[1], up)];
        high = [Math.max(high[0], right), Math.max(high[1], up)];
        farthest = Math.max(farthest, near + Math.abs(right) / wide, near + Math.abs(up) / half);
      }
      if (pass) break;
      this.target.addScaledVector(axes[0], (low[0] + high[0]) / 2);
      this.target.addScaledVector(axes[1], (low[1] + high[1]) / 2);
      farthest = 0;
    }
    this.distance = 1.12 * farthest;
    this.nearest = farthest / 60;
    this.farthest = 5 * farthest;
    this.place();
  }

  /** From where a way is seen best: little of it hidden by boxes, and little of it end on. */
  best(way, boxes) {
    let found = [-0.9, 0.42], merit = -Infinity;
    for (const elevation of [0.4, 0.55])
      for (let degrees = -170; degrees < 180; degrees += 15) {
        const azimuth = (degrees * Math.PI) / 180, level = Math.cos(elevation);
        const ray = new THREE.Ray();
        ray.direction.set(level * Math.cos(azimuth), level * Math.sin(azimuth), Math.sin(elevation));
        let seen = 0, along = 0;
        way.forEach((point, i) => {
          ray.origin.copy(point);
          if (boxes.every((box) => !ray.intersectsBox(box))) seen += 1;
          if (i) along += new THREE.Vector3().subVectors(point, way[i - 1]).cross(ray.direction).length();
        });
        const length = way.reduce((sum, point, i) => sum + (i ? point.distanceTo(way[i - 1]) : 0), 1e-9);
        const value = 2 * (seen / way.length) + along / length - 0.1 * Math.abs(elevation - 0.4);
        if (value > merit + 1e-9) [merit, found] = [value, [azimuth, elevation]];
      }
    return found;
  }

  place() {
    const level = Math.cos(this.elevation);
    this.towards = new THREE.Vector3(
      level * Math.cos(this.azimuth), level * Math.sin(this.azimuth), Math.sin(this.elevation));
    this.camera.position.copy(this.target).addScaledVector(this.towards, this.distance);
    this.camera.near = this.distance / 100;
    this.camera.far = this.distance * 10;
    this.camera.updateProjectionMatrix();
    this.camera.lookAt(this.target);
    this.camera.updateMatrixWorld();
    this.changed();
  }
}
