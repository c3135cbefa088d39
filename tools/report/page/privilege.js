// Agents that know more than the UAV reports have a mark behind the name. Shapes are hollow if the agent sees the future,
// half full (in a lighter colour) if it knows what an operator knows, the site map.

function tierOf(data, name) {
  const agent = data.agents.find((other) => other.name === name);
  return data.privilege_tiers.find((tier) => tier.name === agent?.privilege) ?? data.privilege_tiers[0];
}

export function isPrivileged(data, name) {
  return tierOf(data, name).mark !== '';
}

/** The name as tables and labels show it: "planner **". */
export function marked(data, name) {
  const {mark} = tierOf(data, name);
  return mark === '' ? name : `${name} ${mark}`;
}

/** What an agent knows, in a word or two: the shape of its points says the same. */
export function knows(data, name) {
  return tierOf(data, name).knows;
}

/** An agent's name in a row of a chart's data, with and without its mark. */
export function named(data, name) {
  return {agent: name, shown: marked(data, name)};
}

/** The lines under a chart of these agents that say what their marks mean; a chart of one agent says what that one sees. */
export function tierNote(data, names) {
  const tiers = data.privilege_tiers.filter((tier) => names.some((name) => tierOf(data, name) === tier));
  if (names.length === 1) return [`${marked(data, names[0])} (${knows(data, names[0])}): sees ${tiers[0].sees}`];
  return tiers.filter((tier) => tier.mark !== '').map((tier) => `${tier.mark} ${tier.knows}: sees ${tier.sees}`);
}

/** The label of an axis or a legend of agents, as a Vega expression. */
export function markedLabel(data) {
  const labels = Object.fromEntries(data.agents.map((agent) => [agent.name, marked(data, agent.name)]));
  return `${JSON.stringify(labels)}[datum.label] || datum.label`;
}

/** The agents, those that know more after those that know less. */
export function byKnowledge(data) {
  return data.privilege_tiers.flatMap((tier) => data.agents.filter((agent) => agent.privilege === tier.name));
}

/** 'full', 'half' or 'hollow'. */
export function shapeOf(data, name) {
  return tierOf(data, name).shape;
}

/** Half of one colour and half of another: '#rrggbb'. */
function mixed(one, other) {
  const channel = (at) => Math.round((parseInt(one.slice(at, at + 2), 16) + parseInt(other.slice(at, at + 2), 16)) / 2);
  return '#' + [1, 3, 5].map((at) => channel(at).toString(16).padStart(2, '0')).join('');
}

/** The fills of these agents' shapes: the agent's colour, half of it, or the background. */
export function tierFills(data, {domain, range}, surface, names) {
  const fills = {full: (own) => own, half: (own) => mixed(own, surface.background), hollow: () => surface.background};
  return names.map((name) => fills[shapeOf(data, name)](range[domain.indexOf(name)]));
}

/** The same as an encoding, with the agent's `colour` scale. */
export function tierFill(data, colour, surface) {
  const {domain} = colour.scale;
  return {field: 'agent', type: 'nominal', scale: {domain, range: tierFills(data, colour.scale, surface, domain)}, legend: null};
}

/** What marks and shapes mean; nothing if no agent of the report is privileged. */
export function marksExplained(data) {
  const shapes = new Set(data.agents.map((agent) => shapeOf(data, agent.name)));
  const meanings = [];
  if (shapes.has('half')) meanings.push('Light: knows what an operator knows.');
  if (shapes.has('hollow')) meanings.push('Hollow: sees the future.');
  if (meanings.length === 0) return null;
  return `${meanings.join(' ')} ${data.marks_explained}.`;
}
