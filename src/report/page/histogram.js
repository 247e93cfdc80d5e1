// Histogram of the designs over the column that is on the horizontal axis of the scatter plot. The selected designs have another
// colour.
const COUNTS = { size: [900, 190], box: [74, 14, 880, 138], bins: 30 };
const countsPlot = byId('counts-plot');
const drawCounts = (state) => {
  const [left, top, right, bottom] = COUNTS.box;
  const axis = axisOf(state.x, state.logarithmic);
  const known = allRows.filter((row) => isWhole(row) && value(state.x, row) !== null);
  const binOf = (row) => Math.min(COUNTS.bins - 1, Math.max(0, Math.floor(shareOn(axis, value(state.x, row)) * COUNTS.bins)));
  const count = (rows) => {
    const counts = new Array(COUNTS.bins).fill(0);
    for (const row of rows) counts[binOf(row)] += 1;
    return counts;
  };
  const chosen = known.filter((row) => state.selected === null || state.selected.has(row));
  const [all, own] = [known, chosen].map(count);
  const most = Math.max(1, ...all);
  const width = (right - left) / COUNTS.bins;
  const bars = (counts) => counts.map((n, k) => (n ? `M${(left + k * width + 1).toFixed(1)} ${bottom}v${(-(n / most) * (bottom - top)).toFixed(1)}h${(width - 2).toFixed(1)}V${bottom}Z` : '')).join('');
  const parts = [];
  for (const [share, text] of axis.ticks) {
    const place = (left + share * (right - left)).toFixed(1);
    parts.push(svg('path', { class: 'grid', d: `M${place} ${top}V${bottom}` }), svg('text', { class: 'axis-text', x: place, y: bottom + 18, 'text-anchor': 'middle', text }));
  }
  parts.push(svg('path', { class: 'frame', d: `M${left} ${bottom}H${right}` }),
    svg('text', { class: 'axis-text', x: left - 8, y: top + 10, 'text-anchor': 'end', text: String(most) }),
    svg('text', { class: 'axis-text', x: (left + right) / 2, y: bottom + 42, 'text-anchor': 'middle', text: axis.title }),
    svg('path', { class: 'counts former', d: bars(all) }), svg('path', { class: 'counts main', d: bars(own) }));
  set(countsPlot, { viewBox: `0 0 ${COUNTS.size.join(' ')}` });
  countsPlot.replaceChildren(...parts);
  const sorted = chosen.map((row) => value(state.x, row)).sort((a, b) => a - b);
  const at = (share) => brief(sorted[Math.round(share * (sorted.length - 1))], 4);
  byId('counts-said').textContent = sorted.length ? `${sorted.length} designs: 5 % below ${at(0.05)}, median ${at(0.5)}, 5 % above ${at(0.95)}` : '';
};
