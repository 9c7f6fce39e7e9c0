// Checks and warnings: what needs a look first, what is fine on demand.

function showChecks(data) {
  const fine = data.checks.filter((c) => c.fine);
  const look = data.checks.filter((c) => !c.fine);
  const line = (mark, name, words, remedy) => {
    const li = make('li', undefined, { class: name });
    li.append(make('span', mark, { class: 'mark', 'aria-hidden': 'true' }));
    const text = make('span');
    text.append(make('span', `${name === 'fine' ? WORDS.checkFine : name === 'look' ? WORDS.checkLook : WORDS.checkWarning}: `, { class: 'unseen' }), words);
    if (remedy) text.append(make('span', remedy, { class: 'remedy' }));
    li.append(text);
    return li;
  };
  const problems = [...look.map((c) => line('!', 'look', c.words, c.remedy)), ...data.manifest.warnings.map((w) => line('!', 'warning', w))];
  byId('checks-sum').textContent = WORDS.checksSum(fine.length, data.checks.length);
  byId('checks').replaceChildren(...problems, ...(problems.length > 2 ? [] : fine.map((c) => line('✓', 'fine', c.words))));
  byId('fine-checks').hidden = problems.length <= 2;
  byId('fine-head').textContent = WORDS.showFine(fine.length);
  byId('fine-list').replaceChildren(...(problems.length > 2 ? fine.map((c) => line('✓', 'fine', c.words)) : []));
}

// Trouble with the layout stands at the drawing of its pins, too, which may be far below the picture.
function showAtPins(trouble, mend) {
  const line = byId('pins-error');
  line.hidden = !trouble;
  line.replaceChildren(...(trouble ? [`${troubleWords(trouble, WORDS.groups.layout)}. `, mend() ?? ''] : []));
}

// Trouble with a design: over the picture, and at the control of its field, with a button that mends it. `instead` is what is
// shown where no design of this visit could be.
function showTrouble(trouble, controls, state, instead) {
  const host = byId('trouble');
  host.hidden = !trouble;
  document.body.classList.toggle('stale', Boolean(trouble));
  const mend = () => {
    const fits = (trouble?.changes ?? []).filter((c) => state.fields.has(c.path));
    if (!fits.length) return undefined;
    const words = fits.map((c) => WORDS.setTo(fieldName(state.fields.get(c.path)), shownValue(c.value)));
    return button(WORDS.mends(words), () => {
      state.change({ values: { ...state.now.values, ...Object.fromEntries(fits.map((c) => [c.path, c.value])) } });
    }, { class: 'btn mend', 'data-heir': controls.idOf(fits[0].path) });
  };
  controls.trouble(trouble, mend());
  showAtPins(trouble?.field.startsWith('layout.') ? trouble : null, mend);
  host.replaceChildren();
  if (!trouble) return;
  const field = state.fields.get(trouble.field);
  const name = field ? `${WORDS.groups[field.section] ?? field.section}, ${fieldName(field)}` : trouble.field;
  const text = make('p');
  text.append(make('b', `${instead ? WORDS.refusedAtFirst(instead) : WORDS.refused} `), `${troubleWords(trouble, name)}.`);
  host.append(text);
  const mending = mend();
  if (mending) host.append(mending);
  if (!field && state.now.model) host.append(button(WORDS.dropModel, () => state.change({ model: null }), { class: 'btn mend' }));
  if (state.past.length) host.append(button(WORDS.undo, () => state.undo(), { class: 'btn', 'data-heir': 'undo redo' }));
}
