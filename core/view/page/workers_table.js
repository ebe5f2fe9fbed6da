// SPDX-License-Identifier: Apache-2.0
// The table of workers, and what administrators do with them: drain, and release from quarantine.
import {whyNotAdmin} from './access.js';
import {get, post, remove} from './api.js';
import {confirm, guarded, setReason, toast, toastError} from './dialogs.js';
import {h, setAttribute, setChildren, setHidden, setText} from './dom.js';
import {ago, bytes, count, plural, rate} from './format.js';
import {stateBadge} from './job_row.js';
import {store} from './store.js';

const kTroubled = ['quarantined', 'stuck', 'in cooldown'];

async function drain(worker, undo) {
  await post(`workers/${encodeURIComponent(worker.id)}/drain`, undo ? {undo: true} : {});
  if (undo) return toast(`${worker.name} takes leases again`);
  return toast(`${worker.name} finishes its leases and takes no more`, {
    action: {label: 'Undo', run: () => drain(worker, true).catch(toastError)},
  });
}

async function entriesOf(worker) {
  const own = [];
  for (let token = ''; token !== undefined; ) {
    const page = await get(`quarantine?page_token=${encodeURIComponent(token)}`);
    own.push(
      ...page.entries.filter((entry) => entry.worker_id === worker.id || entry.worker_name === worker.name),
    );
    token = page.next_page_token || undefined;
  }
  return own;
}

async function release(worker) {
  const sure = await confirm(
    `Release ${worker.name} from quarantine?`,
    h(
      'p',
      {},
      `It was quarantined because of ${worker.quarantine_reason || 'wrong results'}. ` +
        'Release it only after the cause is mended.',
    ),
    {label: 'Release'},
  );
  if (!sure) return;
  const own = await entriesOf(worker);
  for (const entry of own) await remove(`quarantine/${encodeURIComponent(entry.id)}`);
  toast(own.length > 0 ? `Released ${worker.name}` : `${worker.name} is not in the list of the quarantine`);
}

function cell(label, classes, ...content) {
  return h('td', {class: classes, role: 'cell', 'data-label': label}, content);
}

class WorkerRow {
  constructor(id) {
    this.id = id;
    this.name = h('span.worker-name', {});
    this.note = h('span.note', {});
    this.state = stateBadge();
    this.texts = {
      threads: h('span', {}),
      speed: h('span', {}),
      leases: h('span', {}),
      accepted: h('span', {}),
      checks: h('span', {}),
      cache: h('span', {}),
      seen: h('span', {}),
    };
    this.button = h('button', {type: 'button', onclick: guarded(() => this.run().catch(toastError))});
    this.element = h(
      'tr',
      {role: 'row'},
      cell('Worker', 'c-name', this.name, this.note),
      cell('State', 'c-state', this.state.element),
      cell('Threads', 'number', this.texts.threads),
      cell('Samples/s', 'number', this.texts.speed),
      cell('Leases', 'number', this.texts.leases),
      cell('Accepted', 'number', this.texts.accepted),
      cell('Audits', '', this.texts.checks),
      cell('Cache', 'number', this.texts.cache),
      cell('Last seen', '', this.texts.seen),
      cell('Actions', 'c-actions', this.button),
    );
  }

  run() {
    const worker = store.workers.get(this.id);
    if (worker.state === 'quarantined') return release(worker);
    return drain(worker, isDraining(worker));
  }

  update(worker) {
    setText(this.name, worker.name);
    setAttribute(this.name, 'title', worker.id);
    setText(this.note, worker.remarks[0] ?? [worker.principal, worker.version].filter(Boolean).join(' · '));
    setAttribute(this.note, 'title', worker.remarks.join('\n') || null);
    this.note.classList.toggle('note-failed', kTroubled.includes(worker.state));
    this.state.update(worker.state, worker.quarantine_reason);
    setText(this.texts.threads, String(worker.threads));
    setText(this.texts.speed, rate(worker.samples_per_second));
    setText(this.texts.leases, String(worker.held_leases));
    setText(this.texts.accepted, count(worker.samples_accepted));
    setText(this.texts.checks, checksOf(worker));
    setText(this.texts.cache, worker.cache ? bytes(worker.cache.used_bytes) : '–');
    setAttribute(this.texts.cache, 'title', worker.cache && `of at most ${bytes(worker.cache.limit_bytes)}`);
    setText(this.texts.seen, ago(worker.last_seen_at));
    setText(
      this.button,
      worker.state === 'quarantined' ? 'Release…' : isDraining(worker) ? 'Undo drain' : 'Drain',
    );
    setAttribute(this.button, 'aria-label', `${this.button.textContent} ${worker.name}`);
    setReason(
      this.button,
      whyNotAdmin() ?? (worker.state === 'silent' ? 'The worker is not connected.' : null),
    );
  }
}

function isDraining(worker) {
  return worker.state === 'draining' || worker.state === 'drained';
}

function checksOf(worker) {
  const parts = [`${worker.audited_ranges} audited`];
  if (worker.disproved_ranges > 0) parts.push(`${worker.disproved_ranges} disproved`);
  if (worker.rejected_results > 0) parts.push(`${worker.rejected_results} rejected`);
  return parts.join(', ');
}

export class WorkersTable {
  constructor() {
    this.rows = new Map();
    this.body = h('tbody', {role: 'rowgroup'});
    this.empty = h('div.empty', {});
    this.count = h('span.count', {});
    const heading = (label, classes = null) =>
      h('th', {class: classes, role: 'columnheader', scope: 'col'}, label);
    const table = h(
      'table.table.workers',
      {role: 'table', 'aria-labelledby': 'workers-heading'},
      h(
        'thead',
        {role: 'rowgroup'},
        h(
          'tr',
          {role: 'row'},
          heading('Worker', 'c-name'),
          heading('State', 'c-state'),
          heading('Threads', 'number'),
          heading('Samples/s', 'number'),
          heading('Leases', 'number'),
          heading('Accepted', 'number'),
          heading('Audits'),
          heading('Cache', 'number'),
          heading('Last seen'),
          h('th.c-actions', {role: 'columnheader', scope: 'col'}, h('span.visually-hidden', {}, 'Actions')),
        ),
      ),
      this.body,
    );
    this.element = h(
      'section.panel',
      {'aria-labelledby': 'workers-heading'},
      h('div.panel-head', {}, h('h2', {id: 'workers-heading'}, 'Workers'), this.count),
      table,
      this.empty,
    );
  }

  update() {
    const workers = [...store.workers.values()].sort((a, b) =>
      a.name < b.name ? -1 : a.name > b.name ? 1 : a.id < b.id ? -1 : 1,
    );
    for (const id of this.rows.keys()) if (!store.workers.has(id)) this.rows.delete(id);
    setChildren(
      this.body,
      workers.map((worker) => this.row(worker).element),
    );
    setText(this.count, workers.length > 0 ? plural(workers.length, 'worker') : '');
    setHidden(this.empty, workers.length > 0);
    if (workers.length > 0) return;
    setText(
      this.empty,
      store.isLoaded
        ? 'No worker is connected. Start one with: tessera-worker --coordinator HOST:PORT'
        : 'Loading…',
    );
  }

  row(worker) {
    let row = this.rows.get(worker.id);
    if (!row) this.rows.set(worker.id, (row = new WorkerRow(worker.id)));
    row.update(worker);
    return row;
  }
}
