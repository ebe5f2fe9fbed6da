// SPDX-License-Identifier: Apache-2.0
// A farm with tokens: login, roles, and what the cookie is.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {axe, open, withFarm} from './page.mjs';

const kTokens = [
  'submit alice alice-has-this-token',
  'watch vera vera-may-only-look-here',
  'submit bob bob-has-this-token-too',
  'work farm workers-have-this-token shared',
  'admin root root-has-this-token-as-well',
];
let farm, browser, id;

withFarm({tokens: kTokens, threads: 1}, async (started) => {
  ({farm, browser} = started);
  id = await farm.submit(['--size', '256x256', '--spp', '100000', '--name', 'of alice'], {token: 'alice'});
});

async function logIn(name, hash = '') {
  const page = await open(browser, farm.url + hash);
  await page.getByLabel('Token').fill(farm.token(name));
  await page.getByRole('button', {name: 'Log in'}).click();
  await page.getByText(`${name} (`).waitFor();
  return page;
}

test('nothing is shown without a token, and a wrong one is refused', async () => {
  const page = await open(browser, farm.url);
  await page.getByLabel('Token').fill('certainly-not-a-known-token');
  await page.getByRole('button', {name: 'Log in'}).click();
  await page.getByText('This token is not known').waitFor();
  assert.equal(await page.getByText('of alice').count(), 0);
  assert.deepEqual(await axe(page), []);
  await page.context().close();
});

test('the token is in no place that scripts can read', async () => {
  const page = await logIn('alice');
  const [cookie] = await page.context().cookies();
  assert.deepEqual([cookie.name, cookie.httpOnly, cookie.sameSite], ['tessera_session', true, 'Strict']);
  assert.equal(await page.evaluate(() => document.cookie), '');
  assert.ok(!JSON.stringify(await page.context().storageState()).includes(farm.token('alice')));
  await page.reload();
  await page.getByRole('link', {name: 'of alice'}).waitFor();
  await page.getByRole('button', {name: 'Log out'}).click();
  await page.getByLabel('Token').waitFor();
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

test('a user cannot change the jobs of others, and is told why', async () => {
  const page = await logIn('bob', `#/jobs/${id}`);
  const pause = page.getByRole('button', {name: 'Pause'});
  await pause.waitFor();
  assert.equal(await pause.getAttribute('aria-disabled'), 'true');
  assert.match(await pause.getAttribute('title'), /Only alice and administrators/);
  await pause.click({force: true});
  await page.getByText('Only alice and administrators').waitFor();
  // Also not by a request of its own.
  const status = await page.evaluate(
    async (job) =>
      (await fetch(`api/v1/jobs/${job}/pause`, {method: 'POST', headers: {'X-Tessera': '1'}})).status,
    id,
  );
  assert.equal(status, 403);
  const job = await farm.api(`jobs/${id}`, {headers: {Authorization: `Bearer ${farm.token('alice')}`}});
  assert.equal(job.state, 'running');
  await page.goto(`${farm.url}#/`);
  const drain = page.getByRole('button', {name: 'Drain worker-1'});
  await drain.waitFor();
  assert.match(await drain.getAttribute('title'), /administrators/);
  await page.context().close();
});

test('a viewer sees everything and can do nothing', async () => {
  const page = await logIn('vera', `#/jobs/${id}`);
  const pause = page.getByRole('button', {name: 'Pause'});
  await pause.waitFor();
  assert.equal(await pause.getAttribute('aria-disabled'), 'true');
  assert.match(await pause.getAttribute('title'), /role of vera \(watch\) does not allow changes/);
  const status = await page.evaluate(
    async (job) =>
      (await fetch(`api/v1/jobs/${job}/pause`, {method: 'POST', headers: {'X-Tessera': '1'}})).status,
    id,
  );
  assert.equal(status, 403);
  await page.context().close();
});

test('the owner and an administrator can', async () => {
  const owner = await logIn('alice', `#/jobs/${id}`);
  await owner.getByRole('button', {name: 'Pause'}).click();
  await owner.locator('.job-title .state', {hasText: 'paused'}).waitFor();
  const admin = await logIn('root', `#/jobs/${id}`);
  await admin.getByRole('button', {name: 'Resume'}).click();
  await owner.locator('.job-title .state', {hasText: 'running'}).waitFor();
  await owner.context().close();
  await admin.context().close();
});

test('a session outlives a restart of the coordinator', async () => {
  const page = await logIn('vera', `#/jobs/${id}`);
  await farm.killCoordinator();
  await page.getByText('Reconnecting…').waitFor();
  await farm.startCoordinator();
  await page.getByText('Live', {exact: true}).waitFor();
  await page.getByText('vera (').waitFor();
  assert.deepEqual(await page.getByLabel('Token').count(), 0);
  await page.context().close();
});
