// Agents that see more than a real UAV reports have a mark behind the name and a hollow shape.

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

/** The label of an axis or a legend of agents, as a Vega expression. */
export function markedLabel(data) {
  const labels = Object.fromEntries(data.agents.map((agent) => [agent.name, marked(data, agent.name)]));
  return `${JSON.stringify(labels)}[datum.label] || datum.label`;
}

/** The fill of shapes whose rows have `privileged`: the background, or the agent's colour. */
export function hollowFill(colour, surface) {
  return {condition: {test: 'datum.privileged', value: surface.background}, field: 'agent', type: 'nominal', scale: colour.scale, legend: null};
}

/** What marks and hollow shapes mean; nothing if no agent of the report is privileged. */
export function marksExplained(data) {
  if (!data.agents.some((agent) => isPrivileged(data, agent.name))) return null;
  return `Hollow: privileged agents. ${data.marks_explained}.`;
}
