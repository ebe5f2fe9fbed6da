// SPDX-License-Identifier: Apache-2.0
// One job: its live image, and beside it everything about it.
import {get, imageQuery, jobPath, url} from './api.js';
import {ComparePanel} from './compare_panel.js';
import {DisplayPanel} from './display_panel.js';
import {EventsPanel, FilesPanel, MessagesPanel, ProgressPanel, SettingsPanel} from './details_panel.js';
import {h, setAttribute, setHidden, setText, throttle} from './dom.js';
import {installHooks} from './hooks.js';
import {ImagesPanel} from './images_panel.js';
import {isOver, jobTitle} from './format.js';
import {JobHead} from './job_head.js';
import {OverlayPanel} from './overlay_panel.js';
import {Readout} from './readout.js';
import {onStore, store} from './store.js';
import {Viewer} from './viewer.js';
import {viewerKeys} from './viewer_input.js';

const kDetailsMs = 5000;

// parameters: `image`, the index of the image to show.
export function jobView(root, id, parameters) {
  const view = new JobView(root, id, Math.max(0, Math.trunc(Number(parameters.get('image'))) || 0));
  return {
    get title() {
      return view.job ? jobTitle(view.job) : 'Job';
    },
    keys: view.keys,
    close: () => view.close(),
  };
}

class JobView {
  constructor(root, id, image) {
    this.id = id;
    this.image = image;
    this.keys = [];
    this.job = null;
    this.head = new JobHead(id);
    this.progress = new ProgressPanel();
    this.images = new ImagesPanel((index) => this.showImage(index));
    this.settings = new SettingsPanel();
    this.files = new FilesPanel();
    this.events = new EventsPanel(id);
    this.messages = new MessagesPanel();
    this.message = h('div.viewer-message', {role: 'status'}, 'Loading…');
    this.waiting = h('p.stage-note.waiting', {role: 'status'});
    this.failure = h('pre.stage-note.failure', {
      role: 'alert',
      tabindex: 0,
      'aria-label': 'Failure',
      hidden: true,
    });
    this.stage = h('div.stage', {}, this.message, this.waiting, this.failure);
    this.side = h(
      'div.side.is-empty',
      {},
      this.images.element,
      this.progress.element,
      this.settings.element,
      this.files.element,
      this.events.element,
      this.messages.element,
    );
    root.append(h('div.job', {}, this.head.element, this.stage, this.side));
    this.askDetails = throttle(400, () => this.fetchDetails());
    this.leave = [onStore('change', () => this.takeFromStore())];
    const isStale = () => this.job && !(this.details && isOver(this.job));
    this.timer = setInterval(() => isStale() && this.fetchDetails(), kDetailsMs);
    this.fetchDetails();
  }

  close() {
    this.isClosed = true;
    this.leave.forEach((f) => f());
    clearInterval(this.timer);
    this.overlays?.close();
    this.readout?.close();
    this.viewer?.close();
    installHooks(null);
  }

  // Files, images, warnings and troubles come only in the answer for a single job.
  async fetchDetails() {
    try {
      const job = await get(jobPath(this.id));
      if (this.isClosed) return;
      store.putJob(job);
      this.details = job;
      this.update(job);
    } catch (error) {
      if (!this.isClosed && error.status === 404) this.showMissing();
    }
  }

  showMissing() {
    this.head.showMissing();
    if (this.viewer) return undefined;
    this.message.replaceChildren(
      h('p', {}, 'There is no job with this id. It may have been deleted.'),
      h('p', {}, h('a.button', {href: '#/'}, 'All jobs')),
    );
    return undefined;
  }

  takeFromStore() {
    const job = store.jobs.get(this.id);
    if (!job) return this.job && store.isLoaded ? this.askDetails() : undefined;
    if (job !== this.job) this.update(job);
    return undefined;
  }

  update(newest) {
    if (this.job && this.job.revision > newest.revision) return;
    const before = this.job;
    const {files, scene, warnings, troubles, images} = this.details ?? newest;
    this.job = {...newest, files, scene, warnings, troubles, images};
    if (this.image >= (newest.image_count ?? 1)) this.image = 0;
    this.images.show(this.image);
    this.images.update(this.job);
    this.head.update(this.job);
    this.progress.update(this.job);
    this.settings.update(this.job);
    this.files.update(this.job);
    this.messages.update(this.job);
    this.updateNotes(this.job);
    document.title = `${jobTitle(this.job)} – Tessera`;
    if (before?.state !== this.job.state) {
      this.events.fetch();
      if (before) this.askDetails();
      if (before && isOver(before) && !isOver(this.job)) this.viewer?.source.reopen();
    }
    if (!this.viewer) this.tryViewer();
    // Which panels there are is known with the details.
    this.side.classList.toggle('is-empty', (this.details?.state ?? 'validating') === 'validating');
    this.overlays?.update(this.job);
    this.compare?.update(this.job);
  }

  // Above the image, so that it stays where it is.
  updateNotes({failure, waiting_reason: reason}) {
    setText(this.waiting, reason ? `Waiting: ${reason}` : '');
    setHidden(this.failure, !failure);
    setText(this.failure, failure ? `tessera: error: ${failure.message}` : '');
  }

  showImage(index) {
    this.image = index;
    this.images.show(index);
    const address = `#/jobs/${encodeURIComponent(this.id)}`;
    history.replaceState(null, '', index > 0 ? `${address}?image=${index}` : address);
    this.viewer?.setImage(index);
    this.overlays?.imageChanged();
    this.compare?.imageChanged();
    this.readout?.imageChanged();
  }

  tryViewer() {
    const {job} = this;
    const isValidated = job.state !== 'validating' && job.width > 0;
    if (isOver(job) && job.samples_done === 0 && (job.state === 'failed' || !isValidated)) {
      const end = job.state === 'failed' ? 'failed' : 'was cancelled';
      setText(this.message, `The job ${end} before there was an image.`);
      return;
    }
    if (!isValidated) {
      setText(
        this.message,
        'The scene is being validated. The image appears here as soon as there are samples.',
      );
      return;
    }
    try {
      this.openViewer(job);
    } catch (error) {
      this.showStill(error);
    }
  }

  openViewer(job) {
    this.viewer = new Viewer(job, this.image, {
      job: (newest) => {
        store.putJob(newest);
        this.update(newest);
      },
      cursor: (cursor, isByKeyboard) => this.readout?.show(cursor, isByKeyboard),
      view: () => this.readout?.showZoom(),
      failed: (error) => {
        if (error?.status === 404) this.showMissing();
      },
      lost: () => this.compare?.forgetKept(),
    });
    setAttribute(
      this.viewer.element,
      'aria-label',
      `Live image of ${jobTitle(job)}, ${job.width} by ${job.height} ` +
        'pixels. Arrow keys pan, plus and minus zoom, Shift with arrow keys reads pixels.',
    );
    this.readout = new Readout(this.viewer, this.id);
    this.display = new DisplayPanel(this.viewer, job, () => {
      this.readout.imageChanged();
      this.compare.imageChanged();
    });
    this.overlays = new OverlayPanel(this.viewer, job);
    this.compare = new ComparePanel(this.viewer, job);
    setHidden(this.message, true);
    this.message.after(this.viewer.element);
    this.stage.append(this.readout.element);
    this.progress.element.after(this.display.element, this.overlays.element, this.compare.element);
    if (job.image_count > 1) this.keys.push(...this.images.keys());
    this.keys.push(
      ...viewerKeys(this.viewer, this.display),
      ...this.display.keys(),
      ...this.overlays.keys(),
      ...this.compare.keys(),
    );
    this.head.view = this.viewer;
    installHooks(this.viewer);
  }

  // Without WebGL: the image as the coordinator develops it, refreshed now and then.
  showStill(error) {
    const image = h('img.still', {alt: `Image of ${jobTitle(this.job)} so far`});
    const refresh = () => {
      image.src = url(jobPath(this.id, '/thumbnail'), {
        size: 512,
        revision: this.job.revision,
        ...imageQuery(this.image),
      });
    };
    this.viewer = {source: {reopen() {}}, setImage: refresh, close() {}};
    this.overlays = {update: throttle(3000, refresh), imageChanged() {}, close() {}};
    this.message.replaceChildren(image, h('p', {}, error.message));
    refresh();
  }
}
