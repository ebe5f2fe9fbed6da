// SPDX-License-Identifier: Apache-2.0
// What is drawn above the live image: tiles coloured by a property, values in the pixels, the cursor.
import {category, css, sequential} from './halves.js';
import {drawValues, kValueZoom} from './pixel_values.js';

export function drawOverlays(viewer) {
  const context = viewer.top.getContext('2d');
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, viewer.top.width, viewer.top.height);
  if (viewer.overlay) drawTiles(context, viewer);
  if (viewer.viewport.zoom >= kValueZoom) drawValues(context, viewer);
  if (viewer.cursor) drawCursor(context, viewer);
}

function drawTiles(context, {overlay, viewport}) {
  const {canvas, map} = overlay;
  const rect = viewport.toDevice({
    x0: 0,
    y0: 0,
    x1: map.columns * map.tile_width,
    y1: map.rows * map.tile_height,
  });
  const image = viewport.toDevice({x0: 0, y0: 0, x1: viewport.imageWidth, y1: viewport.imageHeight});
  context.save();
  context.beginPath();
  context.rect(image.x0, image.y0, image.x1 - image.x0, image.y1 - image.y0);
  context.clip();
  context.imageSmoothingEnabled = false;
  context.globalAlpha = 0.62;
  context.drawImage(canvas, rect.x0, rect.y0, rect.x1 - rect.x0, rect.y1 - rect.y0);
  context.globalAlpha = 1;
  drawLeased(context, overlay, viewport);
  context.restore();
}

// Outlines of the tiles that are being rendered.
function drawLeased(context, {map}, viewport) {
  const side = map.tile_width * viewport.scale;
  if (side < 8) return;
  context.strokeStyle = '#fff';
  context.lineWidth = Math.max(1, viewport.ratio * 1.5);
  map.tiles.forEach(([, leased], i) => {
    if (!leased) return;
    const x = (i % map.columns) * map.tile_width,
      y = Math.floor(i / map.columns) * map.tile_height;
    const at = viewport.toDevice({x0: x, y0: y, x1: x + map.tile_width, y1: y + map.tile_height});
    context.strokeRect(at.x0 + 1, at.y0 + 1, at.x1 - at.x0 - 2, at.y1 - at.y0 - 2);
  });
}

function drawCursor(context, {viewport, cursor}) {
  const at = viewport.toDevice({x0: cursor.x, y0: cursor.y, x1: cursor.x + 1, y1: cursor.y + 1});
  const grow = Math.max(0, 4 * viewport.ratio - viewport.scale / 2);
  const box = [at.x0 - grow, at.y0 - grow, at.x1 - at.x0 + 2 * grow, at.y1 - at.y0 + 2 * grow];
  context.lineWidth = 3 * viewport.ratio;
  context.strokeStyle = 'rgba(0, 0, 0, 0.6)';
  context.strokeRect(...box);
  context.lineWidth = 1.25 * viewport.ratio;
  context.strokeStyle = '#fff';
  context.strokeRect(...box);
}

const kStates = {
  none: ['no samples yet', [70, 70, 70]],
  partly: ['has samples', [64, 120, 220]],
  leased: ['is being rendered', [240, 170, 50]],
  complete: ['complete', [60, 165, 95]],
};

export function tileState([samples, leased], spp) {
  if (samples >= spp) return 'complete';
  return leased ? 'leased' : samples > 0 ? 'partly' : 'none';
}

// Relative noise from 0.1 % to 100 %, on a logarithmic scale.
const noisePlace = (noise) => (Math.log10(Math.max(noise, 1e-9)) + 3) / 3;

// Each: [label, the colour of a tile or null, its legend [[text, colour]]].
export const kOverlays = {
  state: {
    label: 'State',
    colour: (tile, {spp}) => kStates[tileState(tile, spp)][1],
    legend: () => Object.values(kStates),
  },
  samples: {
    label: 'Samples',
    colour: (tile, {most}) => (tile[0] > 0 ? sequential(tile[0] / most) : null),
    legend: ({most}) => [0, 0.25, 0.5, 0.75, 1].map((x) => [`${Math.round(x * most)} spp`, sequential(x)]),
  },
  noise: {
    label: 'Noise',
    colour: (tile) => (tile[3] === null ? null : sequential(noisePlace(tile[3]))),
    legend: () =>
      [
        ['0.1 %', 0.001],
        ['1 %', 0.01],
        ['10 %', 0.1],
        ['100 %', 1],
      ].map(([text, noise]) => [text, sequential(noisePlace(noise))]),
  },
  worker: {
    label: 'Worker',
    colour: (tile) => (tile[2] >= 0 ? category(tile[2]) : null),
    legend: ({map}) => map.workers.slice(0, 12).map(({name}, i) => [name, category(i)]),
  },
};

// Colours the tiles of a map, one pixel each.
export function paintMap(map, kind, spp) {
  const most = Math.max(
    spp,
    map.tiles.reduce((top, [samples]) => Math.max(top, samples), 1),
  );
  const facts = {map, spp, most};
  const canvas = document.createElement('canvas');
  canvas.width = map.columns;
  canvas.height = map.rows;
  const pixels = new ImageData(map.columns, map.rows);
  map.tiles.forEach((tile, i) => {
    const colour = kOverlays[kind].colour(tile, facts);
    if (colour) pixels.data.set([...colour, 255], 4 * i);
  });
  canvas.getContext('2d').putImageData(pixels, 0, 0);
  return {canvas, map, legend: kOverlays[kind].legend(facts).map(([text, colour]) => [text, css(colour)])};
}
