'use strict';
// All English of the page. What an answer of the engine says (reasons, problems, remedies) comes in its own words.

const WORDS = {
  title: 'pinswitch: configure a printable friction switch',
  brand: 'pinswitch',
  skip: 'Skip the parameters',
  // Places of the page, by `data-word`, and accessible names, by `data-name`.
  layouts: 'Layouts', moreTemplates: 'More', undo: 'Undo', redo: 'Redo', share: 'Share', open: 'Open a file', download: 'Download',
  parameters: 'Parameters', close: 'Close',
  find: 'Find a parameter', changedOnly: 'Changed only', noField: 'No parameter has these words.',
  intro: 'A tendon runs over steel pins in silicone. As load grows, the pins sink, the tendon meets silicone, and friction rises.',
  assembly: 'Assembly', apart: 'Pull apart', cut: 'Cut open', cutAt: 'Cut at', turn: 'Turn', tilt: 'Tilt', show: 'Show', look: 'View',
  assemblyName: 'The assembly in three dimensions. Drag to turn, wheel or pinch to zoom; under View, sliders turn and cut it from the keyboard.',
  curve: 'Friction over load', load: 'Load', rivals: 'Other laws', keep: 'Keep to compare', letGo: 'Forget the kept',
  curveTable: 'The curve as a table', why: 'How far to trust it, and why',
  pins: 'Pins', clearPins: 'Lift all', mirror: 'Mirror',
  pinsHelp: 'Click a groove to set or lift a pin, drag a pin to move it. From the keyboard: arrows walk, Space sets or lifts, Shift and an arrow carry the pin along.',
  checks: 'Checks', bill: 'You will need', parts: 'Printed parts', bed: 'On the print bed',
  ask: 'Ask backwards', found: 'Designs that come near', askHelp: 'Drag the marks on the curve, or type: where it should switch, how much friction it should make.',
  askThreshold: 'Switches at', askFriction: 'Friction of', askLoad: 'at a load of', addFriction: 'Add a friction', search: 'Find designs', stop: 'Stop', stopFit: 'Stop the fit', take: 'Take this',
  measured: 'Your measurements', chooseTable: 'Choose a table', takeModel: 'Use this model in the design', dropModel: 'Back to the published constants',
  measuredHelp: 'Drop a table of plateaus (CSV) anywhere on the page. It says whether the model holds for your switch, and what it misses.',
  filesTitle: 'Download', everything: 'Everything, as ZIP', configuration: 'Configuration (TOML)', dropHere: 'Drop a table of plateaus (CSV), a configuration (TOML) or a model.toml',

  groups: {
    switch: 'Switch', layout: 'Layout', segment: 'Segment', shell: 'Shell', fasteners: 'Fasteners', silicone: 'Silicone layer', pins: 'Pins', tendon: 'Tendon',
    support: 'Side supports', mould: 'Casting mould', mount: 'Mount', parts: 'Parts', label: 'Label', print: 'Printer', mesh: 'Mesh', drawing: 'Drawing', friction: 'Friction curve',
  },
  // Where the key without its unit is not what one would say.
  fields: {
    'layout.pins': 'pins in', 'layout.wrap_angle_deg': 'wrap angle', 'segment.span_deg': 'span', 'silicone.hardness_shore_a': 'hardness',
    'silicone.density_g_cm3': 'density', 'print.abs_density_g_cm3': 'density of the plastic', 'silicone.least_mix_g': 'least to mix', 'mould.shrinkage_pct': 'shrinkage',
    'print.bed_mm': 'side of the bed', 'friction.six_single_threshold': 'threshold of six-single', 'parts.proxy': 'rigid proxy', 'parts.coupon': 'fit coupon', 'label.engrave': 'engrave a label',
  },
  units: { deg: '°', shore_a: 'Shore A', 'g/cm3': 'g/cm³', g_cm3: 'g/cm³', pct: '%', n: 'N' },
  groupChanged: (n) => (n === 1 ? '1 changed' : `${n} changed`),
  reset: (name) => `Reset ${name}`,
  about: (name) => `About ${name}`,
  aboutField: (f, shown) => `${f.reason}. Range: ${f.range}. Default: ${shown}, ${f.origin}.`,
  slider: (name) => `${name}, slider`,
  stays: (name, value) => `${name} stays ${value}.`,
  notNumber: 'This is no number.', notWhole: 'A whole number goes here.', notList: 'Groove numbers go here, with commas: 5, 8, 11.',
  setTo: (name, value) => `Set ${name} to ${value}`,

  mends: (changes) => `Mend it: ${changes.join(', ')}`,
  refused: 'This cannot be built. The last design that can stays in view, in grey.', refusedAtFirst: (name) => `This cannot be built. In its place ${name} is shown, in grey.`,
  changedFrom: (name) => `${name}, changed`,

  newtons: (v, digits = 1) => `${v.toFixed(digits)} N`,
  frictionAt: (load) => `of friction at ${load} of load`,
  range: (low, high) => `${low} to ${high}`,
  curveName: (law, load, friction, low, high) => `Friction over load by ${law}: ${friction} N at ${load} N of load, band ${low} to ${high} N`,
  trust: { published: 'published layout', interpolated: 'between measured layouts', extrapolated: 'extrapolated' },
  trustMark: { published: '●', interpolated: '◐', extrapolated: '○' },
  calibratedTrust: (trust) => `your model, ${trust}`,
  trustOf: (words) => `How far to trust the curve: ${words}. Show the reasons`,
  axisLoad: 'load (N)', axisFriction: 'friction (N)',
  band: 'band of 95 %', measuredPoint: 'measured', kept: (name) => `kept: ${name}`, more: (n) => `${n} more`, publishedConstants: 'published constants', calibratedCurve: 'with your model', previewCurve: (n) => `design ${n}`,
  law: (law, source) => `Law of the curve, ${law}: ${source}.`,
  thresholdOwn: (n) => `now ${n}`, thresholdNow: (n) => `switches at ${n}`, thresholdAsked: (n) => `asked: ${n}`, frictionAsked: (n) => `asked: ${n}`,
  thresholdHandle: 'Load at which it should switch', frictionHandle: (i) => `Friction that is asked for, mark ${i}`,
  loadText: (load, friction) => `${load} N of load, ${friction} N of friction`,
  columns: { load: 'load (N)', eccentric: 'eccentric', concentric: 'concentric', friction: 'friction', low: 'low', high: 'high' },

  groove: (i, pin) => `Groove ${i}, ${pin ? 'with a pin' : 'empty'}`,
  pinsName: 'Grooves of the segment, from left to right',
  pinsIn: (pins) => (pins.length ? `Pins in ${pins.join(', ')}` : 'No pins'),
  pinsOf: (n, grooves) => `${n} of ${grooves} grooves`,
  bare: 'The tendon lies on the substrate from the start.',

  checkFine: 'fine', checkLook: 'look', checkWarning: 'warning', checksSum: (fine, all) => `${fine} of ${all} fine`, showFine: (n) => `${n} that are fine`,
  steelPins: 'steel pins', spare: (n, s) => `${n} + ${s} spare`, pour: 'silicone, to pour', mix: 'silicone, to mix', mixed: (b, a) => `${b} g base, ${a} g agent`,
  tendon: 'tendon', coated: (d, o) => `${d} mm, ${o} mm coated`, screws: 'screws', nuts: 'nuts', inserts: 'heat-set inserts', dowels: 'dowels', forMount: 'for the mount',
  rightSide: (l, r) => `${l} left, ${r} right`,
  plastic: 'plastic, all printed parts', part: 'part', size: 'size (mm)', mass: 'mass (g)', volume: 'volume (mm³)', triangles: 'triangles',
  bedSays: (beds, bed, fits) => (fits ? `Outlines of the printed parts, to scale, on ${beds === 1 ? 'a bed' : `${beds} beds`} of ${bed} mm.` : `Not all parts lie on one bed of ${bed} mm: print them in turns.`),
  bedPart: (name, x, y) => `${name}, ${x} by ${y} mm`, bedName: (n, bed) => `Outlines of ${n} printed parts on a bed of ${bed} mm`,

  searching: (s) => `Looking for designs, ${s} s. The page stays yours meanwhile.`, searchedWith: (name) => `; by the ${WORDS.modelName(name)}`, searchedBefore: 'Found for the design and the wishes as they were before your last change. Find designs again for what you ask now.',
  notAsked: (most) => `A number above 0 and up to ${most} N goes here.`, searchNothing: 'Say first where it should switch or how much friction it should make.',
  stopped: 'Stopped.', likely: (p) => `${p} % likely`, designPins: (pins) => (pins.length ? `pins [${pins.join(', ')}]` : 'no pins'),
  likelyMeans: (within) => `Likely: of parts that are made so, this share comes within ${plain(100 * within)} % of all that is asked.`,
  switchesAt: (n) => (n === null ? 'does not switch' : `switches at ${n.toFixed(1)} N`), heaviest: (n) => `${n.toFixed(2)} N at the heaviest load`,
  answer: ({ load_n, asked_n, value_n, is_met }) => `${load_n === null ? WORDS.switchesAt(value_n) : `${value_n.toFixed(2)} N at ${plain(load_n)} N of load`}; asked: ${plain(asked_n)} N${is_met ? '' : ', missed'}`,
  removeFriction: (i) => `Remove friction ${i}`, designName: (i) => `Design ${i}`,
  forgetThreshold: 'Ask for no threshold',

  calibrating: (file, s) => `Fitting the model to ${file}, ${s} s. Thousands of rows take half a minute, tens of thousands some minutes; the page stays yours meanwhile.`,
  calibrated: (before, after, promise) => `Held-out error ${before} N before, ${after} N after; a new session: ${promise} N.`,
  modelTaken: 'The design uses your calibrated model. The address carries it, and is long.', modelName: (file) => `model from ${file}`,
  verdictOf: (file, verdict) => `${file}: ${verdict}`,
  // By the verdict: what it says, with the effects that were found or are not excluded.
  verdicts: {
    none: 'the published model holds for this table.', inconclusive: 'nothing was found, but this table cannot exclude all that matters.', attributed: 'the published model misses something, and this table tells what.',
    ambiguous: 'the published model misses something, and this table cannot tell what of several.', unattributed: 'the published model misses something that no known effect explains.',
  },
  foundEffects: (effects) => `Found: ${effects.map((rivals) => rivals.map(effectWords).join(', or ')).join('; ')}.`,
  notExcluded: (effects) => `Not excluded: ${effects.map((id) => WORDS.effectNames[id] ?? id).join('; ')}.`,
  effectNames: {
    coating_ploughing: 'pins plough the coating of the tendon', coating_stiffening: 'friction of the coating grows with load', polygon_bending: 'the tendon turns sharply at single pins',
    substrate_saturation: 'friction of the silicone is bounded', adhesion: 'the silicone sticks at no load', dwell_relaxation: 'friction of the silicone depends on the pause before',
    run_in: 'friction is higher in the first repetitions', wear_drift: 'friction drifts with the travel', rate_dependence: 'friction depends on the speed', direction_asymmetry: 'friction differs between the directions',
    switching_hysteresis: 'it switches elsewhere with a falling load', switch_local_tension: 'the switch follows the tension along the wrap', fixture_compliance: 'the mount bends under load',
    stroke_position: 'the wrap angle changes along the stroke', guide_drag: 'the guide pulleys drag', load_cell_offset: 'the load cell reads too much or too little', load_cell_gain: 'the load cell has a wrong scale',
    load_cell_nonlinearity: 'the load cell is not linear', load_cell_saturation: 'the load cell stops rising', hook_omitted: 'the hook was not weighed', thermal_drift: 'the reading drifts with time',
  },
  tooLarge: (name, mb, limit) => `${name} has ${mb} MB. A table of plateaus has one line per plateau and stays under ${limit} MB. A raw log becomes one with: pinswitch segment.`,
  tooLargeConfiguration: (name, mb) => `${name} has ${mb} MB, which is no configuration of pinswitch. Drop the TOML file that it wrote.`,
  foreign: (name) => `${name} is of no kind that this page reads. It reads tables of plateaus (.csv), configurations and models (.toml).`,
  notText: (name) => `${name} holds no text. It may be packed, or of another program: export it as CSV.`,
  empty: (name) => `${name} is empty.`, unreadable: (name) => `${name} could not be read. Is it still there?`, manyFiles: 'One file at a time: the first was taken.',

  waitsFor: { search: 'Waits for the search for designs to end, or to be stopped.', calibrate: 'Waits for the fit to your table to end, or to be stopped.' },
  makingFiles: 'Making the files …', filesFail: 'The files were not made: ', saving: (name) => `Making ${name} …`, saved: (name) => `${name} is saved.`, noFiles: 'This design cannot be built, so that it has no files. Mend it first.',
  megabytes: (bytes) => (bytes < 1000 ? `${bytes} B` : bytes < 1e6 ? `${Math.round(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`),
  kinds: { stl: 'Printed parts, one by one', '3mf': 'All parts on a plate', step: 'For CAD, exact', dxf: 'Drawings', svg: 'Drawings and figures', pdf: 'Drawings', glb: 'For viewers and web pages', png: 'Pictures', md: 'Guide', csv: 'Tables', json: 'Tables', html: 'Pages', ini: 'Printer', toml: 'Configuration', other: 'Other' },

  shared: 'The address is copied: it holds the whole design.', shareByHand: 'Copy the address of this page: it holds the whole design.',
  templateTaken: (name, lost) => (lost ? `${name}, as it ships. Undo brings your ${lost} changed ${lost === 1 ? 'value' : 'values'} back.` : `${name}, as it ships.`), printerTaken: (name, kept) => `${name} set under your design.${kept.length ? ` Your own stays: ${kept.join(', ')}.` : ''}`,
  opened: (file) => `${file} is open.`, notOpened: (file) => `${file} could not be opened: `, designTaken: 'Taken. Undo brings the former back.',
  welcomeBack: 'Went on where you left off.',
  published: 'Published', printers: 'Printers',

  hash: {
    older: (v) => `The address is of version ${v}, which there never was: versions begin with 1.`,
    newer: (v) => `The address is of version ${v}, newer than this page (1).`,
    broken: 'The address holds no design, or is cut off.', stays: 'The design stays as it was.',
    unknown: (names) => `The address names ${names.join(', ')}, which this version does not have.`,
    wrong: (names) => `The address gives ${names.join(', ')} a value that cannot be.`,
    rest: 'The rest was taken.',
    twice: (names) => `The address gives ${names.join(', ')} twice: the last one counts.`,
    manyFrictions: (most) => `The address asks for more than ${most} frictions: the first ${most} were taken.`,
    model: 'The address holds a calibrated model that is cut off. The published constants are used.',
  },

  noMessage: 'The message holds neither an address nor values that can be written as one.',
  modelTooLong: (name, length, most) => `${name} was not taken: packed it has ${length} characters, and an address holds ${most}. Take out comments and what is not of the model.`,
  setPage: 'The page of the set that this server follows',
  saveTo: (file) => `Save to ${file}`, savedTo: (file) => `Saved to ${file}.`, notSaved: (file) => `${file} was not saved: `, fileChanged: (file) => `${file} was changed: its values are shown. Undo goes back.`,
  fileDiffers: (file) => `The page shows a design of its address, and ${file} has other values now.`,
  fileNewer: (file, names) => `${file} was not saved: it has been changed since this page last read it (${names.join(', ')}).`,
  savedUnder: (file, fields) => `Saved to ${file}. What it says of ${fields.map(([, name]) => name).join(', ')} counts once pinswitch view is started without ${[...new Set(fields.map(([option]) => option))].join(' and ')}.`,
  fileGone: (file) => `${file} was not saved: it is no longer there.`, writeAnew: 'Write it anew',
  showFile: (file) => `Show ${file}`, saveOver: 'Save over it', savedWithoutModel: (file) => `Saved to ${file}, which holds no model: keep your model.toml, and make the parts with --model.`,

  starting: 'Starting the engine …', working: 'Working …',
  engineMissing: 'This copy of the page holds no engine, and no server answers. Open it with: pinswitch view',
  engineBroken: (reason) => `The engine does not start in this browser (${reason}). A current Firefox, Chrome, Edge or Safari runs it, and so does: pinswitch view`,
  engineStopped: 'The engine stopped on this design and was started again. Undo the last change, or try another value.',
  enginePart: (reason) => `The engine did not answer: ${reason}.`,
  serverGone: 'The server does not answer. Is pinswitch view still running? The last design stays; what you change next asks again.',
  retry: 'Try again',
  stillName: 'A picture of the parts, pulled apart.',
  noWebgl: 'This browser shows no WebGL, which the turning view needs. Pins, curve, checks and downloads work without.',
  fault: (message) => `The page has a fault: ${message}. Reloading keeps the design, which the address holds.`,
};

// An effect in words, with the name under which the catalogue and the reports have it.
const effectWords = (id) => (WORDS.effectNames[id] ? `${WORDS.effectNames[id]} (${id})` : id.replaceAll('_', ' '));

// Trouble as the engine tells it: what has it, its value, what is wrong, and what helps.
function troubleWords({ field, value, problem, remedy }, name = field) {
  const has = value === null || value === undefined || value === '' ? name : `${name} = ${String(value).slice(0, 60)}`;
  return `${has ? `${has}: ` : ''}${problem}${remedy ? `; ${remedy}` : ''}`;
}

// What a field is called: its key without the unit, unless it has a name of its own.
function fieldName(field) {
  if (WORDS.fields[field.path]) return WORDS.fields[field.path];
  return field.key.replace(/_(mm|deg|n|g|pct|g_cm3|shore_a)$/, '').replaceAll('_', ' ');
}
const unitName = (field) => WORDS.units[field.unit] ?? (field.unit || WORDS.units[/_(shore_a|g_cm3|pct|n)$/.exec(field.key)?.[1]] || '');
