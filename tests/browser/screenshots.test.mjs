// SPDX-License-Identifier: Apache-2.0
// The screenshots of the documents show the page as it is: screenshots.mjs keeps the page's headings and
// names in them.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {join} from 'node:path';
import {test} from 'node:test';
import {isDeepStrictEqual} from 'node:util';
import {until} from './farm.mjs';
import {textOf} from './images.mjs';
import {kDesktop, kPhone, labelsOf, open, openJob, withFarm} from './page.mjs';

let farm, browser, id;

withFarm({threads: 1}, async (started) => {
  ({farm, browser} = started);
  id = await farm.submit(['--size', '256x256', '--spp', '100000']);
});

async function openFarm() {
  const page = await open(browser, farm.url);
  await page.locator('.progress-text', {hasText: /[1-9]/}).first().waitFor();
  await page.getByRole('columnheader', {name: 'Cache'}).waitFor();
  return page;
}

for (const [name, show] of Object.entries({
  farm: openFarm,
  job: () => openJob(browser, farm, id, {viewport: kDesktop}),
  phone: () => openJob(browser, farm, id, {viewport: kPhone, hasTouch: true}),
})) {
  test(`docs/images/page/${name}.png shows the page as it is`, async () => {
    const page = await show();
    const file = join(process.env.TESSERA_SOURCE_DIR, 'docs', 'images', 'page', `${name}.png`);
    const kept = JSON.parse(textOf(readFileSync(file), 'Labels'));
    // Some panels wait for their data.
    const isSame = async () => isDeepStrictEqual(await labelsOf(page), kept);
    await until('the labels of the screenshot', isSame, 10000).catch(() => {});
    assert.deepEqual(await labelsOf(page), kept, 'take them anew: node screenshots.mjs docs/images/page');
    await page.context().close();
  });
}
