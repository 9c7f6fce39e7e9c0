"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const PAGE = 200;
const make = (name, text, attributes = {}) => {
  const element = document.createElement(name);
  if (text !== undefined) element.textContent = text;
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
};
const megabytes = bytes => (bytes / 1e6).toFixed(bytes < 1e7 ? 1 : 0) + " MB";
const numeric = data.fields.map((_, i) => data.variants.every(v => typeof v.settings[i] === "number"));

// Columns: the fields that vary, and their results.
const columns = [
  { name: "layout", get: v => v.glyph ? v.glyph.pins_deg.length : undefined, picture: v => glyph(v), words: true },
  { name: "variant", get: v => v.id, words: true, title: true },
  { name: "label", get: v => v.label, words: true },
  ...data.fields.map((name, i) => ({ name: name.split(".").pop(), full: name, get: v => v.settings[i], words: !numeric[i],
    show: v => numeric[i] ? +v.settings[i].toPrecision(6) : v.settings[i] })),
  { name: "friction (N)", get: v => v.friction_n ? v.friction_n[0] : undefined, show: v => v.friction_n ? v.friction_n[0].toFixed(2) : "" },
  { name: "band (N)", get: v => v.friction_n ? v.friction_n[2] - v.friction_n[1] : undefined,
    show: v => v.friction_n ? v.friction_n[1].toFixed(2) + " to " + v.friction_n[2].toFixed(2) : "" },
  { name: "threshold (N)", get: v => v.threshold_n, show: v => v.threshold_n === undefined ? "" : v.threshold_n.toFixed(2) },
  { name: "prediction", get: v => v.trust, words: true },
  { name: "printed (g)", get: v => v.printed_g, show: v => v.printed_g === undefined ? "" : v.printed_g.toFixed(2) },
  { name: "curve", get: v => v.friction_n ? v.friction_n[0] : undefined, words: true,
    picture: v => v.status === "made" ? svg(110, 34, `<path class="spark" d="${path(v, 110, 34)}"/>`) : undefined },
  { name: "files", get: v => v.status, links: true, words: true },
];
const top_n = Math.max(...data.variants.flatMap(v => v.curve_n || [0]), 0.1);
const largest_load = Math.max(...data.variants.map(v => v.loads_n ? v.loads_n[1] : 0), 0.1);

const t = data.tally;
document.getElementById("tally").textContent =
  `${data.of} variants: ${t.made} made, ${t.refused} refused, ${t.failed} failed. ` +
  `${t.parts} part files (${megabytes(t.part_bytes)}), ${t.distinct_parts} of them different (${megabytes(t.distinct_bytes)} stored).` +
  (data.every > 1 ? ` This page shows every ${data.every}th variant; variants.csv and variants.parquet contain all of them.` : "");

const path = (v, width, height) => (v.curve_n || []).map((y, i, all) => {
  const load = v.loads_n[0] + (v.loads_n[1] - v.loads_n[0]) * i / (all.length - 1);
  return (i ? "L" : "M") + (load / largest_load * width).toFixed(1) + " " + (height - y / top_n * height).toFixed(1);
}).join("");
const svg = (width, height, inner) => {
  const holder = make("span");
  holder.innerHTML = `<svg width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">${inner}</svg>`;
  return holder.firstChild;
};

// The segment to scale, seen along the pulley's axis: shell, layer and pins.
// One scale for all variants, at which the widest and the highest segment fit into the box.
const glyphScale = Math.min(...data.variants.filter(v => v.glyph).map(({ glyph: g }) => {
  const [half, outer, inner] = [g.span_deg * Math.PI / 360, g.radius_mm + g.layer_mm, g.radius_mm - g.wall_mm];
  const lowest = Math.min(outer * Math.cos(half), inner * Math.cos(half));
  return Math.min(30 / (outer * Math.sin(Math.min(half, Math.PI / 2))), 28 / (outer - lowest));
}));
const glyph = v => {
  const g = v.glyph;
  if (!g) return undefined;
  const [half, out, inner] = [g.span_deg * Math.PI / 360, g.radius_mm, g.radius_mm - g.wall_mm];
  const scale = glyphScale;
  const large = half > Math.PI / 2 ? 1 : 0;
  const at = (r, a) => (34 + scale * r * Math.sin(a)).toFixed(2) + " " + (4 + scale * (out + g.layer_mm - r * Math.cos(a))).toFixed(2);
  const ring = (low, high, kind) => `<path class="${kind}" d="M${at(high, -half)}A${scale * high} ${scale * high} 0 ${large} 1 ${at(high, half)}L${at(low, half)}` +
    `A${scale * low} ${scale * low} 0 ${large} 0 ${at(low, -half)}Z"/>`;
  const pins = g.pins_deg.map(degrees => {
    const [x, y] = at(out + g.layer_mm, degrees * Math.PI / 180).split(" ");
    return `<circle class="pin" cx="${x}" cy="${y}" r="1.7"/>`;
  });
  return svg(68, 34, ring(inner, out, "shell") + (g.layer_mm ? ring(out, out + g.layer_mm, "silicone") : "") + pins.join(""));
};

// Filters.
const filters = document.getElementById("filters");
const field = (title, ...inputs) => { const label = make("label", title); const span = make("span"); span.append(...inputs); label.append(span); filters.append(label); };
const search = make("input", undefined, { type: "search", placeholder: "id, label, reason" });
const status = make("select");
for (const word of ["all", "made", "refused", "failed"]) status.append(make("option", word));
field("find", search);
field("status", status);
const limits = [];
columns.forEach(column => {
  if (column.picture || column.links || column.name === "variant" || column.name === "label" || column.name === "band (N)") return;
  if (column.words) {
    const select = make("select");
    select.append(make("option", "all"));
    const words = [...new Set(data.variants.map(v => column.get(v)).filter(w => w !== undefined).map(String))].sort();
    if (words.length > 60) return;
    words.forEach(word => select.append(make("option", word)));
    limits.push(v => select.value === "all" || String(column.get(v)) === select.value);
    field(column.name, select);
  } else {
    const low = make("input", undefined, { type: "number", step: "any", placeholder: "from" });
    const high = make("input", undefined, { type: "number", step: "any", placeholder: "to" });
    limits.push(v => {
      const x = column.get(v);
      return (low.value === "" || x >= +low.value) && (high.value === "" || x <= +high.value);
    });
    field(column.name, low, " ", high);
  }
});
filters.addEventListener("submit", event => event.preventDefault());
filters.addEventListener("input", () => { shown = PAGE; draw(); });

// Table.
let order = null, descending = false, shown = PAGE, chosen = null;
const head = document.getElementById("head");
columns.forEach(column => {
  const cell = make("th", undefined, column.words ? { class: "words" } : {});
  const button = make("button", column.name, { type: "button", title: column.full || column.name });
  button.addEventListener("click", () => {
    descending = order === column ? !descending : false;
    order = column;
    draw();
  });
  cell.append(button);
  head.append(cell);
});
const compare = (a, b) => {
  const [x, y] = [order.get(a), order.get(b)];
  if (x === undefined || y === undefined) return (x === undefined) - (y === undefined);
  const sign = typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y), "en", { numeric: true });
  return descending ? -sign : sign;
};
function draw() {
  const text = search.value.toLowerCase();
  let rows = data.variants.filter(v =>
    (status.value === "all" || v.status === status.value) &&
    (!text || (v.id + " " + v.label + " " + (v.reason || "")).toLowerCase().includes(text)) &&
    limits.every(limit => limit(v)));
  if (order) rows = [...rows].sort(compare);
  document.getElementById("count").textContent = `${rows.length} of ${data.variants.length} variants match`;
  const body = document.getElementById("rows");
  body.replaceChildren(...rows.slice(0, shown).map(v => {
    const row = make("tr", undefined, { class: v.status + (v === chosen ? " chosen" : "") });
    columns.forEach(column => {
      const kinds = [column.words && "words", column.title && "title", column.links && "links", (column.title || column.links) && "whole"].filter(Boolean).join(" ");
      const cell = make("td", undefined, { class: kinds, ...(column.title || column.picture ? {} : { "data-name": column.name }) });
      if (column.picture) {
        const picture = column.picture(v);
        if (picture) cell.append(picture);
      } else if (column.links) {
        if (v.status === "made") cell.append(...links(v));
      } else {
        const value = column.show ? column.show(v) : column.get(v);
        cell.textContent = value === undefined ? "" : value;
      }
      row.append(cell);
    });
    if (v.status !== "made") {
      // The reason replaces the columns without values.
      while (row.children.length > 3 + data.fields.length) row.lastChild.remove();
      row.append(make("td", v.status + ": " + (v.reason || ""), { class: "words whole", colspan: columns.length - row.children.length }));
    }
    row.addEventListener("click", () => { chosen = v; draw(); });
    return row;
  }));
  const more = document.getElementById("more");
  more.hidden = rows.length <= shown;
  detail(rows);
}
document.getElementById("more").addEventListener("click", () => { shown += PAGE; draw(); });

// Links to a variant's folder and files.
function links(v) {
  const link = (text, file) => make("a", text, { href: "variants/" + v.id + "/" + file });
  return [link("folder", ""), link("manifest", "manifest.json"), link("curve", "friction.csv")];
}

// The curve of the chosen variant, with those of all matching variants.
function detail(rows) {
  const place = document.getElementById("detail");
  place.hidden = !chosen;
  if (!chosen) return;
  const title = make("p");
  if (chosen.status === "made") {
    title.append(make("strong", chosen.id), " ", ...links(chosen));
  } else {
    title.append(chosen.id + ": " + chosen.status + ", " + (chosen.reason || ""));
  }
  title.append(" — " + data.fields.map((name, i) => name + " = " + (numeric[i] ? +chosen.settings[i].toPrecision(6) : chosen.settings[i])).join(", "));
  const others = rows.filter(v => v.curve_n).slice(0, 300).map(v => `<path class="others" d="${path(v, 520, 150)}"/>`).join("");
  const axes = `<text x="515" y="146" font-size="11" text-anchor="end">${largest_load.toFixed(0)} N load</text>` +
    `<text x="3" y="11" font-size="11">${top_n.toFixed(1)} N friction</text>`;
  place.replaceChildren(title, svg(520, 150,
    `<rect width="520" height="150"/>${others}<path class="spark" d="${path(chosen, 520, 150)}"/>${axes}`));
}
draw();
