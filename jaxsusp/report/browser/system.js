// What moves: the load on its cables, and the robots that hold them.

const THINNEST = 0.022; // own units: a cable drawn as thin as it is would not be seen

/** Colour of a tension between its limits: slack blue, taut red, and beyond them magenta. */
const TENSION_COLORS = ["#2c6fbb", "#1fa187", "#e6b422", "#d7301f"];
const BEYOND = "#d400d4";

function tensionColor(tension, [low, high], out) {
  const share = (tension - low) / (high - low);
  if (!(share >= -1e-6 && share <= 1 + 1e-6)) return out.set(BEYOND);
  const at = Math.min(Math.max(share, 0), 1) * (TENSION_COLORS.length - 1);
  const i = Math.min(Math.floor(at), TENSION_COLORS.length - 2);
  return out.set(TENSION_COLORS[i]).lerp(SECOND.set(TENSION_COLORS[i + 1]), at - i);
}
const SECOND = new THREE.Color();

const ROD = new THREE.CylinderGeometry(1, 1, 1, 12).rotateX(Math.PI / 2).translate(0, 0, 0.5);
const BALL = new THREE.SphereGeometry(1, 16, 12);
const RING = new THREE.TorusGeometry(1, 0.12, 8, 40);

class System {
  /** track: what moves; ghost: drawn pale in the track's colour, beside another one. */
  constructor(track, scene, ghost) {
    Object.assign(this, { track, scene, ghost });
    this.groups = { robots: new THREE.Group(), cables: new THREE.Group(), path: new THREE.Group() };
    this.material = (color, Kind = THREE.MeshLambertMaterial) => new Kind({
      color: ghost ? track.color : color, transparent: ghost, opacity: ghost ? 0.45 : 1 });
    const count = track.cables;
    this.cables = this.instances(this.groups.cables, ROD, count, "#ffffff", THREE.MeshBasicMaterial);
    this.standing = track.chains.shape[0] === 1;
    this.armed = !(ghost && this.standing); // arms that stand would stand in those of the other
    if (this.armed) {
      this.arms = this.instances(this.groups.robots, ROD, 3 * count, scene.theme.arm);
      this.joints = this.instances(this.groups.robots, BALL, 4 * count, scene.theme.joint);
    }
    this.hang(scene.data.payload);
    if (track.times.length > 1) this.draw();
    this.matrix = new THREE.Matrix4();
    this.color = new THREE.Color();
    this.posed = false;
  }

  instances(group, shape, count, color, Kind) {
    const mesh = new THREE.InstancedMesh(shape, this.material(color, Kind), count);
    mesh.frustumCulled = false;
    mesh.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
    group.add(mesh);
    return mesh;
  }

  /** The load, with a shadow straight below it that tells where it is. */
  hang(payload) {
    const { theme, data } = this.scene;
    let shape;
    if (payload.triangles) {
      shape = geometryOf(payload.triangles);
      shape.computeVertexNormals();
    } else {
      shape = new THREE.CylinderGeometry(payload.radius, payload.radius, payload.height, 40);
      shape.rotateX(Math.PI / 2);
    }
    this.load = new THREE.Mesh(shape, this.material(theme.load));
    this.groups.cables.add(this.load);
    if (this.ghost) return;
    const flat = { color: theme.shade, transparent: true, opacity: 0.3, depthWrite: false };
    this.shade = new THREE.Mesh(
      new THREE.CircleGeometry(1.3 * payload.radius, 32), new THREE.MeshBasicMaterial(flat));
    this.shade.position.z = data.floor + 0.012;
    this.plumb = new THREE.Line(
      linesOf([[[0, 0, 0], [0, 0, 1]]]),
      new THREE.LineBasicMaterial({ color: theme.shade, transparent: true, opacity: 0.35 }));
    this.groups.cables.add(this.shade, this.plumb);
  }

  /** The load's way, and the ways of ends that move. */
  draw() {
    const { track } = this, { data, shape } = track.position;
    const points = [], step = Math.max(1, Math.floor(shape[0] / 120));
    for (let i = 0; i < shape[0]; i += step) {
      const point = new THREE.Vector3().fromArray(data, 3 * i);
      if (!points.length || point.distanceTo(points[points.length - 1]) > 0.01) points.push(point);
    }
    points.push(new THREE.Vector3().fromArray(data, 3 * (shape[0] - 1)));
    const tube = new THREE.TubeGeometry(
      new THREE.CatmullRomCurve3(points), 2 * points.length, this.ghost ? 0.018 : 0.028, 6);
    const color = new THREE.MeshLambertMaterial({ color: track.color });
    this.groups.path.add(new THREE.Mesh(tube, color));
    if (track.ends.shape[0] === 1) return;
    for (let k = 0; k < track.cables; k++) {
      const way = [];
      for (let i = 0; i < track.ends.shape[0]; i++) {
        const at = 3 * (i * track.cables + k);
        way.push(new THREE.Vector3().fromArray(track.ends.data, at));
      }
      const look = new THREE.LineBasicMaterial({ color: this.scene.data.colors[k] });
      this.groups.path.add(new THREE.Line(new THREE.BufferGeometry().setFromPoints(way), look));
    }
  }

  /** Puts everything where it is at a time (s). */
  pose(time) {
    const now = this.track.at(time), { data } = this.scene;
    const { position: p, turn: q } = now;
    this.load.position.set(p[0], p[1], p[2]);
    this.load.quaternion.set(q[0], q[1], q[2], q[3]).normalize();
    if (this.shade) {
      this.shade.position.x = this.plumb.position.x = p[0];
      this.shade.position.y = this.plumb.position.y = p[1];
      this.plumb.position.z = data.floor;
      this.plumb.scale.z = Math.max(p[2] - data.payload.height / 2 - data.floor, 1e-3);
    }
    const radius = Math.max(data.cableRadius, THINNEST);
    for (let k = 0; k < this.track.cables; k++) {
      const [x, y, z] = data.payload.attachments[k];
      HOOK.set(x, y, z).applyQuaternion(this.load.quaternion).add(this.load.position);
      const e = now.ends;
      spanned(this.matrix, HOOK.x, HOOK.y, HOOK.z, e[3 * k], e[3 * k + 1], e[3 * k + 2], radius);
      this.cables.setMatrixAt(k, this.matrix);
      if (this.ghost) this.color.set("#ffffff");
      else tensionColor(now.tensions[k], data.tension, this.color);
      this.cables.setColorAt(k, this.color);
    }
    this.cables.instanceMatrix.needsUpdate = this.cables.instanceColor.needsUpdate = true;
    if (this.armed && !(this.standing && this.posed)) this.reach(now.chains);
    this.posed = true;
  }

  /** Puts columns, links and joints where the chains are: foot, shoulder, elbow, end. */
  reach(chains) {
    this.scene.data.robots.forEach((robot, k) => {
      const radii = [robot.column, robot.link, robot.link];
      for (let part = 0; part < 4; part++) {
        const at = 12 * k + 3 * part, c = chains;
        if (part < 3) {
          spanned(this.matrix, c[at], c[at + 1], c[at + 2], c[at + 3], c[at + 4], c[at + 5], radii[part]);
          this.arms.setMatrixAt(3 * k + part, this.matrix);
        }
        const size = part === 0 ? 1.6 * robot.column : part === 3 ? 0.9 * robot.link : 1.25 * robot.link;
        this.matrix.makeScale(size, size, part === 0 ? 0.4 * size : size);
        this.matrix.setPosition(c[at], c[at + 1], c[at + 2]);
        this.joints.setMatrixAt(4 * k + part, this.matrix);
      }
    });
    this.arms.instanceMatrix.needsUpdate = this.joints.instanceMatrix.needsUpdate = true;
  }

  /** Points that a view has to hold. */
  get extent() {
    const points = [], { chains, position } = this.track;
    const every = Math.max(1, Math.floor(chains.shape[0] / 10));
    for (let i = 0; i < chains.data.length / 3; i++)
      if (Math.floor(i / (4 * this.track.cables)) % every === 0)
        points.push(new THREE.Vector3().fromArray(chains.data, 3 * i));
    for (let i = 0; i < position.shape[0]; i += 10)
      points.push(new THREE.Vector3().fromArray(position.data, 3 * i));
    return points;
  }

  dispose() {
    for (const group of Object.values(this.groups)) freed(group);
  }
}
const HOOK = new THREE.Vector3();
const SHARED = new Set([ROD, BALL, RING]);

/** Gives back what a group holds of the graphics card. */
function freed(group) {
  group.removeFromParent();
  group.traverse((each) => {
    if (each.geometry && !SHARED.has(each.geometry)) each.geometry.dispose();
    if (each.material) each.material.dispose();
    if (each.isInstancedMesh) each.dispose();
  });
}
