// Numbers as people type them: decimal comma or point, units, simple sums. What could mean two numbers is refused.

// Units of a field, and other units that are converted into it.
const QUANTITY_UNITS = {
  mm: { mm: 1, cm: 10, m: 1000, um: 1e-3, µm: 1e-3, in: 25.4, '"': 25.4 },
  deg: { deg: 1, '°': 1, rad: 180 / Math.PI },
  N: { n: 1, kn: 1000, kgf: 9.80665, gf: 9.80665e-3, lbf: 4.4482216152605 },
  g: { g: 1, kg: 1000, mg: 1e-3, oz: 28.349523125 },
  '%': { '%': 1 },
  C: { c: 1, '°c': 1 },
  'mm/s': { 'mm/s': 1, 'cm/s': 10, 'm/s': 1000, 'in/s': 25.4 },
  min: { min: 1, h: 60, s: 1 / 60 },
  Hz: { hz: 1, khz: 1000 },
  'Shore A': { a: 1, shore: 1 },
  'g/cm3': { 'g/cm3': 1, 'g/cm³': 1, 'kg/m3': 1e-3, 'kg/m³': 1e-3 },
};

// Reads one number. A comma or a point is the decimal sign; with both, the last one is. Returns a number, or the problem.
function readNumeral(text) {
  const [commas, points] = [text.split(',').length - 1, text.split('.').length - 1];
  const grouped = (group, decimal) => new RegExp(`^\\d{1,3}(\\${group}\\d{3})+(\\${decimal}\\d*)?$`).test(text);
  if (commas === 0 && points <= 1) return Number(text);
  if (points === 0 && commas === 1) {
    // 1,234 is 1.234 in one country, and 1234 in another.
    if (/^[1-9]\d{0,2},\d{3}$/.test(text)) return TEXT.quantity.ambiguous(text, text.replace(',', '.'), text.replace(',', ''));
    return Number(text.replace(',', '.'));
  }
  if (grouped(',', '.')) return Number(text.replaceAll(',', ''));
  if (grouped('.', ',')) return Number(text.replaceAll('.', '').replace(',', '.'));
  return TEXT.quantity.notNumber(text);
}

// Splits a text into numerals, words and signs; null for any other character.
function quantityTokens(text) {
  const pattern = /\s*(?:((?:\d[\d.,]*|[.,]\d+)(?:[eE][-+]?\d+)?)|([a-zA-Zµ°%"](?:[a-zA-Z]|\/(?=[a-z])|\d|³)*)|([-+*/×÷·()−]))/y;
  const tokens = [];
  pattern.lastIndex = 0;
  while (pattern.lastIndex < text.length) {
    const from = pattern.lastIndex;
    const match = pattern.exec(text);
    if (!match) return text.slice(from).trim() === '' ? tokens : null;
    const [, numeral, word, sign] = match;
    tokens.push(numeral ? { numeral } : word ? { word } : { sign: { '×': '*', '·': '*', '÷': '/', '−': '-' }[sign] ?? sign });
  }
  return tokens;
}

// Reads a quantity in `unit`, the unit of a field: a number, or a sum, difference, product or quotient of numbers, each
// with or without a unit. Returns `{ value }`, or `{ problem }`, with `isIncomplete` while more may follow.
function readQuantity(text, unit) {
  const tokens = quantityTokens(text.trim());
  if (!tokens) return { problem: TEXT.quantity.notNumber(text.trim()) };
  if (!tokens.length) return { problem: TEXT.notNumber, isIncomplete: true };
  let at = 0;
  const fail = (problem, isIncomplete = false) => { throw Object.assign(new Error(problem), { isQuantity: true, isIncomplete }); };
  const sign = (...signs) => (signs.includes(tokens[at]?.sign) ? tokens[at++].sign : null);
  const factor = () => {
    if (at >= tokens.length) fail(TEXT.notNumber, true);
    if (sign('-')) { const inner = factor(); return { ...inner, value: -inner.value }; }
    if (sign('+')) return factor();
    if (sign('(')) {
      const inner = sum();
      if (!sign(')')) fail(TEXT.notNumber, at >= tokens.length);
      return withUnit(inner);
    }
    const { numeral, word } = tokens[at++];
    if (numeral === undefined) fail(TEXT.quantity.notNumber(word ?? text.trim()));
    const [, digits, power] = /^(.*?)((?:[eE][-+]?\d+)?)$/.exec(numeral);
    const value = readNumeral(digits);
    if (typeof value === 'string') fail(value);
    return withUnit({ value: Number(`${value}${power}`), scale: null });
  };
  // A unit after a number or a bracket.
  const withUnit = (quantity) => {
    const word = tokens[at]?.word;
    if (word === undefined) return quantity;
    const known = QUANTITY_UNITS[unit] ?? {};
    const scale = known[word] ?? known[word.toLowerCase()];
    if (scale === undefined) fail(unit ? TEXT.quantity.otherUnit(word, unitLabel(unit)) : TEXT.quantity.noUnit(word));
    at += 1;
    // "Shore A" has two words.
    if (word.toLowerCase() === 'shore' && tokens[at]?.word?.toLowerCase() === 'a') at += 1;
    if (quantity.scale !== null) fail(TEXT.quantity.notNumber(text.trim()));
    return { value: quantity.value * scale, scale };
  };
  const product = () => {
    const result = factor();
    for (let by = sign('*', '/'); by; by = sign('*', '/')) {
      const other = factor();
      if (other.scale !== null && result.scale !== null) fail(TEXT.quantity.notNumber(text.trim()));
      // 1/16 in: the unit belongs to the quotient.
      const [number, scale] = by === '/' && other.scale !== null ? [other.value / other.scale, other.scale] : [other.value, 1];
      result.value = (by === '*' ? result.value * number : result.value / number) * scale;
      result.scale ??= other.scale;
    }
    return result;
  };
  const sum = () => {
    const result = product();
    for (let by = sign('+', '-'); by; by = sign('+', '-')) {
      const other = product();
      // In 1 + 2 in, the 1 has the unit of the field or inches.
      const scales = [result.scale, other.scale];
      if (scales.includes(null) && scales.some((scale) => scale !== null && scale !== 1)) fail(TEXT.quantity.mixed(text.trim()));
      result.value += by === '+' ? other.value : -other.value;
      result.scale ??= other.scale;
    }
    return result;
  };
  try {
    const { value } = sum();
    if (at < tokens.length) fail(TEXT.quantity.notNumber(text.trim()));
    if (!Number.isFinite(value)) fail(TEXT.quantity.notNumber(text.trim()));
    return { value: Number(value.toPrecision(12)) };
  } catch (problem) {
    if (!problem.isQuantity) throw problem;
    return { problem: problem.message, isIncomplete: problem.isIncomplete };
  }
}

// The label of a field's unit.
const unitLabel = (unit) => TEXT.units[unit] ?? unit;

// Makes a text input a number input: the arrow keys change the number by `step`, ten of them with Shift.
function stepByArrows(input, step, unit, apply) {
  input.addEventListener('keydown', (event) => {
    const direction = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (!direction || event.altKey || event.ctrlKey || event.metaKey) return;
    const { value } = readQuantity(input.value, unit);
    if (value === undefined) return;
    event.preventDefault();
    const next = Number((value + direction * step * (event.shiftKey ? 10 : 1)).toFixed(9));
    input.value = formatNumber(next, 6);
    apply(next);
  });
}

// On a touch screen a slider changes only by a horizontal drag: a tap, or a swipe that scrolls, leaves it unchanged. A drag that
// leaves the slider upward or downward was a swipe: the value goes back, as sliders of operating systems do.
const LEAST_DRAG_PX = 10, SNAP_BACK_PX = 40;
let touch = null;
addEventListener('pointermove', (event) => {
  if (!touch || touch.isSwipe) return;
  const [dx, dy] = [Math.abs(event.clientX - touch.x), Math.abs(event.clientY - touch.y)];
  Object.assign(touch, { dx, dy });
  touch.isDrag ||= dx > LEAST_DRAG_PX && dx > 2 * dy;
  touch.isSwipe = dy > SNAP_BACK_PX;
  if (!touch.isSwipe) return;
  touch.slider.value = touch.value;
  if (touch.isDrag) touch.revert();
});
for (const name of ['pointerup', 'pointercancel']) {
  addEventListener(name, () => {
    const ended = touch;
    // Steeper than 45 degrees.
    if (ended && !ended.isSwipe && ended.dy > ended.dx) {
      ended.isSwipe = true;
      if (ended.isDrag) ended.revert();
    }
    // After the last event of the slider itself.
    setTimeout(() => {
      if (ended && (!ended.isDrag || ended.isSwipe)) ended.slider.value = ended.value;
      if (touch === ended) touch = null;
    });
  });
}

// Calls `apply` for changes of a slider, and `revert`, which `begin` returns, where a drag turns out to be a swipe.
function listenToSlider(slider, apply, begin) {
  slider.addEventListener('pointerdown', (event) => {
    touch = event.pointerType === 'touch' ? { slider, x: event.clientX, y: event.clientY, value: slider.value, isDrag: false, isSwipe: false, dx: 0, dy: 0, revert: begin() } : null;
  });
  slider.addEventListener('input', () => {
    if (touch?.slider === slider && (!touch.isDrag || touch.isSwipe)) { slider.value = touch.value; return; }
    apply();
  });
}
