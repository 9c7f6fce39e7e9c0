// Bill of materials, printed parts with their volumes, and the print bed.

// Distance between parts on the bed, in millimetres.
const GAP_MM = 4;

function materialRows(bill, parts) {
  const rows = [];
  if (bill.pins?.number) rows.push([TEXT.steelPins, `${TEXT.spare(bill.pins.number, bill.pins.spares)}, ${formatNumber(bill.pins.diameter_mm)} x ${formatNumber(bill.pins.length_mm)} mm`]);
  if (bill.silicone) {
    rows.push([TEXT.mix, `${bill.silicone.mix_g.toFixed(1)} g: ${TEXT.mixed(formatNumber(bill.silicone.base_g, 1), formatNumber(bill.silicone.agent_g, 1))}`]);
    rows.push([TEXT.pour, `${bill.silicone.pour_ml.toFixed(2)} ml${bill.silicone.product ? `, ${bill.silicone.product}` : ''}`]);
    if (bill.silicone.mould_cure) rows.push([TEXT.cure, TEXT.cured(bill.silicone.mould_cure, bill.silicone.post_cure)]);
  }
  if (bill.tendon) rows.push([TEXT.tendon, `${formatNumber(bill.tendon.length_mm)} mm, ${TEXT.coated(formatNumber(bill.tendon.rope_diameter_mm), bill.tendon.outer_diameter_mm.toFixed(2))}`]);
  if (bill.fasteners) {
    const { number, thread, length_mm, right_length_mm, nuts, inserts } = bill.fasteners;
    rows.push([TEXT.screws, `${number} x ${thread} x ${right_length_mm ? TEXT.rightSide(formatNumber(length_mm), formatNumber(right_length_mm)) : formatNumber(length_mm)} mm`]);
    if (nuts) rows.push([TEXT.nuts, `${nuts} x ${thread}`]);
    if (inserts) rows.push([TEXT.inserts, `${inserts} x ${thread}`]);
  }
  if (bill.dowels) rows.push([TEXT.dowels, `${bill.dowels.number} x ${formatNumber(bill.dowels.diameter_mm)} x ${formatNumber(bill.dowels.length_mm)} mm`]);
  for (const item of [bill.pulley_bearing, bill.mount?.bearing, bill.mount?.axle, bill.mount?.crimp_sleeve, bill.mount?.sheath_stop]) if (item) rows.push([String(item), TEXT.forMount]);
  rows.push([TEXT.plastic, `${parts.reduce((sum, p) => sum + p.mass_g, 0).toFixed(1)} g`]);
  return rows;
}

const sizeOf = ({ mesh }) => mesh.high_mm.map((high, k) => high - mesh.low_mm[k]);

// Arranges parts in rows, the deepest first; null if they do not fit on one bed.
function arrangeInRows(parts, bed) {
  const placed = [];
  let [x, y, depth] = [0, 0, 0];
  const sorted = parts.map((part) => ({ part, size: sizeOf(part) })).sort((a, b) => b.size[1] - a.size[1] || b.size[0] - a.size[0]);
  for (const { part, size } of sorted) {
    if (size[0] > bed || size[1] > bed) return null;
    if (x + size[0] > bed) { x = 0; y += depth + GAP_MM; depth = 0; }
    if (y + size[1] > bed) return null;
    placed.push({ part, x, y, size });
    x += size[0] + GAP_MM;
    depth = Math.max(depth, size[1]);
  }
  return placed;
}

// Outlines on beds: as in the manifest, or else in rows; `placed` is null if one bed is not enough
// for the rows.
function beds({ plates, parts, settings }) {
  const bed = settings.find((s) => s.field === 'print.bed_mm')?.value ?? 250;
  if (plates?.length) {
    return plates.map((plate) => ({ bed: plate.bed_mm, placed: plate.parts.flatMap(({ name, x_mm, y_mm, is_turned }) => {
      const part = parts.find((p) => p.name === name);
      if (!part) return [];
      const [width, depth] = is_turned ? [sizeOf(part)[1], sizeOf(part)[0]] : sizeOf(part);
      return [{ part, x: x_mm - width / 2, y: plate.bed_mm - y_mm - depth / 2, size: [width, depth] }];
    }) }));
  }
  const placed = arrangeInRows(parts, bed);
  const used = placed?.reduce(([w, h], p) => [Math.max(w, p.x + p.size[0]), Math.max(h, p.y + p.size[1])], [0, 0]);
  return [{ bed, placed: placed?.map((p) => ({ ...p, x: p.x + (bed - used[0]) / 2, y: p.y + (bed - used[1]) / 2 })) ?? null }];
}

function drawBed({ bed, placed }) {
  const drawing = svg('svg', { viewBox: `-2 -2 ${bed + 4} ${bed + 4}`, role: 'img', 'aria-label': TEXT.bedName(placed?.length ?? 0, formatNumber(bed)), class: 'bed' });
  drawing.append(svg('rect', { width: bed, height: bed, rx: bed / 60, class: 'plate' }));
  for (const { part, x, y, size } of placed ?? []) {
    const outline = svg('rect', { x, y, width: size[0], height: size[1], rx: 1, class: 'outline' });
    outline.append(svg('title', {}, TEXT.bedPart(part.name, size[0].toFixed(1), size[1].toFixed(1))));
    drawing.append(outline);
  }
  return drawing;
}

function showMaterials(data) {
  const { parts, bill_of_materials: bill } = data.manifest;
  byId('materials').replaceChildren(...materialRows(bill, parts).map(([name, amount]) => {
    const row = make('div');
    row.append(make('dt', name), make('dd', amount));
    return row;
  }));
  const rows = parts.map((p) => [p.name, sizeOf(p).map((v) => v.toFixed(1)).join(' x '), p.mass_g.toFixed(2), p.volume_mm3.toFixed(1)]);
  byId('parts').replaceChildren(table([TEXT.part, TEXT.size, TEXT.mass, TEXT.volume], rows));
  const all = beds(data.manifest);
  byId('bed').replaceChildren(...all.map(drawBed));
  byId('bed-caption').textContent = TEXT.bedCaption(all.length, formatNumber(all[0].bed), all[0].placed !== null);
}
