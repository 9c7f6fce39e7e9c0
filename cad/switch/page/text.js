'use strict';
// All English text of the page. Reasons, problems and help in answers of the engine are shown as
// they come.

const TEXT = {
  title: 'pinswitch: design a pulley whose friction rises with the load',
  brand: 'pinswitch',
  skip: 'Skip the parameters',
  // Texts of elements by `data-text`, accessible names by `data-name`.
  layouts: 'Layouts', moreTemplates: 'Templates', undo: 'Undo', redo: 'Redo', share: 'Share', open: 'Open a file', download: 'Download',
  parameters: 'Parameters', close: 'Close',
  find: 'Find a parameter', changedOnly: 'Changed', allParameters: 'All',
  stripName: 'Summary of the design: show the curve', clipboard: 'the clipboard', noField: 'No matching parameter.',
  intro: 'A friction switch is a pulley that lets the tendon of a robot or a machine slip at light loads and holds it at heavy ones: as the load grows, its steel pins sink, and the tendon meets the silicone between them.',
  steps: { parameters: 'What should it do?', curve: 'Does it do it?', download: 'Make it' }, stepsName: 'Three steps',
  playLoad: '▶ Play the load', stopMotion: '■ Stop', stripFriction: (n, load) => `${n} at ${load}`, pinsScale: (load, scale) => `At ${load} N of load; heights are ${scale} times as large. Blue: here the tendon lies on the silicone.`,
  explode: 'Explode', section: 'Section', sectionPosition: 'Position of the section', turn: 'Rotate', tilt: 'Tilt', show: 'Show', viewMenu: 'View',
  flexion: 'Flexion', flex: 'Play', flexionText: (flexion, wrap) => `${flexion}°, wrap ${wrap}°`,
  assemblyName: 'The assembly in 3D. Drag to rotate, use the wheel or pinch to zoom; the sliders under View rotate and cut it from the keyboard.',
  curve: 'Friction over load', load: 'Load', otherLaws: 'Other laws', keepCurve: 'Keep for comparison', clearComparison: 'Clear comparison',
  curveTable: 'The curve as a table', why: 'Prediction status and reasons',
  clearPins: 'Remove all pins', mirror: 'Mirror',
  pinsHelp: 'Click or tap a groove to add or remove a pin, drag a pin to move it. Keyboard: arrows select a groove, Space adds or removes a pin, Shift and an arrow move it.',
  checks: 'Checks', materials: 'Bill of materials', parts: 'Printed parts', bed: 'Print bed',
  targets: 'What should it do?', mayChange: 'The search may change', details: 'Details', printer: 'Printer', ownPrinter: 'my own, under Parameters', curveStep: 'Does it do it?', materialsStep: 'Make it: ',
  varied: { pattern: 'pins', pitch_deg: 'pitch', layer_mm: 'thickness of the silicone', hardness_shore_a: 'hardness', pin_diameter_mm: 'diameter of the pins', radius_mm: 'radius', width_mm: 'width', wrap_deg: 'wrap angle' },
  gainColumns: ['change', 'threshold', 'friction at the heaviest load'], printable: (n, all) => (n === all ? 'All pass the print checks.' : `${n} of ${all} pass the print checks${n ? '; they are first' : ''}.`), designProblems: (problems) => `To review before printing: ${problems.join('; ')}.`,
  changeOf: (a, b) => `${TEXT.switchesAt(a.threshold_n) === TEXT.switchesAt(b.threshold_n) ? '' : `before: ${TEXT.switchesAt(a.threshold_n)}; now ${TEXT.switchesAt(b.threshold_n)}. `}Friction at ${TEXT.newtons(b.load_n)}: ${TEXT.newtons(a.friction_n, 2)}, now ${TEXT.newtons(b.friction_n, 2)}. Undo to revert.`,
  proposedCurves: (n) => `proposed designs (${n})`, lawNames: { paper: 'law of the paper', layout: 'law of layouts', physics: 'equilibrium of the tendon' },
  targetUnchanged: (value) => (value === null ? 'No target is set.' : `The target is still ${value} N.`), yourTargets: 'your targets', asPublished: 'Show it as in the paper', downloadHere: 'Download the files',
 results: 'Proposed designs', targetsHelp: 'Drag the marks on the curve, or enter the load at which it should switch and the friction it should have.',
  targetThreshold: 'Switches at', targetFriction: 'Friction of', targetLoad: 'at a load of', addFriction: 'Add a friction', search: 'Find designs', stop: 'Stop', stopFit: 'Stop the fit', useDesign: 'Use this design',
  isReport: 'This page shows a set that is made. To change it, open assembly.3mf or its TOML file with `pinswitch view`.', filesBeside: 'Linked files are in the folder of this page.',
  measurements: 'Your measurements', chooseTable: 'Choose a table', useModel: 'Use this model in the design', useOtherModel: (file) => `Use the model of ${file} instead`, removeFit: 'Remove these measurements', saveModel: 'Save model.toml',
  notKept: 'These measurements are too large for the memory of this browser. To keep them, save the session under Download.', notSession: (file) => `${file} was not saved by this page.`, session: 'Session with measurements (JSON)', removeModel: 'Back to the published constants',
  sampleTable: 'Try an example', planRuns: 'What to measure next', withinMinutes: 'in', planning: (seconds) => `Planning the next runs: ${seconds} s`,
  planned: (runs, minutes) => `${runs} runs in ${Math.round(minutes)} minutes. Probability that they answer each open question:`, nothingOpen: 'No question is open: every effect that matters is named without a rival, or ruled out.',
  question: ([effect, other]) => (other === 'none' ? TEXT.effectNames[effect] ?? effect : `${TEXT.effectNames[effect] ?? effect}, or ${TEXT.effectNames[other] ?? other}`),
  saveRuns: 'Save the runs', saveSheet: 'Save the run sheet',
  measurementsHelp: 'Drop a table of your rig (CSV, Excel, LVM) anywhere on the page. The calibration reports whether the model fits your switch, and what it lacks.',
  filesTitle: 'Download: make it', everything: 'All files as ZIP', configuration: 'Configuration (TOML)', dropHere: 'Drop a table of plateaus (CSV), a configuration (TOML) or a model.toml',

  groups: {
    switch: 'Switch', layout: 'Layout', segment: 'Segment', shell: 'Shell', fasteners: 'Fasteners', silicone: 'Silicone layer', pins: 'Pins', tendon: 'Tendon',
    support: 'Side supports', mould: 'Casting mould', mount: 'Mount', parts: 'Parts', label: 'Label', print: 'Printer', process: 'Materials and cure', mesh: 'Mesh', drawing: 'Drawing', friction: 'Friction curve',
  },
  // Names of fields whose key without its unit does not read well.
  fields: {
    'layout.pins': 'pins in', 'layout.wrap_angle_deg': 'wrap angle', 'segment.span_deg': 'span', 'silicone.hardness_shore_a': 'hardness',
    'silicone.density_g_cm3': 'density', 'print.abs_density_g_cm3': 'density of the plastic', 'silicone.least_mix_g': 'smallest mix', 'mould.shrinkage_pct': 'shrinkage',
    'process.material': 'material of the parts', 'process.cure_c': 'cure in the mould', 'process.oven_c': 'hottest oven', 'process.pins': 'steel of the pins', 'process.coating': 'coating of the tendon',
    'print.bed_mm': 'side of the bed', 'friction.six_single_threshold': 'threshold of six-single', 'parts.proxy': 'rigid proxy', 'parts.coupon': 'fit coupon', 'label.engrave': 'engrave a label',
  },
  units: { deg: '°', shore_a: 'Shore A', 'g/cm3': 'g/cm³', g_cm3: 'g/cm³', pct: '%', n: 'N', c: '°C', C: '°C' },
  groupChanged: (n) => `${n} changed`,
  reset: (name) => `Reset ${name}`,
  about: (name) => `About ${name}`,
  aboutField: (f, value) => `${f.reason}. Range: ${f.range}. Default: ${value}, ${f.origin}.`,
  slider: (name) => `${name}, slider`,
  unchanged: (name, value) => `${name} is still ${value}.`,
  quantity: {
    notNumber: (text) => `${text} is not a number. Enter a number such as 2.5 or 2,5, or a sum such as 20 + 2*1.2.`,
    ambiguous: (text, decimal, grouped) => `${text} can be ${decimal} or ${grouped}. Enter one of them.`,
    otherUnit: (word, unit) => `${word} cannot be converted to ${unit}.`, noUnit: (word) => `${word} is not part of a number without a unit.`,
    mixed: (text) => `${text} mixes numbers with and without a unit. Enter a unit after each number.`,
  },
  notNumber: 'Enter a number.', notWhole: 'Enter a whole number.', notList: 'Enter groove numbers, separated by commas: 5, 8, 11.',
  reach: (low, high) => `With the other values it can be ${low} to ${high}. Enter another value to see which others it needs.`,
  setTo: (name, value) => `Set ${name} to ${value}`,

  fix: (changes) => `Fix: ${changes.join(', ')}`,
  refused: 'This design cannot be built. The last valid design is shown in grey.', refusedShowing: (name) => `This design cannot be built. ${name} is shown in grey instead.`,
  changedFrom: (name) => `${name}, changed`,

  newtons: (v, digits = 1) => `${v.toFixed(digits)} N`,
  frictionAt: (load) => `of friction at ${load} of load`,
  range: (low, high) => `${low} to ${high}`,
  curveName: (law, load, friction, low, high) => `Friction over load by ${law}: ${friction} N at ${load} N of load, band ${low} to ${high} N`,
  trust: { published: 'layout measured in the paper', interpolated: 'between measured layouts', extrapolated: 'extrapolated' },
  trustMark: { published: '●', interpolated: '◐', extrapolated: '○' },
  calibratedTrust: (status) => `your model, ${status}`,
  trustName: (status) => `Prediction status: ${status}. Show the reasons`,
  axisLoad: 'load (N)', axisFriction: 'friction (N)',
  band: '95 % band: of 20 parts, 19 are within', predicted: (law) => `predicted (${law})`, switchHelp: 'The load at which silicone and pins carry the same friction: above it, the switch holds.', measuredPoint: 'measured in the paper', comparison: (name) => `comparison: ${name}`, more: (n) => `${n} more`, publishedConstants: 'published constants', calibratedCurve: 'with your model', previewCurve: (n) => `design ${n}`,
  law: (law, source) => `Law of the curve, ${law}: ${source}.`,
  thresholdCurrent: (n) => `now ${n}`, switchesAtLoad: (n) => `switches at ${n}`, target: (n) => `target: ${n}`,
  thresholdHandle: 'Target threshold', frictionHandle: (i) => `Target friction ${i}`,
  loadText: (load, friction) => `${load} N of load, ${friction} N of friction`,
  columns: { load: 'load (N)', eccentric: 'eccentric', concentric: 'concentric', friction: 'friction', low: 'low', high: 'high' },

  thumbName: ({ load_n, friction_n, threshold_n }) => `${formatNumber(friction_n.at(-1), 1)} N of friction at ${formatNumber(load_n.at(-1), 1)} N, ${TEXT.switchesAt(threshold_n)}`,
  groove: (i, pin) => `Groove ${i}, ${pin ? 'with a pin' : 'empty'}`,
  pinsName: 'Grooves of the segment, from left to right',
  pinsIn: (pins) => (pins.length ? `Pins in ${pins.join(', ')}` : 'No pins'),
  pinsCount: (n, grooves) => `${n} of ${grooves} grooves`,
  noPinsNote: 'The tendon touches the substrate at any load.',

  checkPassed: 'passed', checkReview: 'to review', checkWarning: 'warning', checksSummary: (passed, all) => `${passed} of ${all} passed`, showPassed: (n) => `${n} passed`,
  steelPins: 'steel pins', spare: (n, s) => `${n} + ${s} spare`, pour: 'silicone, to pour', mix: 'silicone, to mix', mixed: (b, a) => `${b} g base, ${a} g agent`,
  cure: 'cure', cured: (mould, post) => `${TEXT.hoursAt(mould)} in the mould${post ? `, then ${TEXT.hoursAt(post)} outside` : ''}`, hoursAt: ({ temperature_c, hours }) => `${formatNumber(hours, 2)} h at ${formatNumber(temperature_c)} °C`,
  tendon: 'tendon', coated: (d, o) => `${d} mm, ${o} mm coated`, screws: 'screws', nuts: 'nuts', inserts: 'heat-set inserts', dowels: 'dowels', forMount: 'for the mount',
  rightSide: (l, r) => `${l} left, ${r} right`,
  plastic: 'plastic, all printed parts', part: 'part', size: 'size (mm)', mass: 'mass (g)', volume: 'volume (mm³)',
  bedCaption: (beds, bed, fits) => (fits ? `Outlines of the printed parts, to scale, on ${beds === 1 ? 'a bed' : `${beds} beds`} of ${bed} mm.` : `The parts do not fit on one bed of ${bed} mm: print them in several jobs.`),
  bedPart: (name, x, y) => `${name}, ${x} by ${y} mm`, bedName: (n, bed) => `Outlines of ${n} printed parts on a bed of ${bed} mm`,

  searching: (s) => `Searching for designs, ${s} s. You can continue to work on the page.`, searchModel: (name) => `; with the ${TEXT.modelName(name)}`, searchOutdated: 'These designs are for an earlier design or earlier targets. Find designs again for the current ones.',
  invalidTarget: (max) => `Enter a number above 0 and up to ${max} N.`, noTargets: 'First enter a load at which it should switch, or a friction.',
  sourceShare: (source, percent) => `${source} ${percent} %`, uncertain: (sources) => `Sources of uncertainty: ${sources.join(', ')}.`, changedTo: (name, value) => `${name} ${value}`,
  ownPoints: (n) => `your readings (${n})`, probabilities: 'Probabilities of effects', percent: (p) => (p > 0.995 ? '> 99 %' : `${Math.round(100 * p)} %`), sizeColumns: ['effect', 'size', '95 % interval'],
  residualsName: (most) => `Residuals over the load, up to ${most} N: those of the published model, and those of the calibrated one.`, residualsCaption: 'Residuals over the load (N): grey rings by the published model, blue dots by the calibrated one.', pointsOf: (n, own) => `${n} measured points; ${own} of them are of the layout of the design, and on the curve.`,
  stopped: 'Stopped.', probability: (p) => `${p} % probable`, designPins: (pins) => (pins.length ? `pins [${pins.join(', ')}]` : 'no pins'),
  probabilityNote: (tolerance) => `Probability that a printed part is within ${formatNumber(100 * tolerance)} % of all targets.`,
  switchesAt: (n) => (n === null ? 'does not switch' : `switches at ${n.toFixed(1)} N`), heaviest: (n) => `${n.toFixed(2)} N at the heaviest load`,
  targetResult: ({ load_n, target_n, value_n, is_met }) => `${load_n === null ? TEXT.switchesAt(value_n) : `${value_n.toFixed(2)} N at ${formatNumber(load_n)} N of load`}; ${TEXT.target(`${formatNumber(target_n)} N`)}${is_met ? '' : ', missed'}`,
  removeFriction: (i) => `Remove friction ${i}`, designName: (i) => `Design ${i}`,
  removeThreshold: 'Remove the target threshold',

  understood: (file) => `${file} contains`, useTable: 'Calibrate with this table',
  logOf: (file) => `This is a log of the force over time. Run pinswitch import ${file} and pinswitch segment to convert it to a table.`,
  calibrating: (file, s) => `Fitting the model to ${file}, ${s} s. Thousands of rows take half a minute, tens of thousands some minutes; you can continue to work on the page.`,
  heldOutErrors: (before, plain, after, newSession) => `Held-out error: ${before} N by the published model,${plain === null ? '' : ` ${plain} N by least squares,`} ${after} N by this model${newSession === null ? '' : `; expected in a new session: ${newSession} N`}.`,
  modelApplied: 'The design uses your calibrated model. The address contains it and is long.', modelName: (file) => `model from ${file}`,
  verdictOf: (file, verdict) => `${file}: ${verdict}`,
  verdicts: {
    none: 'the published model fits this table.', inconclusive: 'no effect detected, but the table cannot rule out all effects of consequence.', attributed: 'the published model lacks an effect, which the table identifies.',
    ambiguous: 'the published model lacks an effect; several explain the table equally well.', unattributed: 'the published model lacks something that no known effect explains.',
  },
  detectedEffects: (effects) => `Detected: ${effects.map((rivals) => rivals.map(effectText).join(', or ')).join('; ')}.`,
  notExcluded: (effects) => `Not ruled out: ${effects.map((id) => TEXT.effectNames[id] ?? id).join('; ')}.`,
  effectNames: {
    coating_ploughing: 'pins plough the coating of the tendon', coating_stiffening: 'friction of the coating grows with load', polygon_bending: 'the tendon bends sharply at single pins',
    substrate_saturation: 'friction of the silicone is bounded', adhesion: 'the silicone adheres at zero load', dwell_relaxation: 'friction of the silicone depends on the dwell',
    run_in: 'friction is higher in the first repetitions', wear_drift: 'friction drifts with the travel', rate_dependence: 'friction depends on the speed', direction_asymmetry: 'friction differs between the directions',
    switching_hysteresis: 'the threshold differs when the load falls', switch_local_tension: 'the threshold follows the local tension along the wrap', fixture_compliance: 'the fixture bends under load',
    stroke_position: 'the wrap angle changes along the stroke', guide_drag: 'the guide pulleys have drag', load_cell_offset: 'the load cell has an offset', load_cell_gain: 'the load cell has a wrong scale',
    load_cell_nonlinearity: 'the load cell is not linear', load_cell_saturation: 'the load cell saturates', hook_omitted: 'the hook was not weighed', thermal_drift: 'the reading drifts with time',
  },
  tooLarge: (name, mb, limit) => `${name} is ${mb} MB. A table of plateaus has one line per plateau and at most ${limit} MB. To convert a raw log: pinswitch segment.`,
  tooLargeConfiguration: (name, mb) => `${name} is ${mb} MB, and not a pinswitch configuration. Drop a TOML file that pinswitch wrote.`,
  unknownType: (name) => `${name} has an unknown type. The page reads tables (CSV, text, LVM, Excel, OpenDocument), configurations and models (.toml), and its saved sessions (.json).`,
  notText: (name) => `${name} is not a text file. If another program wrote it, export it as CSV.`,
  empty: (name) => `${name} is empty.`, unreadable: (name) => `${name} could not be read. Does it still exist?`, manyFiles: 'The page opens one file at a time: the first one.',

  waitsFor: { experiment: 'Waiting for the plan of the next runs.', search: 'Waiting for the search for designs.', calibrate: 'Waiting for the fit to your table.' },
  generatingFiles: 'Generating the files …', filesFailed: 'No files: ', generating: (name) => `Generating ${name} …`, saved: (name) => `Saved ${name}.`, noFiles: 'This design cannot be built and has no files. Fix it first.',
  megabytes: (bytes) => (bytes < 1000 ? `${bytes} B` : bytes < 1e6 ? `${Math.round(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`),
  kinds: { print: 'Print', drawing: 'Drawing', guide: 'Guide and manual', step: 'CAD, exact', glb: 'Viewers and web pages', curve: 'Curve', data: 'Data', png: 'Pictures', other: 'Other' },

  shared: 'Address copied: it contains the whole design.', sharedLacks: (isLocal) => `It lacks your ${isLocal ? 'targets, model and measurements' : 'measurements'}: to keep them, save the session under Download.`, shareByHand: 'Copy the address of this page: it contains the whole design.',
  sharedText: 'This page runs on your computer, so its address opens nowhere else. The design is copied as text: paste it on any pinswitch page, or save it as a .toml file.', shareFileByHand: 'This page runs on your computer, so its address opens nowhere else. Share the configuration (TOML) under Download.',
  templateApplied: (name, lost, kept) => `${name} opened.${lost ? ` Undo restores your ${lost} changed ${lost === 1 ? 'value' : 'values'}.` : ''}${kept.length ? ` Kept: ${kept.join(', ')}.` : ''}`, printerApplied: (name, kept) => `${name} applied.${kept.length ? ` Your own values are kept: ${kept.join(', ')}.` : ''}`,
  opened: (file) => `${file} opened.`, notOpened: (file) => `Cannot open ${file}: `,
  restored: 'Your last design is restored.',
  published: 'Published', printers: 'Printers',

  hash: {
    older: (v) => `The address has version ${v}, which does not exist: versions start at 1.`,
    newer: (v) => `The address has version ${v}, newer than this page (1).`,
    invalid: 'The address contains no design, or is cut off.', unchanged: 'The design is unchanged.',
    unknown: (names) => `Unknown in the address: ${names.join(', ')}.`,
    wrong: (names) => `Invalid value in the address: ${names.join(', ')}.`,
    rest: 'The rest is applied.',
    duplicate: (names) => `More than once in the address: ${names.join(', ')}. The last value applies.`,
    manyFrictions: (max) => `The address has more than ${max} target frictions: the first ${max} apply.`,
    model: 'The calibrated model in the address is cut off. The published constants apply.',
  },

  invalidMessage: 'The message contains neither an address nor valid values.',
  modelTooLong: (name, length, max) => `${name} is too long for an address: ${length} characters packed, at most ${max}. Remove comments and unused entries.`,
  saveTo: (file) => `Save to ${file}`, savedTo: (file) => `Saved to ${file}.`, notSaved: (file) => `Not saved to ${file}: `, fileChanged: (file) => `${file} has changed: its values are shown. Undo to revert.`,
  fileDiffers: (file) => `The design in the address differs from ${file}.`,
  fileNewer: (file, names) => `Not saved: ${file} has changed since this page last read it (${names.join(', ')}).`,
  savedOverridden: (file, fields) => `Saved to ${file}. Options of pinswitch view override ${fields.map(([, name]) => name).join(', ')}: restart it without ${[...new Set(fields.map(([option]) => option))].join(' and ')} to use the file's values.`,
  fileMissing: (file) => `Not saved: ${file} does not exist any more.`, createFile: 'Create it',
  showFile: (file) => `Show ${file}`, overwrite: 'Overwrite it', savedWithoutModel: (file) => `Saved to ${file} without the model: keep your model.toml and generate the parts with --model.`,

  starting: 'Starting the engine …', working: 'Working …',
  engineMissing: 'This copy of the page contains no engine, and there is no server. Open it with: pinswitch view',
  engineFailed: (reason) => `The engine does not start in this browser (${reason}). Use a current Firefox, Chrome, Edge or Safari, or: pinswitch view`,
  engineStopped: 'The engine stopped on this design and was restarted. Undo the last change, or try another value.',
  engineStatus: (status) => `The engine did not answer: status ${status}.`,
  serverGone: 'The server does not answer. Is pinswitch view still running? The last design is shown; the next change tries again.',
  retry: 'Try again',
  pictureName: 'A picture of the parts, exploded.',
  noWebgl: 'This browser has no WebGL, which the 3D view needs. Pins, curve, checks and downloads work without it.',
  fault: (message) => `Error in the page: ${message}. Reload it; the design is in the address.`,
};

// The fields of a configuration by path.
let FIELDS = new Map();

// Replaces names of fields and of parameters of a request by those that the page shows.
function inWords(text) {
  const named = text.replace(/\b[a-z]+\.[a-z][a-z0-9_]*\b/g, (path) => {
    const field = FIELDS.get(path);
    return field ? `“${TEXT.groups[field.section] ?? field.section}: ${fieldName(field)}”` : path;
  });
  return named.replace(/\b[a-z]+(_[a-z]+)*_(deg|mm|a)\b/g, (name) => TEXT.varied[name] ?? name).replaceAll(', because it is not in vary', ', which the search does not change');
}

// An effect in words, with its id in the catalogue and the reports.
const effectText = (id) => (TEXT.effectNames[id] ? `${TEXT.effectNames[id]} (${id})` : id.replaceAll('_', ' '));

// Why the engine refuses a design or a file: field, value, problem, help.
const troubleText = (trouble, name) => inWords(plainTrouble(trouble, name));

// The same with the names of a configuration, for other programs.
function plainTrouble({ field, value, problem, help }, name = field) {
  const subject = [name, value === null || value === undefined || value === '' ? '' : `= ${String(value).slice(0, 60)}`].filter(Boolean).join(' ');
  return `${subject ? `${subject}: ` : ''}${problem}${help ? `; ${help}` : ''}`;
}

// The name of a field: its key without the unit, unless TEXT has one.
function fieldName(field) {
  if (TEXT.fields[field.path]) return TEXT.fields[field.path];
  return field.key.replace(/_(mm|deg|n|g|pct|g_cm3|shore_a)$/, '').replaceAll('_', ' ');
}
const unitName = (field) => TEXT.units[field.unit] ?? (field.unit || TEXT.units[/_(shore_a|g_cm3|pct|n)$/.exec(field.key)?.[1]] || '');
