// Which agents and conditions the reader wants to see: reading them from the address, and the data without the others.

/** The values of a list in the address that exist; null (all) if it is not there or names none that exists. */
function chosen(text, known) {
  if (text === null) return null;
  if (text === '') return [];
  const values = known.filter((value) => text.split(',').includes(value));
  return values.length > 0 ? values : null;
}

/** {agents, conditions}: names and indices that are shown, null for all. `address`: the parameters of the address. */
export function readFilter(data, address) {
  return {
    agents: chosen(address.get('agents'), data.agents.map((agent) => agent.name)),
    conditions: chosen(address.get('conditions'), data.conditions.map((_, index) => String(index)))?.map(Number) ?? null,
  };
}

export function writeFilter({agents, conditions}, address) {
  if (agents !== null) address.set('agents', agents.join(','));
  if (conditions !== null) address.set('conditions', conditions.join(','));
}

/** The data as if the other agents and conditions had not flown; conditions keep their `index`. */
export function filtered(data, {agents, conditions}) {
  const wanted = (one) => agents === null || agents.includes(one.name);
  const some = (part) => {
    if (!part) return null;
    const left = part.agents.filter(wanted);
    return left.length > 0 ? {...part, agents: left} : null;
  };
  return {
    ...data,
    agents: data.agents.filter(wanted),
    conditions: data.conditions.map((condition, index) => ({...condition, index}))
      .filter(({index}) => conditions === null || conditions.includes(index))
      .map((condition) => ({...condition, views: Object.fromEntries(Object.entries(condition.views).map(([name, view]) => [name, some(view)])), flight: some(condition.flight)})),
  };
}
