// Numbers for the plot: columns of several curves on one axis of loads, and ends of axes that do not jump about.

const OTHERS = 3;

// The next of 1, 1.2, 1.6, 2, 2.5, ... times a power of ten.
function roundedUp(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 1.2, 1.6, 2, 2.5, 3, 4, 5, 6, 8, 10].find((m) => m * power >= value * 0.9999) * power;
}

// uPlot wants one axis of loads. Columns: main, low, high, other laws, kept, preview, calibrated, measured.
function columnsOf({ data, kept, preview, calibrated, rivals }) {
  const { curve, published } = data;
  const others = rivals ? data.other_laws.slice(0, OTHERS) : [];
  const further = [kept?.curve, preview?.curve, calibrated?.curve];
  const all = [curve, ...others, ...further.filter(Boolean)];
  const loads = [...new Set([...all.flatMap((c) => c.load_n), ...published.map((p) => p.load_n)])].sort((a, b) => a - b);
  const on = (xs, ys) => loads.map((x) => (x < xs[0] - 1e-9 || x > xs.at(-1) + 1e-9 ? null : at(xs, ys, x)));
  const nothing = loads.map(() => null);
  return [loads, on(curve.load_n, curve.friction_n), on(curve.load_n, curve.band_low_n), on(curve.load_n, curve.band_high_n),
    ...Array.from({ length: OTHERS }, (_, i) => (others[i] ? on(others[i].load_n, others[i].friction_n) : nothing)),
    ...further.map((c) => (c ? on(c.load_n, c.friction_n) : nothing)),
    loads.map((x) => published.find((p) => p.load_n === x)?.friction_n ?? null)];
}

// Ends of both axes: everything shown, and marks of the ask, with room above.
function endsOf(columns, ask) {
  const highest = Math.max(...columns.slice(1).flat().filter((v) => v !== null), ...ask.friction.map((f) => f.friction_n));
  const heaviest = Math.max(columns[0].at(-1), ask.threshold_n ?? 0, ...ask.friction.map((f) => f.load_n));
  return { load: heaviest * 1.02, friction: roundedUp(highest * 1.06) };
}
