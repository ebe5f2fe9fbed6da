// SPDX-License-Identifier: Apache-2.0
// Starts the page: session, header, and the view that the address names: #/ (farm), #/jobs/ID?image=N,
// #/submit.
import {get, remove, setUnauthenticatedHandler} from './api.js';
import {farmView} from './farm.js';
import {header} from './header.js';
import {h} from './dom.js';
import {jobView} from './job.js';
import {loginView} from './login.js';
import {listenToKeys, setViewKeys} from './shortcuts.js';
import {store} from './store.js';
import {submitView} from './submit.js';

const root = document.getElementById('main');
let view = null;
let shownHash = null;

function route() {
  const [path, query = ''] = location.hash.replace(/^#/, '').split('?');
  const [, name, id] = path.split('/');
  const parameters = new URLSearchParams(query);
  if (store.isLocal) return () => jobView(root, 'local', parameters);
  if (name === 'jobs' && id) return () => jobView(root, decodeURIComponent(id), parameters);
  if (name === 'submit') return () => submitView(root);
  return () => farmView(root, parameters);
}

function show(build, isMoved) {
  view?.close();
  root.replaceChildren();
  view = build();
  document.title = view.title ? `${view.title} – Tessera` : 'Tessera';
  setViewKeys(view.keys, !store.isLocal);
  head.update();
  scrollTo(0, 0);
  if (!isMoved) return;
  (view.focus ?? (() => root.querySelector('h1')?.focus({preventScroll: true})))();
}

function showRoute(isMoved = true) {
  shownHash = location.hash;
  show(route(), isMoved);
}

function showLogin() {
  store.disconnect();
  store.session = {open: false, principal: null, role: ''};
  show(() => loginView(root, start), true);
}

async function logOut() {
  await remove('session').catch(() => {});
  showLogin();
}

// A coordinator that is still starting is waited for.
async function getPatiently(path) {
  for (let wait = 250; ; wait = Math.min(2 * wait, 4000)) {
    try {
      return await get(path);
    } catch (error) {
      if (error.status > 0 && error.status < 500) throw error;
      store.setConnection('reconnecting');
      await new Promise((resolve) => {
        setTimeout(resolve, wait);
      });
    }
  }
}

async function start() {
  store.session = await getPatiently('session');
  if (!store.session.open && !store.session.principal) return showLogin();
  store.server = await getPatiently('server');
  store.connect();
  return showRoute(false);
}

const head = header(document.getElementById('header'), {logOut});
setUnauthenticatedHandler(() => {
  if (store.live) showLogin();
});
addEventListener('hashchange', () => {
  if (location.hash !== shownHash && store.live) showRoute();
});
// The address names the view, so this link must not change it.
document.querySelector('.skip').addEventListener('click', (event) => {
  event.preventDefault();
  root.focus();
});
listenToKeys();
start().catch((error) => {
  root.replaceChildren(h('p.notice.error', {role: 'alert'}, `The page cannot start: ${error.message}`));
});
