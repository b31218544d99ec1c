// Shows what the file holds. Each kind of page is a function of the facts, by its name.
import { showCampaign } from './campaign_page.js';
import { facts } from './data.js';
import { element } from './elements.js';
import { showRun } from './run_page.js';

const kinds = { run: showRun, campaign: showCampaign };

async function show() {
  const all = facts();
  document.title = `${all.title} \u2013 Screed report`;
  const page = document.getElementById('page');
  await kinds[all.kind](page, all);
  // For whoever waits for the page: it stands.
  document.documentElement.dataset.ready = 'yes';
}

show().catch((error) => {
  document.getElementById('page').append(
    element('p', { class: 'warning' }, `This page cannot be shown: ${error.message}`));
  throw error;
});
