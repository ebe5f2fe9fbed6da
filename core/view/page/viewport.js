// SPDX-License-Identifier: Apache-2.0
// Which part of the image is seen, and how large. Positions in the canvas are CSS pixels from its top left;
// positions in the image are pixels relative to the job's window.

const kMaxZoom = 128;
// The deepest level of the tile stream: a tile of 64 pixels becomes one texel.
const kMaxLevel = 6;

const clamp = (value, low, high) => Math.max(low, Math.min(high, value));

export class Viewport {
  constructor(width, height) {
    Object.assign(this, {imageWidth: width, imageHeight: height, width: 1, height: 1, ratio: 1});
    Object.assign(this, {x: width / 2, y: height / 2, zoom: 1, isFit: true});
  }

  // The canvas in CSS pixels, and device pixels for each of them.
  resize(width, height, ratio) {
    Object.assign(this, {width, height, ratio});
    if (this.isFit) this.fit();
  }

  get fitZoom() {
    const zoom = Math.min(this.width / this.imageWidth, this.height / this.imageHeight);
    // Small images grow by whole numbers of device pixels only.
    return zoom < 1 ? zoom * 0.98 : Math.max(1, Math.floor(zoom * 0.98 * this.ratio) / this.ratio);
  }

  fit() {
    Object.assign(this, {x: this.imageWidth / 2, y: this.imageHeight / 2, zoom: this.fitZoom, isFit: true});
  }

  // The pixel of the image under a point of the canvas, with fraction.
  toImage(x, y) {
    return {x: (x * this.ratio - this.originX) / this.scale, y: (y * this.ratio - this.originY) / this.scale};
  }

  // Device pixels for each pixel of the image.
  get scale() {
    return this.zoom * this.ratio;
  }

  // The image's corner in whole device pixels, so that pixels are sharp at whole zooms.
  get originX() {
    return Math.round((this.width * this.ratio) / 2 - this.x * this.scale);
  }
  get originY() {
    return Math.round((this.height * this.ratio) / 2 - this.y * this.scale);
  }

  // A rectangle of the image in device pixels of the canvas.
  toDevice({x0, y0, x1, y1}) {
    const {originX, originY, scale} = this;
    return {
      x0: originX + x0 * scale,
      y0: originY + y0 * scale,
      x1: originX + x1 * scale,
      y1: originY + y1 * scale,
    };
  }

  // The visible pixels of the image.
  get region() {
    const from = this.toImage(0, 0),
      to = this.toImage(this.width, this.height);
    return {
      x0: clamp(Math.floor(from.x), 0, this.imageWidth - 1),
      y0: clamp(Math.floor(from.y), 0, this.imageHeight - 1),
      x1: clamp(Math.ceil(to.x), 1, this.imageWidth),
      y1: clamp(Math.ceil(to.y), 1, this.imageHeight),
    };
  }

  // The level whose texels are about as large as device pixels.
  get level() {
    return clamp(Math.round(-Math.log2(this.scale)), 0, kMaxLevel);
  }

  panBy(dx, dy) {
    this.isFit = false;
    this.x = clamp(this.x - dx / this.zoom, 0, this.imageWidth);
    this.y = clamp(this.y - dy / this.zoom, 0, this.imageHeight);
  }

  // Keeps the pixel under (x, y) of the canvas where it is. Whole device pixels play no part: by their rounding
  // the image would drift away while it is pinched.
  zoomAt(factor, x = this.width / 2, y = this.height / 2) {
    const zoom = clamp(this.zoom * factor, Math.min(1, this.fitZoom) / 2, kMaxZoom);
    const shift = 1 / this.zoom - 1 / zoom;
    this.isFit = false;
    this.zoom = zoom;
    this.x = clamp(this.x + (x - this.width / 2) * shift, 0, this.imageWidth);
    this.y = clamp(this.y + (y - this.height / 2) * shift, 0, this.imageHeight);
  }

  zoomTo(zoom, x, y) {
    this.zoomAt(zoom / this.zoom, x, y);
  }

  // Moves as little as needed for the pixel to be seen.
  reveal(px, py) {
    const margin = 1.5 * Math.max(1, this.zoom);
    const at = this.toDevice({x0: px, y0: py, x1: px + 1, y1: py + 1});
    const [x, y] = [at.x0 / this.ratio, at.y0 / this.ratio];
    const dx = x < margin ? margin - x : Math.min(0, this.width - margin - x);
    const dy = y < margin ? margin - y : Math.min(0, this.height - margin - y);
    if (dx !== 0 || dy !== 0) this.panBy(dx, dy);
  }
}
