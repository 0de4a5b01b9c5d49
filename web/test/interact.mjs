// node test/interact.mjs CHROMIUM PAGE FOLDER: keyboard, slider, plots, hiding, following, themes, a notebook's
// frame, a browser without WebGL.  Prints a line for each check.
import { chromium } from 'playwright-core';
import { readFileSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';

const [executablePath, path, folder] = process.argv.slice(2);
const GL = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
const url = `file://${resolve(path)}`;
const problems = [];
function check(what, ok) {
  console.log(`${ok ? 'ok  ' : 'FAIL'} ${what}`);
  if (!ok) problems.push(what);
}

const browser = await chromium.launch({ executablePath, args: GL });
const context = await browser.newContext({
  viewport: { width: 1280, height: 760 },
  offline: true,
  reducedMotion: 'reduce',
});
const page = await context.newPage();
page.on('pageerror', e => problems.push(String(e)));
await page.goto(url);
await page.waitForFunction(() => window.lagcAnimation?.stats.frames > 1, null, { timeout: 60000 });
const ask = job => page.evaluate(job);
const t = () => ask(() => lagcAnimation.state.t);
const playing = () => ask(() => lagcAnimation.state.playing);
const end = await ask(() => lagcAnimation.end);
const press = key => page.keyboard.press(key);

async function keyboard() {
  check('with reduced motion it does not start by itself', !(await playing()));
  await press('Space');
  await page.waitForTimeout(600);
  check('space plays', (await playing()) && (await t()) > 0);
  await press('Space');
  check('space pauses', !(await playing()));
  await press('Home');
  check('home', (await t()) === 0);
  await press('ArrowRight');
  const one = await t();
  check('right: one frame', one > 0);
  await press('Shift+ArrowRight');
  check('shift right: ten', Math.abs((await t()) - 11 * one) < 1e-6);
  await press('End');
  check('end', (await t()) === end);
  await press('Home');
}

async function events() {
  if (!(await ask(() => !!document.querySelector('.events')))) return;
  await press('e');
  check('e: the next event', (await t()) > 0);
  await ask(() => lagcAnimation.seek(lagcAnimation.state.t + 0.08 * lagcAnimation.state.speed));
  await page.waitForTimeout(400);
  check('an impact flashes', await ask(() => lagcAnimation.stage.flashes.some(f => f.visible)));
}

async function pointer() {
  await page.locator('input[type=range]').fill('5000');
  check('the slider seeks', Math.abs((await t()) / end - 0.5) < 1e-3);
  check(
    'the slider has a text',
    /s$/.test(await page.locator('input[type=range]').getAttribute('aria-valuetext')),
  );
  const box = await page.locator('.u-over').first().boundingBox();
  await page.mouse.click(box.x + box.width * 0.25, box.y + 20);
  await page.waitForTimeout(300);
  check('a click in a plot seeks', Math.abs((await t()) / end - 0.25) < 0.02);
  const now = await page.locator('.now').first().boundingBox();
  check('the cursor stands there', Math.abs(now.x - box.x - box.width * 0.25) < 4);
  const item = page.locator('button.item').first();
  await item.click();
  check('the legend hides a body', await ask(() => lagcAnimation.stage.hidden.size === 1));
  await item.click();
  await page.selectOption('select[title="follow a body"]', '0');
  await page.waitForTimeout(200);
  check('follow', await ask(() => lagcAnimation.stage.followed === 0));
}

async function looks() {
  const theme = () => ask(() => document.documentElement.dataset.theme);
  const first = await theme();
  await page.locator('canvas').first().focus();
  await press('d');
  check('dark and light', first !== (await theme()));
  const camera = () =>
    ask(() =>
      lagcAnimation.stage.camera.position
        .toArray()
        .map(x => x.toFixed(3))
        .join(),
    );
  const before = await camera();
  const box = await page.locator('.stage canvas').first().boundingBox();
  await page.mouse.move(box.x + 300, box.y + 200);
  await page.mouse.down();
  await page.mouse.move(box.x + 380, box.y + 240, { steps: 6 });
  await page.mouse.up();
  await page.waitForTimeout(400);
  const planar = await ask(() => lagcAnimation.stage.planar);
  check('the camera turns in space', planar || before !== (await camera()));
  const nameless = await ask(() => {
    const controls = [...document.querySelectorAll('button,select,input,canvas[role]')];
    return controls.filter(e => !(e.textContent || e.title || e.getAttribute('aria-label'))).length;
  });
  check('every control has a name', nameless === 0);
  const idle = await ask(async () => {
    lagcAnimation.play(false);
    await new Promise(done => setTimeout(done, 600));
    const before = lagcAnimation.stats.frames;
    await new Promise(done => setTimeout(done, 600));
    return lagcAnimation.stats.frames - before;
  });
  check('paused, nothing is drawn', idle <= 1);
}

/** In a notebook the page is the `srcdoc` of a frame that may run scripts and nothing else. */
async function notebook() {
  const text = readFileSync(path, 'utf8').replace(/&/g, '&amp;').replace(/"/g, '&quot;');
  const outer = `${folder}/notebook.html`;
  writeFileSync(
    outer,
    `<!doctype html><body><iframe sandbox="allow-scripts allow-downloads" style="width:100%;height:560px" srcdoc="${text}"></iframe>`,
  );
  const opened = await context.newPage();
  opened.on('pageerror', e => problems.push(String(e)));
  await opened.goto(`file://${resolve(outer)}`);
  await opened.waitForTimeout(500);
  const frame = opened.frames()[1];
  await frame.waitForFunction(() => window.lagcAnimation?.stats.frames > 0, null, { timeout: 60000 });
  check('it works in a sandboxed frame', true);
}

async function withoutWebGL() {
  const bare = await chromium.launch({
    executablePath,
    args: ['--no-sandbox', '--disable-gpu', '--disable-3d-apis'],
  });
  const poor = await bare.newPage();
  poor.on('pageerror', e => problems.push(String(e)));
  await poor.goto(url);
  await poor.waitForFunction(() => document.querySelectorAll('.uplot').length > 0, null, { timeout: 60000 });
  check('without WebGL: a note, and plots', /no WebGL/.test(await poor.locator('.note').textContent()));
  await bare.close();
}

for (const part of [keyboard, events, pointer, looks, notebook, withoutWebGL]) await part();
await browser.close();
process.exit(problems.length ? 1 : 0);
