// SPDX-License-Identifier: Apache-2.0
// Compares the image with that of another job, or with an earlier state of it: by a slider, or by their
// difference.
import {section} from './details_panel.js';
import {toast, toastError} from './dialogs.js';
import {field, h, icon, select, setAttribute, setHidden} from './dom.js';
import {count, jobTitle, localTime, shortId} from './format.js';
import {KeptImages} from './kept_images.js';
import {onStore, store} from './store.js';

const kModes = [
  ['slider', 'Slider'],
  ['difference', 'Difference'],
];

export class ComparePanel {
  constructor(viewer, job) {
    this.viewer = viewer;
    this.job = job;
    this.kept = new KeptImages(viewer);
    this.choice = h('select', {onchange: () => this.choose(this.choice.value)});
    this.mode = select(kModes, 'slider', (mode) => this.setMode(mode));
    this.modeField = field('Shown as', this.mode);
    this.take = h(
      'button',
      {type: 'button', onclick: () => this.takeSnapshot()},
      icon('camera'),
      'Take a snapshot',
    );
    this.handle = h(
      'div.split',
      {
        role: 'slider',
        tabindex: 0,
        'aria-label': 'Split between the images',
        'aria-valuemin': 0,
        'aria-valuemax': 100,
        hidden: true,
        onkeydown: (event) => this.moveByKey(event),
        onpointerdown: (event) => this.startDrag(event),
        onpointermove: (event) => this.drag(event),
      },
      h('span.split-name.split-left', {}, 'this job'),
      (this.rightName = h('span.split-name.split-right', {})),
    );
    viewer.element.append(this.handle);
    this.element = section(
      'Compare',
      [
        field('With', this.choice),
        this.modeField,
        this.take,
        h(
          'p.hint',
          {},
          'While you watch, the last six moments at which the samples had doubled are kept; a snapshot keeps ' +
            'the image as it is now. The difference is shown with the exposure.',
        ),
      ],
      {isOpen: false},
    );
    this.listChoices();
    this.element.addEventListener('toggle', () => this.listChoices());
    this.leave = onStore('change', () =>
      this.element.isConnected ? this.element.open && this.listChoices() : this.leave(),
    );
    this.choose('');
  }

  // Jobs of the same size first: only these can be compared pixel by pixel.
  listChoices() {
    const others = [...store.jobs.values()].filter(
      (job) =>
        job.id !== this.job.id &&
        job.samples_done > 0 &&
        job.width === this.job.width &&
        job.height === this.job.height,
    );
    const options = [
      ['', 'Nothing'],
      ...this.kept.shown().map((kept) => [kept.id, keptName(kept)]),
      ...others.slice(0, 200).map((job) => [job.id, `${jobTitle(job)} (${shortId(job.id)})`]),
    ];
    const key = JSON.stringify(options);
    if (key === this.listed) return;
    this.listed = key;
    const value = this.choice.value;
    this.choice.replaceChildren(...options.map(([id, text]) => h('option', {value: id}, text)));
    if (options.some(([id]) => id === value)) this.choice.value = value;
  }

  async takeSnapshot() {
    this.take.disabled = true;
    try {
      const {id} = await this.kept.takeSnapshot(this.job);
      this.listChoices();
      this.choice.value = id;
      this.choose(id);
      toast('Snapshot taken');
    } catch (error) {
      toastError(error);
    }
    this.take.disabled = false;
  }

  // Something of the job has changed.
  async update(job) {
    this.job = job;
    if (await this.kept.keepMoment(job)) this.listChoices();
  }

  forgetKept() {
    this.kept.forget();
    this.listChoices();
    this.choose('');
  }

  // Another job is shown with its image of the same index, if it has that.
  openOther(job) {
    const {image} = this.viewer;
    return this.viewer.openSource(job, image < (job.image_count ?? 1) ? image : 0);
  }

  // Another image or layer is shown.
  imageChanged() {
    this.listChoices();
    this.choose(this.choice.value);
  }

  choose(value) {
    const job = store.jobs.get(value);
    const kept = this.kept.get(value);
    const other = kept ?? (job ? this.openOther(job) : null);
    if (!other) this.choice.value = '';
    this.viewer.setOther(other);
    this.rightName.textContent = kept ? keptName(kept) : job ? jobTitle(job) : '';
    this.setMode(this.mode.value);
  }

  setMode(mode) {
    this.mode.value = mode;
    const isActive = Boolean(this.viewer.other);
    this.viewer.comparison.mode = isActive ? mode : 'none';
    setHidden(this.handle, !isActive || mode !== 'slider');
    setHidden(this.modeField, !isActive);
    this.setSplit(this.viewer.comparison.split);
  }

  setSplit(split) {
    this.viewer.comparison.split = Math.max(0, Math.min(1, split));
    const hundredths = 100 * this.viewer.comparison.split;
    this.handle.style.left = `${hundredths}%`;
    setAttribute(this.handle, 'aria-valuenow', Math.round(hundredths));
    setAttribute(this.handle, 'aria-valuetext', `${Math.round(hundredths)} %`);
    this.viewer.redraw();
  }

  moveByKey(event) {
    const {split} = this.viewer.comparison;
    const step = event.shiftKey ? 0.1 : 0.01;
    const next = {ArrowLeft: split - step, ArrowRight: split + step, Home: 0, End: 1}[event.key];
    if (next === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    this.setSplit(next);
  }

  startDrag(event) {
    event.stopPropagation();
    this.handle.setPointerCapture(event.pointerId);
  }

  drag(event) {
    if (!this.handle.hasPointerCapture(event.pointerId)) return;
    event.stopPropagation();
    const box = this.viewer.element.getBoundingClientRect();
    this.setSplit((event.clientX - box.left) / box.width);
  }

  keys() {
    return [
      {key: 's', help: 'Take a snapshot and compare with it', run: () => this.takeSnapshot()},
      {
        key: 'm',
        help: 'Compare by slider or difference',
        run: () => this.viewer.other && this.setMode(this.mode.value === 'slider' ? 'difference' : 'slider'),
      },
    ];
  }
}

function keptName({isMoment, spp, at}) {
  const kind = isMoment ? 'Earlier' : 'Snapshot';
  return `${kind}, ${count(spp)} spp, ${localTime(at).slice(11)}`;
}
