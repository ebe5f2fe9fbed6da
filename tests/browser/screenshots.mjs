// SPDX-License-Identifier: Apache-2.0
// screenshots.mjs FOLDER: takes the screenshots of docs/viewing.md, of a farm that renders the example
// scenes, which takes a quarter of an hour.
import {writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {Farm, until} from './farm.mjs';
import {withText} from './images.mjs';
import {kDesktop, kPhone, labelsOf, launch, open, openJob} from './page.mjs';

// [scene, options]: those that this build has not generated are left out. The first ones are done before the
// others are submitted.
const kFirst = 2;
const kJobs = [
  ['veach_mis', ['--size', '360x240', '--spp', '64', '--name', 'veach_mis, draft']],
  ['cornell', ['--size', '240x240', '--spp', '64', '--label', 'shot=3']],
  [
    'still_life',
    '--size 720x480 --spp 256 --clamp-indirect 2 --priority 5 --name'.split(' ').concat('still_life, final'),
  ],
  ['go', ['--size', '832x512', '--spp', '256', '--name', 'go, evening', '--priority', '1']],
  ['menagerie', ['--size', '832x512', '--spp', '256']],
];

async function submitAll(farm) {
  const ids = {};
  for (const [i, [scene, options]] of kJobs.entries()) {
    if (i === kFirst) for (const id of Object.values(ids)) await farm.waitForState(id, 'done');
    const {code, out, err} = await farm.tessera(['submit', scene, ...options]);
    if (code === 0) ids[scene] = out.trim();
    else console.error(`no ${scene}: ${err.trim()}`);
  }
  return ids;
}

// With the labels of the page, for screenshots.test.mjs.
async function shoot(folder, name, page) {
  const png = withText(await page.screenshot(), 'Labels', JSON.stringify(await labelsOf(page)));
  writeFileSync(join(folder, `${name}.png`), png);
  await page.context().close();
}

async function takeAll(farm, browser, folder) {
  const farmPage = await open(browser, farm.url, {viewport: kDesktop});
  const ids = await submitAll(farm);
  const main = ids.still_life ?? ids.cornell;
  // Without visible noise, and still running.
  const isNearlyDone = async () => {
    const {samples_done: done, samples_total: total} = await farm.api(`jobs/${main}`);
    return done > 0.94 * total;
  };
  await until('nearly all samples', isNearlyDone, 7200000);
  const jobPage = await openJob(browser, farm, main, {viewport: kDesktop});
  const phonePage = await openJob(browser, farm, main, {
    viewport: kPhone,
    colorScheme: 'light',
    hasTouch: true,
  });
  for (const page of [jobPage, phonePage]) {
    await page.waitForFunction(() => window.tessera.isComplete);
    await page.getByRole('heading', {name: 'Files'}).waitFor();
  }
  await shoot(folder, 'job', jobPage);
  await shoot(folder, 'phone', phonePage);
  await shoot(folder, 'farm', farmPage);
}

const [folder] = process.argv.slice(2);
if (!folder) throw new Error('usage: screenshots.mjs FOLDER');
const farm = await Farm.start({workers: 2, threads: 1});
const browser = await launch();
try {
  await takeAll(farm, browser, folder);
} finally {
  await browser.close();
  await farm.close();
}
