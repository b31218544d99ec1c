// build.mjs OUT: the page of `screed report` as one file: page.html with style.css and the bundled scripts in it.
//
// Run in a folder that holds this folder's files and node_modules (report.mk). The data of a run takes the place of the
// mark that page.html has for it.
import { build } from 'esbuild';
import { readFile, writeFile } from 'node:fs/promises';

const out = process.argv[2];
const result = await build({
  entryPoints: ['src/main.js'],
  bundle: true,
  minify: true,
  format: 'iife',
  target: ['chrome103', 'firefox113', 'safari16.4'], // the first with DecompressionStream
  charset: 'ascii',
  legalComments: 'inline',
  write: false,
});
// The licences of what is bundled stay with it.
const licences = await Promise.all(
  ['three', 'uplot'].map(async (name) => `${name}: ${await readFile(`node_modules/${name}/LICENSE`, 'utf8')}`),
);
const script = result.outputFiles[0].text.replaceAll('</script', '<\\/script');
const style = (await readFile('node_modules/uplot/dist/uPlot.min.css', 'utf8')) + (await readFile('style.css', 'utf8'));
const page = (await readFile('page.html', 'utf8'))
  .replace('/* style */', () => style)
  .replace('/* script */', () => `/*!\n${licences.join('\n').replaceAll('*/', '* /')}*/\n${script}`);
await writeFile(out, page);
