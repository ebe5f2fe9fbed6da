// SPDX-License-Identifier: Apache-2.0
// Beside the image: progress, settings, life, files and messages of the job, as text.
import {get, jobPath} from './api.js';
import {h, setAttribute, setHidden, setText} from './dom.js';
import {bytes, count, duration, localTime, plural, rate, speedOf} from './format.js';
import {store} from './store.js';

export function section(title, content, {isOpen = true} = {}) {
  return h(
    'details.section',
    {open: isOpen},
    h('summary', {}, h('h2', {}, title)),
    h('div.section-body', {}, content),
  );
}

// A list of names and values that is updated in place.
class Facts {
  constructor() {
    this.element = h('dl.facts', {});
    this.values = new Map();
  }

  update(facts) {
    for (const [name, value] of facts) {
      let [term, text] = this.values.get(name) ?? [];
      if (!term) {
        [term, text] = [h('dt', {}, name), h('dd', {})];
        this.values.set(name, [term, text]);
        this.element.append(term, text);
      }
      setHidden(term, value === null);
      setHidden(text, value === null);
      setText(text, value ?? '');
      setAttribute(text, 'title', value?.length > 24 ? value : null);
    }
  }
}

function updateList(element, texts) {
  setHidden(element, texts.length === 0);
  const key = texts.join('\n');
  if (element.dataset.key === key) return;
  element.dataset.key = key;
  element.replaceChildren(...texts.map((text) => h('li', {}, text)));
}

const kNoCounters = {closest_hit_rays: 0, shadow_rays: 0, non_finite_samples: 0, saturated_samples: 0};

// What a local render has none of.
function farmFacts(job) {
  const counters = {...kNoCounters, ...job.counters};
  const rays = counters.closest_hit_rays + counters.shadow_rays;
  const {non_finite_samples: nonFinite, saturated_samples: saturated} = counters;
  return [
    ['Workers', `${job.active_workers}${job.max_workers > 0 ? ` of at most ${job.max_workers}` : ''}`],
    ['To verify', job.samples_to_verify > 0 ? count(job.samples_to_verify) : 'none'],
    ['Rays', rays > 0 ? count(rays) : '–'],
    ['Odd samples', nonFinite + saturated > 0 ? `${nonFinite} not finite, ${saturated} saturated` : 'none'],
  ];
}

// The same lines from the first sample to the last, so that nothing below them moves.
export class ProgressPanel {
  constructor() {
    this.facts = new Facts();
    this.element = section('Progress', this.facts.element);
  }

  update(job) {
    const isServed = job.state === 'running' && !job.queue_position;
    this.facts.update([
      ['Samples', `${count(job.samples_done)} of ${count(job.samples_total)}`],
      ['Samples/s', rate(speedOf(job))],
      ['Time left', isServed ? duration(job.seconds_left) : '–'],
      ...(store.isLocal ? [] : farmFacts(job)),
    ]);
  }
}

// What went wrong without ending the job.
export class MessagesPanel {
  constructor() {
    this.troubles = h('ul.messages', {'aria-label': 'Troubles of workers'});
    this.warnings = h('ul.messages.warnings', {'aria-label': 'Warnings about the scene'});
    this.element = section('Messages', [this.warnings, this.troubles]);
  }

  update({troubles, warnings}) {
    updateList(this.troubles, troubles ?? []);
    updateList(
      this.warnings,
      (warnings ?? []).map((warning) => `warning: ${warning}`),
    );
    setHidden(this.element, this.troubles.hidden && this.warnings.hidden);
  }
}

export class SettingsPanel {
  constructor() {
    this.facts = new Facts();
    this.element = section('Settings', this.facts.element, {isOpen: false});
  }

  update(job) {
    this.facts.update([
      ['Id', job.id],
      ['Owner', job.owner || null],
      ['Scene', job.scene ?? null],
      ['Size', `${job.width} × ${job.height}`],
      ['Crop', job.crop ? `${job.crop.slice(0, 2).join(', ')} to ${job.crop.slice(2).join(', ')}` : null],
      ['Samples per pixel', String(job.spp)],
      ['Integrator', job.integrator],
      ['Heuristic', job.integrator === 'mis' ? job.heuristic : null],
      ['Maximum depth', job.max_depth > 0 ? String(job.max_depth) : 'default'],
      ['Filter', `${job.filter}, radius ${job.filter_radius}`],
      ['Clamp indirect', job.clamp_indirect > 0 ? String(job.clamp_indirect) : 'off'],
      ['Seed', String(job.seed)],
      ['Exposure', `${job.exposure} stops`],
      ['Tone curve', job.tone_curve],
      ['Priority', String(job.priority)],
      [
        'Labels',
        Object.entries(job.labels ?? {})
          .map(([k, v]) => `${k}=${v}`)
          .join(', ') || null,
      ],
      ['Submitted', localTime(job.created_at)],
      ['Finished', localTime(job.finished_at)],
    ]);
  }
}

export class EventsPanel {
  constructor(id) {
    this.id = id;
    this.list = h('ol.events', {});
    this.element = section('Events', this.list, {isOpen: false});
    this.element.addEventListener('toggle', () => this.element.open && this.fetch());
  }

  async fetch() {
    const {events} = await get(jobPath(this.id, '/events')).catch(() => ({events: []}));
    this.list.replaceChildren(
      ...events.map(({at, kind, message}) =>
        h(
          'li',
          {},
          h('time', {datetime: at, title: at}, at ? localTime(at) : ''),
          h('span.event-kind', {}, kind),
          message && h('span', {}, message),
        ),
      ),
    );
  }
}

export class FilesPanel {
  constructor() {
    this.list = h('ul.file-list', {});
    this.sum = h('p.hint', {});
    this.element = section('Files', [this.sum, this.list], {isOpen: false});
    setHidden(this.element, true);
  }

  update({files}) {
    setHidden(this.element, !files);
    if (!files || files === this.files) return;
    this.files = files;
    setText(
      this.sum,
      `${plural(files.length, 'file')}, ${bytes(files.reduce((sum, file) => sum + file.bytes, 0))}`,
    );
    this.list.replaceChildren(
      ...files
        .slice(0, 200)
        .map((file) =>
          h(
            'li',
            {title: file.sha256},
            h('span.file-name', {}, file.path),
            h('span.number', {}, bytes(file.bytes)),
          ),
        ),
    );
  }
}
