// SPDX-License-Identifier: Apache-2.0
// The page in Chromium. CHROMIUM is the browser's program.
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {after, before} from 'node:test';
import {chromium} from 'playwright-core';
import {Farm} from './farm.mjs';

const require = createRequire(import.meta.url);

export const kDesktop = {width: 1440, height: 900};
export const kPhone = {width: 390, height: 844};
export const kSmallPhone = {width: 360, height: 740};

export async function launch() {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
}

// Starts a farm with these options and a browser before the tests of a file, which `prepare({farm, browser})`
// takes, and ends both after them.
export function withFarm(options, prepare) {
  const started = {farm: null, browser: null};
  before(async () => {
    started.farm = await Farm.start(options);
    started.browser = await launch();
    await prepare(started);
  });
  after(async () => {
    await started.browser?.close();
    await started.farm?.close();
  });
}

// Opens the page; every error on it, and every violation of its content security policy, is in `page.errors`,
// the address of every request in `page.requests`. `init` runs in the browser before the page's own scripts.
export async function open(
  browser,
  url,
  {viewport = kDesktop, colorScheme = 'dark', hasTouch = false, init = null} = {},
) {
  const context = await browser.newContext({viewport, colorScheme, hasTouch});
  const page = await context.newPage();
  page.setDefaultTimeout(60000);
  if (init) await page.addInitScript(init);
  page.errors = [];
  page.requests = [];
  page.on('request', (request) => page.requests.push(request.url()));
  page.on('pageerror', (error) => page.errors.push(String(error.stack ?? error)));
  page.on('console', (message) => {
    if (/Content Security Policy|Refused to/.test(message.text())) page.errors.push(message.text());
  });
  await page.goto(url);
  return page;
}

export async function openJob(browser, farm, id, options) {
  const page = await open(browser, `${farm.url}#/jobs/${id}`, options);
  await page.waitForFunction(() => window.tessera);
  return page;
}

// Shows the image's top left at its own scale, and waits until all of it is there.
export async function showPixels(page, width, height) {
  await page.evaluate(([w, h]) => window.tessera.setView({x: w / 2, y: h / 2, zoom: 1}), [width, height]);
  await page.waitForFunction(() => window.tessera.isComplete);
}

// The array of this type that `read(argument)` returns on the page. By its bytes: Playwright takes seconds
// for the numbers of a whole image.
export async function readArray(page, Type, read, argument) {
  const array = await page.evaluateHandle(read, argument);
  const text = await array.evaluate(({buffer, byteOffset, byteLength}) => {
    const bytes = new Uint8Array(buffer, byteOffset, byteLength);
    let characters = '';
    for (let from = 0; from < bytes.length; from += 0x8000)
      characters += String.fromCharCode(...bytes.subarray(from, from + 0x8000));
    return btoa(characters);
  });
  await array.dispose();
  return new Type(new Uint8Array(Buffer.from(text, 'base64')).buffer);
}

// The colours of the image's pixels as they are on the screen at zoom 1, R, G, B, row by row; and the device
// column of the first one.
export async function readColours(page, width, height) {
  const {originX, scale} = await page.evaluate(() => window.tessera.view);
  if (scale !== 1) throw new Error(`the image is shown at scale ${scale}`);
  const rgb = await readArray(
    page,
    Uint8Array,
    ([columns, rows]) => {
      const {width: canvasWidth, data} = window.tessera.readCanvas();
      const {originX: left, originY: top} = window.tessera.view;
      const colours = new Uint8Array(3 * columns * rows);
      for (let y = 0, to = 0; y < rows; ++y) {
        for (let x = 0; x < columns; ++x, to += 3) {
          const from = 4 * ((y + top) * canvasWidth + x + left);
          colours.set(data.subarray(from, from + 3), to);
        }
      }
      return colours;
    },
    [width, height],
  );
  return {rgb, originX};
}

// The headings and names on the page, which tell whether a screenshot of it is out of date.
export const labelsOf = (page) =>
  page.evaluate(() => {
    const all = [...document.querySelectorAll('nav a, h2, th, label, .chip, .job-actions button')];
    const texts = all.filter((each) => each.checkVisibility()).map((each) => each.textContent.trim());
    return texts.map((text) => text.replace(/ \d+$/, '')).filter(Boolean);
  });

// What axe finds, one line for each.
export async function axe(page) {
  await page.evaluate(readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8'));
  const {violations} = await page.evaluate(() => window.axe.run(document, {resultTypes: ['violations']}));
  return violations.flatMap(({id, nodes}) =>
    nodes.map(({target, failureSummary}) => `${id}: ${target.join(' ')}: ${failureSummary}`),
  );
}
