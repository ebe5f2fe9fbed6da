// SPDX-License-Identifier: Apache-2.0
// screenshots.mjs FOLDER: takes the screenshots of docs/viewing.md, of a farm that renders the example scenes.
import {join} from 'node:path';
import {Farm, sleep, until} from './farm.mjs';
import {kDesktop, kPhone, launch, open, openJob} from './page.mjs';

// [scene, options]: those that this build has not generated are left out.
const kJobs = [
  ['veach_mis', ['--size', '360x240', '--spp', '16', '--name', 'veach_mis, draft']],
  ['cornell', ['--size', '240x240', '--spp', '16', '--label', 'shot=3']],
  ['still_life', ['--size', '960x640', '--spp', '64', '--name', 'still_life, final', '--priority', '5']],
  ['go', ['--size', '832x512', '--spp', '256', '--name', 'go, evening', '--priority', '1']],
  ['menagerie', ['--size', '832x512', '--spp', '256']],
];

async function submitAll(farm) {
  const ids = {};
  for (const [scene, options] of kJobs) {
    const {code, out, err} = await farm.tessera(['submit', scene, ...options]);
    if (code === 0) ids[scene] = out.trim();
    else console.error(`no ${scene}: ${err.trim()}`);
  }
  return ids;
}

async function shoot(folder, name, page) {
  await page.screenshot({path: join(folder, `${name}.png`)});
  await page.context().close();
}

async function takeAll(farm, browser, folder) {
  const ids = await submitAll(farm);
  const main = ids.still_life ?? ids.cornell;
  const isHalfDone = async () => {
    const {samples_done: done, samples_total: total} = await farm.api(`jobs/${main}`);
    return done > total / 2;
  };
  await until('half of the samples', isHalfDone, 1800000);
  const farmPage = await open(browser, farm.url, {viewport: kDesktop});
  const jobPage = await openJob(browser, farm, main, {viewport: kDesktop});
  const phonePage = await openJob(browser, farm, main, {
    viewport: kPhone,
    colorScheme: 'light',
    hasTouch: true,
  });
  await jobPage.getByLabel('Colour the tiles by').selectOption('none');
  await sleep(30000);
  await jobPage.waitForFunction(() => window.tessera.isComplete);
  await shoot(folder, 'farm', farmPage);
  await shoot(folder, 'job', jobPage);
  await shoot(folder, 'phone', phonePage);
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
