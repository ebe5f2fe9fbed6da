// SPDX-License-Identifier: Apache-2.0
// What the viewer makes of linear light and of the state of tiles, and how fingers move it.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {until} from './farm.mjs';
import {largestDifference, linearAt, luminance, readExr, srgb} from './images.mjs';
import {openJob, readColours, showPixels, withFarm} from './page.mjs';

const kWidth = 150;
const kHeight = 100;
let farm, browser, id, linear;

withFarm({}, async (started) => {
  ({farm, browser} = started);
  id = await farm.submit(['--size', `${kWidth}x${kHeight}`, '--spp', '8']);
  await farm.waitForState(id, 'done');
  linear = linearAt(readExr(await farm.api(`jobs/${id}/image?format=exr`)));
});

async function openDone() {
  const page = await openJob(browser, farm, id);
  await showPixels(page, kWidth, kHeight);
  await page.getByLabel('Tone curve').selectOption('none');
  return page;
}

// `colour(rgb)`: that of a linear value.
async function assertColours(page, what, colour) {
  const {rgb} = await readColours(page, kWidth, kHeight);
  const worst = largestDifference(rgb, kWidth, (x, y) => colour(linear(x, y)));
  assert.ok(worst <= 1, `${what} differs by ${worst}`);
}

async function close(page) {
  assert.deepEqual(page.errors, []);
  await page.context().close();
}

test('channels', async () => {
  const page = await openDone();
  const gray = (value) => srgb([value, value, value]);
  for (const [key, value] of [
    ['r', ([r]) => r],
    ['g', ([, g]) => g],
    ['b', ([, , b]) => b],
    ['luminance', luminance],
  ]) {
    await page.getByLabel('Channels').selectOption(key);
    await assertColours(page, key, (rgb) => gray(value(rgb)));
  }
  await page.getByLabel('Channels').selectOption('rgb');
  await assertColours(page, 'rgb', srgb);
  await close(page);
});

// Turbo (Mikhailov 2019) of the luminance in stops from -8 to +8.
function falseColour(rgb) {
  const x = Math.max(0, Math.min(1, (Math.log2(Math.max(luminance(rgb), 1e-12)) + 8) / 16));
  return [
    [0.13572138, 4.6153926, -42.66032258, 132.13108234, -152.94239396, 59.28637943],
    [0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604],
    [0.1066733, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973],
  ].map((factors) => {
    const value = factors.reduce((sum, factor, i) => sum + factor * x ** i, 0);
    return Math.round(255 * Math.max(0, Math.min(1, value)));
  });
}

test('false colour', async () => {
  const page = await openDone();
  await page.getByLabel('False colour').check();
  await assertColours(page, 'false colour', falseColour);
  await page.locator('.viewer').focus();
  for (let i = 0; i < 4; ++i) await page.keyboard.press('e');
  await assertColours(page, 'false colour, one stop more', (rgb) => falseColour(rgb.map((v) => 2 * v)));
  await page.keyboard.press('f');
  await assertColours(page, 'one stop more', (rgb) => srgb(rgb.map((v) => 2 * v)));
  await close(page);
});

// The specification of Khronos (2024).
function pbrNeutral(rgb) {
  const start = 0.8 - 0.04,
    desaturation = 0.15;
  const least = Math.min(...rgb);
  const offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
  const lifted = rgb.map((v) => v - offset);
  const peak = Math.max(...lifted);
  if (peak < start) return lifted;
  const d = 1 - start;
  const compressed = 1 - (d * d) / (peak + d - start);
  const g = 1 - 1 / (desaturation * (peak - compressed) + 1);
  return lifted.map((v) => ((v * compressed) / peak) * (1 - g) + compressed * g);
}

test('Khronos PBR Neutral', async () => {
  const page = await openDone();
  await page.getByLabel('Tone curve').selectOption('neutral');
  for (const stops of [0, -2, 3.5]) {
    await page.evaluate((exposure) => Object.assign(window.tessera.viewer.display, {exposure}), stops);
    const developed = (rgb) => srgb(pbrNeutral(rgb.map((v) => v * 2 ** stops)));
    await assertColours(page, `neutral at ${stops} stops`, developed);
  }
  await close(page);
});

// With four significant digits.
function text(value) {
  if (value === 0) return '0';
  return value >= 1e5 || value < 1e-4 ? value.toExponential(2) : value.toPrecision(4);
}

// Lists what is written into canvases in window.written: [text, x, y].
function listTexts() {
  const {fillText} = CanvasRenderingContext2D.prototype;
  window.written = [];
  CanvasRenderingContext2D.prototype.fillText = function write(...args) {
    window.written.push(args);
    fillText.apply(this, args);
  };
}

test('at high zoom the values stand in the pixels', async () => {
  const page = await openJob(browser, farm, id, {init: listTexts});
  const drawn = () =>
    page.evaluate(() => {
      window.written = [];
      window.tessera.viewer.draw();
      const {view, viewer} = window.tessera;
      return {texts: window.written, view, region: viewer.viewport.region};
    });
  await showPixels(page, kWidth, kHeight);
  assert.equal((await drawn()).texts.length, 0);
  await page.locator('.viewer').focus();
  await page.keyboard.press('2');
  await page.waitForFunction(() => window.tessera.isComplete);
  const {texts, view, region} = await drawn();
  assert.equal(texts.length, 3 * (region.x1 - region.x0) * (region.y1 - region.y0));
  texts.forEach(([written, left, top], i) => {
    const [x, y] = [(left - view.originX) / view.scale, (top - view.originY) / view.scale].map(Math.floor);
    assert.equal(written, text(linear(x, y)[i % 3]), `channel ${i % 3} of (${x}, ${y})`);
  });
  await close(page);
});

// Dark blue over green to yellow.
const kSequential = ['211e4a', '34518b', '28808b', '38ae6e', 'a6d646', 'fae75a'].map((hex) => [
  ...Buffer.from(hex, 'hex'),
]);
function sequential(x) {
  const at = 5 * Math.max(0, Math.min(1, x)),
    i = Math.min(4, Math.floor(at));
  return kSequential[i].map((from, c) => from + (kSequential[i + 1][c] - from) * (at - i));
}

test('tiles are coloured by state, samples, noise and worker', async () => {
  const [width, height, spp] = [256, 192, 100000];
  const paused = await farm.submit(['--size', `${width}x${height}`, '--spp', String(spp)]);
  await until('samples', async () => (await farm.api(`jobs/${paused}`)).samples_done > 40 * width * height);
  await farm.pause(paused);
  // Results that were on their way are counted, too.
  let map = await farm.api(`jobs/${paused}/map`);
  await until('the last results', async () => {
    const earlier = JSON.stringify(map.tiles);
    await new Promise((resolve) => setTimeout(resolve, 1000));
    map = await farm.api(`jobs/${paused}/map`);
    return JSON.stringify(map.tiles) === earlier;
  });
  assert.equal(map.tiles.length, 12);
  const most = Math.max(spp, ...map.tiles.map(([samples]) => samples));
  const expected = {
    state: ([samples]) => (samples > 0 ? [64, 120, 220] : [70, 70, 70]),
    samples: ([samples]) => samples > 0 && sequential(samples / most),
    noise: ([, , , noise]) => noise !== null && sequential((Math.log10(noise) + 3) / 3),
    worker: ([, , worker]) => worker >= 0 && [230, 159, 0],
  };
  assert.ok(map.tiles.some(([, , worker, noise]) => worker === 0 && noise > 0.001));
  const page = await openJob(browser, farm, paused);
  await showPixels(page, width, height);
  for (const [kind, colour] of Object.entries(expected)) {
    await page.getByLabel('Colour the tiles by').selectOption(kind);
    await page.waitForFunction(() => window.tessera.viewer.overlay);
    const shown = await page.evaluate(() => {
      const {viewer, view} = window.tessera;
      viewer.draw();
      const context = viewer.top.getContext('2d');
      const centre = (column, row) => [view.originX + 64 * column + 32, view.originY + 64 * row + 32];
      return Array.from({length: 12}, (_, i) =>
        Array.from(context.getImageData(...centre(i % 4, Math.floor(i / 4)), 1, 1).data),
      );
    });
    map.tiles.forEach((tile, i) => {
      const [wanted, [r, g, b, alpha]] = [colour(tile), shown[i]];
      assert.equal(alpha > 0, Boolean(wanted), `${kind} of tile ${i}`);
      if (!wanted) return;
      // Stored multiplied by alpha.
      const worst = Math.max(...[r, g, b].map((v, c) => Math.abs(v - wanted[c])));
      assert.ok(worst <= 3, `${kind} of tile ${i}: ${[r, g, b]} for ${wanted}`);
    });
  }
  await page.locator('.legend-list', {hasText: 'worker-1'}).waitFor();
  await farm.api(`jobs/${paused}`, {method: 'DELETE'});
  await close(page);
});

test('fingers pan, pinch and read a pixel', async () => {
  const page = await openJob(browser, farm, id, {hasTouch: true});
  await showPixels(page, kWidth, kHeight);
  await page.evaluate(([x, y]) => window.tessera.setView({x, y, zoom: 2}), [kWidth / 2, kHeight / 2]);
  const box = await page.locator('.viewer').boundingBox();
  const [x, y] = [Math.round(box.x + box.width / 2), Math.round(box.y + box.height / 2)];
  const browserTouch = await page.context().newCDPSession(page);
  const touch = (type, ...points) =>
    browserTouch.send('Input.dispatchTouchEvent', {
      type,
      touchPoints: points.map(([px, py], fingerId) => ({x: px, y: py, id: fingerId})),
    });
  const near = (view) =>
    page.waitForFunction((wanted) => {
      const {viewport} = window.tessera.viewer;
      return Object.entries(wanted).every(([key, value]) => Math.abs(viewport[key] - value) < 0.6);
    }, view);

  await touch('touchStart', [x, y]);
  for (let i = 1; i <= 6; ++i) await touch('touchMove', [x - 10 * i, y - 5 * i]);
  await touch('touchEnd');
  await near({x: kWidth / 2 + 30, y: kHeight / 2 + 15, zoom: 2});

  await touch('touchStart', [x - 50, y]);
  await touch('touchStart', [x - 50, y], [x + 50, y]);
  for (let i = 1; i <= 10; ++i) await touch('touchMove', [x - 50 - 5 * i, y], [x + 50 + 5 * i, y]);
  await touch('touchEnd');
  await near({x: kWidth / 2 + 30, y: kHeight / 2 + 15, zoom: 4});

  await touch('touchStart', [x, y]);
  await touch('touchEnd');
  const {originX, originY, scale} = await page.evaluate(() => window.tessera.view);
  const [column, row] = [x - box.x - originX, y - box.y - originY].map((at) => Math.floor(at / scale));
  assert.ok(Math.abs(column - 105) <= 1 && Math.abs(row - 65) <= 1, `${column}, ${row}`);
  const place = `x ${column}  y ${row}`;
  await page.locator('.readout-place').filter({hasText: place}).waitFor();
  await close(page);
});
