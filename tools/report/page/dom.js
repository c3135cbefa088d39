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

/** A table that scrolls sideways on its own when the screen is narrow. `columns`: {title, text(row), number, header, long}. */
export function table(columns, rows, caption) {
  const cell = (column, row) => {
    const content = column.text(row);
    return column.header
      ? h('th', {scope: 'row'}, content)
      : h('td', {class: column.number ? 'number' : column.long ? 'long' : null}, content);
  };
  return h('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption},
    h('table', {},
      h('caption', {}, caption),
      h('thead', {}, h('tr', {}, columns.map((column) => h('th', {scope: 'col', class: column.number ? 'number' : null}, column.title)))),
      h('tbody', {}, rows.map((row) => h('tr', {}, columns.map((column) => cell(column, row)))))));
}

/** A drop-down list of {value, text}. */
export function choice(label, options, value, onchange) {
  return h('label', {class: 'choice'}, h('span', {}, label),
    h('select', {onchange: (event) => onchange(event.target.value)},
      options.map((option) => h('option', {value: option.value, selected: String(option.value) === String(value)}, option.text))));
}
