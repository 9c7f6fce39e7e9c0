// Checks and warnings; if several need a review, those that passed are folded.

function showChecks(data) {
  const passed = data.checks.filter((c) => c.fine);
  const review = data.checks.filter((c) => !c.fine);
  const prefix = { passed: TEXT.checkPassed, review: TEXT.checkReview, warning: TEXT.checkWarning };
  const line = (mark, name, text, remedy) => {
    const li = make('li', undefined, { class: name });
    li.append(make('span', mark, { class: 'mark', 'aria-hidden': 'true' }));
    const content = make('span');
    content.append(make('span', `${prefix[name]}: `, { class: 'visually-hidden' }), text);
    if (remedy) content.append(make('span', remedy, { class: 'remedy' }));
    li.append(content);
    return li;
  };
  const problems = [...review.map((c) => line('!', 'review', inWords(c.words), inWords(c.remedy))), ...data.manifest.warnings.map((w) => line('!', 'warning', inWords(w)))];
  byId('checks-summary').textContent = TEXT.checksSummary(passed.length, data.checks.length);
  byId('checks').replaceChildren(...problems, ...(problems.length > 2 ? [] : passed.map((c) => line('✓', 'passed', c.words))));
  byId('passed-checks').hidden = problems.length <= 2;
  byId('passed-head').textContent = TEXT.showPassed(passed.length);
  byId('passed-list').replaceChildren(...(problems.length > 2 ? passed.map((c) => line('✓', 'passed', c.words)) : []));
}

// Most remedies that are offered.
const MOST_REMEDIES = 3;

// The sets of changes that solve a problem: first those that keep the values of the last step, which are what is wanted.
function remediesOf(trouble, state) {
  const before = state.past.at(-1)?.values ?? {};
  const isWanted = (path) => !sameValue(before[path], state.now.values[path]);
  const all = [trouble.changes, ...(trouble.alternatives ?? [])].map((changes) => changes.filter((c) => state.fields.has(c.path)));
  const remedies = all.filter((changes) => changes.length);
  const keeps = (changes) => !changes.some((c) => isWanted(c.path));
  return [...remedies.filter(keeps), ...remedies.filter((changes) => !keeps(changes))].slice(0, MOST_REMEDIES);
}

// Shows a refused layout at the drawing of the pins, too, which may be far below the picture.
function showAtPins(trouble, fixes) {
  const line = byId('pins-error');
  line.hidden = !trouble;
  line.replaceChildren(...(trouble ? [`${troubleText(trouble, TEXT.groups.layout)}. `, ...fixes()] : []));
}

// Shows why a design is refused, over the picture and at the control of its field, with buttons
// that fix it. `instead` is the name of the design that is shown if none of this visit could be
// built.
function showTrouble(trouble, controls, state, instead) {
  const host = byId('trouble');
  host.hidden = !trouble;
  document.body.classList.toggle('stale', Boolean(trouble));
  const fixes = () => (trouble ? remediesOf(trouble, state) : []).map((changes) => {
    const texts = changes.map((c) => TEXT.setTo(fieldName(state.fields.get(c.path)), formatValue(c.value)));
    return button(TEXT.fix(texts), () => {
      state.change({ values: { ...state.now.values, ...Object.fromEntries(changes.map((c) => [c.path, c.value])) } });
    }, { class: 'btn fix', 'data-focus-next': controls.idOf(changes[0].path) });
  });
  controls.showTrouble(trouble, fixes());
  showAtPins(trouble?.field.startsWith('layout.') ? trouble : null, fixes);
  host.replaceChildren();
  if (!trouble) return;
  const field = state.fields.get(trouble.field);
  const name = field ? `${TEXT.groups[field.section] ?? field.section}, ${fieldName(field)}` : trouble.field;
  const text = make('p');
  text.append(make('b', `${instead ? TEXT.refusedShowing(instead) : TEXT.refused} `), `${troubleText(trouble, name)}.`);
  host.append(text, ...fixes());
  if (!field && state.now.model) host.append(button(TEXT.removeModel, () => state.change({ model: null }), { class: 'btn fix' }));
  if (state.past.length) host.append(button(TEXT.undo, () => state.undo(), { class: 'btn', 'data-focus-next': 'undo redo' }));
}
