// node test/check.mjs CHROMIUM SHOTS PAGE...: opens each page without a network, at 1280 and 390 px, light and
// dark.  No message, no request, no sideways scrolling, something drawn.  Puts a picture of each into SHOTS.
import { chromium } from 'playwright-core';
import { basename, resolve } from 'node:path';

const [executablePath, shots, ...pages] = process.argv.slice(2);
const GL = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
const DRIVER = /GPU stall|software WebGL|GL Driver/; // messages about the machine
const LEAST_COLORS = 8; // of a picture in which something is drawn
const MODES = [1280, 390].flatMap(width => ['light', 'dark'].map(colorScheme => ({ width, colorScheme })));

/** The number of colours that the canvas shows. */
function colors() {
  const small = document.createElement('canvas');
  small.width = small.height = 64;
  const pen = small.getContext('2d');
  pen.drawImage(document.querySelector('.stage canvas'), 0, 0, 64, 64);
  return new Set(new Uint32Array(pen.getImageData(0, 0, 64, 64).data.buffer)).size;
}

/** Open a page in one mode and return what is wrong with it. */
async function problemsOf(browser, path, { width, colorScheme }) {
  const phone = width < 760;
  const viewport = { width, height: phone ? 844 : 760 };
  const context = await browser.newContext({ viewport, colorScheme, offline: true, reducedMotion: 'reduce' });
  const page = await context.newPage();
  const problems = [];
  page.on('console', m => !DRIVER.test(m.text()) && problems.push(`says: ${m.text()}`));
  page.on('pageerror', e => problems.push(String(e)));
  page.on('request', r => /^(file|blob|data):/.test(r.url()) || problems.push(`asks for ${r.url()}`));
  await page.goto(`file://${resolve(path)}`);
  await page.waitForFunction(() => window.lagcAnimation?.stats.frames > 0, null, { timeout: 60000 });
  await page.evaluate(() => lagcAnimation.seek(0.4 * lagcAnimation.end));
  await page.waitForTimeout(300);
  await page.screenshot({ path: `${shots}/${basename(path, '.html')}_${width}_${colorScheme}.png` });
  if (await page.evaluate(() => document.documentElement.scrollWidth > innerWidth + 1))
    problems.push('scrolls sideways');
  if (await page.evaluate(() => window.hacked)) problems.push('a text of the model ran');
  const drawn = await page.evaluate(colors);
  const bodies = await page.evaluate(
    () => JSON.parse(document.getElementById('data').textContent).bodies.length,
  );
  if (bodies && drawn < LEAST_COLORS) problems.push(`nothing is drawn (${drawn} colours)`);
  await context.close();
  return problems;
}

const browser = await chromium.launch({ executablePath, args: GL });
let failed = 0;
for (const path of pages) {
  for (const mode of MODES) {
    const problems = await problemsOf(browser, path, mode);
    failed += problems.length;
    console.log(`${basename(path)} ${mode.width} ${mode.colorScheme}: ${problems.join(' | ') || 'ok'}`);
  }
}
await browser.close();
process.exit(failed ? 1 : 0);
