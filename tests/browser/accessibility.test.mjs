// SPDX-License-Identifier: Apache-2.0
// axe finds nothing on any view, on desktops and phones, dark and light; and nothing is wider than a phone.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {glowingSphere} from './farm.mjs';
import {axe, kDesktop, kSmallPhone, open, withFarm} from './page.mjs';

let farm, browser, animation, done, failed, running;

withFarm({threads: 1}, async (started) => {
  ({farm, browser} = started);
  done = await farm.submit(['--size', '64x64', '--spp', '4', '--name', 'done']);
  await farm.waitForState(done, 'done');
  animation = await farm.submitScene(glowingSphere(64, 64), {frames: [1, 2]});
  await farm.waitForState(animation, 'done');
  running = await farm.submit(['--size', '256x256', '--spp', '100000', '--name', 'running']);
  failed = await farm.submit(['--size', '64x64', '--spp', '4', '--name', 'cancelled']);
  await farm.api(`jobs/${failed}/cancel`, {
    method: 'POST',
    body: '{}',
    headers: {'Content-Type': 'application/json'},
  });
});

const kViews = {
  farm: [() => '#/', async (page) => page.getByRole('link', {name: 'running'}).waitFor()],
  job: [
    () => `#/jobs/${running}`,
    async (page) => {
      await page.waitForFunction(() => window.tessera);
      for (const heading of ['Compare', 'Settings', 'Events', 'Files'])
        await page.getByRole('heading', {name: heading}).click();
      await page.getByLabel('Colour the tiles by').selectOption('samples');
      await page.getByLabel('False colour').check();
    },
  ],
  animation: [
    () => `#/jobs/${animation}`,
    async (page) => page.getByLabel('Image', {exact: true}).waitFor(),
  ],
  finished: [() => `#/jobs/${done}`, async (page) => page.waitForFunction(() => window.tessera)],
  submit: [() => '#/submit', async (page) => page.getByRole('heading', {name: 'Submit a scene'}).waitFor()],
  unknown: [() => '#/jobs/0123', async (page) => page.getByText('There is no job with this id').waitFor()],
};

for (const [device, viewport] of Object.entries({desktop: kDesktop, phone: kSmallPhone})) {
  for (const colorScheme of ['dark', 'light']) {
    for (const [name, [hash, prepare]] of Object.entries(kViews)) {
      test(`${name}, ${device}, ${colorScheme}`, async () => {
        const page = await open(browser, farm.url + hash(), {
          viewport,
          colorScheme,
          hasTouch: device === 'phone',
        });
        await prepare(page);
        assert.deepEqual(await axe(page), []);
        const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        assert.ok(overflow <= 0, `wider than the screen by ${overflow} px`);
        assert.deepEqual(page.errors, []);
        await page.context().close();
      });
    }
  }
}
