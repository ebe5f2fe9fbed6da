// SPDX-License-Identifier: Apache-2.0
// The live image: the graphics card holds the halves of the EXR file, and the canvas has the colours of the
// PNG file.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {existsSync, mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {glowingSphere, kCornell, startView, until} from './farm.mjs';
import {largestDifference, nearestHalf, readExr, readPng, readTileStream} from './images.mjs';
import {open, openJob, readColours, showPixels, withFarm} from './page.mjs';

const kWidth = 150;
const kHeight = 100;
let farm, browser;

withFarm({}, (started) => {
  ({farm, browser} = started);
});

const readPixels = (page) =>
  page.evaluate(([w, h]) => window.tessera.readPixels(0, 0, w, h), [kWidth, kHeight]);

// What the graphics card should hold: the halves of the EXR file, and null in tiles without samples.
async function expectedHalves(id, image, layer) {
  const exr = readExr(await farm.api(`jobs/${id}/image?format=exr&image=${image}&layer=${layer}`));
  assert.deepEqual([exr.width, exr.height], [kWidth, kHeight]);
  const {columns, tile_width, tile_height, tiles} = await farm.api(`jobs/${id}/map?image=${image}`);
  return Array.from(exr.halves, (half, i) => {
    const [x, y] = [Math.floor(i / 3) % kWidth, Math.floor(i / 3 / kWidth)];
    const [samples] = tiles[Math.floor(y / tile_height) * columns + Math.floor(x / tile_width)];
    return samples > 0 ? half : null;
  });
}

async function assertHalves(page, expected) {
  // The last tiles may be under way.
  await until(
    'the tiles of the last samples',
    async () => (await readPixels(page)).every((half, i) => half === expected[i]),
    20000,
  ).catch(() => {});
  const pixels = await readPixels(page);
  assert.deepEqual(pixels, expected);
  return pixels;
}

const assertHalvesOfExr = async (page, id, image = 0, layer = '') =>
  assertHalves(page, await expectedHalves(id, image, layer));

test('each image of a job with several', async () => {
  const id = await farm.submitScene(glowingSphere(kWidth, kHeight), {frames: [10, 12, 7]});
  await farm.waitForState(id, 'done');
  const page = await openJob(browser, farm, id);
  const chooser = page.getByLabel('Image', {exact: true});
  await until('the list of images', async () => (await chooser.locator('option').count()) === 3);
  await page.getByRole('option', {name: 'Frame 12', exact: true}).waitFor({state: 'attached'});
  assert.deepEqual(await chooser.locator('option').allTextContents(), ['Frame 10', 'Frame 12', 'Frame 7']);
  const asked = page.waitForRequest((request) => /tiles\?.*image=2/.test(request.url()));
  await chooser.selectOption('2');
  await asked;
  assert.match(page.url(), /\?image=2$/);
  await showPixels(page, kWidth, kHeight);
  await assertHalvesOfExr(page, id, 2);
  await page.locator('.viewer').focus();
  await page.keyboard.press('i');
  assert.equal(await chooser.inputValue(), '0', 'after the last one comes the first');
  await page.keyboard.press('i');
  assert.match(page.url(), /\?image=1$/);
  await page.reload();
  await page.waitForFunction(() => window.tessera);
  assert.equal(await chooser.inputValue(), '1');
  await showPixels(page, kWidth, kHeight);
  await assertHalvesOfExr(page, id, 1);
  await page.getByRole('button', {name: 'Download the image'}).click();
  const link = page.getByRole('menuitem', {name: 'OpenEXR, linear'});
  assert.match(await link.getAttribute('href'), /image=1/);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('each layer of a job', async () => {
  const id = await farm.submit(['--size', `${kWidth}x${kHeight}`, '--spp', '4', '--layers', 'albedo,depth']);
  await farm.waitForState(id, 'done');
  const page = await openJob(browser, farm, id);
  const chooser = page.getByLabel('Layer', {exact: true});
  assert.deepEqual(await chooser.locator('option').allTextContents(), ['Beauty', 'Albedo', 'Depth']);
  const asked = page.waitForRequest((request) => /tiles\?.*layer=albedo/.test(request.url()));
  await chooser.selectOption('albedo');
  await asked;
  await showPixels(page, kWidth, kHeight);
  await assertHalvesOfExr(page, id, 0, 'albedo');
  await page.locator('.viewer').focus();
  await page.keyboard.press('l');
  assert.equal(await chooser.inputValue(), 'depth');
  await page.keyboard.press('Shift+ArrowRight');
  const {layer} = await farm.api(`jobs/${id}/pixel?x=${kWidth / 2 + 1}&y=${kHeight / 2}&layer=depth`);
  assert.deepEqual(layer.channels, ['Depth.Z']);
  await page.waitForFunction(() => /Z .*4 samples/.test(document.querySelector('.readout-text').textContent));
  await page.keyboard.press('l');
  assert.equal(await chooser.inputValue(), '', 'after the last one comes the beauty');
  await showPixels(page, kWidth, kHeight);
  await assertHalvesOfExr(page, id);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('the image of a local render', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'tessera-view-'));
  const size = `${kWidth}x${kHeight}`;
  const file = join(folder, 'a.exr');
  const view = await startView([kCornell, '-o', file, '--size', size, '--spp', '2']);
  const page = await open(browser, view.url);
  await page.waitForFunction(() => window.tessera);
  await showPixels(page, kWidth, kHeight);
  // Written when the last sample is there, while the page stays.
  await until('the EXR file', () => existsSync(file));
  const {halves} = readExr(readFileSync(file));
  await assertHalves(page, Array.from(halves));
  assert.deepEqual(page.errors, []);
  await page.context().close();
  await view.close();
  rmSync(folder, {recursive: true, force: true});
});

test('halves are rounded to the nearest', () => {
  assert.deepEqual(
    [0, 1, 65504, 1e9, 2 ** -24, 2 ** -25, 1.00048828125, 1.00146484375, -2].map(nearestHalf),
    [0, 0x3c00, 0x7bff, 0x7bff, 1, 0, 0x3c00, 0x3c02, 0xc000],
  );
});

test('the halves of the tile stream, while the job renders', async () => {
  const id = await farm.submit(['--size', `${kWidth}x${kHeight}`, '--spp', '100000']);
  const page = await openJob(browser, farm, id);
  await showPixels(page, kWidth, kHeight);
  const sent = new Map(); // the halves of each state of each tile that this test was sent
  const stop = new AbortController();
  const note = (tile, halves) => sent.set(`${tile.x0},${tile.y0} revision ${tile.revision}`, halves);
  const address = `${farm.url}api/v1/jobs/${id}/tiles?since=0&level=0`;
  const reading = readTileStream(address, stop.signal, note).catch((error) => error);
  // The states that the page has now, each with what the graphics card holds of it.
  const held = () =>
    page.evaluate(
      ([width, height]) =>
        Array.from(window.tessera.viewer.source.store.pages.get('0/0/0').tiles, ([corner, tile]) => {
          const [x, y] = corner.split(',').map(Number);
          const halves = window.tessera.readPixels(x, y, Math.min(x + 64, width), Math.min(y + 64, height));
          return {key: `${corner} revision ${tile.revision}`, level: tile.level, halves};
        }),
      [kWidth, kHeight],
    );
  // Both are sent the newest state of a tile when they are ready for it, so most states are known to both.
  const compared = new Set();
  await until('twelve states that both were sent', async () => {
    for (const {key, level, halves} of await held()) {
      if (level !== 0 || !sent.has(key)) continue;
      assert.deepEqual(halves, sent.get(key), key);
      compared.add(key);
    }
    return compared.size >= 12;
  });
  assert.equal((await farm.api(`jobs/${id}`)).state, 'running');
  stop.abort();
  assert.equal((await reading).name, 'AbortError');
  await farm.api(`jobs/${id}`, {method: 'DELETE'});
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('the halves of the EXR file, before the render is complete', async () => {
  const id = await farm.submit(['--size', `${kWidth}x${kHeight}`, '--spp', '5000']);
  const page = await openJob(browser, farm, id);
  await until('samples', async () => (await farm.api(`jobs/${id}`)).samples_done > 0);
  // Nothing changes while the two are compared.
  await page.getByRole('button', {name: 'Pause'}).click();
  await farm.waitForState(id, 'paused');
  await farm.waitForRest(id);
  await showPixels(page, kWidth, kHeight);
  const paused = await assertHalvesOfExr(page, id);
  assert.ok(paused.some((half) => half > 0));

  await farm.api(`jobs/${id}`, {method: 'DELETE'});
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('the halves of the EXR file and the colours of the PNG file, of a finished image', async () => {
  const id = await farm.submit(['--size', `${kWidth}x${kHeight}`, '--spp', '8']);
  const page = await openJob(browser, farm, id);
  await farm.waitForState(id, 'done');
  await showPixels(page, kWidth, kHeight);
  const pixels = await assertHalvesOfExr(page, id);
  assert.ok(!pixels.includes(null));
  for (const [curve, exposure] of [
    ['none', 0],
    ['aces', 0.5],
    ['agx', -1],
    ['agx', 2.25],
    ['none', 1],
  ])
    await assertColours(page, id, curve, exposure);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

async function assertColours(page, id, curve, exposure) {
  const png = readPng(await farm.api(`jobs/${id}/image?format=png&tone_curve=${curve}&exposure=${exposure}`));
  await page.evaluate(
    ([tone, stops]) => Object.assign(window.tessera.viewer.display, {curve: tone, exposure: stops}),
    [curve, exposure],
  );
  const {rgb} = await readColours(page, kWidth, kHeight);
  const colourAt = (x, y) => [0, 1, 2].map((c) => png.rgb[3 * (y * kWidth + x) + c]);
  const worst = largestDifference(rgb, kWidth, colourAt);
  assert.ok(worst <= 1, `${curve} at ${exposure} stops differs by ${worst}`);
}

test('the value, samples and standard error of a pixel', async () => {
  const id = await farm.submit(['--size', `${kWidth}x${kHeight}`, '--spp', '8']);
  await farm.waitForState(id, 'done');
  const page = await openJob(browser, farm, id);
  await showPixels(page, kWidth, kHeight);
  const viewer = page.getByRole('application');
  await viewer.focus();
  await page.keyboard.press('Shift+ArrowRight');
  const [x, y] = [kWidth / 2 + 1, kHeight / 2];
  const pixel = await farm.api(`jobs/${id}/pixel?x=${x}&y=${y}`);
  const readout = page.locator('.readout-text');
  await page.waitForFunction(() => /8 samples/.test(document.querySelector('.readout-text').textContent));
  const text = await readout.textContent();
  assert.match(text, new RegExp(`x ${x}  y ${y}`));
  assert.ok(text.includes(pixel.value[0].toPrecision(4)), `${text} has ${pixel.value[0]}`);
  assert.match(text, /±/);
  await page.context().close();
});

test('downloads are the files of the API', async () => {
  const id = await farm.submit(['--size', `${kWidth}x${kHeight}`, '--spp', '4', '--name', 'to download']);
  await farm.waitForState(id, 'done');
  const page = await openJob(browser, farm, id);
  await page.getByLabel('Tone curve').selectOption('agx');
  for (const [item, query, ending] of [
    ['OpenEXR, linear', 'format=exr', 'exr'],
    ['PNG, as displayed', 'format=png&tone_curve=agx', 'png'],
  ]) {
    await page.getByRole('button', {name: 'Download the image'}).click();
    const [download] = await Promise.all([
      page.waitForEvent('download'),
      page.getByRole('menuitem', {name: item}).click(),
    ]);
    assert.match(download.suggestedFilename(), new RegExp(`\\.${ending}$`));
    const bytes = readFileSync(await download.path());
    assert.ok(bytes.equals(await farm.api(`jobs/${id}/image?${query}`)), `${item} has other bytes`);
  }
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a restart of the coordinator is survived', async () => {
  const id = await farm.submit(['--size', `${kWidth}x${kHeight}`, '--spp', '100']);
  const page = await openJob(browser, farm, id);
  await until('samples', async () => (await farm.api(`jobs/${id}`)).samples_done > 0);
  await farm.killCoordinator();
  await page.getByText('Reconnecting…').waitFor();
  await farm.startCoordinator();
  await page.getByText('Live', {exact: true}).waitFor();
  await farm.waitForState(id, 'done');
  await page.locator('.job-title .state', {hasText: 'done'}).waitFor();
  await showPixels(page, kWidth, kHeight);
  await assertHalvesOfExr(page, id);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});
