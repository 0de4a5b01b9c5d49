// node walk.mjs CHROMIUM PACKAGES PAGE FOLDER: a first model from an empty page; pictures go into FOLDER.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [executablePath, packages, folder, pictures] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(join(packages, 'playwright-core/index.mjs')));
const browser = await chromium.launch({
  executablePath,
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const address = pathToFileURL(join(folder, 'index.html')).href;
const faults = [];

async function open(width, hash, colorScheme) {
  const page = await browser.newPage({ viewport: { width, height: 800 }, colorScheme });
  page.setDefaultTimeout(120_000);
  page.on('pageerror', error => faults.push(error.message));
  page.on('request', request => /^(file|data|blob|about):/.test(request.url()) || faults.push(request.url()));
  await page.goto(address + hash);
  return page;
}
const picture = (page, name) => page.screenshot({ path: join(pictures, `${name}.png`) });
const text = page => page.evaluate(() => self.playground.editor.text());
const ran = (page, title) => page.waitForFunction(title => document.title.startsWith(title) && document.querySelector('iframe.shown'), title);

const page = await open(1280, '#model=new', 'light');
await page.waitForSelector('body[data-state=ready]');
await picture(page, '1-empty');
await page.click('.cm-content');
await page.keyboard.type('model Swing "a mass on a spring"\nparam', { delay: 20 });
await page.waitForSelector('.cm-tooltip-autocomplete li[aria-selected]');
await page.waitForSelector('#faults .error');
await picture(page, '2-completion');
await page.keyboard.press('Enter');
await page.keyboard.type(' Mass m = 1 [kg];\nparameter Real[N/m] k = 20 [N/m];\ncoordinate Length x(start = 0.2 [mm]);\n');
await page.keyboard.type('body block = Particle(mass = mm, at = {x, 0, 0});\npotential spring = 1/2*k*x^2;\nend Swing;');
await page.keyboard.press('Escape');
await page.waitForSelector('#faults .fix');
await picture(page, '3-fix');
await page.click('#faults .fix');
await ran(page, 'Swing');
assert.match(await text(page), /mass = m,/);
assert.equal((await text(page)).split('\n')[1], '  parameter Mass m = 1 [kg];'); // indented as it was typed
assert.equal(await page.locator('#faults > *').count(), 0);
assert.match(await page.locator('#formulas annotation').first().textContent(), /\\ddot\{x\}/);
await picture(page, '4-motion');

// A slider changes the run, the link carries it.
const summary = await page.textContent('#summary');
await page.locator('#sliders input').nth(1).fill('900');
await page.waitForFunction(before => document.getElementById('summary').textContent !== before, summary);
await page.click('#share');
await page.waitForFunction(() => location.hash.includes('p.k=36'));
const link = await page.evaluate(() => location.hash);
const phone = await open(390, link, 'dark');
await ran(phone, 'Swing');
assert.equal(await text(phone), await text(page));
assert.equal(await phone.locator('#sliders output').nth(1).textContent(), '36');
for (const part of ['model', 'motion', 'equations']) {
  await phone.click(`nav [data-part=${part}]`);
  await phone.waitForTimeout(700);
  await picture(phone, `5-phone-${part}`);
  assert.ok(await phone.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
}

// Stop ends a run, and the next one begins in a new worker.
await page.evaluate(() => {
  const { editor } = self.playground;
  editor.write(editor.text().replace('end Swing', '  scene long\n    simulate(stop = 1e7 [s]);\n  end long;\nend Swing'));
  document.getElementById('run').click(); // before it runs by itself
});
await page.waitForSelector('body[data-state=running]');
await page.click('#run');
await page.waitForFunction(() => document.getElementById('summary').textContent === 'Stopped.');
await page.evaluate(() => self.playground.editor.write(self.MODELS['classic/four_bar']));
await page.click('#run'); // once Python has begun again
await ran(page, 'FourBar');
await picture(page, '6-again');
assert.deepEqual(faults, []);
await browser.close();
console.log('ok');
