// 3D view of an assembly, with filled cut faces. A report shows one assembly, the configurator hundreds.
// Needs three.js as THREE. The data is `PageData`.

// Decodes base64.
function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i += 1) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// Corners of a mesh in mm, three numbers each, and three indices of corners per triangle: of two bytes if that is enough.
function arraysOf({ positions, triangles }) {
  const corners = new Float32Array(bytesOf(positions).buffer);
  const Indices = corners.length / 3 <= 65536 ? Uint16Array : Uint32Array;
  return { positions: corners, indices: new Indices(bytesOf(triangles).buffer) };
}

const isDark = () => matchMedia('(prefers-color-scheme: dark)').matches;
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

// Interpolates a column linearly.
function at(xs, ys, x) {
  let i = xs.findIndex((v) => v >= x);
  if (i < 0) i = xs.length - 1;
  if (i === 0) return ys[0];
  return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
}

// The points of a line with a close point at both ends of each long piece, which keeps a curve through them straight.
const CLOSE_MM = 1;
function dense(line) {
  const points = [line[0]];
  for (let i = 1; i < line.length; i += 1) {
    const [[ax, ay], [bx, by]] = [line[i - 1], line[i]];
    const length = Math.hypot(bx - ax, by - ay);
    const between = (share) => [ax + (bx - ax) * share, ay + (by - ay) * share];
    if (length > 3 * CLOSE_MM) points.push(between(CLOSE_MM / length), between(1 - CLOSE_MM / length));
    points.push(line[i]);
  }
  return points;
}

// Pins are shown and hidden together.
const groupOf = (name) => (/^pin-\d+$/.test(name) ? 'pins' : name);
// Constants of three.js that are not in its build for this page.
const FRONT = 0, BACK = 1, ALWAYS = 519, NOT_EQUAL = 517, INCREMENT = 34055, DECREMENT = 34056;
// Margin around the bodies, as a factor.
const ROOM = 1.1;
// Points of a body that are enough to find its extent.
const SAMPLES = 600;
// Step between the points of the tendon for its extent.
const TENDON_STEP = 11;
// Without a graphics card, the processor renders all pixels: at a low resolution while something moves, and at full resolution
// after this time without changes.
const QUICK_RATIO = 0.5, STILL_MS = 700;
// Angle between sharp and smooth edges. Facets of round edges have smaller angles even in coarse designs. With pins in 4, 8 and
// 12, no edge is between 30 and 40 degrees.
const SHARP_DEG = 35;
const SHARP = Math.cos(SHARP_DEG * Math.PI / 180);

// Material that counts, in the stencil buffer, inner faces minus outer faces of a cut body: the rest is cut material. It is not
// visible, so a material without lighting is enough.
function counting(side, operation, plane) {
  return new THREE.LineBasicMaterial({ side, clippingPlanes: [plane], depthWrite: false, depthTest: false, colorWrite: false,
    stencilWrite: true, stencilFunc: ALWAYS, stencilFail: operation, stencilZFail: operation, stencilZPass: operation });
}

// A square in the cutting plane.
function square() {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), 3));
  geometry.setAttribute('normal', new THREE.BufferAttribute(new Float32Array([0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1]), 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array([0, 1, 2, 0, 2, 3]), 1));
  return geometry;
}

// The cut face, drawn where material was counted, before the next body.
function cap(geometry, material) {
  const mesh = new THREE.Mesh(geometry, material);
  mesh.onAfterRender = (renderer) => renderer.clearStencil();
  return mesh;
}

// Edges with an angle above `SHARP_DEG`. Meshes of a set share their vertices, so an edge is a pair of indices. EdgesGeometry
// compares positions as text, and would take most of the time of a design.
function sharpEdges(geometry) {
  const places = geometry.getAttribute('position').array;
  const index = geometry.index.array;
  const count = places.length / 3;
  const normals = new Float32Array(index.length);
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [3 * index[t], 3 * index[t + 1], 3 * index[t + 2]];
    const [ux, uy, uz, vx, vy, vz] = [places[b] - places[a], places[b + 1] - places[a + 1], places[b + 2] - places[a + 2],
      places[c] - places[a], places[c + 1] - places[a + 1], places[c + 2] - places[a + 2]];
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    const length = Math.hypot(x, y, z) || 1;
    normals.set([x / length, y / length, z / length], t);
  }
  const met = new Map();
  const ends = [];
  for (let i = 0; i < index.length; i += 1) {
    const t = i - (i % 3);
    const [a, b] = [index[i], index[t + ((i + 1) % 3)]];
    const edge = Math.min(a, b) * count + Math.max(a, b);
    const other = met.get(edge);
    if (other === undefined) { met.set(edge, t); continue; }
    const turn = normals[t] * normals[other] + normals[t + 1] * normals[other + 1] + normals[t + 2] * normals[other + 2];
    if (turn < SHARP) for (const v of [a, b]) ends.push(places[3 * v], places[3 * v + 1], places[3 * v + 2]);
  }
  const lines = new THREE.BufferGeometry();
  lines.setAttribute('position', new THREE.BufferAttribute(new Float32Array(ends), 3));
  return lines;
}

// Returns whether the processor renders, without a graphics card.
function isWithoutCard() {
  const gl = document.createElement('canvas').getContext('webgl2');
  const named = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = named ? String(gl.getParameter(named.UNMASKED_RENDERER_WEBGL)) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

class Assembly {
  constructor(host) {
    this.host = host;
    this.isSlow = isWithoutCard();
    this.still_ratio = Math.min(devicePixelRatio, 2);
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, stencil: true });
    this.renderer.localClippingEnabled = true;
    this.renderer.setPixelRatio(this.isSlow ? QUICK_RATIO : this.still_ratio);
    host.replaceChildren(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x707880, 1.6));
    const sun = new THREE.DirectionalLight(0xffffff, 2.2);
    sun.position.set(40, 70, 90);
    this.scene.add(sun);
    this.camera = new THREE.PerspectiveCamera(28, 1, 1, 2000);
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.draw());
    // A manual rotation is kept after changes.
    this.controls.addEventListener('end', () => {
      this.towards = this.camera.position.clone().sub(this.controls.target).normalize();
      this.turned?.(Math.atan2(this.towards.x, this.towards.z), Math.asin(clamp(this.towards.y, -1, 1)));
    });
    this.plane = new THREE.Plane(new THREE.Vector3(0, 0, -1), 0);
    // Materials by kind. They are kept, since a graphics card compiles a program for each kind and deletes it with the last
    // material of that kind.
    this.materials = new Map();
    this.shapes = [];
    this.square = square();
    this.counted = [counting(BACK, INCREMENT, this.plane), counting(FRONT, DECREMENT, this.plane)];
    this.group = new THREE.Group();
    this.covers = new THREE.Group();
    this.scene.add(this.group, this.covers);
    new ResizeObserver(() => this.resize()).observe(host);
  }

  load(data, hidden) {
    const before = this.reach;
    this.forget();
    this.data = data;
    const shapes = this.shaped(data);
    this.bodies = data.bodies.map((body, order) => {
      const { geometry, lines } = shapes.get(body.mesh);
      const { material, cut } = this.coat(body);
      const mesh = new THREE.Mesh(geometry, material);
      const edges = new THREE.LineSegments(lines, this.ink());
      // Each body is counted, covered and cleared before the next.
      const counted = this.counted.map((count) => new THREE.Mesh(geometry, count));
      counted.forEach((count) => { count.renderOrder = 2 * order + 1; });
      const cover = cap(this.square, cut);
      cover.renderOrder = 2 * order + 2;
      mesh.renderOrder = edges.renderOrder = 2 * data.bodies.length + 3;
      const node = new THREE.Group();
      node.add(mesh, edges, ...counted);
      node.userData = { body, cover, counted, materials: [material, this.ink()], home: new THREE.Matrix4().fromArray(body.matrix) };
      this.covers.add(cover);
      node.matrixAutoUpdate = false;
      node.matrix.copy(node.userData.home);
      node.visible = !hidden.has(groupOf(body.name));
      this.group.add(node);
      return node;
    });
    this.group.updateMatrixWorld(true);
    const box = new THREE.Box3().setFromObject(this.group);
    this.reach = box.getSize(new THREE.Vector3()).length();
    this.low = box.min.z;
    this.high = box.max.z;
    this.edges();
    // The camera is kept for a part of nearly the same size.
    if (!before || Math.abs(this.reach / before - 1) > 0.08) this.apart = undefined;
  }

  // Meshes with their edges, by number. Unchanged meshes are reused: their edges are known, and they are on the graphics card.
  shaped(data) {
    const before = this.shapes;
    const shapes = new Map();
    for (const { mesh } of data.bodies) {
      if (shapes.has(mesh)) continue;
      const { positions, triangles } = data.meshes[mesh];
      const same = before.find((shape) => shape.positions === positions && shape.triangles === triangles);
      if (same) { shapes.set(mesh, same); continue; }
      const geometry = new THREE.BufferGeometry();
      const arrays = arraysOf({ positions, triangles });
      geometry.setAttribute('position', new THREE.BufferAttribute(arrays.positions, 3));
      geometry.setIndex(new THREE.BufferAttribute(arrays.indices, 1));
      shapes.set(mesh, { positions, triangles, geometry, lines: sharpEdges(geometry) });
    }
    this.shapes = [...shapes.values()];
    for (const shape of before) {
      if (!this.shapes.includes(shape)) [shape.geometry, shape.lines].forEach((geometry) => geometry.dispose());
    }
    return shapes;
  }

  kept(kind, material) {
    if (!this.materials.has(kind)) this.materials.set(kind, material());
    return this.materials.get(kind);
  }

  // The materials of a body, and of its cut face.
  coat({ material: of, colour }) {
    const [isSteel, isSilicone] = [of === 'steel', of === 'silicone'];
    const shade = () => new THREE.Color(...colour.map((c) => c / 255)).convertSRGBToLinear();
    return {
      // Bodies are closed, and filled where they are cut: inner faces are never visible.
      material: this.kept(`${of} ${colour}`, () => new THREE.MeshStandardMaterial({
        color: shade(), side: FRONT, flatShading: true, metalness: isSteel ? 0.55 : 0.0, roughness: isSteel ? 0.35 : 0.75, transparent: isSilicone, opacity: isSilicone ? 0.78 : 1,
      })),
      cut: this.kept(`cut ${colour}`, () => new THREE.MeshStandardMaterial({
        color: shade().multiplyScalar(0.72), side: THREE.DoubleSide, roughness: 0.9, stencilWrite: true, stencilRef: 0, stencilFunc: NOT_EQUAL,
      })),
    };
  }

  // The material of edges.
  ink() { return this.kept('ink', () => new THREE.LineBasicMaterial({ transparent: true, opacity: 0.45 })); }

  // Removes all bodies, and frees their memory on the graphics card.
  forget() {
    this.tendon?.geometry.dispose();
    this.group.clear();
    this.covers.clear();
    this.tendon = undefined;
  }

  // Sets the colour of edges for a light or dark page.
  edges() {
    this.ink().color.set(isDark() ? 0x0a0e13 : 0x1a2530);
  }

  aim(turn, tilt) {
    const [a, b] = [turn, tilt].map((degrees) => degrees * Math.PI / 180);
    this.towards = new THREE.Vector3(Math.sin(a) * Math.cos(b), Math.sin(b), Math.cos(a) * Math.cos(b));
    this.frame();
  }

  // Points of visible bodies and of the tendon, in the assembly; a sample of large meshes.
  *points() {
    if (this.tendon) {
      const { array } = this.tendon.geometry.getAttribute('position');
      for (let i = 0; i < array.length; i += 3 * TENDON_STEP) yield new THREE.Vector3(array[i], array[i + 1], array[i + 2]);
    }
    for (const node of this.bodies) {
      if (!node.visible) continue;
      const [mesh] = node.children;
      const { array } = mesh.geometry.getAttribute('position');
      const step = 3 * Math.max(1, Math.floor(array.length / 3 / SAMPLES));
      for (let i = 0; i < array.length; i += step) yield new THREE.Vector3(array[i], array[i + 1], array[i + 2]).applyMatrix4(mesh.matrixWorld);
    }
  }

  // Moves the camera along its direction so that the bodies fill the view.
  frame() {
    if (!this.bodies || !this.towards) return;
    const right = new THREE.Vector3(0, 1, 0).cross(this.towards).normalize();
    const up = this.towards.clone().cross(right);
    const seen = [...this.points()].map((p) => [p.dot(right), p.dot(up), p.dot(this.towards)]);
    if (!seen.length) return;
    const middle = [0, 1, 2].map((k) => {
      const [low, high] = seen.reduce(([l, h], p) => [Math.min(l, p[k]), Math.max(h, p[k])], [Infinity, -Infinity]);
      return (low + high) / 2;
    });
    const height = Math.tan(this.camera.fov * Math.PI / 360);
    const distance = seen.reduce((far, p) => {
      const aside = Math.max(Math.abs(p[0] - middle[0]) / (height * this.camera.aspect), Math.abs(p[1] - middle[1]) / height);
      return Math.max(far, p[2] - middle[2] + aside * ROOM);
    }, 0);
    const centre = right.multiplyScalar(middle[0]).add(up.multiplyScalar(middle[1])).add(this.towards.clone().multiplyScalar(middle[2]));
    this.camera.far = 10 * distance + 10 * this.reach;
    this.camera.updateProjectionMatrix();
    this.camera.position.copy(this.towards).multiplyScalar(distance).add(centre);
    this.controls.target.copy(centre);
    this.controls.update();
    this.draw();
  }

  // Turns the distal link of a joint to a flexion in degrees.
  bend(flexion) {
    this.flexion = flexion;
    this.pose(this.load_n, this.apart);
  }

  // The flexion of a joint if it differs from that of the assembly; undefined otherwise. There the tendon is drawn without load.
  bent() {
    const { joint } = this.data;
    return joint && this.flexion !== undefined && Math.abs(this.flexion - joint.assembled_deg) > 0.01 ? clamp(this.flexion, joint.flexion_deg[0], joint.flexion_deg.at(-1)) : undefined;
  }

  // Moves pins and tendon to their positions at a load, and explodes the bodies by `apart`.
  pose(load, apart) {
    const moved = this.apart !== apart;
    this.apart = apart;
    this.load_n = load;
    const [bent, { joint }] = [this.bent(), this.data];
    for (const node of this.bodies) {
      const { body, home } = node.userData;
      const way = new THREE.Vector3(...body.explode_offset).multiplyScalar(apart);
      if (body.sink && bent === undefined) {
        const depth = at(this.data.contact.load_n, body.sink.depth_mm, load);
        way.add(new THREE.Vector3(body.sink.towards[0], body.sink.towards[1], 0).multiplyScalar(depth));
      }
      node.matrix.makeTranslation(way.x, way.y, way.z);
      if (bent !== undefined && joint.moving.includes(body.name)) node.matrix.multiply(new THREE.Matrix4().makeRotationZ((bent - joint.assembled_deg) * Math.PI / 180));
      node.matrix.multiply(home);
      // The body of the tendon has the flexion of the assembly.
      if (body.name === 'tendon') node.visible = !this.tendonHidden && bent === undefined;
      node.matrixWorldNeedsUpdate = true;
    }
    this.lay(load, apart);
    this.group.updateMatrixWorld(true);
    if (moved) this.frame();
    // All materials exist now, and can be compiled.
    this.compiling ??= this.compile();
    this.draw();
  }

  // Adds the tendon over the pins, unless the view is exploded.
  lay(load, apart) {
    const contact = this.data.contact;
    if (this.tendon) { this.group.remove(this.tendon); this.tendon.geometry.dispose(); this.tendon = undefined; }
    const bent = this.bent();
    if (bent !== undefined && apart <= 0.02 && !this.tendonHidden) {
      const { joint } = this.data;
      const nearest = joint.flexion_deg.reduce((best, deg, i) => (Math.abs(deg - bent) < Math.abs(joint.flexion_deg[best] - bent) ? i : best), 0);
      this.tube(dense(joint.paths[nearest]).map(([x, y]) => new THREE.Vector3(x, y, joint.z_mm)), joint.tendon_radius_mm);
      return;
    }
    if (!contact.angle_rad.length || apart > 0.02 || this.tendonHidden) return;
    const points = contact.angle_rad.map((angle, i) => {
      const radius = contact.axis_radius_mm + at(contact.load_n, contact.gap_mm.map((gaps) => gaps[i]), load);
      return new THREE.Vector3(radius * Math.sin(angle), radius * Math.cos(angle), contact.z_mm);
    });
    const straight = (end, side, by) => end.clone().add(
      new THREE.Vector3(side * Math.cos(contact.half_wrap_rad), -Math.sin(contact.half_wrap_rad), 0).multiplyScalar(by));
    const [first, last] = [points[0], points[points.length - 1]];
    // A close point keeps the long ends straight.
    points.unshift(straight(first, -1, contact.lead_mm[0]), straight(first, -1, 2));
    points.push(straight(last, 1, 2), straight(last, 1, contact.lead_mm[1]));
    this.tube(points, contact.tendon_radius_mm);
  }

  // Adds the tendon along a line of points.
  tube(points, radius_mm) {
    const tube = new THREE.TubeGeometry(new THREE.CatmullRomCurve3(points), 120, radius_mm, 8);
    const rope = this.kept('rope', () => new THREE.MeshStandardMaterial({ roughness: 0.6 }));
    rope.color.set(isDark() ? 0x8296ab : 0x3a4a5c);
    this.tendon = new THREE.Mesh(tube, rope);
    this.group.add(this.tendon);
  }

  cut(on, share) {
    // A small offset from faces at the same height: a face in the plane would flicker.
    const z = this.low + (this.high - this.low) * share + 1.3e-3;
    this.plane.constant = z;
    const planes = on ? [this.plane] : [];
    for (const node of this.bodies) {
      const { materials, counted, cover } = node.userData;
      for (const m of materials) {
        if (m.clippingPlanes?.length === planes.length) continue;
        m.clippingPlanes = planes;
        m.needsUpdate = true;
      }
      counted.forEach((count) => { count.visible = on; });
      cover.visible = on && node.visible;
      cover.position.set(0, 0, z);
      cover.scale.setScalar(4 * this.reach);
    }
    this.isCut = on;
    this.draw();
  }

  show(name, visible) {
    for (const node of this.bodies) {
      if (groupOf(node.userData.body.name) !== name) continue;
      node.visible = visible;
      node.userData.cover.visible = visible && this.isCut;
    }
    if (name === 'tendon') { this.tendonHidden = !visible; this.pose(this.load_n, this.apart); }
    this.draw();
  }

  resize() {
    const { clientWidth, clientHeight } = this.host;
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / Math.max(clientHeight, 1);
    this.camera.updateProjectionMatrix();
    this.frame();
    // Immediately: a resized canvas is empty.
    if (this.isCompiled) this.renderer.render(this.scene, this.camera);
  }

  // Compiles the programs of the graphics card, asynchronously where possible, and starts to render.
  async compile() {
    if (this.renderer.extensions.has('KHR_parallel_shader_compile')) await this.renderer.compileAsync(this.scene, this.camera);
    this.isCompiled = true;
    this.draw();
  }

  // Renders once for the next frame, also after several changes.
  draw() {
    if (this.drawing || !this.isCompiled) return;
    // For tests of pictures: a rough rendering is followed by a fine one.
    this.host.dataset.drawn = 'roughly';
    this.drawing = requestAnimationFrame(() => {
      this.drawing = 0;
      if (this.isSlow) this.refine();
      this.renderer.render(this.scene, this.camera);
      if (!this.isSlow) this.host.dataset.drawn = 'finely';
    });
  }

  // Renders at a low resolution, and at full resolution after some time without changes.
  refine() {
    clearTimeout(this.refining);
    if (this.renderer.getPixelRatio() !== QUICK_RATIO) this.renderer.setPixelRatio(QUICK_RATIO);
    this.refining = setTimeout(() => {
      this.renderer.setPixelRatio(this.still_ratio);
      this.renderer.render(this.scene, this.camera);
      this.host.dataset.drawn = 'finely';
    }, STILL_MS);
  }
}
