// Templates as pictures: the segment with its pins, and the curve, all over the same axes.

const THUMB = [100, 40];

function thumbOf(curve, mostLoad, mostFriction) {
  const [width, height] = THUMB;
  const x = (load) => (width * load / mostLoad).toFixed(1);
  const y = (friction) => (height * (1 - friction / mostFriction)).toFixed(1);
  const line = curve.load_n.map((load, i) => `${x(load)},${y(curve.friction_n[i])}`).join(' ');
  const thumb = svg('svg', { viewBox: `-2 -2 ${width + 4} ${height + 4}`, class: 'thumb', role: 'img', 'aria-label': TEXT.thumbName(curve) });
  thumb.append(svg('path', { d: `M0,0V${height}H${width}`, class: 'axes' }), svg('polyline', { points: line }));
  if (curve.threshold_n !== null) {
    const at = curve.load_n.findIndex((load) => load >= curve.threshold_n);
    thumb.append(svg('circle', { cx: x(curve.load_n[at]), cy: y(curve.friction_n[at]), r: 2.5 }));
  }
  return thumb;
}

class TemplateList {
  constructor(engine, pins, apply) { this.engine = engine; this.pins = pins; this.apply = apply; this.items = new Map(); }

  // Adds a group of templates under a title; switches get a picture.
  add(list, title, templates) {
    if (!templates.length) return;
    list.append(make('h2', title));
    for (const template of templates) {
      const item = button('', () => this.apply(template), { class: 'link template' });
      const text = make('span');
      text.append(make('b', template.name), make('span', template.about, { class: 'dim' }));
      item.append(text);
      if (template.kind === 'published') {
        item.prepend(this.pins.picture(template.values));
        this.items.set(template.name, item);
      }
      list.append(item);
    }
  }

  // Adds the curves, the first time that the list is opened.
  async drawCurves() {
    if (this.hasCurves) return;
    this.hasCurves = true;
    try {
      const curves = await this.engine.request({ command: 'templates' });
      const most = (key) => Math.max(...curves.flatMap((curve) => curve[key]));
      const [load, friction] = [most('load_n'), most('friction_n')];
      for (const curve of curves) this.items.get(curve.name)?.append(thumbOf(curve, load, friction));
    } catch (problem) {
      // The next opening tries again.
      this.hasCurves = false;
    }
  }
}
