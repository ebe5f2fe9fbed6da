// SPDX-License-Identifier: Apache-2.0
// Nothing on the page moves by itself, from its first frame on and whatever becomes of a job and of the
// coordinator, and nothing is fetched from elsewhere.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {kDesktop, kPhone, open, withFarm} from './page.mjs';

let farm, browser;

withFarm({threads: 1}, (started) => {
  ({farm, browser} = started);
});

const submit = (name, spp) => farm.submit(['--size', '256x256', '--spp', spp, '--name', name]);

// Lists layout shifts in window.shifts, each with what moved.
function listShifts() {
  window.shifts = [];
  const place = ({x, y, width, height}) => `${width} x ${height} at ${x}, ${y}`;
  const text = ({node, previousRect, currentRect}) =>
    `${node?.className || node?.nodeName} from ${place(previousRect)} to ${place(currentRect)}`;
  new PerformanceObserver((list) => {
    for (const {value, sources, startTime} of list.getEntries())
      window.shifts.push({at: Math.round(startTime), value, moved: sources.map(text)});
  }).observe({type: 'layout-shift', buffered: true});
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

// Ten changes of what is shown.
async function seeChanges(page, selector) {
  for (let i = 0; i < 10; ++i) {
    const before = await page.locator(selector).first().textContent();
    await page.waitForFunction(
      ([at, old]) => document.querySelector(at).textContent !== old,
      [selector, before],
    );
  }
}

for (const [device, viewport] of Object.entries({desktop: kDesktop, phone: kPhone})) {
  test(`nothing moves by itself, ${device}`, async () => {
    await farm.waitForState(await submit(`done on a ${device}`, '1'), 'done');
    const id = await submit(`steady on a ${device}`, '100000');
    const pages = await Promise.all(
      ['#/', `#/jobs/${id}`].map((hash) => open(browser, farm.url + hash, {viewport, init: listShifts})),
    );
    const [farmPage, jobPage] = pages;
    const all = (see) => Promise.all(pages.map(see));
    const isState = (state) => all((page) => page.locator('.state', {hasText: state}).first().waitFor());
    const change = (verb, body = {}) =>
      farm.api(`jobs/${id}/${verb}`, {
        method: 'POST',
        body: JSON.stringify(body),
        headers: {'Content-Type': 'application/json'},
      });

    await seeChanges(farmPage, '.figure-number');
    await seeChanges(jobPage, '.facts');
    await change('pause');
    await isState('paused');
    await change('resume');
    await isState('running');
    await farm.killCoordinator();
    await all((page) => page.getByText('Reconnecting…').waitFor());
    await farm.startCoordinator();
    await all((page) => page.getByText('Live', {exact: true}).waitFor());
    await isState('running');
    await seeChanges(jobPage, '.facts');
    await change('extend', {spp: 200000});
    await change('cancel');
    await isState('cancelled');
    await assertSteady(farmPage, 'the farm');
    await assertSteady(jobPage, 'the job');
    await farm.api(`jobs/${id}`, {method: 'DELETE'});
  });
}

test('what is known late moves nothing', async () => {
  const id = await submit('known late', '100000');
  const page = await open(browser, farm.url, {init: listShifts});
  await page.getByRole('link', {name: 'known late'}).waitFor();
  const details = new RegExp(`/api/v1/jobs/${id}$`);
  const seeWithout = async () => {
    await page.locator('.facts').first().waitFor({state: 'attached'});
    await seeChanges(page, '.facts');
  };
  let seen = null; // the page may ask more than once
  await page.route(details, async (route) => {
    seen ??= seeWithout();
    await seen;
    await route.continue();
  });
  await page.evaluate((hash) => (location.hash = hash), `#/jobs/${id}`);
  await page.getByRole('heading', {name: 'Files'}).waitFor();
  await page.unrouteAll({behavior: 'wait'});
  await assertSteady(page, 'the job');
  await farm.api(`jobs/${id}`, {method: 'DELETE'});
});

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
