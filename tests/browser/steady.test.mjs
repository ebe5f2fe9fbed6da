// SPDX-License-Identifier: Apache-2.0
// While a job renders nothing on the page moves by itself, and nothing is fetched from elsewhere.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {kDesktop, kPhone, open, withFarm} from './page.mjs';

let farm, browser;

withFarm({threads: 1}, (started) => {
  ({farm, browser} = started);
});

const submit = (name, spp) => farm.submit(['--size', '256x256', '--spp', spp, '--name', name]);

// Lists layout shifts in window.shifts, each with what moved: those since window.loadedAt.
function listShifts() {
  window.shifts = [];
  window.loadedAt = Infinity;
  const place = ({x, y, width, height}) => `${width} x ${height} at ${x}, ${y}`;
  const text = ({node, previousRect, currentRect}) =>
    `${node?.className || node?.nodeName} from ${place(previousRect)} to ${place(currentRect)}`;
  new PerformanceObserver((list) => {
    for (const {value, sources, startTime} of list.getEntries())
      if (startTime > window.loadedAt) window.shifts.push({value, moved: sources.map(text)});
  }).observe({type: 'layout-shift'});
}

async function openSteady(hash, viewport, isLoaded) {
  const page = await open(browser, farm.url + hash, {viewport, init: listShifts});
  await isLoaded(page);
  await page.getByText('Live', {exact: true}).waitFor();
  await page.evaluate(() => {
    window.loadedAt = performance.now();
  });
  return page;
}

async function assertSteady(page, what) {
  assert.deepEqual(await page.evaluate(() => window.shifts), [], what);
  // The list can have some.
  await page.evaluate(() => {
    document.querySelector('.header').style.marginTop = '50px';
  });
  await page.waitForFunction(() => window.shifts.length > 0);
  assert.deepEqual(page.errors, []);
  await page.context().close();
}

for (const [device, viewport] of Object.entries({desktop: kDesktop, phone: kPhone})) {
  test(`nothing moves while a job renders, ${device}`, async () => {
    const name = `steady on a ${device}`;
    const id = await submit(name, '100000');
    const pages = await Promise.all([
      openSteady('#/', viewport, async (page) => {
        await page.getByRole('link', {name}).waitFor();
        await page.locator('.workers .state', {hasText: 'working'}).waitFor();
        await page.locator('.progress-text', {hasText: /[1-9]/}).first().waitFor();
        await page.waitForFunction(() => document.querySelector('.figure-number').textContent !== '0');
      }),
      openSteady(`#/jobs/${id}`, viewport, async (page) => {
        await page.waitForFunction(() => window.tessera?.isComplete);
        // Also an image without samples is complete.
        await page.waitForFunction(() => {
          const shown = document.querySelector('.side').textContent;
          return /Time left[<\d]/.test(shown) && /Rays\d/.test(shown);
        });
      }),
    ]);
    const [farmPage, jobPage] = pages;
    // Ten changes of what is shown.
    for (let i = 0; i < 10; ++i) {
      for (const [page, selector] of [
        [farmPage, '.figure-number'],
        [jobPage, '.facts'],
      ]) {
        const before = await page.locator(selector).first().textContent();
        await page.waitForFunction(
          ([at, old]) => document.querySelector(at).textContent !== old,
          [selector, before],
        );
      }
    }
    await assertSteady(farmPage, 'the farm');
    await assertSteady(jobPage, 'the job');
    await farm.api(`jobs/${id}`, {method: 'DELETE'});
  });
}

test('nothing is fetched from elsewhere', async () => {
  const id = await submit('at home', '16');
  const page = await open(browser, farm.url);
  await page.getByRole('link', {name: 'at home'}).click();
  await page.waitForFunction(() => window.tessera);
  await farm.waitForState(id, 'done');
  for (const heading of ['Compare', 'Settings', 'Events', 'Files'])
    await page.getByRole('heading', {name: heading}).click();
  await page.getByLabel('Colour the tiles by').selectOption('noise');
  await page.keyboard.press('?');
  await page.getByRole('dialog', {name: 'Keyboard shortcuts'}).waitFor();
  await page.keyboard.press('Escape');
  await page.keyboard.press('n');
  await page.getByRole('heading', {name: 'Submit a scene'}).waitFor();
  await page.keyboard.press('g');
  await page.waitForFunction(() => document.querySelector('.thumb img')?.naturalWidth > 0);
  const own = new URL(farm.url).origin;
  const origins = new Set(page.requests.map((address) => new URL(address).origin));
  assert.ok(page.requests.length > 40, `only ${page.requests.length} requests were seen`);
  assert.deepEqual([...origins], [own]);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});
