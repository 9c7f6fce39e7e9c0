// Helpers for elements, numbers, tables, drags and the toast.

const byId = (id) => document.getElementById(id);

const make = (tag, text, attributes = {}) => {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  for (const [name, value] of Object.entries(attributes)) if (value !== undefined) element.setAttribute(name, value);
  return element;
};

const svg = (tag, attributes = {}, text) => {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  if (text !== undefined) element.textContent = text;
  return element;
};

const button = (text, act, attributes = {}) => {
  const element = make('button', text, { type: 'button', class: 'btn', ...attributes });
  element.addEventListener('click', act);
  return element;
};

const colourOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Returns a function that calls `act` once, when `pause_ms` have passed since its last call.
function debounce(act, pause_ms) {
  let timer;
  return (...given) => {
    clearTimeout(timer);
    timer = setTimeout(() => act(...given), pause_ms);
  };
}

// A number without insignificant digits.
const formatNumber = (value, digits = 4) => (typeof value === 'number' ? String(Number(Math.abs(value) < 1 ? value.toPrecision(digits) : value.toFixed(digits))) : String(value));

function formatValue(value) {
  if (Array.isArray(value)) return `[${value.join(', ')}]`;
  return value === '' ? '""' : formatNumber(value);
}

function table(head, rows) {
  const element = make('table');
  const numeric = (cell) => typeof cell === 'number' || /^[-+\d.]/.test(String(cell));
  const line = (cells, tag) => {
    const row = make('tr');
    cells.forEach((cell, i) => row.append(make(tag, cell, { class: i && numeric(rows[0]?.[i] ?? '') ? 'n' : undefined, scope: tag === 'th' ? 'col' : undefined })));
    return row;
  };
  element.append(make('thead'), make('tbody'));
  element.tHead.append(line(head, 'th'));
  rows.forEach((row) => element.tBodies[0].append(line(row, 'td')));
  return element;
}

function save(name, content, type) {
  const link = make('a', '', { download: name, href: URL.createObjectURL(new Blob([content], { type })) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// Returns bytes in base64; in parts, since a call has a limited number of arguments.
const CALL_BYTES = 32768;
function base64Of(bytes) {
  let text = '';
  for (let from = 0; from < bytes.length; from += CALL_BYTES) text += String.fromCharCode(...bytes.subarray(from, from + CALL_BYTES));
  return btoa(text);
}

// Reports elapsed seconds at once and then at long intervals, since a screen reader reads each
// report. Returns a function that ends the reports.
const REPORT_INTERVAL_MS = 5000;
function reportElapsed(report) {
  const start = performance.now();
  const tick = () => report(Math.round((performance.now() - start) / 1000));
  tick();
  const timer = setInterval(tick, REPORT_INTERVAL_MS);
  return () => clearInterval(timer);
}

// Shows a message at the lower edge for some seconds.
const TOAST_MS = 5000;
let toastTimer;
function showToast(text) {
  byId('toast').textContent = text;
  byId('toast').classList.add('on');
  clearTimeout(toastTimer);
  toastTimer = setTimeout(() => byId('toast').classList.remove('on'), TOAST_MS);
}

// Handles drags of `element`: `move` gets each pointer event, `end` the last one and whether the
// drag was cancelled.
function draggable(element, { start, move, end }) {
  element.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || start?.(event) === false) return;
    element.setPointerCapture(event.pointerId);
    const follow = (e) => move(e);
    const stop = (e) => {
      element.removeEventListener('pointermove', follow);
      element.removeEventListener('pointerup', stop);
      element.removeEventListener('pointercancel', stop);
      end?.(e, e.type === 'pointercancel');
    };
    element.addEventListener('pointermove', follow);
    element.addEventListener('pointerup', stop);
    element.addEventListener('pointercancel', stop);
  });
}
