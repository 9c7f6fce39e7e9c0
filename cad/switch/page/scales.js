// Data of the plot: several curves on one axis of loads, and stable ends of the axes.

const MAX_OTHER_LAWS = 3;
// Most proposed designs, all of which are on the plot.
const MAX_PROPOSALS = 6;

// Rounds up to 1, 1.2, 1.6, 2, 2.5, ... times a power of ten.
function roundedUp(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 1.2, 1.6, 2, 2.5, 3, 4, 5, 6, 8, 10].find((m) => m * power >= value * 0.9999) * power;
}

// Columns for uPlot over one axis of loads: main, low, high, other laws, comparison, preview,
// calibrated, published points, points of the person, proposed designs.
function columnsOf({ data, comparison, preview, calibrated, proposals, showsOtherLaws, ownPoints }) {
  const { curve, published } = data;
  const others = showsOtherLaws ? data.other_laws.slice(0, MAX_OTHER_LAWS) : [];
  const extra = [comparison?.curve, preview?.curve, calibrated?.curve];
  const proposed = Array.from({ length: MAX_PROPOSALS }, (_, i) => proposals[i]);
  const all = [curve, ...others, ...extra.filter(Boolean), ...proposals];
  const loads = [...new Set([...all.flatMap((c) => c.load_n), ...published.map((p) => p.load_n), ...ownPoints.map((p) => p.load_n)])].sort((a, b) => a - b);
  const on = (xs, ys) => loads.map((x) => (x < xs[0] - 1e-9 || x > xs.at(-1) + 1e-9 ? null : at(xs, ys, x)));
  const empty = loads.map(() => null);
  return [loads, on(curve.load_n, curve.friction_n), on(curve.load_n, curve.band_low_n), on(curve.load_n, curve.band_high_n),
    ...Array.from({ length: MAX_OTHER_LAWS }, (_, i) => (others[i] ? on(others[i].load_n, others[i].friction_n) : empty)),
    ...extra.map((c) => (c ? on(c.load_n, c.friction_n) : empty)),
    ...[published, ownPoints].map((points) => loads.map((x) => points.find((p) => p.load_n === x)?.friction_n ?? null)),
    ...proposed.map((c) => (c ? on(c.load_n, c.friction_n) : empty))];
}

// Ends of both axes: all curves and targets, with a margin.
function endsOf(columns, targets) {
  const maxFriction = Math.max(...columns.slice(1).flat().filter((v) => v !== null), ...targets.friction.map((f) => f.friction_n));
  const maxLoad = Math.max(columns[0].at(-1), targets.threshold_n ?? 0, ...targets.friction.map((f) => f.load_n));
  return { load: maxLoad * 1.02, friction: roundedUp(maxFriction * 1.06) };
}
