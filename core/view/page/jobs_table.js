// SPDX-License-Identifier: Apache-2.0
// The table of jobs: search, filter, sort, select, and actions on one or several.
import {whyNotAll} from './access.js';
import {kActions} from './actions.js';
import {guarded, setReason, toastError} from './dialogs.js';
import {h, icon, setAttribute, setChildren, setHidden, setText} from './dom.js';
import {isOver, jobTitle, plural, shownState, speedOf} from './format.js';
import {JobRow} from './job_row.js';
import {store} from './store.js';

const kFilters = [
  ['all', 'All', () => true],
  ['active', 'Active', (job) => !isOver(job)],
  ['queued', 'Queued', (job) => shownState(job) === 'queued'],
  ['done', 'Done', (job) => job.state === 'done'],
  ['failed', 'Failed', (job) => job.state === 'failed'],
  ['cancelled', 'Cancelled', (job) => job.state === 'cancelled'],
];
const kStateOrder = ['running', 'queued', 'validating', 'paused', 'failed', 'done', 'cancelled'];

// Columns: [key, heading, the value to sort by, class].
const kColumns = [
  ['name', 'Job', (job) => jobTitle(job).toLowerCase(), 'c-name'],
  ['state', 'State', (job) => kStateOrder.indexOf(shownState(job)), 'c-state'],
  ['progress', 'Progress', (job) => -job.samples_done / (job.samples_total || 1), 'c-progress'],
  ['left', 'Time left', (job) => job.seconds_left ?? Infinity, 'c-left'],
  ['rate', 'Samples/s', (job) => -speedOf(job), 'c-rate number'],
  ['owner', 'Owner', (job) => job.owner, 'c-owner'],
  ['priority', 'Priority', (job) => -job.priority, 'c-priority number'],
  ['age', 'Submitted', (job) => -Date.parse(job.created_at), 'c-age'],
];
const kRowsAtOnce = 100;

export function matches(job, words) {
  const text = [
    job.name,
    job.id,
    job.owner,
    shownState(job),
    ...Object.entries(job.labels ?? {}).map(([k, v]) => `${k}=${v}`),
  ]
    .join('\n')
    .toLowerCase();
  return words.every((word) => text.includes(word));
}

export class JobsTable {
  constructor(query) {
    this.rows = new Map();
    this.selected = new Set();
    this.text = query.get('q') ?? '';
    this.filter = query.get('show') ?? 'all';
    this.sort = {key: null, isReversed: false};
    this.limit = kRowsAtOnce;
    this.build();
  }

  build() {
    this.search = h('input.search', {
      type: 'search',
      placeholder: 'Search name, owner, id, label',
      value: this.text,
      'aria-label': 'Search jobs',
      oninput: () => this.setQuery({text: this.search.value}),
    });
    this.chips = kFilters.map(([key, label]) =>
      h(
        'button.chip',
        {type: 'button', onclick: () => this.setQuery({filter: key})},
        label,
        ' ',
        h('span.chip-count', {}),
      ),
    );
    this.summary = h('p.visually-hidden', {role: 'status'});
    this.selectAll = h('input', {
      type: 'checkbox',
      'aria-label': 'Select all shown jobs',
      onchange: () => this.toggleAll(),
    });
    this.headings = kColumns.map(([key, label, , classes]) =>
      h(
        'th',
        {class: classes, role: 'columnheader', scope: 'col'},
        h('button.sort', {type: 'button', onclick: () => this.sortBy(key)}, label),
      ),
    );
    this.body = h('tbody', {role: 'rowgroup'});
    this.empty = h('div.empty', {});
    this.more = h('button', {type: 'button', onclick: () => this.showMore()}, 'Show older jobs');
    this.buildBulk();
    this.element = h(
      'section.panel',
      {'aria-labelledby': 'jobs-heading'},
      h(
        'div.panel-head',
        {},
        h('h2', {id: 'jobs-heading'}, 'Jobs'),
        h('div.chips', {role: 'group', 'aria-label': 'Filter by state'}, this.chips),
        this.search,
      ),
      this.bulk,
      this.summary,
      h(
        'table.table.jobs',
        {role: 'table', 'aria-labelledby': 'jobs-heading'},
        h(
          'thead',
          {role: 'rowgroup'},
          h(
            'tr',
            {role: 'row'},
            h('th.c-select', {role: 'columnheader', scope: 'col'}, this.selectAll),
            h('th.c-thumb', {role: 'columnheader', scope: 'col'}, h('span.visually-hidden', {}, 'Image')),
            this.headings,
            h('th.c-actions', {role: 'columnheader', scope: 'col'}, h('span.visually-hidden', {}, 'Actions')),
          ),
        ),
        this.body,
      ),
      this.empty,
      h('div.panel-foot', {}, this.more),
    );
  }

  buildBulk() {
    this.bulkCount = h('span.bulk-count', {});
    this.bulkButtons = kActions.map((action) => [
      action,
      h(
        'button',
        {
          type: 'button',
          class: action.isDanger ? 'danger-text' : null,
          onclick: guarded(async () => {
            await action.run(this.selection());
          }),
        },
        icon(action.icon),
        action.label,
      ),
    ]);
    this.bulk = h(
      'div.bulk',
      {role: 'toolbar', 'aria-label': 'Actions on the selected jobs'},
      this.bulkCount,
      this.bulkButtons.map(([, button]) => button),
      h(
        'button.quiet',
        {
          type: 'button',
          onclick: () => {
            this.selected.clear();
            this.update();
          },
        },
        'Clear',
      ),
    );
  }

  selection() {
    return [...this.selected].map((id) => store.jobs.get(id)).filter(Boolean);
  }

  setQuery({text = this.text, filter = this.filter}) {
    this.text = text;
    this.filter = filter;
    this.limit = kRowsAtOnce;
    const query = new URLSearchParams();
    if (text) query.set('q', text);
    if (filter !== 'all') query.set('show', filter);
    history.replaceState(null, '', `#/${query.size > 0 ? `?${query}` : ''}`);
    this.update();
  }

  sortBy(key) {
    const {key: before, isReversed} = this.sort;
    this.sort = before !== key ? {key, isReversed: false} : {key: isReversed ? null : key, isReversed: true};
    this.update();
  }

  // The jobs to show, in order: unfinished ones first, in the order in which they are served.
  found() {
    const words = this.text.toLowerCase().split(/\s+/).filter(Boolean);
    const fits = kFilters.find(([key]) => key === this.filter)?.[2] ?? (() => true);
    const jobs = [...store.jobs.values()].filter((job) => fits(job) && matches(job, words));
    const column = kColumns.find(([key]) => key === this.sort.key);
    const age = (a, b) => Date.parse(b.created_at) - Date.parse(a.created_at) || (a.id < b.id ? -1 : 1);
    if (!column) {
      return jobs.sort(
        (a, b) => isOver(a) - isOver(b) || (isOver(a) ? 0 : b.priority - a.priority) || age(a, b),
      );
    }
    const sign = this.sort.isReversed ? -1 : 1;
    const order = (a, b) => (a < b ? -sign : a > b ? sign : 0);
    return jobs.sort((a, b) => order(column[2](a), column[2](b)) || age(a, b));
  }

  update() {
    const found = this.found();
    const shown = found.slice(0, this.limit);
    for (const id of this.rows.keys()) if (!store.jobs.has(id)) this.rows.delete(id);
    for (const id of [...this.selected]) if (!store.jobs.has(id)) this.selected.delete(id);
    setChildren(
      this.body,
      shown.map((job) => this.row(job).element),
    );
    this.updateHead(found);
    this.updateBulk(shown);
    this.updateEmpty(found);
    setHidden(this.more, found.length <= this.limit && !store.hasOlderJobs);
  }

  row(job) {
    let row = this.rows.get(job.id);
    if (!row) {
      row = new JobRow(job.id, (id, isSelected, isRange) => this.select(id, isSelected, isRange));
      this.rows.set(job.id, row);
    }
    row.update(job, this.selected.has(job.id));
    return row;
  }

  updateHead(found) {
    kFilters.forEach(([key, , fits], i) => {
      const number = [...store.jobs.values()].filter(fits).length;
      setAttribute(this.chips[i], 'aria-pressed', String(key === this.filter));
      setText(this.chips[i].lastElementChild, String(number));
    });
    kColumns.forEach(([key], i) =>
      setAttribute(
        this.headings[i],
        'aria-sort',
        key !== this.sort.key ? null : this.sort.isReversed ? 'descending' : 'ascending',
      ),
    );
    setText(this.summary, this.text ? `${plural(found.length, 'job')} found` : '');
  }

  updateBulk(shown) {
    const chosen = this.selection();
    this.bulk.classList.toggle('is-active', chosen.length > 0);
    this.bulk.inert = chosen.length === 0;
    setText(
      this.bulkCount,
      chosen.length > 0 ? `${chosen.length} selected` : 'Select jobs to act on several',
    );
    for (const [action, button] of this.bulkButtons) setReason(button, whyNotAll(action.name, chosen));
    const selectedShown = shown.filter((job) => this.selected.has(job.id)).length;
    this.selectAll.checked = shown.length > 0 && selectedShown === shown.length;
    this.selectAll.indeterminate = selectedShown > 0 && selectedShown < shown.length;
  }

  updateEmpty(found) {
    setHidden(this.empty, found.length > 0);
    if (found.length > 0) return;
    if (!store.isLoaded) setText(this.empty, 'Loading…');
    else if (store.jobs.size > 0) setText(this.empty, 'No job matches.');
    else if (this.empty.childElementCount === 0) {
      this.empty.replaceChildren(
        h('p', {}, 'There are no jobs yet.'),
        h(
          'p',
          {},
          h('a.button.primary', {href: '#/submit'}, 'Submit a scene'),
          ' or ',
          h('code', {}, 'tessera submit scene.json'),
        ),
      );
    }
  }

  updateTimes() {
    for (const [id, row] of this.rows) if (store.jobs.has(id)) row.updateTimes(store.jobs.get(id));
  }

  select(id, isSelected, isRange) {
    const ids = [...this.body.children].map((element) => element.dataset.id);
    const from = isRange && this.lastSelected ? ids.indexOf(this.lastSelected) : -1;
    const to = ids.indexOf(id);
    const range = from < 0 ? [id] : ids.slice(Math.min(from, to), Math.max(from, to) + 1);
    for (const each of range) isSelected ? this.selected.add(each) : this.selected.delete(each);
    this.lastSelected = id;
    this.update();
  }

  toggleAll() {
    const shown = this.found().slice(0, this.limit);
    const all = shown.every((job) => this.selected.has(job.id));
    for (const job of shown) all ? this.selected.delete(job.id) : this.selected.add(job.id);
    this.update();
  }

  // More of what is known; then what else the coordinator has.
  async showMore() {
    this.limit += kRowsAtOnce;
    try {
      while (store.hasOlderJobs && this.found().length < this.limit) await store.fetchOlderJobs();
    } catch (error) {
      toastError(error);
    }
    this.update();
  }

  keys() {
    const rows = () => [...this.body.querySelectorAll('a.job-name')];
    const move = (step) => {
      const all = rows();
      const at = all.findIndex((a) => a.closest('tr').contains(document.activeElement));
      all[Math.max(0, Math.min(all.length - 1, at < 0 ? 0 : at + step))]?.focus();
    };
    return [
      {key: '/', help: 'Search jobs', run: () => this.search.focus()},
      {key: 'j', help: 'Next job', run: () => move(1)},
      {key: 'k', help: 'Previous job', run: () => move(-1)},
      {
        key: 'x',
        help: 'Select the focused job',
        run: () => document.activeElement.closest('tr')?.querySelector('input[type=checkbox]')?.click(),
      },
    ];
  }
}
