// SPDX-License-Identifier: Apache-2.0
// Small plots of the farm's activity, drawn as SVG.
import {setAttribute, svg} from './dom.js';

const kWidth = 240,
  kHeight = 36;

// The fewest values that a plot spans, so that the first values do not look like much.
const kFewest = 30;

// A plot of values of the last `hours`, newest at the right; update(values) redraws it.
export function sparkline(label, hours) {
  const area = svg('path', {class: 'plot-area'});
  const line = svg('path', {class: 'plot-line', 'vector-effect': 'non-scaling-stroke'});
  const title = svg('title', {}, label);
  const element = svg(
    'svg',
    {class: 'plot', viewBox: `0 0 ${kWidth} ${kHeight}`, role: 'img', preserveAspectRatio: 'none'},
    title,
    area,
    line,
  );
  const update = (values, text) => {
    title.textContent = `${label}, at most the last ${hours} hours: ${text}`;
    const points = toPoints(values);
    setAttribute(line, 'd', points.length > 1 ? `M${points.map((p) => p.join(' ')).join('L')}` : 'M0 0');
    setAttribute(
      area,
      'd',
      points.length > 1
        ? `M${points[0][0]} ${kHeight}L${points.map((p) => p.join(' ')).join('L')}L${kWidth} ${kHeight}Z`
        : 'M0 0',
    );
  };
  return {element, update};
}

function toPoints(values) {
  const top = Math.max(1e-9, ...values);
  const step = kWidth / (Math.max(kFewest, values.length) - 1);
  return values.map((value, i) => [
    round(kWidth - (values.length - 1 - i) * step),
    round(kHeight - 1 - ((kHeight - 4) * value) / top),
  ]);
}

const round = (value) => Math.round(10 * value) / 10;
