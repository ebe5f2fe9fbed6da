// SPDX-License-Identifier: Apache-2.0
// The head of a job's view: name, state, progress, and what can be done with it.
import {whyNot} from './access.js';
import {kActions} from './actions.js';
import {imageQuery, jobPath, url} from './api.js';
import {guarded, menuButton, setReason} from './dialogs.js';
import {h, icon, setHidden, setText} from './dom.js';
import {duration, jobTitle, shownState, timeLeft} from './format.js';
import {progressBar, stateBadge} from './job_row.js';
import {store} from './store.js';

const kFormats = [
  ['png', 'PNG, as displayed'],
  ['exr', 'OpenEXR, linear'],
  ['hdr', 'Radiance HDR, linear'],
  ['pfm', 'PFM, linear'],
];
// What the coordinator can develop; the view may use others.
const kServerCurves = ['none', 'aces', 'agx'];

// The address of an image of the job in a file format, developed as the viewer shows it if there is one.
export function imageUrl(id, format, viewer) {
  const query = {format, ...imageQuery(viewer?.image ?? 0, format === 'exr' ? '' : viewer?.layer)};
  const display = viewer?.display;
  if (format === 'png' && display) {
    query.exposure = String(display.exposure);
    query.tone_curve = kServerCurves.includes(display.curve) ? display.curve : 'none';
  }
  return url(jobPath(id, '/image'), query);
}

export class JobHead {
  constructor(id) {
    this.id = id;
    this.view = null; // the viewer, when there is one
    this.title = h('h1', {tabindex: -1}, 'Job');
    this.state = stateBadge();
    this.progress = progressBar('Progress');
    this.left = h('span.job-left', {});
    this.buttons = kActions.map((action) => [
      action,
      h(
        'button',
        {
          type: 'button',
          'aria-label': action.label,
          class: action.isDanger ? 'danger-text' : null,
          onclick: guarded(() => action.run([this.job])),
        },
        icon(action.icon),
        h('span', {}, action.label),
      ),
    ]);
    this.showPauseOrResume(false);
    this.download = menuButton(
      'Download the image',
      [icon('download'), h('span', {}, 'Download')],
      () => this.downloads(),
      {class: 'download'},
    );
    this.actions = h(
      'div.job-actions',
      {role: 'group', 'aria-label': 'Actions'},
      this.buttons.map(([, button]) => button),
    );
    this.element = h(
      'header.job-head.is-empty',
      {},
      h(
        'div.job-title',
        {},
        !store.isLocal &&
          h('a.icon-button', {href: '#/', 'aria-label': 'All jobs', title: 'All jobs'}, icon('back')),
        this.title,
        this.state.element,
      ),
      h('div.job-progress', {}, this.progress.element, this.left),
      h('div.job-buttons', {}, !store.isLocal && this.actions, this.download),
    );
  }

  downloads() {
    const files = kFormats.map(([format, label]) => ({
      label,
      icon: 'download',
      href: imageUrl(this.id, format, this.view),
    }));
    return this.view
      ? [...files, {label: 'PNG of the view', icon: 'camera', run: () => this.saveView()}]
      : files;
  }

  async saveView() {
    const address = URL.createObjectURL(await this.view.saveView());
    h('a', {href: address, download: `${jobTitle(this.job)}.png`}).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  }

  update(job) {
    this.job = job;
    this.element.classList.remove('is-empty');
    setText(this.title, jobTitle(job));
    this.title.title = jobTitle(job);
    this.state.update(shownState(job), job.waiting_reason);
    this.progress.update(job);
    const taken = job.finished_at && (Date.parse(job.finished_at) - Date.parse(job.created_at)) / 1000;
    setText(
      this.left,
      job.finished_at
        ? `took ${duration(taken)}`
        : job.state === 'running'
          ? `${timeLeft(job)}${job.queue_position ? '' : ' left'}`
          : '',
    );
    for (const [action, button] of this.buttons) setReason(button, whyNot(action.name, job), action.label);
    this.showPauseOrResume(job.state === 'paused');
  }

  // Only the one that applies.
  showPauseOrResume(isPaused) {
    setHidden(this.buttons[0][1], isPaused);
    setHidden(this.buttons[1][1], !isPaused);
  }

  // The job is deleted, or never was.
  showMissing() {
    if (this.job) setText(this.left, 'deleted');
    else setText(this.title, 'Unknown job');
  }
}
