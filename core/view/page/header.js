// SPDX-License-Identifier: Apache-2.0
// The header: where one is, whether what is shown is live, who one is, dark or light.
import {h, icon, setAttribute, setHidden, setText} from './dom.js';
import {showShortcuts} from './shortcuts.js';
import {onStore, store} from './store.js';

const kConnections = {
  connecting: ['Connecting…', 'wait'],
  live: ['Live', 'live'],
  reconnecting: ['Reconnecting…', 'wait'],
  paused: ['Paused', 'wait'],
};

function toggleTheme() {
  const root = document.documentElement;
  const isDark = root.dataset.theme
    ? root.dataset.theme === 'dark'
    : matchMedia('(prefers-color-scheme: dark)').matches;
  root.dataset.theme = isDark ? 'light' : 'dark';
  try {
    localStorage.setItem('tessera-theme', root.dataset.theme);
  } catch {
    // Storage is blocked: the choice lasts until the page is closed.
  }
}

export function header(element, {logOut}) {
  const farm = h('a.nav-link', {href: '#/'}, 'Farm');
  const submit = h('a.nav-link', {href: '#/submit'}, 'Submit');
  const nav = h('nav.nav', {'aria-label': 'Views'}, farm, submit);
  const connection = h('span.connection-text', {});
  const light = h(
    'span.connection',
    {role: 'status'},
    h('span.connection-dot', {'aria-hidden': 'true'}),
    connection,
  );
  const who = h('span.who', {});
  const out = h(
    'button.quiet.log-out',
    {type: 'button', onclick: logOut, 'aria-label': 'Log out'},
    icon('leave'),
    h('span', {}, 'Log out'),
  );
  element.append(
    h(
      'a.brand',
      {href: '#/', 'aria-label': 'Tessera, start page'},
      h('img', {src: 'assets/icon.svg', alt: '', width: 24, height: 24}),
      h('span', {}, 'Tessera'),
    ),
    nav,
    // Changes its width by itself: only the spacer gives way.
    light,
    h('span.spacer', {}),
    who,
    out,
    h(
      'button.icon-button',
      {
        type: 'button',
        id: 'theme',
        onclick: toggleTheme,
        'aria-label': 'Dark or light',
        title: 'Dark or light (t)',
      },
      icon('theme'),
    ),
    h(
      'button.icon-button.keys-button',
      {
        type: 'button',
        onclick: showShortcuts,
        'aria-label': 'Keyboard shortcuts',
        title: 'Keyboard shortcuts (?)',
      },
      '?',
    ),
  );
  const isIn = () => store.session.open || Boolean(store.session.principal);
  const updateConnection = () => {
    const [text, kind] = kConnections[store.connection];
    setText(connection, text);
    setAttribute(light, 'data-kind', kind);
    // Before the first answer it is not known whether there are links beside it.
    setHidden(light, !isIn() || (!store.live && store.connection === 'connecting'));
  };
  const update = () => {
    const {open, principal, role} = store.session;
    setHidden(nav, store.isLocal || !isIn());
    nav.classList.toggle('is-unknown', !store.live);
    setHidden(out, open || !principal);
    setText(who, principal ? `${principal} (${role || 'no role'})` : '');
    setHidden(who, !principal);
    setAttribute(submit, 'aria-current', location.hash.startsWith('#/submit') ? 'page' : null);
    setAttribute(farm, 'aria-current', /^#?(\/(\?.*)?)?$/.test(location.hash) ? 'page' : null);
    updateConnection();
  };
  onStore('connection', updateConnection);
  update();
  return {update};
}
