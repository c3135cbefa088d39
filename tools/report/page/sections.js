// The parts of the page that are text and tables.

import {h, table} from './dom.js';
import {interval, number, percent, signed, signedInterval} from './format.js';
import {knows, marked, shapeOf} from './privilege.js';
import {agentScales} from './theme.js';

const verdicts = {
  supported: {text: 'Supported', mark: '✓'},
  contradicted: {text: 'Contradicted', mark: '✗'},
  undecided: {text: 'Cannot decide', mark: '?'},
  'not-applicable': {text: 'Does not apply', mark: '–'},
};

export function verdictBadge(verdict) {
  const {text, mark} = verdicts[verdict];
  return h('span', {class: `verdict ${verdict}`}, h('span', {'aria-hidden': 'true'}, mark), ` ${text}`);
}

export function agentName(data, name, theme) {
  const scale = agentScales(data, theme, [name]);
  const look = `swatch ${shapeOf(data, name)}`;
  return h('span', {class: 'agent'}, h('span', {class: look, style: `color:${scale.colour.range[0]}`}), marked(data, name));
}

export function missingSection(data) {
  if (data.missing.length === 0) return null;
  return h('section', {class: 'notice', id: 'missing'},
    h('h2', {}, 'This run is not finished'),
    h('p', {}, 'Everything below counts what is stored so far. Missing:'),
    h('ul', {}, data.missing.map((line) => h('li', {}, line))));
}

export function selectionRemark(data) {
  const counts = data.conditions.filter((condition) => condition.views.selected)
    .map((condition) => `${condition.label}: ${condition.views.selected.trials} of ${condition.views.all.trials}`);
  return h('div', {class: 'notice', id: 'selection'},
    h('p', {}, h('strong', {}, 'Selected trials only. '),
      `Shown are the trials in which ${data.learner} beat constant-120, the rule that every published trial satisfies. `,
      'Keeping trials by their outcome lifts the mean of whoever had to win, and of everyone who does well on the same worlds: ',
      'these numbers describe the trials that were kept, not what a UAV can expect. Intervals do not repair that. Use them only beside the published values.'),
    h('p', {class: 'soft'}, `Kept: ${counts.join('; ')}.`));
}

export function summaryTable(data, condition, context) {
  const view = condition.views[context.view];
  const metric = ({name, title, decimals}) => ({
    title, number: true, text: ({metrics}) => (metrics[name] === null ? 'unknown' : number(metrics[name], decimals)),
  });
  const gain = (agent) => agent.gain && agent.name !== 'min-height';
  return table([
    {title: 'Agent', header: true, text: (agent) => agentName(data, agent.name, context.theme)},
    {title: 'Knows', text: (agent) => knows(data, agent.name)},
    {title: 'Trials', number: true, text: (agent) => String(agent.trials)},
    {title: `Mean (${condition.qos_unit})`, number: true, text: (agent) => number(agent.mean)},
    {title: '95 % interval', number: true, text: (agent) => interval(agent.ci95)},
    {title: 'Median', number: true, text: (agent) => number(agent.median)},
    {title: 'Interquartile mean', number: true, text: (agent) => number(agent.iqm) + (agent.iqm_ci95 ? ` (${interval(agent.iqm_ci95)})` : '')},
    ...data.metrics.map(metric),
    {title: 'Gain over min-height', number: true, text: (agent) => (gain(agent) ? signed(agent.gain.mean) : '–')},
    {title: '95 % interval', number: true, text: (agent) => (gain(agent) ? signedInterval(agent.gain.ci95) : '–')},
    {title: 'Better in', number: true, text: (agent) => (gain(agent) ? percent(agent.gain.probability_of_improvement) : '–')},
    {title: 'Head-room closed', number: true, text: (agent) => (gain(agent) && agent.headroom_share !== null ? percent(agent.headroom_share) : '–')},
  ], view.agents, `${condition.label}, ${view.trials} trials`);
}

export function publishedTable(data, context) {
  const rows = data.published.rows.filter((row) => row.views[context.view]);
  if (rows.length === 0) return h('p', {class: 'soft'}, 'Nothing in this report has a published value to compare with.');
  const ours = (row) => row.views[context.view];
  const verdicts = {agrees: 'agrees', disagrees: 'disagrees', undecided: 'cannot tell', 'not-applicable': 'does not apply'};
  const decimals = (row) => (row.unit === '' ? 2 : 1);
  return table([
    {title: 'Condition', header: true, text: (row) => row.label},
    {title: 'Agent', text: (row) => agentName(data, row.agent, context.theme)},
    {title: 'Knows', text: (row) => knows(data, row.agent)},
    {title: 'Quantity', text: (row) => (row.unit ? `${row.quantity} (${row.unit})` : row.quantity)},
    {title: 'Published', number: true, text: (row) => number(row.published, decimals(row)) + (row.plus_minus ? ` ± ${row.plus_minus}` : '')},
    {title: 'Ours', number: true, text: (row) => number(ours(row).value, 2)},
    {title: '95 % interval', number: true, text: (row) => interval(ours(row).ci95)},
    {title: 'Difference', number: true, text: (row) => (ours(row).value === null ? '–' : signed(ours(row).value - row.published))},
    {title: 'Verdict', long: true, text: (row) => verdicts[ours(row).verdict] + (ours(row).reason ? `: ${ours(row).reason}` : '')},
  ], rows, 'Published values beside ours');
}

/** The parts of this report that cannot be compared with the paper, and why. */
export function leftOutList(data, context) {
  const lines = data.published.left_out[context.view];
  if (lines.length === 0) return null;
  return h('details', {open: lines.length <= 6}, h('summary', {}, `Not compared (${lines.length})`), h('ul', {}, lines.map((line) => h('li', {}, line))));
}

export function claimsList(data, context) {
  const claims = data.claims[context.view];
  return h('ol', {class: 'claims'}, claims.map((claim) => h('li', {},
    h('p', {class: 'claim'}, verdictBadge(claim.verdict), ' ', h('q', {}, claim.text)),
    h('p', {class: 'soft'}, claim.reading),
    h('p', {}, claim.reason),
    claim.details.length === 0 ? null : h('details', {}, h('summary', {}, `Comparisons (${claim.details.length})`),
      h('ul', {}, claim.details.map((detail) => h('li', {}, detail)))))));
}
