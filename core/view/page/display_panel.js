// SPDX-License-Identifier: Apache-2.0
// How linear light becomes colours: exposure, tone curve, channels, false colour.
import {section} from './details_panel.js';
import {field, h, select, setHidden, setText} from './dom.js';
import {stops} from './format.js';
import {turbo} from './halves.js';

const kCurves = [
  ['none', 'None'],
  ['aces', 'ACES'],
  ['agx', 'AgX'],
  ['neutral', 'Khronos PBR Neutral'],
];
const kChannels = [
  ['rgb', 'RGB'],
  ['r', 'Red'],
  ['g', 'Green'],
  ['b', 'Blue'],
  ['luminance', 'Luminance'],
];
const kMaxStops = 12;

// "crypto_object" as "Crypto object".
const layerText = (name) => name.charAt(0).toUpperCase() + name.slice(1).replaceAll('_', ' ');

export class DisplayPanel {
  // layerChanged(): another layer is shown.
  constructor(viewer, job, layerChanged = () => {}) {
    this.viewer = viewer;
    this.job = job;
    this.layerChanged = layerChanged;
    this.layers = ['', ...(job.layers ?? [])];
    this.layer = select(
      this.layers.map((name) => [name, name ? layerText(name) : 'Beauty']),
      viewer.layer,
      (name) => this.setLayer(name),
    );
    this.value = h('output.number', {});
    this.exposure = h('input', {
      type: 'range',
      min: -kMaxStops,
      max: kMaxStops,
      step: 0.25,
      oninput: () => this.setExposure(Number(this.exposure.value)),
    });
    this.curve = select(kCurves, job.tone_curve, (value) => this.set({curve: value}));
    this.channel = select(kChannels, 'rgb', (value) => this.set({channel: value}));
    this.falseColour = h('input', {
      type: 'checkbox',
      onchange: () => this.set({isFalseColour: this.falseColour.checked}),
    });
    this.legend = falseColourLegend();
    const reset = h(
      'button.quiet',
      {type: 'button', title: 'Exposure and tone curve of the job', onclick: () => this.reset()},
      'Reset',
    );
    const label = h('label', {for: 'exposure'}, 'Exposure');
    this.exposure.id = 'exposure';
    const layerField = field('Layer', this.layer);
    setHidden(layerField, this.layers.length < 2);
    this.element = section('Display', [
      layerField,
      h('div.field', {}, h('div.field-head', {}, label, this.value, reset), this.exposure),
      h('div.field-row', {}, field('Tone curve', this.curve), field('Channels', this.channel)),
      h('label.check', {}, this.falseColour, ' False colour of luminance'),
      this.legend,
    ]);
    this.show();
  }

  set(change) {
    Object.assign(this.viewer.display, change);
    this.show();
    this.viewer.redraw();
  }

  setLayer(name) {
    this.viewer.setLayer(name);
    this.layer.value = name;
    this.layerChanged();
  }

  setExposure = (value) => {
    this.set({exposure: Math.max(-64, Math.min(64, value))});
  };

  reset() {
    this.set({exposure: this.job.exposure, curve: this.job.tone_curve, channel: 'rgb', isFalseColour: false});
  }

  show() {
    const {exposure, curve, channel, isFalseColour} = this.viewer.display;
    setText(this.value, `${stops(exposure)} stops`);
    this.exposure.value = exposure;
    this.exposure.setAttribute('aria-valuetext', `${stops(exposure)} stops`);
    this.curve.value = curve;
    this.curve.disabled = isFalseColour;
    this.channel.value = channel;
    this.falseColour.checked = isFalseColour;
    setHidden(this.legend, !isFalseColour);
  }

  nextLayer() {
    const at = this.layers.indexOf(this.viewer.layer);
    this.setLayer(this.layers[(at + 1) % this.layers.length]);
  }

  keys() {
    const next = (list, value) => list[(list.findIndex(([key]) => key === value) + 1) % list.length][0];
    return [
      {
        key: 'c',
        help: 'Next tone curve',
        run: () => this.set({curve: next(kCurves, this.viewer.display.curve)}),
      },
      {
        key: 'h',
        help: 'Next channel',
        run: () => this.set({channel: next(kChannels, this.viewer.display.channel)}),
      },
      {
        key: 'f',
        help: 'False colour',
        run: () => this.set({isFalseColour: !this.viewer.display.isFalseColour}),
      },
      {key: 'r', help: 'Reset the display', run: () => this.reset()},
      ...(this.layers.length < 2 ? [] : [{key: 'l', help: 'Next layer', run: () => this.nextLayer()}]),
    ];
  }
}

function falseColourLegend() {
  const canvas = h('canvas.legend-bar', {width: 256, height: 1, 'aria-hidden': 'true'});
  const context = canvas.getContext('2d');
  const pixels = context.createImageData(256, 1);
  for (let x = 0; x < 256; ++x) pixels.data.set([...turbo(x / 255), 255], 4 * x);
  context.putImageData(pixels, 0, 0);
  return h(
    'div.legend',
    {},
    canvas,
    h(
      'div.legend-scale',
      {},
      ['−8', '−4', '0', '+4', '+8 stops'].map((text) => h('span', {}, text)),
    ),
    h('p.hint', {}, '0 is a luminance of 1 after exposure.'),
  );
}
