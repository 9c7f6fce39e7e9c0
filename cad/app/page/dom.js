// Small pieces that every part of the page uses.

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

// Calls once, when nothing has called for `pause_ms`.
function later(act, pause_ms) {
  let timer;
  return (...given) => {
    clearTimeout(timer);
    timer = setTimeout(() => act(...given), pause_ms);
  };
}

// A number as one would write it: no digits that say nothing.
const plain = (value, digits = 4) => (typeof value === 'number' ? String(Number(Math.abs(value) < 1 ? value.toPrecision(digits) : value.toFixed(digits))) : String(value));

function shownValue(value) {
  if (Array.isArray(value)) return `[${value.join(', ')}]`;
  return value === '' ? '""' : plain(value);
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

// Tells how many seconds something has taken, at once and then seldom, since each time is read aloud. Returns what ends it.
const TOLD_EVERY_MS = 5000;
function tellTime(tell) {
  const began = performance.now();
  const tick = () => tell(Math.round((performance.now() - began) / 1000));
  tick();
  const clock = setInterval(tick, TOLD_EVERY_MS);
  return () => clearInterval(clock);
}

// A line at the lower edge that says what was done, and goes by itself.
let sayingEnds;
function say(text) {
  byId('said').textContent = text;
  byId('said').classList.add('on');
  clearTimeout(sayingEnds);
  sayingEnds = setTimeout(() => byId('said').classList.remove('on'), 5000);
}

// Pulls on `element`: `move` gets each place of the pointer until it is let go, `end` the last one.
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
