// SPDX-License-Identifier: Apache-2.0
// What tests and scripts in the browser's console may read: `window.tessera` (docs/viewing.md).
import {toHalf} from './halves.js';

export function installHooks(viewer) {
  window.tessera = viewer && {
    viewer,

    // Whether all that is visible has been received, at the level at which it is seen.
    get isComplete() {
      return viewer.source.isComplete && !viewer.looking;
    },

    // The bits of the half floats that the graphics card holds for these pixels of the whole image, R, G, B,
    // row by row; null for pixels that are not there at level 0. Visible at zoom 100 % and above.
    readPixels(x0, y0, x1, y1) {
      return Array.from(viewer.source.store.read(x0, y0, x1, y1), (value) =>
        Number.isNaN(value) ? null : toHalf(value),
      );
    },

    // The colours of the canvas, as drawn now: {width, height, data} with RGBA rows from the top.
    readCanvas() {
      viewer.draw();
      const {gl} = viewer;
      const {width, height} = viewer.canvas;
      const upward = new Uint8Array(4 * width * height);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, upward);
      const data = new Uint8Array(upward.length);
      for (let y = 0; y < height; ++y)
        data.set(upward.subarray(4 * width * y, 4 * width * (y + 1)), 4 * width * (height - 1 - y));
      return {width, height, data};
    },

    // Centres the view on a point of the image (relative to the job's window), `zoom` CSS pixels to a pixel.
    setView({x, y, zoom}) {
      Object.assign(viewer.viewport, {x, y, zoom, isFit: false});
      viewer.viewChanged();
      viewer.draw();
    },

    // Where the image's corner is in the canvas, in device pixels, and device pixels for a pixel.
    get view() {
      const {originX, originY, scale, level} = viewer.viewport;
      return {originX, originY, scale, level};
    },
  };
}
