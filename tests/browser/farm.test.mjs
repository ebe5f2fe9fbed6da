// SPDX-License-Identifier: Apache-2.0
// The farm's view: what is shown of jobs and workers, and what can be done with them.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {Farm, until} from './farm.mjs';
import {launch, open} from './page.mjs';

const kHostile = '<img src=x onerror="window.hacked=1"><b>bold</b>&amp;';
let farm, browser, page;

before(async () => {
  farm = await Farm.start({threads: 1});
  browser = await launch();
  page = await open(browser, farm.url);
});
after(async () => {
  await browser?.close();
  await farm?.close();
});

const row = (name) => page.getByRole('row').filter({has: page.getByRole('link', {name, exact: true})});
const isState = (name, state) => row(name).locator('.state', {hasText: state}).waitFor();
const stateOf = async (id) => (await farm.api(`jobs/${id}`)).state;
const longJob = (name) => farm.submit(['--size', '256x256', '--spp', '100000', '--name', name]);

test('jobs and workers appear by themselves, and progress', async () => {
  await longJob('first');
  await isState('first', 'running');
  await page.getByRole('row', {name: 'worker-1'}).waitFor();
  await page.locator('.progress-text', {hasText: /[1-9]/}).first().waitFor();
  await page.waitForFunction(() => document.querySelector('.thumb img')?.naturalWidth > 0);
});

test('a hostile name stays text', async () => {
  await longJob(kHostile);
  await row(kHostile).waitFor();
  await row(kHostile).getByRole('link').click();
  await page.getByRole('heading', {level: 1, name: kHostile}).waitFor();
  assert.equal(await page.evaluate(() => window.hacked), undefined);
  assert.equal(await page.locator('main b, main img[src="x"]').count(), 0);
  await page.getByRole('link', {name: 'All jobs'}).click();
});

test('pausing pauses, and can be undone', async () => {
  const id = await longJob('to pause');
  await isState('to pause', /running|queued/);
  await row('to pause').getByRole('button', {name: 'Pause to pause'}).click();
  await isState('to pause', 'paused');
  assert.equal(await stateOf(id), 'paused');
  await page.getByRole('button', {name: 'Undo'}).click();
  await isState('to pause', /running|queued/);
  assert.equal(await stateOf(id), 'running');
});

test('the menu sets the priority and extends', async () => {
  const id = await longJob('to change');
  const choose = async (item, value, accept) => {
    await row('to change').getByRole('button', {name: 'Actions for to change'}).click();
    await page.getByRole('menuitem', {name: item}).click();
    await page.getByRole('spinbutton').fill(value);
    await page.getByRole('button', {name: accept, exact: true}).click();
  };
  await choose('Priority…', '7', 'Set the priority');
  await until('the priority is set', async () => (await farm.api(`jobs/${id}`)).priority === 7);
  await choose('Extend…', '200000', 'Extend');
  await until('the job is extended', async () => (await farm.api(`jobs/${id}`)).spp === 200000);
});

test('several jobs are cancelled and deleted together, after a question', async () => {
  const ids = [await longJob('one of two'), await longJob('two of two')];
  await page.getByRole('searchbox').fill('of two');
  await page.waitForFunction(() => document.querySelectorAll('.jobs tbody tr').length === 2);
  await page.getByRole('checkbox', {name: 'Select all shown jobs'}).check();
  const bulk = page.getByRole('toolbar');
  await bulk.getByRole('button', {name: 'Cancel…'}).click();
  await page.getByRole('button', {name: 'Keep as it is'}).click();
  assert.deepEqual(await Promise.all(ids.map(stateOf)), ['running', 'running']);
  await bulk.getByRole('button', {name: 'Cancel…'}).click();
  await page.getByRole('button', {name: 'Cancel the jobs'}).click();
  for (const id of ids) await farm.waitForState(id, 'cancelled');
  await bulk.getByRole('button', {name: 'Delete…'}).click();
  await page.getByRole('button', {name: 'Delete', exact: true}).click();
  await page.getByText('No job matches.').waitFor();
  for (const id of ids) await assert.rejects(stateOf(id), /404/);
  await page.getByRole('searchbox').fill('');
});

test('a worker drains, and takes leases again', async () => {
  await page.getByRole('button', {name: 'Drain worker-1'}).click();
  await page.locator('.workers .state', {hasText: /draining|drained/}).waitFor();
  await page.getByRole('button', {name: 'Undo drain worker-1'}).click();
  await page.locator('.workers .state', {hasText: /working|idle/}).waitFor();
});

test('the keyboard reaches everything', async () => {
  await page.locator('body').press('/');
  assert.ok(await page.getByRole('searchbox').evaluate((element) => element === document.activeElement));
  await page.getByRole('searchbox').press('Tab');
  await page.locator('h1').press('j');
  await page.keyboard.press('x');
  await page.getByText('1 selected').waitFor();
  await page.keyboard.press('?');
  await page.getByRole('dialog', {name: 'Keyboard shortcuts'}).waitFor();
  await page.keyboard.press('Escape');
  await page.keyboard.press('n');
  await page.getByRole('heading', {name: 'Submit a scene'}).waitFor();
  await page.keyboard.press('g');
  await page.getByRole('heading', {name: 'Jobs', exact: true}).waitFor();
  assert.deepEqual(page.errors, []);
});
