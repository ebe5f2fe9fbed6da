// SPDX-License-Identifier: Apache-2.0
// The tiles of an image on the graphics card: half-float textures ("pages") of 256 x 256 texels. A page of
// level L holds means over blocks of 2^L x 2^L pixels. Only what was seen lately is kept. Of a large image that
// is seen as a whole come tens of thousands of tiles of a few texels each: pages of such levels are put
// together in memory, and go to the card once for each frame that is drawn.
import {createTexture, readTexels, setFilter} from './gl.js';

export const kPage = 256;
const kMaxPages = 320;
const kFirstComposedLevel = 3; // from which on a tile has 8 x 8 texels at the most
const kOne = 0x3c00; // 1 as a half float

export class TileStore {
  // `window` {x0, y0, x1, y1}: the pixels of the whole image that the job renders.
  constructor(gl, window) {
    this.gl = gl;
    this.window = window;
    this.pages = new Map();
    this.clock = 0;
    this.keep = null; // {level, region}: pages that are not evicted; the region is relative to the window
    this.dropped = () => {}; // called with the level of a page that is evicted
    this.scratch = new Uint16Array(0);
    this.composed = new Set(); // pages with texels that the card lacks
  }

  release() {
    for (const page of this.pages.values()) this.gl.deleteTexture(page.texture);
    this.pages.clear();
    this.composed.clear();
  }

  // Draws a tile into the pages of `level`; a coarser one is enlarged. An older state never replaces a newer
  // one.
  put(level, tile, halves) {
    const x = (tile.x0 - this.window.x0) >> level,
      y = (tile.y0 - this.window.y0) >> level;
    const {tiles} = this.page(level, Math.floor(x / kPage), Math.floor(y / kPage));
    const key = `${tile.x0},${tile.y0}`;
    const known = tiles.get(key);
    if (
      known &&
      (known.revision > tile.revision || (known.revision === tile.revision && known.level < tile.level))
    )
      return;
    tiles.set(key, {revision: tile.revision, level: tile.level});
    const width = Math.ceil((tile.x1 - tile.x0) / 2 ** level),
      height = Math.ceil((tile.y1 - tile.y0) / 2 ** level);
    this.expand(tile, halves, width, height, tile.level - level);
    this.upload(level, x, y, width, height);
  }

  // RGB to RGBA, each texel repeated 2^shift times each way.
  expand(tile, halves, width, height, shift) {
    if (this.scratch.length < 4 * width * height) this.scratch = new Uint16Array(4 * width * height);
    const columns = Math.ceil((tile.x1 - tile.x0) / 2 ** tile.level);
    for (let j = 0, to = 0; j < height; ++j) {
      const row = (j >> shift) * columns;
      for (let i = 0; i < width; ++i, to += 4) {
        const from = 3 * (row + (i >> shift));
        this.scratch[to] = halves[from];
        this.scratch[to + 1] = halves[from + 1];
        this.scratch[to + 2] = halves[from + 2];
        this.scratch[to + 3] = kOne;
      }
    }
  }

  // The expanded texels, whose corner is (x, y) in the level, to the pages on which they lie.
  upload(level, x, y, width, height) {
    for (let py = Math.floor(y / kPage); py * kPage < y + height; ++py) {
      for (let px = Math.floor(x / kPage); px * kPage < x + width; ++px) {
        const page = this.page(level, px, py);
        const [left, top] = [px * kPage, py * kPage];
        const rect = {
          x0: Math.max(x - left, 0),
          x1: Math.min(x + width - left, kPage),
          y0: Math.max(y - top, 0),
          y1: Math.min(y + height - top, kPage),
        };
        const from = {texels: this.scratch, width, x: x - left, y: y - top};
        if (level < kFirstComposedLevel) this.send(page, rect, from);
        else this.compose(page, rect, from);
      }
    }
  }

  // A rectangle of a page to the card, from texels in rows of `width`, the first one at (x, y) of the page.
  send(page, {x0, y0, x1, y1}, {texels, width, x, y}) {
    const {gl} = this;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, width);
    gl.pixelStorei(gl.UNPACK_SKIP_PIXELS, x0 - x);
    gl.pixelStorei(gl.UNPACK_SKIP_ROWS, y0 - y);
    gl.bindTexture(gl.TEXTURE_2D, page.texture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, x0, y0, x1 - x0, y1 - y0, gl.RGBA, gl.HALF_FLOAT, texels);
  }

  compose(page, rect, {texels, width, x, y}) {
    page.texels ??= new Uint16Array(4 * kPage * kPage);
    for (let row = rect.y0; row < rect.y1; ++row) {
      const start = 4 * ((row - y) * width + rect.x0 - x);
      const part = texels.subarray(start, start + 4 * (rect.x1 - rect.x0));
      page.texels.set(part, 4 * (row * kPage + rect.x0));
    }
    page.changed = page.changed ? union(page.changed, rect) : rect;
    this.composed.add(page);
  }

  sendComposed() {
    for (const page of this.composed) {
      this.send(page, page.changed, {texels: page.texels, width: kPage, x: 0, y: 0});
      page.changed = null;
    }
    this.composed.clear();
  }

  page(level, px, py) {
    const key = `${level}/${px}/${py}`;
    let page = this.pages.get(key);
    if (!page) {
      // `tiles`: what is there of each, by its corner.
      page = {level, px, py, texture: createTexture(this.gl, kPage, kPage), tiles: new Map()};
      this.pages.set(key, page);
    }
    page.used = this.clock;
    return page;
  }

  // The rectangle of a page in pixels of the image, relative to the window.
  rect({level, px, py}) {
    const size = kPage * 2 ** level;
    return {x0: px * size, y0: py * size, x1: (px + 1) * size, y1: (py + 1) * size};
  }

  // Draws what there is of `region` (relative to the window): other levels first, the coarsest of them below,
  // `level` on top. `isWhole`: it is enough.
  draw(uniforms, {level, isWhole}, region, toTarget) {
    const {gl} = this;
    this.clock += 1;
    this.sendComposed();
    const seen = [...this.pages.values()].filter(
      (page) => (!isWhole || page.level === level) && touches(this.rect(page), region),
    );
    const depth = (page) => (page.level === level ? -1 : page.level);
    for (const page of seen.sort((a, b) => depth(b) - depth(a))) {
      page.used = this.clock;
      gl.bindTexture(gl.TEXTURE_2D, page.texture);
      const target = toTarget(this.rect(page));
      setFilter(gl, target.x1 - target.x0 >= kPage ? gl.NEAREST : gl.LINEAR);
      gl.uniform4f(uniforms.rect, target.x0, target.y0, target.x1, target.y1);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }
    this.evict();
  }

  evict() {
    if (this.pages.size <= kMaxPages) return;
    const isKept = (page) =>
      page.used === this.clock ||
      (this.keep && page.level === this.keep.level && touches(this.rect(page), this.keep.region));
    const oldest = [...this.pages.values()].filter((page) => !isKept(page)).sort((a, b) => a.used - b.used);
    oldest.slice(0, this.pages.size - kMaxPages).forEach((page) => this.drop(page));
  }

  drop(page) {
    this.gl.deleteTexture(page.texture);
    this.pages.delete(`${page.level}/${page.px}/${page.py}`);
    this.composed.delete(page);
    this.dropped(page.level);
  }

  // Linear values of the pixels [x0, x1) x [y0, y1) of the whole image at level 0 as floats, RGB, row-major;
  // alpha 0 (no samples) gives NaN.
  read(x0, y0, x1, y1) {
    const values = new Float32Array(3 * (x1 - x0) * (y1 - y0)).fill(NaN);
    const {window} = this;
    const region = {x0: x0 - window.x0, y0: y0 - window.y0, x1: x1 - window.x0, y1: y1 - window.y0};
    for (const page of this.pages.values())
      if (page.level === 0 && touches(this.rect(page), region)) this.readPage(page, region, values);
    return values;
  }

  readPage(page, region, values) {
    const rect = this.rect(page);
    const x0 = Math.max(rect.x0, region.x0),
      x1 = Math.min(rect.x1, region.x1);
    const y0 = Math.max(rect.y0, region.y0),
      y1 = Math.min(rect.y1, region.y1);
    const texels = readTexels(this.gl, page.texture, x0 - rect.x0, y0 - rect.y0, x1 - x0, y1 - y0);
    for (let y = y0, from = 0; y < y1; ++y) {
      for (let x = x0; x < x1; ++x, from += 4) {
        if (texels[from + 3] === 0) continue;
        const to = 3 * ((y - region.y0) * (region.x1 - region.x0) + x - region.x0);
        values.set(texels.subarray(from, from + 3), to);
      }
    }
  }
}

const union = (a, b) => ({
  x0: Math.min(a.x0, b.x0),
  y0: Math.min(a.y0, b.y0),
  x1: Math.max(a.x1, b.x1),
  y1: Math.max(a.y1, b.y1),
});

export function touches(a, b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}
