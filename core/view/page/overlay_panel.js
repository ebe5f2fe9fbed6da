// SPDX-License-Identifier: Apache-2.0
// Tiles coloured by state, samples, noise or worker, refreshed while the job runs.
import {get, imageQuery, jobPath} from './api.js';
import {section} from './details_panel.js';
import {h, select, setHidden, throttle} from './dom.js';
import {isOver} from './format.js';
import {kOverlays, paintMap} from './overlay.js';

const kRefreshMs = 1000;
const kChoices = [['none', 'None'], ...Object.entries(kOverlays).map(([key, {label}]) => [key, label])];

export class OverlayPanel {
  constructor(viewer, job) {
    this.viewer = viewer;
    this.job = job;
    this.kind = 'none';
    this.choice = select(kChoices, 'none', (kind) => this.set(kind), {'aria-label': 'Colour the tiles by'});
    this.legend = h('ul.legend-list', {hidden: true});
    this.element = section('Tiles', [this.choice, this.legend]);
    this.refresh = throttle(kRefreshMs, () => this.fetch());
    // Leases change without a change of the job.
    this.timer = setInterval(() => !document.hidden && !isOver(this.job) && this.fetch(), 2 * kRefreshMs);
  }

  close() {
    clearInterval(this.timer);
    this.kind = 'none';
  }

  set(kind) {
    this.kind = kind;
    this.choice.value = kind;
    this.paint();
    this.fetch();
  }

  update(job) {
    const isChanged = job.samples_done !== this.job.samples_done || job.state !== this.job.state;
    this.job = job;
    if (isChanged) this.refresh();
  }

  async fetch() {
    if (this.kind === 'none' || this.isFetching) return;
    this.isFetching = true;
    const {image} = this.viewer;
    const query = imageQuery(image);
    const map = await get(jobPath(this.job.id, '/map'), {query}).catch(() => this.map);
    this.isFetching = false;
    if (image !== this.viewer.image) return void this.fetch();
    this.map = map;
    this.paint();
  }

  imageChanged() {
    this.map = null;
    this.paint();
    this.fetch();
  }

  paint() {
    const painted = this.kind !== 'none' && this.map ? paintMap(this.map, this.kind, this.job.spp) : null;
    this.viewer.overlay = painted;
    setHidden(this.legend, !painted);
    const key = JSON.stringify(painted?.legend ?? []);
    if (key !== this.legendKey) {
      this.legendKey = key;
      this.legend.replaceChildren(...(painted?.legend ?? []).map(legendItem));
    }
    this.viewer.redraw();
  }

  keys() {
    return [
      {
        key: 'o',
        help: 'Next colouring of tiles',
        run: () => {
          const at = kChoices.findIndex(([key]) => key === this.kind);
          this.set(kChoices[(at + 1) % kChoices.length][0]);
        },
      },
    ];
  }
}

function legendItem([text, colour]) {
  const swatch = h('span.swatch', {'aria-hidden': 'true'});
  swatch.style.backgroundColor = colour;
  return h('li', {}, swatch, text);
}
