// Form for a new study: topology with a picture, points from a spreadsheet, and file name.
import { byId, html, notANumber, parsed, svg } from './draw.js';
import { post } from './server.js';

const SIZE = { width: 230, height: 150 };

// Picture of the mechanism from the front: the wheel and the links are lines.
const picture = ({ scene, design }) => {
  const { bodies, signs, wheel_centre: centre, wheel_radius: radius } = scene;
  const ends = (values) => [Math.min(...values), Math.max(...values)];
  const reach = radius ?? 0;
  const [low, high] = ends([...design.map((p) => signs[1] * p[1]), signs[1] * design[centre][1] + 60]);
  const [bottom, top] = ends([...design.map((p) => signs[2] * p[2]), signs[2] * design[centre][2] - reach, signs[2] * design[centre][2] + reach]);
  const scale = Math.min((SIZE.width - 20) / (high - low), (SIZE.height - 20) / (top - bottom));
  const place = (p) => [10 + scale * (signs[1] * p[1] - low), SIZE.height - 10 - scale * (signs[2] * p[2] - bottom)];
  const path = (points) => `M${points.map((p) => place(p).map((c) => c.toFixed(1)).join(' ')).join('L')}`;
  const lines = bodies.map((body, k) => svg('path', { class: `${body.kind} hue${k % 7}`, d: body.lines.map((line) => path(line.map((i) => design[i]))).join('') }));
  const wheel = [-1, 1].map((by) => design[centre].map((c, k) => (k === 2 ? c + by * reach : c)));
  // Points of the right half of a solid axle are not drawn, because this picture has no lines to them.
  const joined = new Set(bodies.flatMap(({ lines: own }) => own.flat()));
  const dots = design.filter((_, p) => joined.has(p)).map((p) => { const [x, y] = place(p); return svg('circle', { cx: x.toFixed(1), cy: y.toFixed(1), r: 2.5, fill: 'currentColor' }); });
  return svg('svg', { class: 'view', viewBox: `0 0 ${SIZE.width} ${SIZE.height}`, role: 'img', 'aria-label': 'front view' },
    svg('g', { class: 'bodies' }, svg('path', { class: 'rim', d: path(wheel) }), ...lines), ...dots);
};

const expected = (choice) => {
  const names = choice.hardpoints.filter(([, required]) => required).map(([name]) => name);
  byId('expected').textContent = `Points that this kind needs: ${names.join(', ')}. Other common names are recognised.`;
};
const chosen = () => document.querySelector('input[name=kind]:checked')?.value;

const build = (choices) => {
  byId('kinds').replaceChildren(...choices.map((choice, k) => {
    const input = html('input', { type: 'radio', name: 'kind', value: choice.name, on: { change: () => expected(choice) } });
    input.checked = k === 0;
    return html('label', { class: 'kind' }, input, picture(choice), html('b', { text: choice.name.replaceAll('_', ' ') }), html('small', { text: choice.summary }));
  }));
  expected(choices[0]);
};

const start = async (event) => {
  event.preventDefault();
  const length = (id) => (byId(id).value.trim() === '' ? null : parsed(byId(id).value));
  byId('refused').textContent = '';
  for (const [id, name] of [['half-track', 'Half track'], ['wheel-radius', 'Wheel radius']]) {
    const field = byId(id);
    const isWrong = field.value.trim() !== '' && length(id) === null;
    field.setAttribute('aria-invalid', String(isWrong));
    if (!isWrong) continue;
    byId('refused').textContent = `${name}: ${notANumber(field.value)}.`;
    field.focus();
    return;
  }
  byId('start').disabled = true;
  try {
    const name = byId('name').value.trim();
    await post('start', {
      topology: chosen(), name: name.endsWith('.toml') ? name : `${name}.toml`, points: byId('points').value,
      unit: byId('unit').value, axes: byId('axes').value.trim(), side: byId('side').value, half_track: length('half-track'), wheel_radius: length('wheel-radius'),
    });
    location.reload();
  } catch (refused) {
    byId('refused').textContent = refused.message;
  } finally {
    byId('start').disabled = false;
  }
};

byId('form').addEventListener('submit', start);
byId('file').addEventListener('change', async (event) => {
  const [file] = event.target.files;
  if (file) byId('points').value = await file.text();
});
post('choices', null).then((choices) => {
  build(choices);
  document.documentElement.dataset.ready = 'true';
}).catch((refused) => { byId('refused').textContent = refused.message; });
