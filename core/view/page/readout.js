// SPDX-License-Identifier: Apache-2.0
// The line below the image: the pixel under the pointer, and the zoom.
import {get, imageQuery, jobPath} from './api.js';
import {h, icon, setAttribute, setText, throttle} from './dom.js';
import {light, plural} from './format.js';

const kRequestMs = 150;

export class Readout {
  constructor(viewer, id) {
    this.viewer = viewer;
    this.id = id;
    this.cursor = null;
    this.place = h('span.readout-place', {});
    this.values = ['red', 'green', 'blue'].map((name) => h(`span.readout-value.${name}`, {}));
    this.statistics = h('span.readout-statistics', {});
    this.zoom = h('span.zoom-value', {});
    this.text = h(
      'div.readout-text',
      {role: 'status', 'aria-live': 'off'},
      this.place,
      this.values,
      this.statistics,
    );
    const zoom = (name, label, change) =>
      h(
        'button.icon-button',
        {
          type: 'button',
          'aria-label': label,
          title: label,
          onclick: () => {
            change(viewer.viewport);
            viewer.viewChanged();
          },
        },
        icon(name),
      );
    this.element = h(
      'div.readout',
      {},
      this.text,
      h(
        'div.zoom',
        {role: 'group', 'aria-label': 'Zoom'},
        zoom('minus', 'Zoom out (-)', (view) => view.zoomAt(Math.SQRT1_2)),
        h(
          'button.quiet.zoom-button',
          {
            type: 'button',
            title: 'One pixel is one pixel (1)',
            onclick: () => {
              viewer.viewport.zoomTo(1 / viewer.viewport.ratio);
              viewer.viewChanged();
            },
          },
          this.zoom,
        ),
        zoom('plus', 'Zoom in (+)', (view) => view.zoomAt(Math.SQRT2)),
        zoom('fit', 'Fit the image (0)', (view) => view.fit()),
      ),
    );
    this.ask = throttle(kRequestMs, () => this.fetch());
    this.sizes = new ResizeObserver(() => this.showZoom());
    this.sizes.observe(viewer.element);
    this.timer = setInterval(() => this.cursor && !document.hidden && this.ask(), 1000);
    this.show(null);
  }

  close() {
    this.sizes.disconnect();
    clearInterval(this.timer);
    this.cursor = null;
  }

  showZoom() {
    const {scale} = this.viewer.viewport;
    setText(this.zoom, scale >= 0.1 ? `${Math.round(100 * scale)} %` : `${(100 * scale).toFixed(1)} %`);
  }

  show(cursor, isByKeyboard = false) {
    this.cursor = cursor;
    setAttribute(this.text, 'aria-live', isByKeyboard ? 'polite' : 'off');
    if (!cursor) {
      setText(
        this.place,
        matchMedia('(hover: none)').matches
          ? 'Tap the image to read a pixel'
          : 'Point at the image to read a pixel',
      );
      this.values.forEach((value) => setText(value, ''));
      setText(this.statistics, '');
      return;
    }
    const {window, store} = this.viewer.source;
    const [x, y] = [cursor.x + window.x0, cursor.y + window.y0];
    setText(this.place, `x ${x}  y ${y}`);
    setText(this.statistics, '');
    // What is drawn, at once; the exact values and the statistics follow.
    this.showValue(this.viewer.viewport.level === 0 ? [...store.read(x, y, x + 1, y + 1)] : [NaN, NaN, NaN]);
    this.ask();
  }

  showValue(value) {
    value.forEach((v, i) => setText(this.values[i], Number.isNaN(v) ? '' : `${'RGB'[i]} ${light(v)}`));
  }

  // The values of a layer by the names of its channels; of ids, the first one that covers something.
  showLayer({channels, values}) {
    this.values.forEach((value, i) => {
      const number = values[i] === null ? 'none' : light(values[i] ?? 0);
      setText(value, i < Math.min(channels.length, 3) ? `${channels[i].split('.').pop()} ${number}` : '');
    });
  }

  imageChanged() {
    if (this.cursor) this.show(this.cursor);
  }

  async fetch() {
    if (!this.cursor) return;
    const {image, layer, source} = this.viewer;
    const {window} = source;
    const [x, y] = [this.cursor.x + window.x0, this.cursor.y + window.y0];
    const query = {x: String(x), y: String(y), ...imageQuery(image, layer)};
    const pixel = await get(jobPath(this.id, '/pixel'), {query}).catch(() => null);
    if (
      !pixel ||
      !this.cursor ||
      image !== this.viewer.image ||
      layer !== this.viewer.layer ||
      this.cursor.x + window.x0 !== pixel.x ||
      this.cursor.y + window.y0 !== pixel.y
    )
      return;
    if (pixel.layer) this.showLayer(pixel.layer);
    else this.showValue(pixel.value);
    const error =
      !pixel.layer && pixel.standard_error && pixel.samples > 1 ? `  ± ${pixel.standard_error.map(light).join('  ')}` : '';
    setText(this.statistics, `${plural(pixel.samples, 'sample')}${error}`);
    setAttribute(this.statistics, 'title', 'Samples of this pixel, and the standard error of R, G and B');
  }
}
