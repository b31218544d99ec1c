// pictures.mjs PAGE PREFIX: PREFIX_light_start.png and so on: the page of a run at both ends of its slider, for eyes.
import { openReport, startBrowser } from './browser.mjs';

const [file, prefix] = process.argv.slice(2);
const browser = await startBrowser();
for (const scheme of ['light', 'dark']) {
  const { page, complaints } = await openReport(browser, file, { scheme });
  for (const end of ['start', 'end']) {
    await page.$eval('input[type=range]', (input, last) => {
      input.value = last ? input.max : 0;
      input.dispatchEvent(new Event('input'));
    }, end === 'end');
    await page.screenshot({ path: `${prefix}_${scheme}_${end}.png`, fullPage: true });
  }
  for (const text of complaints) console.error(`${scheme}: ${text}`);
}
await browser.close();
