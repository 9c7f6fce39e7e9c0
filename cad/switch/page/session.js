// A session in a file: design, targets, model and measurements, saved and opened again.

const SESSION = 'pinswitch.session/1';
const isText = (value) => typeof value === 'string';
// None that a plot cannot draw.
const areNumbers = (...values) => values.every((value) => Number.isFinite(value) && Math.abs(value) < 1e9);

// An end that is null is not bounded.
const isInterval = (ends) => Array.isArray(ends) && ends.length === 2 && ends.every((end) => end === null || areNumbers(end));

// A fit that was kept or that a file contains; null if it is none, since people edit files.
function readFit(fit) {
  const isList = (list, isEntry) => Array.isArray(list) && list.every((entry) => entry !== null && isEntry(entry));
  const isFit = fit && isText(fit.file) && isText(fit.model) && isText(fit.head) && isList(fit.lines, isText)
    && isList(fit.probabilities, (p) => isText(p[0]) && areNumbers(p[1]))
    && isList(fit.sizes, (s) => isText(s.id) && isText(s.name) && isText(s.unit) && areNumbers(s.value) && isInterval(s.ci95))
    && isList(fit.points, (p) => Array.isArray(p.pins) && areNumbers(p.wrap_angle_deg, p.load_n, p.friction_n))
    && isList(fit.residuals, (r) => areNumbers(r.load_n, r.before_n, r.after_n));
  return isFit ? { ...fit, csv: isText(fit.csv) ? fit.csv : null } : null;
}

// The whole state as a text that `readSession` reads.
function writeSession({ values, targets, model, fit }) {
  return `${JSON.stringify({ schema: SESSION, values, targets, model: model && { name: model.name, toml: model.toml }, fit }, null, 1)}\n`;
}

// Returns the state of a saved session; null for another file. Unknown fields are left out.
async function readSession(text, fields) {
  try {
    const { schema, values, targets, model, fit } = JSON.parse(text);
    if (schema !== SESSION) return null;
    const known = Object.fromEntries(Object.entries(values).filter(([path]) => fields.has(path)));
    // As in an address, and of the kind of the field.
    const isOfKind = ([path, value]) => sameValue(readValue(fields.get(path), Array.isArray(value) ? value.join(',') : String(value)), value);
    if (!Object.entries(known).every(isOfKind)) return null;
    const isThreshold = targets.threshold_n === null || isTarget(targets.threshold_n);
    const areFrictions = targets.friction.every((f) => isTarget(f.load_n) && isTarget(f.friction_n)) && targets.friction.length <= MAX_FRICTIONS;
    if (!isThreshold || !areFrictions) return null;
    const packed = model && isText(model.name) && isText(model.toml) ? await packModel(model.name, model.toml) : null;
    if (packed?.packed.length > MAX_MODEL_LENGTH || (fit && !readFit(fit))) return null;
    return { values: known, targets: { threshold_n: targets.threshold_n, friction: targets.friction }, model: packed, fit: readFit(fit) };
  } catch {
    return null;
  }
}
