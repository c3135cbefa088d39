// Building HTML without a framework.

/** h('p', {class: 'note'}, 'text', child): an element; `on` + event name adds a listener; null children are left out. */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value);
  }
  for (const child of children.flat()) if (child !== null && child !== undefined && child !== '') element.append(child);
  return element;
}

/** Tells under which tables columns are hidden, whenever a width changes. */
const overflowWatch = new ResizeObserver((entries) => {
  for (const {target} of entries) {
    const scroll = target.closest('.scroll');
    scroll.parentElement.classList.toggle('overflows', scroll.scrollWidth > scroll.clientWidth + 1);
  }
});

/** A table that scrolls sideways on its own, and says so, when the screen is narrow; the first column stays. `columns`: {title, text(row), number, header, long}. */
export function table(columns, rows, caption) {
  const cell = (column, row) => {
    const content = column.text(row);
    return column.header
      ? h('th', {scope: 'row'}, content)
      : h('td', {class: column.number ? 'number' : column.long ? 'long' : null}, content);
  };
  const content = h('table', {},
    h('caption', {}, h('span', {}, caption)),
    h('thead', {}, h('tr', {}, columns.map((column) => h('th', {scope: 'col', class: column.number ? 'number' : null}, column.title)))),
    h('tbody', {}, rows.map((row) => h('tr', {}, columns.map((column) => cell(column, row))))));
  const scroll = h('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption}, content);
  overflowWatch.observe(scroll);
  overflowWatch.observe(content);
  return h('div', {class: 'table'}, h('p', {class: 'hint'}, 'More columns: scroll sideways →'), scroll);
}

/** A drop-down list of {value, text}. */
export function choice(label, options, value, onchange) {
  return h('label', {class: 'choice'}, h('span', {}, label),
    h('select', {id: `choose-${label.toLowerCase()}`, onchange: (event) => onchange(event.target.value)},
      options.map((option) => h('option', {value: option.value, selected: String(option.value) === String(value)}, option.text))));
}

/** A list that unfolds, to tick {value, text} of; `chosen`: values, null for all. */
export function ticks(label, options, chosen, onchange) {
  const id = label.toLowerCase();
  const values = options.map((option) => option.value);
  const ticked = chosen ?? values;
  const choose = (some) => onchange(some.length === values.length ? null : some);
  const button = (text, some) => h('button', {type: 'button', id: `${id}-${text.toLowerCase()}`, 'aria-label': `${text} ${id}`, onclick: () => choose(some)}, text);
  const box = ({value, text}, i) => h('label', {}, h('input', {
    type: 'checkbox', id: `${id}-${i}`, checked: ticked.includes(value),
    onchange: (event) => choose(values.filter((other) => (other === value ? event.target.checked : ticked.includes(other)))),
  }), text);
  return h('details', {id: `${id}-shown`, class: 'ticks'},
    h('summary', {id: `${id}-summary`}, `${label}: ${chosen === null ? `all ${values.length}` : `${ticked.length} of ${values.length}`}`),
    h('fieldset', {}, h('legend', {}, `${label} to show`), h('div', {class: 'bar controls'}, button('All', values), button('None', [])), h('div', {class: 'boxes'}, options.map(box))));
}
