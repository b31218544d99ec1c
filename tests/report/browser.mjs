// Opens a page of `screed report` from disk in a headless Chromium, and notes whatever it complains of.
import puppeteer from 'puppeteer-core';
import { pathToFileURL } from 'node:url';

// For a machine that is busy: a page that hangs ends the test, a slow one does not.
const patience_ms = 600000;

/// The browser; its WebGL is software, so that no graphics card decides.
export function startBrowser() {
  return puppeteer.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    headless: true,
    protocolTimeout: patience_ms,
    // A page behind another goes on as well.
    args: ['--disable-backgrounding-occluded-windows', '--disable-renderer-backgrounding',
      '--disable-background-timer-throttling', '--no-sandbox', '--disable-dev-shm-usage',
      '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--force-color-profile=srgb'],
  });
}

/// Until `condition` holds in the page. Looks every so often: a browser that is busy may draw no frame, on which it
/// would look otherwise.
export function waitFor(page, condition, ...values) {
  return page.waitForFunction(condition, { timeout: patience_ms, polling: 50 }, ...values);
}

/// { page, complaints }: the page once it stands; complaints grow with console errors, warnings and requests for
/// anything but the file.
export async function openReport(browser, file, { scheme = 'light', width = 1280, height = 900 } = {}) {
  const page = await browser.newPage();
  const complaints = [];
  const url = pathToFileURL(file).href;
  page.on('console', (message) => {
    // What the driver of the software renderer says of its own speed is none of the page's.
    if (['error', 'warn', 'assert'].includes(message.type()) &&
      !message.text().includes('GPU stall')) complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('request', (request) => {
    if (request.url() !== url && !/^(blob|data):/.test(request.url())) complaints.push(`request for ${request.url()}`);
  });
  await page.setViewport({ width, height });
  await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: scheme }]);
  await page.goto(url, { timeout: patience_ms });
  await waitFor(page, () => document.documentElement.dataset.ready === 'yes');
  return { page, complaints };
}
