// SPDX-License-Identifier: Apache-2.0
// Keyboard shortcuts: those of the page and those of the view that is open. `?` lists them. They can be
// turned off for those whom single keys disturb.
import {inform} from './dialogs.js';
import {h} from './dom.js';

const kOff = 'tessera-keys-off';
let viewKeys = [];
let isOff = false;
try {
  isOff = localStorage.getItem(kOff) === '1';
} catch {
  // Storage is blocked: shortcuts stay on.
}

const kPageKeys = [
  {
    key: 'g',
    help: 'Farm',
    run: () => {
      location.hash = '#/';
    },
    isFarmOnly: true,
  },
  {
    key: 'n',
    help: 'Submit a scene',
    run: () => {
      location.hash = '#/submit';
    },
    isFarmOnly: true,
  },
  {key: 't', help: 'Dark or light', run: () => document.getElementById('theme').click()},
  {key: '?', help: 'This list', run: showShortcuts},
];
let hasFarm = true;

export function setViewKeys(keys, isFarm) {
  viewKeys = keys;
  hasFarm = isFarm;
}

const pageKeys = () => kPageKeys.filter((entry) => hasFarm || !entry.isFarmOnly);

export function listenToKeys() {
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (event.target.closest('input:not([type=checkbox], [type=range]), select, textarea, dialog, .menu'))
      return;
    const entry = [...viewKeys, ...pageKeys()].find(({key}) => [key].flat().includes(event.key));
    // When they are off, `?` still tells how to turn them on again.
    if (!entry || (isOff && event.key !== '?')) return;
    // Keys that controls use stay theirs.
    if (event.target.closest('button, a, input, [role=slider]') && [' ', 'Enter'].includes(event.key)) return;
    if (event.key.startsWith('Arrow') && !event.target.matches('body, main, h1, .viewer')) return;
    event.preventDefault();
    entry.run(event);
  });
}

const kNames = {' ': 'Space', ArrowLeft: '←', ArrowRight: '→', ArrowUp: '↑', ArrowDown: '↓'};

function row({key, shown, help}) {
  const keys = shown ?? [key].flat();
  return h(
    'tr',
    {},
    h(
      'th',
      {scope: 'row'},
      keys.map((k) => [h('kbd', {}, kNames[k] ?? k), ' ']),
    ),
    h('td', {}, help),
  );
}

export function showShortcuts() {
  const listed = viewKeys.filter(({help}) => help);
  const table = (caption, keys) =>
    keys.length > 0 && h('table.keys', {}, h('caption', {}, caption), h('tbody', {}, keys.map(row)));
  const toggle = h('input', {
    type: 'checkbox',
    checked: !isOff,
    onchange: (event) => {
      isOff = !event.target.checked;
      try {
        localStorage.setItem(kOff, isOff ? '1' : '0');
      } catch {
        // Storage is blocked: the choice lasts until the page is closed.
      }
    },
  });
  inform('Keyboard shortcuts', [
    h('div.keys-columns', {}, table('This view', listed), table('Everywhere', pageKeys())),
    h('label.check', {}, toggle, 'Single keys act as shortcuts'),
  ]);
}
