// SPDX-License-Identifier: Apache-2.0
// The farm: what it does now, its jobs and its workers.
import {h, setHidden, setText} from './dom.js';
import {count, plural} from './format.js';
import {JobsTable} from './jobs_table.js';
import {sparkline} from './plots.js';
import {onStore, store} from './store.js';
import {WorkersTable} from './workers_table.js';

const kPlotHours = 3;

const kFigures = [
  {
    label: 'Samples/s',
    value: (t) => t.rate,
    text: (t) => count(Math.round(t.rate)),
    note: () => 'of all jobs',
  },
  {
    label: 'Busy workers',
    value: (t) => t.working,
    text: (t) => String(t.working),
    note: (t) => `of ${t.workers}, ${plural(t.threads, 'thread')}`,
  },
  {
    label: 'Current jobs',
    value: (t) => t.running + t.queued,
    text: (t) => String(t.running + t.queued),
    note: (t) => (t.queued > 0 ? `${t.queued} of them queued` : 'none queued'),
  },
];

function figure({label, value, text, note}) {
  const number = h('span.figure-number', {}, '–');
  const remark = h('span.figure-note', {}, '\u00a0');
  const plot = sparkline(label, kPlotHours);
  const element = h('div.figure', {}, h('h2.figure-label', {}, label), number, remark, plot.element);
  const update = () => {
    const totals = store.totals();
    setText(number, store.isLoaded ? text(totals) : '–');
    setText(remark, store.isLoaded ? note(totals) : '\u00a0');
    plot.update(store.history.map(value), text(totals));
  };
  return {element, update};
}

export function farmView(root, query) {
  const figures = kFigures.map(figure);
  const jobs = new JobsTable(query);
  const workers = new WorkersTable();
  root.append(
    h(
      'div.farm',
      {},
      h('h1.visually-hidden', {tabindex: -1}, 'Farm'),
      h(
        'section.figures',
        {'aria-label': 'Activity'},
        figures.map((f) => f.element),
      ),
      jobs.element,
      workers.element,
    ),
  );
  const update = () => {
    figures.forEach((f) => f.update());
    jobs.update();
    workers.update();
    // Below the jobs: what comes and goes above would move it.
    setHidden(workers.element, !store.isLoaded);
  };
  update();
  const clock = setInterval(() => {
    jobs.updateTimes();
    workers.update();
  }, 5000);
  const leave = [onStore('change', update), onStore('history', () => figures.forEach((f) => f.update()))];
  return {
    title: 'Farm',
    keys: jobs.keys(),
    close() {
      leave.forEach((f) => f());
      clearInterval(clock);
    },
  };
}
