import { chromium } from 'playwright-core';
const [url, out] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox','--enable-unsafe-swiftshader'] });
const page = await browser.newPage({ viewport: { width: 1280, height: 820 } });
page.on('console', m => console.log('console:', m.text().slice(0, 300)));
page.on('pageerror', e => console.log('error:', e.message.slice(0, 500)));
const t0 = Date.now();
await page.goto(url);
try {
await page.waitForFunction(() => ['ready','running'].includes(document.body.dataset.state), null, { timeout: 60000 });
console.log('ready', Date.now() - t0);
await page.waitForSelector('iframe.shown', { timeout: 60000 });
console.log('shown', Date.now() - t0);
await page.waitForTimeout(2500);
} catch (e) { console.log(String(e).slice(0,300)); console.log(await page.evaluate(() => document.body.dataset.state + ' ' + document.getElementById('state').textContent)); }
await page.screenshot({ path: out });
await browser.close();
