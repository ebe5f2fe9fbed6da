// SPDX-License-Identifier: Apache-2.0
// The farm's view: what is shown of jobs and workers, and what can be done with them.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {glowingSphere, until} from './farm.mjs';
import {open, withFarm} from './page.mjs';
import {quarantineWorker} from './wrong_worker.mjs';

const kHostile = '<img src=x onerror="window.hacked=1"><b>bold</b>&amp;';
let farm, browser, page;

withFarm({threads: 1}, async (started) => {
  ({farm, browser} = started);
  page = await open(browser, farm.url);
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

const names = () => page.locator('.jobs a.job-name').allTextContents();
const areNamed = (...wanted) =>
  until(`the jobs ${wanted}`, async () => JSON.stringify(await names()) === JSON.stringify(wanted));

test('the tables are sorted and filtered', async () => {
  for (const [name, priority, end] of [
    ['sorted a', '1', 'pause'],
    ['sorted b', '3', 'pause'],
    ['sorted c', '2', 'cancel'],
  ]) {
    const options = ['--size', '64x64', '--spp', '100000', '--name', name, '--priority', priority];
    const id = await farm.submit(options);
    await farm.api(`jobs/${id}/${end}`, {method: 'POST'});
  }
  await page.getByRole('searchbox').fill('sorted');
  // Unfinished ones first, in the order in which they are served.
  await areNamed('sorted b', 'sorted a', 'sorted c');
  const heading = (name) => page.locator('.jobs').getByRole('columnheader', {name, exact: true});
  const sortBy = async (name, order) => {
    await heading(name).getByRole('button').click();
    assert.equal(await heading(name).getAttribute('aria-sort'), order);
  };
  await sortBy('Job', 'ascending');
  await areNamed('sorted a', 'sorted b', 'sorted c');
  await sortBy('Job', 'descending');
  await areNamed('sorted c', 'sorted b', 'sorted a');
  await sortBy('Priority', 'ascending');
  await areNamed('sorted b', 'sorted c', 'sorted a');
  await sortBy('State', 'ascending');
  await areNamed('sorted b', 'sorted a', 'sorted c');
  await sortBy('State', 'descending');
  await areNamed('sorted c', 'sorted b', 'sorted a');
  await sortBy('State', null);
  await areNamed('sorted b', 'sorted a', 'sorted c');

  const chip = (name) => page.getByRole('group', {name: 'Filter by state'}).getByRole('button', {name});
  const {jobs} = await farm.api('jobs');
  const cancelled = jobs.filter((job) => job.state === 'cancelled').length;
  await chip(`Cancelled ${cancelled}`).click();
  await areNamed('sorted c');
  assert.match(page.url(), /show=cancelled/);
  await page.reload();
  await areNamed('sorted c');
  assert.equal(await page.getByRole('searchbox').inputValue(), 'sorted');
  assert.equal(await chip('Cancelled').getAttribute('aria-pressed'), 'true');
  await chip('Active').click();
  await areNamed('sorted b', 'sorted a');
  await chip('Done').click();
  await page.getByText('No job matches.').waitFor();
  await chip('All').click();
  await page.getByRole('searchbox').fill('');
  await isState('first', /running|queued/);
});

test('a worker is released from quarantine', async () => {
  const id = await quarantineWorker(farm, 'wrong');
  const worker = page.getByRole('row').filter({hasText: 'wrong'});
  await worker.locator('.state', {hasText: 'quarantined'}).waitFor();
  await page.getByRole('button', {name: 'Release… wrong'}).click();
  await page.getByText('3 of its results in a row were rejected').last().waitFor();
  await page.getByRole('button', {name: 'Keep as it is'}).click();
  assert.equal((await farm.api('quarantine')).entries.length, 1);
  await page.getByRole('button', {name: 'Release… wrong'}).click();
  await page.getByRole('button', {name: 'Release', exact: true}).click();
  await page.getByText('Released wrong').waitFor();
  assert.deepEqual((await farm.api('quarantine')).entries, []);
  const {workers} = await farm.api(`workers?prefix=${id}`);
  assert.notEqual(workers[0]?.state, 'quarantined');
  await page.getByRole('button', {name: 'Release… wrong'}).waitFor({state: 'detached'});
});

// The heights of a plot's points, from 0 to 32; none before the page is built.
const plot = (label) =>
  page.evaluate((text) => {
    const figures = [...document.querySelectorAll('.figure')];
    const figure = figures.find((each) => each.querySelector('h2').textContent === text);
    if (!figure) return [];
    const points = figure.querySelector('.plot-line').getAttribute('d').slice(1).split('L');
    return points.map((point) => 35 - Number(point.split(' ')[1]));
  }, label);

test('the plots follow the activity', async () => {
  const {jobs} = await farm.api('jobs?state=running');
  await until('a plot of jobs', async () => {
    const heights = await plot('Current jobs');
    return heights.length > 2 && heights.at(-1) > 0;
  });
  const change = (verb) => Promise.all(jobs.map(({id}) => farm.api(`jobs/${id}/${verb}`, {method: 'POST'})));
  await change('pause');
  for (const label of ['Current jobs', 'Samples/s', 'Busy workers'])
    await until(`${label} at the base line`, async () => (await plot(label)).at(-1) === 0);
  assert.ok((await plot('Current jobs')).some((height) => height === 32), 'the past stays');
  await until('a sample of the pause', async () => (await farm.api('activity')).samples.at(-1)[2] === 0);
  const {length} = await plot('Busy workers');
  await change('resume');
  for (const label of ['Current jobs', 'Samples/s', 'Busy workers'])
    await until(`${label} above the base line`, async () => (await plot(label)).at(-1) > 0);
  await until('another point', async () => (await plot('Busy workers')).length > length);

  // A page that is opened later has the past.
  const past = await plot('Current jobs');
  const shown = page;
  page = await open(browser, farm.url);
  // By itself it would have one point in this time.
  await until('the past', async () => (await plot('Current jobs')).length >= past.length, 9000);
  assert.ok((await plot('Current jobs')).some((height) => height === 0), 'all jobs were paused');
  await page.context().close();
  page = shown;
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

test('older jobs are offered while there are any', async () => {
  const {jobs} = await farm.api('jobs');
  const button = page.getByRole('button', {name: 'Show older jobs'});
  const figure = page.locator('.figure', {hasText: 'Current jobs'});
  const current = jobs.filter(({state}) => state === 'running').length;
  await figure.locator('.figure-number', {hasText: new RegExp(`^${current}$`)}).waitFor();
  assert.equal(await button.isVisible(), false);
  // The list in pages of two jobs.
  await page.route(/\/api\/v1\/jobs\?/, (route) => {
    const address = new URL(route.request().url());
    address.searchParams.set('page_size', '2');
    return route.continue({url: address.href});
  });
  await page.reload();
  await button.click();
  await until('all jobs', async () => (await names()).length === jobs.length);
  await button.waitFor({state: 'hidden'});
  await page.unroute(/\/api\/v1\/jobs\?/);
});

test('a restart of the coordinator is survived', async () => {
  const {jobs} = await farm.api('jobs');
  await farm.killCoordinator();
  await page.getByText('Reconnecting…').waitFor();
  await farm.startCoordinator();
  await page.getByText('Live', {exact: true}).waitFor();
  await longJob('after the restart');
  await row('after the restart').waitFor();
  // Also those that had ended, of which the coordinator's events tell nothing.
  await until('all jobs', async () => (await names()).length === jobs.length + 1);
  assert.equal(await page.getByRole('button', {name: 'Show older jobs'}).isVisible(), false);
  await page.locator('.workers .state', {hasText: 'working'}).waitFor();
  assert.equal(await page.getByRole('row', {name: 'worker-1'}).count(), 1);
  assert.deepEqual(page.errors, []);
});

test('a failed job says why', async () => {
  const scene = glowingSphere(64, 64);
  scene.shapes[0].material = 'glw';
  await farm.waitForState(await farm.submitScene(scene, {name: 'with a mistake'}), 'failed');
  await row('with a mistake').getByRole('link').click();
  await page.getByLabel('Failure').getByText("did you mean 'glow'?").waitFor();
  await page.getByText('The job failed before there was an image.').waitFor();
  await page.getByRole('link', {name: 'All jobs'}).click();
});

test('a page of the list that comes late changes nothing', async () => {
  const [job] = (await farm.api('jobs')).jobs;
  const listed = await page.evaluate(async (like) => {
    const {store} = await import(new URL('assets/store.js', document.baseURI));
    store.disconnect();
    const {fetch} = window;
    const answers = [];
    window.fetch = () =>
      new Promise((resolve) => {
        answers.push((ids, next_page_token) => {
          const jobs = ids.map((id) => ({...like, id}));
          resolve(new Response(JSON.stringify({jobs, next_page_token})));
        });
      });
    store.apply('reset');
    store.apply('reset');
    store.apply('removed', {jobs: ['removed']});
    const [late, newest] = answers;
    newest(['newest', 'removed'], '');
    late(['late'], 'more');
    await new Promise((resolve) => {
      setTimeout(resolve, 200);
    });
    window.fetch = fetch;
    return {jobs: [...store.jobs.keys()], hasOlder: store.hasOlderJobs};
  }, job);
  assert.deepEqual(listed, {jobs: ['newest'], hasOlder: false});
});
