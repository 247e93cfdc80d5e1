// Tables with shaded cells, and ranked bars. `unbroken` keeps the unit in brackets on one line.
const unbroken = (text) => {
  const at = text.lastIndexOf(' [');
  return at < 0 ? [text] : [text.slice(0, at + 1), html('span', { class: 'unit', text: text.slice(at + 1) })];
};
// Table whose cells have a text and a strength from -1 to 1. A click on a column ranks the rows by this column.
const drawShades = (element, { rows, columns, cell, pick, picked }) => {
  const table = html('table', { class: 'shades' });
  const head = html('tr', {}, html('td'));
  columns.forEach((title, k) => head.append(html('th', { scope: 'col' }, html('button', {
    type: 'button', title: 'Rank by this column', 'aria-pressed': picked === k ? 'true' : 'false', on: { click: () => pick(k) },
  }, ...unbroken(title)))));
  table.append(html('thead', {}, head));
  const body = html('tbody');
  rows.forEach((title, row) => {
    const line = html('tr', {}, html('th', { scope: 'row' }, ...unbroken(title)));
    columns.forEach((_, k) => {
      const { text, strength, title: more } = cell(row, k);
      const td = html('td', { text, title: more, class: strength < 0 ? 'less' : 'more' });
      td.style.setProperty('--part', `${Math.round(70 * Math.min(1, Math.abs(strength)))}%`);
      line.append(td);
    });
    body.append(line);
  });
  table.append(body);
  element.replaceChildren(table);
  noteDrawn(element);
};

// Bars with their names and numbers. The caller has sorted the bars, the longest first.
const drawBars = (element, title, bars) => {
  const most = Math.max(1e-300, ...bars.map(({ value }) => Math.abs(value)));
  element.replaceChildren(html('p', { class: 'note', text: title }), ...bars.map(({ name, value, text, more }) => {
    const bar = html('i', { class: value < 0 ? 'less' : 'more' });
    bar.style.width = `${(100 * Math.abs(value)) / most}%`;
    return html('div', { class: 'bar-row', title: more }, html('span', { text: name }), html('span', { class: 'track' }, bar), html('b', { text }));
  }));
  noteDrawn(element);
};
