// The page of one set. Its data is the JSON in #data; a live preview replaces it through `update`. Needs `assembly.js`.

const byId = (id) => document.getElementById(id);
const errors = [];
addEventListener('error', (event) => { errors.push(event.message); document.body.dataset.errors = errors.length; });
document.body.dataset.errors = 0;

const make = (tag, text, attributes = {}) => {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
};

// ---- the curve ----------------------------------------------------------------------------------------------------

const COLOURS = { main: '#0072c6', band: 'rgba(0, 114, 198, 0.16)', measured: '#d9822b' };
// Colours of other laws, in their order, repeated.
const OTHER_COLOURS = ['#00866a', '#a24bb0', '#d0284b'];
let chart;
let shownLoad = 0;

function drawChart(data) {
  const { curve, other_laws: others, published } = data;
  const ink = isDark() ? '#e8ecf1' : '#1c2430';
  const grid = isDark() ? '#333c47' : '#e3e6ea';
  // uPlot needs one column of loads. Other laws are interpolated at the loads of curve and measurements.
  const loads = [...new Set([...curve.load_n, ...published.map((p) => p.load_n)])].sort((a, b) => a - b);
  const inside = (xs, ys) => loads.map((x) => (x < xs[0] - 1e-9 || x > xs[xs.length - 1] + 1e-9 ? null : at(xs, ys, x)));
  const series = [
    { label: 'load (N)' },
    { label: `${curve.law}`, stroke: COLOURS.main, width: 3 },
    { label: 'band, low', stroke: 'transparent' },
    { label: `band (${curve.trust})`, stroke: 'transparent' },
    ...others.map((other, i) => ({ label: other.law, stroke: OTHER_COLOURS[i % OTHER_COLOURS.length], width: 1.2, dash: [6, 4] })),
    { label: 'measured', stroke: COLOURS.measured, paths: () => null, points: { show: true, size: 13, width: 2, stroke: isDark() ? '#14181d' : '#fff', fill: COLOURS.measured } },
  ].map((s) => ({ spanGaps: true, points: { show: false }, ...s }));
  if (!published.length) { series.pop(); }
  const columns = [loads, inside(curve.load_n, curve.friction_n), inside(curve.load_n, curve.band_low_n), inside(curve.load_n, curve.band_high_n),
    ...others.map((other) => inside(other.load_n, other.friction_n)),
    ...(published.length ? [loads.map((x) => published.find((p) => p.load_n === x)?.friction_n ?? null)] : [])];
  const markers = { width: 2, fill: (_, i) => (i === 3 ? COLOURS.band : series[i].label === 'measured' ? COLOURS.measured : 'transparent'),
    stroke: (_, i) => (i === 3 ? COLOURS.band : series[i].label === 'measured' ? COLOURS.measured : series[i].stroke) };
  const axis = (label) => ({ label, stroke: ink, grid: { stroke: grid }, ticks: { stroke: grid } });
  byId('chart').replaceChildren();
  chart = new uPlot({
    width: byId('chart').clientWidth || 900, height: 360, scales: { x: { time: false } }, series, bands: [{ series: [3, 2], fill: COLOURS.band }],
    legend: { live: false, markers }, cursor: { points: { show: false } },
    axes: [axis('load F (N)'), axis('friction D (N)')],
    hooks: { draw: [(u) => {
      const [x, y] = [u.valToPos(shownLoad, 'x', true), u.valToPos(at(curve.load_n, curve.friction_n, shownLoad), 'y', true)];
      u.ctx.beginPath();
      u.ctx.arc(x, y, 7 * devicePixelRatio, 0, 2 * Math.PI);
      u.ctx.fillStyle = COLOURS.main;
      u.ctx.fill();
      u.ctx.lineWidth = 2 * devicePixelRatio;
      u.ctx.strokeStyle = isDark() ? '#14181d' : '#fff';
      u.ctx.stroke();
    }] },
  }, columns, byId('chart'));
  // The band has one row in the legend.
  [...chart.root.querySelectorAll('.u-series')].find((row) => row.textContent.includes('band, low'))?.remove();
}

// ---- tables and downloads -----------------------------------------------------------------------------------------

function table(head, rows) {
  const element = make('table');
  // The first column is text, also if it begins with a digit.
  const numeric = (cell, i) => i > 0 && (typeof cell === 'number' || /^[-+\d.]/.test(String(cell)));
  const line = (cells, tag) => {
    const row = make('tr');
    cells.forEach((cell, i) => row.append(make(tag, cell, { class: tag === 'td' && numeric(cell, i) ? 'n' : '', ...(tag === 'th' ? { scope: 'col' } : {}) })));
    return row;
  };
  element.append(make('thead'), make('tbody'));
  element.tHead.append(line(head, 'th'));
  rows.forEach((row) => element.tBodies[0].append(line(row, 'td')));
  return element;
}

// Binary STL of a mesh, equal to the file of `generate` but for the header.
function stl(mesh) {
  const p = new Float32Array(bytesOf(mesh.positions).buffer);
  const t = new Uint32Array(bytesOf(mesh.triangles).buffer);
  const out = new DataView(new ArrayBuffer(84 + 50 * t.length / 3));
  out.setUint32(80, t.length / 3, true);
  for (let i = 0, offset = 84; i < t.length; i += 3, offset += 50) {
    const [a, b, c] = [0, 1, 2].map((k) => [0, 1, 2].map((d) => p[3 * t[i + k] + d]));
    const [u, v] = [b, c].map((q) => q.map((x, d) => x - a[d]));
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(...n) || 1;
    [...n.map((x) => x / length), ...a, ...b, ...c].forEach((x, k) => out.setFloat32(offset + 4 * k, x, true));
  }
  return out.buffer;
}

function download(name, content, type) {
  const link = make('a', '', { download: name, href: URL.createObjectURL(new Blob([content], { type })) });
  link.click();
  URL.revokeObjectURL(link.href);
}

function fillTables(data) {
  const { manifest, curve } = data;
  const bill = manifest.bill_of_materials;
  const rows = [];
  if (bill.pins.number) rows.push(['steel pins', `${bill.pins.number} + ${bill.pins.spares} spare`, `${bill.pins.diameter_mm} x ${bill.pins.length_mm} mm`]);
  if (bill.silicone) {
    rows.push(['silicone, to pour', `${bill.silicone.pour_ml.toFixed(2)} ml`, `${bill.silicone.pour_g.toFixed(2)} g`]);
    rows.push(['silicone, to mix', `${bill.silicone.mix_g.toFixed(1)} g`, `${bill.silicone.base_g.toFixed(1)} g base + ${bill.silicone.agent_g.toFixed(1)} g agent`]);
  }
  rows.push(['tendon', `${bill.tendon.length_mm} mm`, `${bill.tendon.rope_diameter_mm} mm, ${bill.tendon.outer_diameter_mm.toFixed(2)} mm coated`]);
  if (bill.fasteners) {
    const { number, thread, length_mm, right_length_mm, nuts, inserts } = bill.fasteners;
    rows.push([nuts ? 'screws with nuts' : 'screws', number, `${thread} x ${length_mm}${right_length_mm ? ` left, ${right_length_mm} right` : ''} mm`]);
    if (inserts) rows.push(['heat-set inserts', inserts, thread]);
  }
  if (bill.dowels) rows.push(['dowels', bill.dowels.number, `${bill.dowels.diameter_mm} x ${bill.dowels.length_mm} mm`]);
  if (bill.pulley_bearing) rows.push([`bearing ${bill.pulley_bearing}`, 1, 'for the guide pulley']);
  if (bill.mount?.bearing) rows.push([`bearing ${bill.mount.bearing}`, 1, 'for the guide pulley']);
  if (bill.mount?.axle) rows.push([bill.mount.axle, 1, bill.mount.bearing ? 'for the guide pulley' : 'for the joint']);
  if (bill.mount?.crimp_sleeve) rows.push([bill.mount.crimp_sleeve, 1, 'for the anchor of the tendon']);
  if (bill.mount?.sheath_stop) {
    const [, number, words] = bill.mount.sheath_stop.match(/^(\d+) (.*)$/);
    rows.push([words, Number(number), 'for the sheath stop']);
  }
  byId('bill').replaceChildren(table(['item', 'quantity', 'size'], rows));
  byId('parts').replaceChildren(table(['part', 'mass (g)', 'volume (mm³)'],
    manifest.parts.map((p) => [p.name, p.mass_g.toFixed(2), p.volume_mm3.toFixed(2)])));
  byId('table').replaceChildren(table(['load (N)', 'eccentric', 'concentric', 'friction', 'low', 'high'],
    curve.load_n.map((_, i) => [curve.load_n, curve.eccentric_n, curve.concentric_n, curve.friction_n, curve.band_low_n, curve.band_high_n].map((c) => c[i].toFixed(3)))));
  byId('checks').replaceChildren(...data.checks.map((c) => make('li', c.fine ? `ok: ${c.words}` : `attention: ${c.words}; ${c.remedy}`, { class: c.fine ? '' : 'bad' })),
    ...manifest.warnings.map((w) => make('li', `warning: ${w}`, { class: 'bad' })));
  byId('law').textContent = `Law: ${curve.law} (${curve.trust}). ${manifest.friction.source}.`;
  byId('reasons').replaceChildren(...curve.reasons.map((r) => make('li', r)));
  const files = data.meshes.filter((m) => m.file).map((m) => [m.file, () => download(m.file, stl(m), 'model/stl')]);
  files.push(['manifest.json', () => download('manifest.json', JSON.stringify(manifest, null, 2), 'application/json')]);
  files.push(['friction.csv', () => download('friction.csv', data.friction_csv, 'text/csv')]);
  const saved = new Set(files.map(([name]) => name));
  const saves = files.map(([name, save]) => {
    const item = make('li');
    const button = make('button', `Save ${name}`, { type: 'button' });
    button.addEventListener('click', save);
    item.append(button);
    return item;
  });
  // Links to the files in the folder of the page. A live preview has no folder.
  const others = data.live ? [] : manifest.files.map((f) => f.file).filter((name) => !saved.has(name) && name !== 'report.html');
  const links = others.map((name) => {
    const item = make('li');
    item.append(make('a', name, { href: encodeURI(name), download: name }));
    const plate = (manifest.plates ?? []).find((p) => p.file === name);
    if (plate) item.append(`, plate with ${plate.parts.map((p) => p.name).join(', ')}`);
    return item;
  });
  byId('files').replaceChildren(...saves, ...links);
  byId('other-files').hidden = !links.length;
}

// ---- the page -----------------------------------------------------------------------------------------------------

let assembly;
let current;
const hidden = new Set();

function fillBodies(data) {
  const names = [...new Set(data.bodies.map((b) => groupOf(b.name)))].concat(data.contact.angle_rad.length ? ['tendon'] : []);
  const rows = names.map((name) => {
    const label = make('label', undefined, { class: 'row' });
    const box = make('input', undefined, { type: 'checkbox' });
    box.checked = !hidden.has(name);
    box.addEventListener('change', () => {
      if (box.checked) hidden.delete(name); else hidden.add(name);
      assembly?.show(name, box.checked);
    });
    label.append(box, name);
    return label;
  });
  byId('bodies').replaceChildren(make('legend', 'Show'), ...rows);
}

function moveLoad() {
  const { curve } = current;
  const [lightest, heaviest] = [curve.load_n[0], curve.load_n[curve.load_n.length - 1]];
  shownLoad = lightest + (heaviest - lightest) * Number(byId('load').value);
  byId('load-value').textContent = `${shownLoad.toFixed(1)} N: friction ${at(curve.load_n, curve.friction_n, shownLoad).toFixed(2)} N`;
  assembly?.pose(shownLoad, Number(byId('explode').value));
  chart?.redraw(false);
}

// Shows the first state of the set, or one from the live preview.
function update(data) {
  current = data;
  byId('name').textContent = data.manifest.name;
  const f = data.manifest.friction;
  const switches = f.threshold_n ? ` Switches at ${f.threshold_n.toFixed(1)} N.` : '';
  byId('summary').textContent = `Layout ${data.layout}.${switches} Friction ${f.friction_n.toFixed(2)} N (${f.band_n[0].toFixed(2)} to ${f.band_n[1].toFixed(2)} N, ${f.trust}) at a load of ${f.load_n.toFixed(2)} N.`;
  byId('maker').textContent = `Made by ${data.manifest.generator}.`;
  fillBodies(data);
  fillTables(data);
  assembly?.load(data, hidden);
  drawChart(data);
  moveLoad();
  assembly?.cut(byId('section').checked, Number(byId('cut').value));
  document.body.dataset.ready = 'true';
}

function start() {
  const data = JSON.parse(byId('data').textContent);
  try {
    assembly = new Assembly(byId('view'));
  } catch (problem) {
    // Without WebGL, the still picture is shown.
    document.body.dataset.still = 'true';
  }
  for (const id of ['load', 'explode']) byId(id).addEventListener('input', moveLoad);
  const aim = () => assembly?.aim(Number(byId('turn').value), Number(byId('tilt').value));
  for (const id of ['turn', 'tilt']) byId(id).addEventListener('input', aim);
  const cut = () => assembly?.cut(byId('section').checked, Number(byId('cut').value));
  for (const id of ['section', 'cut']) byId(id).addEventListener('input', cut);
  update(data);
  aim();
  addEventListener('resize', () => chart?.setSize({ width: byId('chart').clientWidth, height: 360 }));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => drawChart(current));
  if (data.live) follow(data.live);
}

// Live preview: requests the next state. The server answers when the configuration has changed.
async function follow(version) {
  for (;;) {
    try {
      const answer = await (await fetch(`/state?after=${version}`)).json();
      version = answer.version;
      byId('trouble').hidden = !answer.trouble;
      byId('trouble').textContent = answer.trouble ?? '';
      if (answer.data) update(answer.data);
    } catch {
      byId('trouble').hidden = false;
      byId('trouble').textContent = 'The preview has stopped. The last state is shown.';
      await new Promise((later) => setTimeout(later, 1000));
    }
  }
}

start();
