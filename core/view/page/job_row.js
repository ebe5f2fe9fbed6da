// SPDX-License-Identifier: Apache-2.0
// One row of the table of jobs. Only what changes is touched.
import {whyNot} from './access.js';
import {jobMenu, kActions} from './actions.js';
import {jobPath, url} from './api.js';
import {guarded, menuButton, setReason} from './dialogs.js';
import {h, icon, setAttribute, setText, svg} from './dom.js';
import {ago, jobTitle, localTime, percent, rate, shortId, shownState, speedOf, timeLeft} from './format.js';
import {store} from './store.js';

const kThumbnailPx = 112;
const kThumbnailMs = 4000;

export function stateBadge() {
  const text = h('span', {});
  const element = h('span.state', {}, h('span.state-dot', {'aria-hidden': 'true'}), text);
  const update = (state, title = null) => {
    setAttribute(element, 'data-state', state);
    setAttribute(element, 'title', title);
    setText(text, state);
  };
  return {element, update};
}

export function progressBar(label) {
  const bar = svg('rect', {class: 'bar-done', x: 0, y: 0, width: 0, height: 4});
  const verify = svg('rect', {class: 'bar-verify', x: 0, y: 0, width: 0, height: 4});
  const text = h('span.progress-text', {});
  const element = h(
    'div.progress',
    {role: 'progressbar', 'aria-label': label, 'aria-valuemin': 0, 'aria-valuemax': 100},
    svg(
      'svg',
      {class: 'bar', viewBox: '0 0 100 4', preserveAspectRatio: 'none', 'aria-hidden': 'true'},
      bar,
      verify,
    ),
    text,
  );
  const update = (job) => {
    const done = job.samples_total > 0 ? Math.min(1, job.samples_done / job.samples_total) : 0;
    const unverified = job.samples_total > 0 ? Math.min(done, job.samples_to_verify / job.samples_total) : 0;
    setAttribute(bar, 'width', (100 * done).toFixed(2));
    setAttribute(verify, 'x', (100 * (done - unverified)).toFixed(2));
    setAttribute(verify, 'width', (100 * unverified).toFixed(2));
    setAttribute(element, 'aria-valuenow', Math.floor(100 * done));
    setAttribute(element, 'data-state', shownState(job));
    setText(text, percent(job.samples_done, job.samples_total));
  };
  return {element, update};
}

// A thumbnail that is fetched again when the image has changed, and not more often than every few seconds.
export class Thumbnail {
  constructor(id, size = kThumbnailPx) {
    this.id = id;
    this.size = size;
    this.image = h('img', {alt: '', loading: 'lazy', decoding: 'async'});
    this.image.addEventListener('load', () => this.image.classList.add('is-loaded'));
    this.image.addEventListener('error', () => this.image.classList.remove('is-loaded'));
    this.element = h('span.thumb', {}, this.image);
    this.shownAt = -Infinity;
  }

  update(job) {
    const key = `${job.revision}`;
    const wait = this.shownAt + kThumbnailMs - performance.now();
    if (key === this.key || job.samples_done === 0) return;
    if (wait > 0 && this.key !== undefined) {
      clearTimeout(this.timer);
      this.timer = setTimeout(() => this.update(store.jobs.get(this.id) ?? job), wait);
      return;
    }
    this.key = key;
    this.shownAt = performance.now();
    this.image.src = url(jobPath(this.id, '/thumbnail'), {size: this.size, revision: key});
  }
}

function cell(label, classes, ...content) {
  return h('td', {class: classes, role: 'cell', 'data-label': label}, content);
}

export class JobRow {
  constructor(id, onSelect) {
    this.id = id;
    this.name = h('a.job-name', {href: `#/jobs/${encodeURIComponent(id)}`});
    this.note = h('span.note', {});
    this.box = h('input', {
      type: 'checkbox',
      onclick: (event) => onSelect(id, this.box.checked, event.shiftKey),
    });
    this.thumbnail = new Thumbnail(id);
    this.state = stateBadge();
    this.progress = progressBar('Progress');
    this.left = h('span', {});
    this.rate = h('span', {});
    this.owner = h('span', {});
    this.priority = h('span', {});
    this.age = h('time', {});
    this.quick = h('button.icon-button', {type: 'button', onclick: guarded(() => this.runQuick())});
    this.menu = menuButton('Actions', icon('more'), () => jobMenu(store.jobs.get(id)), {
      class: 'icon-button',
    });
    this.element = h(
      'tr',
      {role: 'row', 'data-id': id},
      cell('Select', 'c-select', this.box),
      cell('Image', 'c-thumb', this.thumbnail.element),
      cell('Job', 'c-name', this.name, this.note),
      cell('State', 'c-state', this.state.element),
      cell('Progress', 'c-progress', this.progress.element),
      cell('Time left', 'c-left', this.left),
      cell('Samples/s', 'c-rate number', this.rate),
      cell('Owner', 'c-owner', this.owner),
      cell('Priority', 'c-priority number', this.priority),
      cell('Submitted', 'c-age', this.age),
      cell('Actions', 'c-actions', this.quick, this.menu),
    );
  }

  runQuick() {
    kActions.find((action) => action.name === this.quickAction).run([store.jobs.get(this.id)]);
  }

  update(job, isSelected) {
    if (this.box.checked !== isSelected) this.box.checked = isSelected;
    this.element.classList.toggle('is-selected', isSelected);
    if (this.job !== job) this.updateJob(job);
    const reason = whyNot(this.quickAction, job);
    setReason(this.quick, reason, this.quickAction === 'resume' ? 'Resume' : 'Pause');
  }

  updateJob(job) {
    this.job = job;
    const title = jobTitle(job);
    setText(this.name, title);
    setAttribute(this.name, 'title', title);
    setText(this.note, noteOf(job));
    setAttribute(this.note, 'title', job.failure?.message ?? job.waiting_reason);
    this.note.classList.toggle('note-failed', job.state === 'failed');
    setAttribute(this.box, 'aria-label', `Select ${title}`);
    this.thumbnail.update(job);
    this.state.update(shownState(job), job.waiting_reason);
    setAttribute(this.progress.element, 'aria-label', `Progress of ${title}`);
    this.progress.update(job);
    setText(this.left, timeLeft(job));
    setText(this.rate, rate(speedOf(job)));
    setText(this.owner, job.owner || '–');
    setAttribute(this.owner, 'title', job.owner || null);
    setText(this.priority, String(job.priority));
    this.updateTimes(job);
    this.updateQuick(job);
    setAttribute(this.menu, 'aria-label', `Actions for ${title}`);
  }

  updateTimes(job) {
    setText(this.age, ago(job.created_at));
    setAttribute(this.age, 'title', localTime(job.created_at));
    setAttribute(this.age, 'datetime', job.created_at);
  }

  updateQuick(job) {
    const action = job.state === 'paused' ? 'resume' : 'pause';
    if (action !== this.quickAction) this.quick.replaceChildren(icon(action));
    this.quickAction = action;
    setAttribute(this.quick, 'aria-label', `${action === 'resume' ? 'Resume' : 'Pause'} ${jobTitle(job)}`);
  }
}

function noteOf(job) {
  if (job.failure) return job.failure.message;
  if (job.waiting_reason) return job.waiting_reason;
  const size = job.width > 0 ? `${job.width} × ${job.height}, ${job.spp} spp` : 'scene is being validated';
  return `${shortId(job.id)} · ${size}`;
}
