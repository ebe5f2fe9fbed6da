// SPDX-License-Identifier: Apache-2.0
// Comparing an image with another job's and with an earlier moment: the colours on the screen are those of
// the EXR files.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {glowingSphere, until} from './farm.mjs';
import {halfValue, largestDifference, linearAt, readExr, srgb} from './images.mjs';
import {openJob, readArray, readColours, showPixels, withFarm} from './page.mjs';

const kSmall = {width: 150, height: 100};
// More than a server sends in one go.
const kWidth = 800;
const kHeight = 600;
const kLarge = {width: kWidth, height: kHeight};
let farm, browser;

withFarm({}, (started) => {
  ({farm, browser} = started);
});

const exrOf = async (id) => readExr(await farm.api(`jobs/${id}/image?format=exr`));

async function submitDone(options, {width, height} = kLarge) {
  const id = await farm.submit(['--size', `${width}x${height}`, ...options]);
  await farm.waitForState(id, 'done');
  return id;
}

async function openCompared(id, {width, height} = kLarge) {
  const page = await openJob(browser, farm, id);
  await showPixels(page, width, height);
  await page.getByLabel('Tone curve').selectOption('none');
  await page.getByRole('heading', {name: 'Compare'}).click();
  return page;
}

// The linear values of the large image that the graphics card holds, and of what it is compared with.
const kAll = [0, 0, kWidth, kHeight];
const readShown = (page) =>
  readArray(page, Float32Array, (rect) => window.tessera.viewer.source.store.read(...rect), kAll);
const readOther = (page) =>
  readArray(page, Float32Array, (rect) => window.tessera.viewer.other.store.read(...rect), kAll);

// `linear(x, y, isRight)`: what is expected of a pixel; isRight: it is right of the split.
async function assertShown(page, what, linear, {width, height} = kLarge) {
  const split = await page.evaluate(() => {
    const {comparison, canvas} = window.tessera.viewer;
    return Math.round(comparison.split * canvas.width);
  });
  const {rgb, originX} = await readColours(page, width, height);
  const worst = largestDifference(rgb, width, (x, y) => srgb(linear(x, y, x + originX >= split)));
  assert.ok(worst <= 1, `${what} differs by ${worst}`);
}

test('another job, by slider and by difference', async () => {
  const own = await submitDone(['--spp', '8'], kSmall);
  const other = await submitDone(['--spp', '2', '--seed', '7', '--name', 'coarse'], kSmall);
  const [a, b] = [linearAt(await exrOf(own)), linearAt(await exrOf(other))];
  const page = await openCompared(own, kSmall);
  await page.getByLabel('With', {exact: true}).selectOption(other);
  await page.waitForFunction(() => window.tessera.viewer.other?.isComplete);
  await page.getByText('coarse', {exact: true}).waitFor();
  const bySplit = (x, y, isRight) => (isRight ? b(x, y) : a(x, y));
  await assertShown(page, 'the middle', bySplit, kSmall);

  const handle = page.getByRole('slider', {name: 'Split between the images'});
  const place = async () => Number(await handle.getAttribute('aria-valuenow'));
  await handle.press('Home');
  assert.equal(await place(), 0);
  await assertShown(page, 'the other', b, kSmall);
  await handle.press('End');
  assert.equal(await place(), 100);
  await assertShown(page, 'the own', a, kSmall);
  await handle.press('Home');
  const {x, y, width, height} = await page.locator('.viewer').boundingBox();
  await page.mouse.move(x + 5, y + height / 4);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 + 20, y + height / 4, {steps: 4});
  await page.mouse.up();
  assert.ok((await place()) >= 50, `the handle was dragged to ${await place()} %`);
  await assertShown(page, 'a dragged split', bySplit, kSmall);

  await page.mouse.move(1, 1);
  await page.getByLabel('Shown as').selectOption('difference');
  const difference = (stops) => (px, py) => {
    const theirs = b(px, py);
    return a(px, py).map((value, c) => Math.abs(value - theirs[c]) * 2 ** stops);
  };
  await assertShown(page, 'the difference', difference(0), kSmall);
  await page.evaluate(() => Object.assign(window.tessera.viewer.display, {exposure: 3}));
  await assertShown(page, 'the difference, three stops up', difference(3), kSmall);
  await page.getByLabel('With', {exact: true}).selectOption('');
  await page.evaluate(() => Object.assign(window.tessera.viewer.display, {exposure: 0}));
  await assertShown(page, 'the image alone', a, kSmall);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a snapshot keeps an earlier moment', async () => {
  const id = await submitDone(['--spp', '2']);
  const early = await exrOf(id);
  const page = await openCompared(id);
  await page.getByRole('button', {name: 'Take a snapshot'}).click();
  await page.waitForFunction(() => window.tessera.viewer.other?.at);
  await farm.api(`jobs/${id}/extend`, {
    method: 'POST',
    body: JSON.stringify({spp: 4}),
    headers: {'Content-Type': 'application/json'},
  });
  await farm.waitForState(id, 'done');
  await page.locator('.job-title .state', {hasText: 'done'}).waitFor();
  const late = await exrOf(id);
  assert.notDeepEqual(early.halves, late.halves);
  // Of the own image, the last tiles may be under way.
  const wanted = Float32Array.from(late.halves, halfValue);
  await until('the last tiles', async () => {
    const values = await readShown(page);
    return wanted.every((value, i) => value === values[i]);
  });
  const kept = await readOther(page);
  assert.ok(kept.every(Number.isFinite));
  assert.deepEqual(kept, Float32Array.from(early.halves, halfValue));
  const [before, now] = [linearAt(early), linearAt(late)];
  await assertShown(page, 'the snapshot', (x, y, isRight) => (isRight ? before(x, y) : now(x, y)));
  await page.locator('.viewer').focus();
  await page.keyboard.press('m');
  assert.equal(await page.getByLabel('Shown as').inputValue(), 'difference');
  await assertShown(page, 'the difference', (x, y) => now(x, y).map((v, c) => Math.abs(v - before(x, y)[c])));
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('earlier moments are kept without being asked for', async () => {
  const id = await farm.submitScene(glowingSphere(kWidth, kHeight), {overrides: {spp: 100000}});
  const page = await openCompared(id);
  const choice = page.getByLabel('With', {exact: true});
  const moments = async () => {
    const texts = await choice.locator('option').allTextContents();
    return texts.filter((text) => text.startsWith('Earlier, '));
  };
  await until('three moments', async () => (await moments()).length >= 3);
  // At once: the oldest may give way to a new one at any time.
  const value = await choice.evaluate((select) => {
    select.value = [...select.options].findLast(({text}) => text.startsWith('Earlier, ')).value;
    select.dispatchEvent(new Event('change'));
    return select.value;
  });
  const read = async () => ({
    samples: await page.evaluate(() => window.tessera.viewer.other.job.samples_done),
    values: await readOther(page),
  });
  const first = await read();
  assert.ok(first.values.every(Number.isFinite));
  await until('more samples', async () => (await farm.api(`jobs/${id}`)).samples_done > 16 * first.samples);
  await until('more moments', async () => (await moments()).length >= 4);
  // The one that is shown stays as it is, and the others are bounded.
  assert.equal(await choice.inputValue(), value);
  assert.deepEqual(await read(), first);
  assert.ok((await moments()).length <= 7);
  await farm.api(`jobs/${id}/cancel`, {method: 'POST'});
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a snapshot of one image of several has the samples of that image', async () => {
  const id = await farm.submitScene(glowingSphere(kWidth, kHeight), {frames: [1, 2], overrides: {spp: 256}});
  await until('samples', async () => (await farm.api(`jobs/${id}`)).images[0].samples_done > 0);
  const samples = (await farm.pause(id)).images.map((each) => each.samples_done);
  assert.notEqual(samples[0], samples[1]);
  const page = await openCompared(id);
  await page.getByRole('button', {name: 'Take a snapshot'}).click();
  await page.waitForFunction(() => window.tessera.viewer.other?.at);
  assert.equal(await page.evaluate(() => window.tessera.viewer.other.spp), samples[0] / (kWidth * kHeight));
  await farm.api(`jobs/${id}/cancel`, {method: 'POST'});
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a snapshot is given up when the graphics card loses it', async () => {
  const page = await openCompared(await submitDone(['--spp', '1']));
  const held = [];
  await page.route('**/tiles?*', (route) => held.push(route));
  await page.getByRole('button', {name: 'Take a snapshot'}).click();
  await until('the request for the snapshot', () => held.length > 0);
  await page.evaluate(async () => {
    const {canvas, gl} = window.tessera.viewer;
    const heard = (name) =>
      new Promise((resolve) => {
        canvas.addEventListener(name, resolve, {once: true});
      });
    const extension = gl.getExtension('WEBGL_lose_context');
    const lost = heard('webglcontextlost');
    extension.loseContext();
    await lost;
    const restored = heard('webglcontextrestored');
    setTimeout(() => extension.restoreContext());
    await restored;
  });
  await page.unroute('**/tiles?*');
  await Promise.all(held.map((route) => route.continue().catch(() => {})));
  await page.getByRole('alert').getByText('The snapshot was lost with the view.').waitFor();
  const options = await page.getByLabel('With', {exact: true}).locator('option').allTextContents();
  assert.ok(!options.some((text) => text.startsWith('Snapshot')), options.join());
  assert.deepEqual(page.errors, []);
  await page.context().close();
});
