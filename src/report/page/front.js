// Pareto front of an optimisation. The page shows the offsets and the study of the chosen point.
const front = record.front;
const frontState = { picked: run.kept_point ?? 0 };
const frontCharts = charts.filter(({ figure }) => 'front' in figure.dataset);

// Study of a point: the study of the first point, with the lines that differ replaced.
const studyOf = (number) => {
  const lines = [...front.study];
  for (const [k, line] of front.points[number].lines) lines[k] = line;
  return `${lines.join('\n')}\n`;
};

const sayPoint = () => {
  const { picked } = frontState;
  const { weights, misfits, offsets } = front.points[picked];
  byId('front-point').value = String(picked);
  byId('front-study').textContent = studyOf(picked);
  const [first, second] = weights;
  const rate = front.targets.length === 2 && first > 0 && second > 0 ? `; an improvement of ${front.targets[0]} by one tolerance worsens ${front.targets[1]} by ${brief(first / second, 3)}` : '';
  byId('front-said').textContent = (picked === run.kept_point ? 'kept: ' : '') + front.targets.map((name, k) => `${name} ${brief(misfits[k], 3)}`).join(', ') + rate;
  byId('front-table').replaceChildren(...front.variables.map((name, k) => html('tr', {}, html('td', { text: name }), html('td', { class: 'number', text: brief(offsets[k]) }))));
  for (const chart of frontCharts) {
    const { x, y } = chart.layout;
    const [a, b] = [x, y].map(({ column: name }) => misfits[Number(name.replace('misfit', ''))]);
    const home = chart.home;
    const share = (axis, v) => (v - home[axis][0]) / (home[axis][1] - home[axis][0]);
    const { left, top, width, height } = chart.box;
    chart.ring ??= chart.inner.appendChild(svg('path', { class: 'ring' }));
    set(chart.ring, { d: `M${(left + share(0, a) * width).toFixed(1)} ${(top + (1 - share(1, b)) * height).toFixed(1)}h.01` });
  }
  // Shows the curves of the point beside the curves of the kept design.
  for (const { figure } of charts) {
    if (!figure.dataset.over) continue;
    figure.classList.forEach((name) => { if (name.startsWith('shows-')) figure.classList.remove(name); });
    figure.classList.add(`shows-of-${picked}`);
    figure.querySelectorAll('.front-point').forEach((part) => part.classList.toggle('on', part.classList.contains(`of-${picked}`) && picked !== run.kept_point));
  }
  root.dataset.frontPoint = picked + 1;
};

const pickPoint = (number) => {
  frontState.picked = number;
  sayPoint();
};
const setUpFront = () => {
  if (!front || !front.points.length) return;
  front.points.forEach((_, k) => option(byId('front-point'), String(k), `${k + 1}${k === run.kept_point ? ', kept' : ''}`));
  byId('front-point').addEventListener('change', (e) => pickPoint(Number(e.target.value)));
  byId('front-save').addEventListener('click', () => saveText(`${record.study}_front_${frontState.picked + 1}.toml`, studyOf(frontState.picked), 'text/plain'));
  for (const chart of frontCharts) {
    chart.svg.addEventListener('click', (event) => {
      const [x, y] = chart.pointer(event);
      const keys = [chart.layout.x, chart.layout.y].map(({ column: name }) => Number(name.replace('misfit', '')));
      const far = ({ misfits }) => {
        const [a, b] = chart.at(keys.map((k) => misfits[k]));
        return Math.hypot(a - x, b - y);
      };
      const all = front.points.map(far);
      const nearest = all.indexOf(Math.min(...all));
      if (all[nearest] < 24) pickPoint(nearest);
    });
  }
  sayPoint();
};
