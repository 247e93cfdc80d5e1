// Influence of coordinates on curves.
const measure = () => byId('measure').value;
const influences = record.influences;
const influenced = record.outputs.filter((o) => influences.some((i) => i.output === o.column));
const influenceOf = (output, coordinate) => influences.find((i) => i.output === output && i.coordinate === coordinate);
const perLength = (output) => `${output.unit || '1'} per ${record.length_unit}`;
const MOST_COORDINATES = 24;
const MOST_BARS = 15;

const drawInfluences = () => {
  if (!influenced.length) return;
  const most = new Map(influenced.map((o) => [o.column, Math.max(...influences.filter((i) => i.output === o.column).map((i) => i[measure()]))]));
  const share = (output, coordinate) => {
    const found = influenceOf(output, coordinate);
    return found && most.get(output) > 0 ? found[measure()] / most.get(output) : 0;
  };
  const chosen = byId('influence-output').value;
  const strength = (coordinate) => Math.max(...influenced.map((o) => share(o.column, coordinate)));
  const coordinates = [...new Set(influences.map((i) => i.coordinate))].sort((a, b) => strength(b) - strength(a)).slice(0, MOST_COORDINATES)
    .sort((a, b) => share(chosen, b) - share(chosen, a));
  drawShades(byId('influence-map'), {
    rows: coordinates, columns: influenced.map((o) => o.title), picked: influenced.findIndex((o) => o.column === chosen),
    pick: (k) => { byId('influence-output').value = influenced[k].column; drawInfluences(); },
    cell: (row, k) => {
      const output = influenced[k];
      const found = influenceOf(output.column, coordinates[row]);
      const part = share(output.column, coordinates[row]);
      return {
        strength: part, text: part < 0.01 ? '' : brief(found[measure()], 2),
        title: found ? `${coordinates[row]} on ${output.title}: change ${brief(found.rms, 3)}, bend ${brief(found.bend, 3)}, at most ${brief(found.largest, 3)} ${perLength(output)}` : null,
      };
    },
  });
  const output = influenced.find((o) => o.column === chosen);
  const ranked = influences.filter((i) => i.output === chosen).sort((a, b) => b[measure()] - a[measure()]).slice(0, MOST_BARS);
  drawBars(byId('influence-bars'), withUnit(output.title, perLength(output)), ranked.map((i) => ({
    name: i.coordinate, value: i[measure()], text: brief(i[measure()], 3), more: `at most ${brief(i.largest, 3)}`,
  })));
};
