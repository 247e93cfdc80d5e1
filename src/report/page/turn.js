// Steered axle from above, in the axes of the body, at the position of the mechanism. It shows both wheels, their spin axes up to
// the line of the other axle, and the centre about which the vehicle turns.
const TURN_SIZE = [900, 460];
const turnPlot = byId('turn-plot');
const turnOf = (design, place) => frameAt(design, place).pose.Ok?.turn ?? null;
const hasTurn = allFrames.some((f) => f.pose.Ok?.turn?.centre);

const drawTurn = (place) => {
  byId('turn').hidden = !hasTurn;
  if (!hasTurn) return;
  const last = record.designs.length - 1;
  if (!frameAt(last, place).pose.Ok) {
    turnPlot.replaceChildren();
    noteDrawn(turnPlot);
    byId('turn-text').textContent = 'Not solved at this position.';
    return;
  }
  const designs = record.designs.map((_, k) => k).filter((k) => record.designs[k].frames.length);
  const turns = designs.map((design) => ({ design, turn: turnOf(design, place) })).filter(({ turn }) => turn);
  // Converts a position to the picture: forward is up, and left is on the left.
  const flatTo = (p) => [-p[1] * outboard, p[0] * forward];
  const all = turns.flatMap(({ turn }) => [...turn.wheels.flat(), ...(turn.centre ? [turn.centre] : []), [turn.other_axle, 0]].map(flatTo));
  const [low, high] = [Math.min, Math.max].map((end) => [0, 1].map((k) => end(...all.map((p) => p[k]))));
  const room = [TURN_SIZE[0] - 120, TURN_SIZE[1] - 70];
  const scale = Math.min(...[0, 1].map((k) => room[k] / Math.max(high[k] - low[k], 1e-9)));
  const at = (p) => {
    const [x, y] = flatTo(p);
    return [TURN_SIZE[0] / 2 + scale * (x - (low[0] + high[0]) / 2), TURN_SIZE[1] / 2 - scale * (y - (low[1] + high[1]) / 2)].map((v) => v.toFixed(1)).join(' ');
  };
  const parts = turns.flatMap(({ design, turn }) => {
    const look = design === last ? 'is-main' : 'is-former';
    const middles = turn.wheels.map(([a, b]) => a.map((v, k) => (v + b[k]) / 2));
    const half = Math.max(...turn.wheels.flat().map((end) => Math.abs(end[1])));
    const line = (points, kind) => svg('path', { class: `${kind} ${look}`, d: `M${points.map(at).join('L')}` });
    return [
      line([[turn.other_axle, -half], [turn.other_axle, half]], 'turn-axle'),
      ...(turn.meets ? turn.meets.map((meet, k) => line([middles[k], meet], 'turn-spin')) : []),
      ...turn.wheels.map((ends) => line(ends, 'turn-wheel')),
      ...(turn.centre ? [line([turn.centre, turn.centre], 'turn-centre')] : []),
    ];
  });
  set(turnPlot, { viewBox: `0 0 ${TURN_SIZE.join(' ')}` });
  const bar = niceStep(room[0] / scale, 5);
  parts.push(svg('path', { class: 'scale-bar', d: `M24 ${TURN_SIZE[1] - 16}h${(bar * scale).toFixed(1)}` }),
    svg('text', { x: 24, y: TURN_SIZE[1] - 22, text: `${brief(bar)} ${record.length_unit}` }),
    svg('text', { x: 24, y: 22, text: '↑ forward' }));
  turnPlot.replaceChildren(...parts);
  noteDrawn(turnPlot);
  const centre = turnOf(last, place)?.centre;
  byId('turn-text').textContent = centre ? `Centre of the turn: ${brief(centre[0], 4)}, ${brief(centre[1], 4)} ${record.length_unit} (x, y).`
    : 'Straight ahead: the spin axes are almost parallel to the other axle. Move the slider of the rack or steering wheel.';
};
