// SPDX-License-Identifier: Apache-2.0
// The live image: a WebGL canvas with linear light, and above it a canvas for overlays, values and the
// cursor. Draws only when something has changed.
import {LinearTarget, createContext, createPrograms} from './gl.js';
import {h} from './dom.js';
import {ImageSource} from './image_source.js';
import {drawOverlays} from './overlay.js';
import {Viewport} from './viewport.js';
import {listenToInput} from './viewer_input.js';

const kCurves = ['none', 'aces', 'agx', 'neutral'];
const kChannels = ['rgb', 'r', 'g', 'b', 'luminance'];
export const kComparisons = ['none', 'slider', 'difference'];

export class Viewer {
  // listener: job(job), cursor({x, y} or null, isByKeyboard), view(), failed(error), and lost() after the
  // graphics card has forgotten all kept images.
  // `image`: the index of the image in the job.
  constructor(job, image, listener) {
    this.listener = listener;
    this.image = image;
    this.layer = ''; // the name of the layer that is shown; '' for the beauty
    this.display = {
      exposure: job.exposure ?? 0,
      curve: job.tone_curve ?? 'none',
      channel: 'rgb',
      isFalseColour: false,
    };
    this.other = null; // what the image is compared with: {store, level} or an ImageSource
    this.comparison = {mode: 'none', split: 0.5};
    this.overlay = null; // {canvas, columns, rows, tile_width, tile_height}
    this.cursor = null; // in pixels of the image, relative to the window
    this.canvas = h('canvas.viewer-image', {'aria-hidden': 'true'});
    this.top = h('canvas.viewer-top', {'aria-hidden': 'true'});
    this.element = h(
      'div.viewer',
      {tabindex: 0, role: 'application', 'aria-roledescription': 'image viewer'},
      this.canvas,
      this.top,
    );
    this.canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    this.canvas.addEventListener('webglcontextrestored', () => this.restart());
    this.gl = createContext(this.canvas);
    this.mostPx = this.gl.getParameter(this.gl.MAX_TEXTURE_SIZE);
    this.start(job);
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(this.element);
    this.schemes = new MutationObserver(() => this.redraw());
    this.schemes.observe(document.documentElement, {attributeFilter: ['data-theme']});
    this.stopInput = listenToInput(this);
  }

  start(job) {
    this.job = job;
    this.programs = createPrograms(this.gl);
    this.targets = [new LinearTarget(this.gl), new LinearTarget(this.gl)];
    this.openOwnSource();
    const {x0, y0, x1, y1} = this.source.window;
    this.viewport ??= new Viewport(x1 - x0, y1 - y0);
  }

  openOwnSource() {
    this.source = this.openSource(this.job, this.image, {
      job: (newest) => this.listener.job(newest),
      failed: (error) => this.listener.failed(error),
    });
  }

  // The layer that is shown, if the job has it.
  openSource(job, image, {job: onJob = () => {}, failed = () => {}} = {}) {
    const layer = job.layers?.includes(this.layer) ? this.layer : '';
    return new ImageSource(this.gl, job, image, layer, {changed: () => this.redraw(), job: onJob, failed});
  }

  // Shows another image of the job, with the same view and display.
  setImage(image) {
    this.image = image;
    this.reopenSource();
  }

  setLayer(layer) {
    this.layer = layer;
    this.reopenSource();
  }

  reopenSource() {
    this.source.close();
    this.openOwnSource();
    this.redraw();
  }

  // After the graphics card has lost everything.
  restart() {
    this.source.close();
    this.setOther(null);
    this.start(this.job);
    this.listener.lost();
    this.redraw();
  }

  close() {
    this.isClosed = true;
    this.stopInput();
    this.sizes.disconnect();
    this.schemes.disconnect();
    this.source.close();
    this.setOther(null);
    this.targets.forEach((target) => target.release());
    this.gl.getExtension('WEBGL_lose_context')?.loseContext();
  }

  // Kept images stay those of the caller; sources are closed when another is set.
  setOther(other) {
    this.other?.close?.();
    this.other = other;
    this.redraw();
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.element;
    const ratio = Math.min(devicePixelRatio || 1, 3);
    // Larger ones cannot be drawn into, and are no screen.
    if (width === 0 || height === 0 || Math.max(width, height) * ratio > this.mostPx) return;
    for (const canvas of [this.canvas, this.top]) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    this.viewport.resize(width, height, ratio);
    this.isSized = true;
    this.draw();
  }

  // Draws before the next frame.
  redraw() {
    if (this.frame || this.isClosed) return;
    this.frame = requestAnimationFrame(() => this.draw());
  }

  // The view has changed: other tiles may be wanted, once it rests for a moment.
  viewChanged() {
    this.redraw();
    this.listener.view();
  }

  draw() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    if (this.isClosed || this.gl.isContextLost() || !this.isSized) return;
    this.look();
    this.drawLight(this.targets[0], this.source);
    const isCompared = this.other && this.comparison.mode !== 'none';
    if (isCompared) this.drawLight(this.targets[1], this.other);
    this.develop(isCompared ? kComparisons.indexOf(this.comparison.mode) : 0);
    drawOverlays(this);
  }

  look() {
    const {region, level} = this.viewport;
    const ask = () => {
      clearTimeout(this.looking);
      this.looking = 0;
      if (this.isClosed) return;
      for (const source of [this.source, this.other])
        source?.look?.(shift(this.viewport.region, source.window), this.viewport.level);
    };
    if (this.source.region === null || (this.other?.look && this.other.region === null)) return ask();
    const key = `${level}/${region.x0}/${region.y0}/${region.x1}/${region.y1}`;
    if (key === this.lookedAt) return undefined;
    this.lookedAt = key;
    clearTimeout(this.looking);
    this.looking = setTimeout(ask, 120);
    return undefined;
  }

  drawLight(target, source) {
    const {gl, viewport} = this;
    const {store, level} = source;
    const {program, uniforms} = this.programs.page;
    target.begin(this.canvas.width, this.canvas.height);
    const image = this.imageRect();
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(
      Math.round(image.x0),
      Math.round(image.y0),
      Math.max(0, Math.round(image.x1) - Math.round(image.x0)),
      Math.max(0, Math.round(image.y1) - Math.round(image.y0)),
    );
    gl.useProgram(program);
    gl.activeTexture(gl.TEXTURE0);
    gl.uniform1i(uniforms.page, 0);
    gl.uniform2f(uniforms.target_size, this.canvas.width, this.canvas.height);
    const {region} = viewport;
    const isWhole = source.hasAll?.(shift(region, source.window)) ?? false;
    store.draw(uniforms, {level, isWhole}, region, (rect) => viewport.toDevice(rect));
    gl.disable(gl.SCISSOR_TEST);
  }

  imageRect() {
    const {imageWidth, imageHeight} = this.viewport;
    return this.viewport.toDevice({x0: 0, y0: 0, x1: imageWidth, y1: imageHeight});
  }

  develop(compare) {
    const {gl, display} = this;
    const {program, uniforms} = this.programs.screen;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.useProgram(program);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.targets[compare ? 1 : 0].texture);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.targets[0].texture);
    gl.uniform1i(uniforms.image_a, 0);
    gl.uniform1i(uniforms.image_b, 1);
    gl.uniform1i(uniforms.compare, compare);
    gl.uniform1f(uniforms.split, Math.round(this.comparison.split * this.canvas.width));
    gl.uniform1f(uniforms.scale, 2 ** display.exposure);
    gl.uniform1i(uniforms.curve, compare === 2 ? 0 : Math.max(0, kCurves.indexOf(display.curve)));
    gl.uniform1i(uniforms.channel, Math.max(0, kChannels.indexOf(display.channel)));
    gl.uniform1i(uniforms.is_false_colour, display.isFalseColour ? 1 : 0);
    const image = this.imageRect();
    gl.uniform4f(uniforms.image_rect, image.x0, image.y0, image.x1, image.y1);
    const {backgroundColor, color} = getComputedStyle(this.canvas);
    gl.uniform3fv(uniforms.surround, numbersOf(backgroundColor));
    gl.uniform3fv(uniforms.unsampled, numbersOf(color));
    gl.uniform1f(uniforms.target_height, this.canvas.height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  setCursor(cursor, isByKeyboard = false) {
    this.cursor = cursor;
    this.listener.cursor(cursor, isByKeyboard);
    this.redraw();
  }

  // The canvas as it is, as a PNG file.
  async saveView() {
    this.draw();
    return new Promise((resolve) => {
      this.canvas.toBlob(resolve, 'image/png');
    });
  }
}

// A computed colour, "rgb(16, 16, 16)", from 0 to 1.
function numbersOf(colour) {
  return colour.match(/[\d.]+/g).slice(0, 3).map((part) => Number(part) / 255);
}

export function shift({x0, y0, x1, y1}, window) {
  return {x0: x0 + window.x0, y0: y0 + window.y0, x1: x1 + window.x0, y1: y1 + window.y0};
}
