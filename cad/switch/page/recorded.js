// The answers of a report: what the program recorded when it wrote the set.

class Recorded {
  constructor(text) {
    Object.assign(this, JSON.parse(text));
    // A picture of the assembly, which the page shows without WebGL.
    this.still = byId('still')?.src.split(',')[1] ?? '';
  }

  // Content of the files that the page contains; the others are in its folder.
  contents() {
    const { data } = this.design;
    const contents = new Map(data.meshes.filter((mesh) => mesh.file).map((mesh) => [mesh.file, () => stlOf(mesh)]));
    contents.set('friction.csv', () => data.friction_csv);
    contents.set('assembly.png', () => bytesOf(this.still));
    return contents;
  }

  async request({ command, name }) {
    if (command === 'facts') return this.facts;
    if (command === 'design') return this.design;
    if (command === 'files') {
      const contents = this.contents();
      const listed = this.design.data.manifest.files.filter((f) => f.file !== 'report.html').map((f) => ({ name: f.file, bytes: f.bytes, isBeside: !contents.has(f.file) }));
      // The manifest does not list itself.
      return { files: [...listed, { name: 'manifest.json', isBeside: true }] };
    }
    const content = command === 'file' && this.contents().get(name);
    if (!content) throw new EngineError(TEXT.isReport, 'refused');
    return content();
  }

  stop() {}
}

// Binary STL of a mesh: the file of the set, but for last digits of the normals, which come from rounded corners here.
const STL_HEAD = 84, STL_TRIANGLE = 50;
function stlOf(mesh) {
  const { positions, indices } = arraysOf(mesh);
  const out = new DataView(new ArrayBuffer(STL_HEAD + STL_TRIANGLE * indices.length / 3));
  out.setUint32(80, indices.length / 3, true);
  for (let i = 0, offset = STL_HEAD; i < indices.length; i += 3, offset += STL_TRIANGLE) {
    const [a, b, c] = [0, 1, 2].map((k) => [...positions.subarray(3 * indices[i + k], 3 * indices[i + k] + 3)]);
    const [u, v] = [b, c].map((q) => q.map((x, d) => x - a[d]));
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(...normal) || 1;
    [...normal.map((x) => x / length), ...a, ...b, ...c].forEach((x, k) => out.setFloat32(offset + 4 * k, x, true));
  }
  return out.buffer;
}
