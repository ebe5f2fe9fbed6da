// SPDX-License-Identifier: Apache-2.0
// Comparing an image with another job's and with an earlier moment: the colours on the screen are those of
// the EXR files.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {Farm} from './farm.mjs';
import {halfValue, largestDifference, linearAt, readExr, srgb} from './images.mjs';
import {launch, openJob, readColours, showPixels} from './page.mjs';

const kWidth = 150;
const kHeight = 100;
let farm, browser;

before(async () => {
  farm = await Farm.start();
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await farm?.close();
});

const exrOf = async (id) => readExr(await farm.api(`jobs/${id}/image?format=exr`));

async function submitDone(options) {
  const id = await farm.submit(['--size', `${kWidth}x${kHeight}`, ...options]);
  await farm.waitForState(id, 'done');
  return id;
}

async function openCompared(id) {
  const page = await openJob(browser, farm, id);
  await showPixels(page, kWidth, kHeight);
  await page.getByLabel('Tone curve').selectOption('none');
  await page.getByRole('heading', {name: 'Compare'}).click();
  return page;
}

// `linear(x, y, isRight)`: what is expected of a pixel; isRight: it is right of the split.
async function assertShown(page, what, linear) {
  const split = await page.evaluate(() => {
    const {comparison, canvas} = window.tessera.viewer;
    return Math.round(comparison.split * canvas.width);
  });
  const {rgb, originX} = await readColours(page, kWidth, kHeight);
  const worst = largestDifference(rgb, kWidth, (x, y) => srgb(linear(x, y, x + originX >= split)));
  assert.ok(worst <= 1, `${what} differs by ${worst}`);
}

test('another job, by slider and by difference', async () => {
  const own = await submitDone(['--spp', '8']);
  const other = await submitDone(['--spp', '2', '--seed', '7', '--name', 'coarse']);
  const [a, b] = [linearAt(await exrOf(own)), linearAt(await exrOf(other))];
  const page = await openCompared(own);
  await page.getByLabel('With', {exact: true}).selectOption(other);
  await page.waitForFunction(() => window.tessera.viewer.other?.isComplete);
  await page.getByText('coarse', {exact: true}).waitFor();
  const bySplit = (x, y, isRight) => (isRight ? b(x, y) : a(x, y));
  await assertShown(page, 'the middle', bySplit);

  const handle = page.getByRole('slider', {name: 'Split between the images'});
  const place = async () => Number(await handle.getAttribute('aria-valuenow'));
  await handle.press('Home');
  assert.equal(await place(), 0);
  await assertShown(page, 'the other', b);
  await handle.press('End');
  assert.equal(await place(), 100);
  await assertShown(page, 'the own', a);
  await handle.press('Home');
  const {x, y, width, height} = await page.locator('.viewer').boundingBox();
  await page.mouse.move(x + 5, y + height / 4);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 + 20, y + height / 4, {steps: 4});
  await page.mouse.up();
  assert.ok((await place()) >= 50, `the handle was dragged to ${await place()} %`);
  await assertShown(page, 'a dragged split', bySplit);

  await page.mouse.move(1, 1);
  await page.getByLabel('Shown as').selectOption('difference');
  const difference = (stops) => (px, py) => {
    const theirs = b(px, py);
    return a(px, py).map((value, c) => Math.abs(value - theirs[c]) * 2 ** stops);
  };
  await assertShown(page, 'the difference', difference(0));
  await page.evaluate(() => Object.assign(window.tessera.viewer.display, {exposure: 3}));
  await assertShown(page, 'the difference, three stops up', difference(3));
  await page.getByLabel('With', {exact: true}).selectOption('');
  await page.evaluate(() => Object.assign(window.tessera.viewer.display, {exposure: 0}));
  await assertShown(page, 'the image alone', a);
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
    body: JSON.stringify({spp: 16}),
    headers: {'Content-Type': 'application/json'},
  });
  await farm.waitForState(id, 'done');
  await page.locator('.job-title .state', {hasText: 'done'}).waitFor();
  const late = await exrOf(id);
  assert.notDeepEqual(early.halves, late.halves);
  // Of the own image, the last tiles may be under way.
  await page.waitForFunction(
    ([width, height, wanted]) => {
      const read = window.tessera.readPixels(0, 0, width, height);
      return wanted.every((half, i) => half === read[i]);
    },
    [kWidth, kHeight, Array.from(late.halves)],
  );
  const kept = await page.evaluate(
    ([width, height]) => Array.from(window.tessera.viewer.other.store.read(0, 0, width, height)),
    [kWidth, kHeight],
  );
  assert.deepEqual(kept, Array.from(early.halves, halfValue));
  const [before, now] = [linearAt(early), linearAt(late)];
  await assertShown(page, 'the snapshot', (x, y, isRight) => (isRight ? before(x, y) : now(x, y)));
  await page.locator('.viewer').focus();
  await page.keyboard.press('m');
  assert.equal(await page.getByLabel('Shown as').inputValue(), 'difference');
  await assertShown(page, 'the difference', (x, y) => now(x, y).map((v, c) => Math.abs(v - before(x, y)[c])));
  assert.deepEqual(page.errors, []);
  await page.context().close();
});
