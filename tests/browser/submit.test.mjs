// SPDX-License-Identifier: Apache-2.0
// Submitting from the page: a folder, a zip archive, and a scene with mistakes.
import assert from 'node:assert/strict';
import {mkdirSync, readFileSync, readdirSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {test} from 'node:test';
import {kScenes} from './farm.mjs';
import {readExr, writeZip} from './images.mjs';
import {open, withFarm} from './page.mjs';

const kFolder = join(kScenes, 'cornell');
let farm, browser, page;

withFarm({}, (started) => {
  ({farm, browser} = started);
});

async function openSubmit() {
  page = await open(browser, `${farm.url}#/submit`);
  await page.getByRole('heading', {name: 'Submit a scene'}).waitFor();
}

async function submitSmall() {
  await page.getByLabel('Width').fill('64');
  await page.getByLabel('Height').fill('48');
  await page.getByLabel('Samples per pixel').fill('8');
  await page.getByRole('button', {name: 'Submit', exact: true}).click();
}

// The job that the page has opened renders the same bytes as the command line.
async function assertImage() {
  await page.waitForURL(/#\/jobs\//);
  const id = page.url().split('/').at(-1);
  await farm.waitForState(id, 'done');
  const there = readExr(await farm.api(`jobs/${id}/image?format=exr`));
  const file = join(farm.folder, 'here.exr');
  const {code, err} = await farm.tessera([
    'render',
    join(kFolder, 'scene.json'),
    '--size',
    '64x48',
    '--spp',
    '8',
    '-o',
    file,
  ]);
  assert.equal(code, 0, err);
  assert.deepEqual(there, readExr(readFileSync(file)));
  return farm.api(`jobs/${id}`);
}

test('a folder: only what the scene names is sent', async () => {
  await openSubmit();
  await page.locator('input[type=file][webkitdirectory]').setInputFiles(kFolder);
  await page.getByText(/3 files, .* of 4 given/).waitFor();
  await submitSmall();
  const job = await assertImage();
  assert.equal(job.name, 'cornell');
  assert.deepEqual(
    job.files.map((entry) => entry.path),
    ['box.mtl', 'box.obj', 'scene.json'],
  );
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a dropped zip archive', async () => {
  await openSubmit();
  const files = readdirSync(kFolder).map((name) => [`my scene/${name}`, readFileSync(join(kFolder, name))]);
  const zip = writeZip([...files, ['__MACOSX/._scene.json', Buffer.from('x')]]).toString('base64');
  await page.evaluate((base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const transfer = new DataTransfer();
    transfer.items.add(new File([bytes], 'scene.zip'));
    document.dispatchEvent(new DragEvent('drop', {dataTransfer: transfer, bubbles: true, cancelable: true}));
  }, zip);
  await page.getByText(/3 files/).waitFor();
  await submitSmall();
  assert.equal((await assertImage()).name, 'my scene');
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('mistakes are shown as in the terminal', async () => {
  const scene = readFileSync(join(kFolder, 'scene.json'), 'utf8').replace('"reflectance"', '"reflectence"');
  const folder = join(farm.folder, 'wrong');
  mkdirSync(folder);
  writeFileSync(join(folder, 'scene.json'), scene);
  for (const name of ['box.obj', 'box.mtl'])
    writeFileSync(join(folder, name), readFileSync(join(kFolder, name)));
  const {err} = await farm.tessera(['submit', join(folder, 'scene.json')]);
  const expected = err.trim().replaceAll(`${folder}/`, '');
  assert.match(expected, /reflectence/);
  await openSubmit();
  await page.locator('input[type=file][webkitdirectory]').setInputFiles(folder);
  await page.getByRole('button', {name: 'Submit', exact: true}).click();
  const shown = page.locator('.terminal');
  await shown.filter({hasText: 'reflectence'}).waitFor();
  assert.equal((await shown.textContent()).trim(), expected);
  await page.context().close();
});
