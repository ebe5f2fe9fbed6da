// SPDX-License-Identifier: Apache-2.0
// An image of 16,384 x 16,384 pixels: only what is seen is fetched, at the scale at which it is seen. With
// LARGE_IMAGE=whole it is rendered to its end, which takes a minute, for the figures of docs/scaling.md.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {glowingSphere, until} from './farm.mjs';
import {openJob, withFarm} from './page.mjs';

const kSide = 16384;
const kTilePixels = 64 * 64;
const kIsWhole = process.env.LARGE_IMAGE === 'whole';
let farm, browser, id, tiles;

withFarm({}, async (started) => {
  ({farm, browser} = started);
  const scene = glowingSphere(kSide, kSide);
  scene.render.spp = 1;
  id = await farm.submitScene(scene);
  if (kIsWhole) {
    await farm.waitForState(id, 'done', 600000);
  } else {
    const enough = async () => (await farm.api(`jobs/${id}`)).samples_done > 2000 * kTilePixels;
    await until('some tiles', enough);
    await farm.pause(id);
  }
  tiles = (await farm.api(`jobs/${id}`)).samples_done / kTilePixels;
});

// Opens the job in a page that counts the bytes of its tile streams as it reads them, received().bytes, and the
// pixels of which it asks for every tile, received().pixels.
async function openCounted() {
  const start = performance.now();
  const page = await openJob(browser, farm, id);
  await page.addInitScript(() => {
    window.received = {bytes: 0, pixels: 0};
    const count = (chunk, controller) => {
      window.received.bytes += chunk.length;
      controller.enqueue(chunk);
    };
    const note = ({searchParams}) => {
      const [x0, y0, x1, y1] = searchParams.get('region').split(',').map(Number);
      if (searchParams.get('since') === '0') window.received.pixels += (x1 - x0) * (y1 - y0);
    };
    const fetch = window.fetch.bind(window);
    window.fetch = async (resource, options) => {
      const answer = await fetch(resource, options);
      const address = new URL(resource, document.baseURI);
      if (!address.pathname.endsWith('/tiles')) return answer;
      note(address);
      return new Response(answer.body.pipeThrough(new TransformStream({transform: count})), answer);
    };
  });
  await page.reload();
  return {page, start, received: () => page.evaluate(() => window.received)};
}

// The tiles that the page has at a level.
const tilesThere = (page, level) =>
  page.evaluate((wanted) => {
    const pages = [...window.tessera.viewer.source.store.pages.values()];
    return pages.filter((each) => each.level === wanted).reduce((sum, each) => sum + each.tiles.size, 0);
  }, level);

const complete = (page) => page.waitForFunction(() => window.tessera?.isComplete, null, {timeout: 120000});

// Moves the view to a place, and returns what it took to see all of it: {ms, bytes, pixels}.
async function look(counted, view) {
  const before = await counted.received();
  const start = performance.now();
  await counted.page.evaluate((to) => window.tessera.setView(to), view);
  await complete(counted.page);
  const after = await counted.received();
  return {
    ms: Math.round(performance.now() - start),
    bytes: after.bytes - before.bytes,
    pixels: after.pixels - before.pixels,
  };
}

// The time between frames while the view moves by 20 pixels in each: the median and the longest, in ms.
const panFrames = (page) =>
  page.evaluate(async () => {
    const {viewer} = window.tessera;
    const frame = () =>
      new Promise((resolve) => {
        requestAnimationFrame(resolve);
      });
    const times = [];
    let last = await frame();
    for (let i = 0; i < 90; ++i) {
      viewer.viewport.panBy(-20, 0);
      viewer.viewChanged();
      const now = await frame();
      times.push(now - last);
      last = now;
    }
    times.sort((a, b) => a - b);
    return {median: Math.round(times[45]), longest: Math.round(times[89])};
  });

test('a large image is fetched at the scale at which it is seen', async (context) => {
  const counted = await openCounted();
  const {page} = counted;
  const opened = performance.now();
  await page.waitForFunction(() => window.tessera?.viewer.source.store.pages.size > 0);
  const first = Math.round(performance.now() - opened);
  await complete(page);
  const whole = {ms: Math.round(performance.now() - opened), bytes: (await counted.received()).bytes};
  const {level} = await page.evaluate(() => window.tessera.view);
  assert.ok(level >= 4, `level ${level}`);
  const perTile = 6 * (64 >> level) ** 2 + 60;
  assert.ok(whole.bytes < tiles * perTile + 20000, `${whole.bytes} bytes of ${tiles} tiles`);
  assert.ok(whole.bytes > tiles * 6 * (64 >> level) ** 2, `${whole.bytes} bytes of ${tiles} tiles`);
  assert.equal(await tilesThere(page, level), tiles, 'tiles of the whole image');

  const {width, height} = await page.evaluate(() => window.tessera.readCanvas());
  const overview = await page.evaluate(() => {
    const {x, y, zoom} = window.tessera.viewer.viewport;
    return {x, y, zoom};
  });
  const close = await look(counted, {x: kSide / 2, y: height / 2, zoom: 1});
  // An eighth more on each side, whole tiles, and the coarse ones before.
  const seen = (width * 1.25 + 128) * (height * 1.25 + 128);
  assert.ok(close.bytes < 6 * seen * 1.1, `${close.bytes} bytes for ${width} x ${height} pixels`);
  const moved = await look(counted, {x: kSide / 2 + width / 2, y: height / 2, zoom: 1});
  assert.ok(moved.pixels < 0.75 * close.pixels, `${moved.pixels} of ${close.pixels} pixels: half was there`);
  assert.ok(moved.pixels > 0.25 * close.pixels, `${moved.pixels} of ${close.pixels} pixels: half was missing`);

  const frames = await panFrames(page);
  await complete(page);
  const back = await look(counted, overview);
  assert.ok(back.bytes < 20000, `${back.bytes} bytes to see the whole image again`);
  context.diagnostic(JSON.stringify({tiles, level, first, whole, close, moved, frames, back}));
  assert.deepEqual(page.errors, []);
  await page.context().close();
});
