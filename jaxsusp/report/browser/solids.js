// Shapes of what stands still, many of them as one geometry: draw calls are what takes time.

/** The shape of an obstacle, larger by a clearance all around, where it stands. */
function obstacleShape(obstacle, clearance = 0) {
  const grown = 2 * clearance;
  let shape;
  if (obstacle.kind === "cylinder") {
    const radius = obstacle.radius + clearance;
    shape = new THREE.CylinderGeometry(radius, radius, obstacle.height + grown, 48);
    shape.rotateX(Math.PI / 2);
  } else if (obstacle.kind === "sphere") {
    shape = new THREE.SphereGeometry(obstacle.radius + clearance, 32, 20);
    shape.rotateX(Math.PI / 2);
  } else if (obstacle.kind === "hull") {
    shape = geometryOf(clearance ? obstacle.wide : obstacle.triangles);
    shape.computeVertexNormals();
  } else {
    shape = new THREE.BoxGeometry(...obstacle.size.map((side) => side + grown));
    shape.rotateZ(obstacle.yaw);
  }
  return shape.translate(...obstacle.center);
}

/** Several geometries as one, without indices. */
function merged(shapes) {
  const parts = shapes.map((shape) => (shape.index ? shape.toNonIndexed() : shape));
  const found = new THREE.BufferGeometry();
  for (const name of ["position", "normal"]) {
    const arrays = parts.map((part) => part.getAttribute(name)).filter(Boolean);
    if (arrays.length < parts.length || !arrays.length) continue;
    const all = new Float32Array(arrays.reduce((sum, each) => sum + each.array.length, 0));
    let at = 0;
    for (const each of arrays) {
      all.set(each.array, at);
      at += each.array.length;
    }
    found.setAttribute(name, new THREE.BufferAttribute(all, 3));
  }
  return found;
}

/** Edges of shapes as one geometry of lines; round ones keep only their rims. */
function edgesOf(shapes) {
  return merged(shapes.map((shape) => new THREE.EdgesGeometry(shape, 30)));
}

/** Points (n, …, 3) packed by Python as a geometry. */
function geometryOf(array) {
  const found = new THREE.BufferGeometry();
  return found.setAttribute("position", new THREE.BufferAttribute(unpack(array).data, 3));
}

/** Straight lines [[a, b], …] as a geometry. */
function linesOf(pairs) {
  const found = new THREE.BufferGeometry();
  return found.setAttribute("position", new THREE.Float32BufferAttribute(pairs.flat(2), 3));
}

/** The twelve edges of a box. */
function boxEdges([low, high]) {
  const corner = (bits) => [0, 1, 2].map((i) => ((bits >> i) & 1 ? high : low)[i]);
  const pairs = [];
  for (let bits = 0; bits < 8; bits++)
    for (let i = 0; i < 3; i++)
      if (!((bits >> i) & 1)) pairs.push([corner(bits), corner(bits | (1 << i))]);
  return pairs;
}

/** Round numbers between low and high, about `count` of them. */
function ticksBetween(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((each) => each * power >= rough * 0.999) * power;
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return { step, values: found };
}

/** Makes `matrix` that of a unit cylinder (along z, from 0 to 1) between two points. */
function spanned(matrix, x0, y0, z0, x1, y1, z1, radius) {
  let a = x1 - x0, b = y1 - y0, c = z1 - z0;
  const length = Math.hypot(a, b, c) || 1e-9;
  a /= length; b /= length; c /= length;
  const level = Math.hypot(a, b);
  const px = level > 1e-6 ? -b / level : 1, py = level > 1e-6 ? a / level : 0;
  const qx = -c * py, qy = c * px, qz = a * py - b * px;
  const e = matrix.elements;
  e[0] = radius * px; e[1] = radius * py; e[2] = 0; e[3] = 0;
  e[4] = radius * qx; e[5] = radius * qy; e[6] = radius * qz; e[7] = 0;
  e[8] = length * a; e[9] = length * b; e[10] = length * c; e[11] = 0;
  e[12] = x0; e[13] = y0; e[14] = z0; e[15] = 1;
  return matrix;
}
