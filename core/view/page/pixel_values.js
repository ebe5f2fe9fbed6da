// SPDX-License-Identifier: Apache-2.0
// At high zoom the values stand in the pixels: of what is shown there, also where two images are compared.
import {light} from './format.js';

// CSS pixels of a pixel from which its values fit inside.
export const kValueZoom = 56;

const kColours = ['#ffb3ad', '#b6f2b6', '#b9ccff'];

// Of `region`, which is relative to the window of each image.
function readRegion(store, region) {
  const {x0, y0} = store.window;
  return store.read(region.x0 + x0, region.y0 + y0, region.x1 + x0, region.y1 + y0);
}

// The value to write at `i`, a position in arrays of values: NaN for none.
function shownValues({viewport, source, other, comparison, canvas}) {
  const {region} = viewport;
  const ours = readRegion(source.store, region);
  if (!other || comparison.mode === 'none') return (x, i) => ours[i];
  const theirs = readRegion(other.store, region);
  if (comparison.mode === 'difference') return (x, i) => Math.abs(ours[i] - theirs[i]);
  const split = Math.round(comparison.split * canvas.width);
  return (x, i) => (x < split ? ours[i] : theirs[i]);
}

export function drawValues(context, viewer) {
  const {region, ratio, scale, zoom} = viewer.viewport;
  const valueAt = shownValues(viewer);
  context.font = `${Math.min(13, zoom / 5.2) * ratio}px ui-monospace, monospace`;
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.lineWidth = 3 * ratio;
  context.lineJoin = 'round';
  context.strokeStyle = 'rgba(0, 0, 0, 0.75)';
  for (let y = region.y0, i = 0; y < region.y1; ++y) {
    for (let x = region.x0; x < region.x1; ++x) {
      const at = viewer.viewport.toDevice({x0: x, y0: y, x1: x, y1: y});
      for (let c = 0; c < 3; ++c, ++i) {
        const value = valueAt(at.x0 + scale / 2, i);
        if (Number.isNaN(value)) continue;
        const text = light(value);
        const place = [at.x0 + scale / 2, at.y0 + scale * (0.26 + 0.24 * c)];
        context.strokeText(text, ...place);
        context.fillStyle = kColours[c];
        context.fillText(text, ...place);
      }
    }
  }
}
