// Colours and fonts. Every agent keeps its colour, dash and place in all charts; its registration defines them.

/** Vega-Lite scales {domain, range} of colour and dash for these agents, in the report's order. */
export function agentScales(data, theme, names) {
  const agents = data.agents.filter((agent) => names.includes(agent.name));
  const domain = agents.map((agent) => agent.name);
  return {
    colour: {domain, range: agents.map((agent) => agent.colour[theme])},
    dash: {domain, range: agents.map((agent) => agent.dash)},
  };
}

/** Colours for serving base stations, in order of first appearance; they repeat after eight. */
export const cellColours = {
  light: ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#b08800', '#56b4e9', '#882255', '#555555'],
  dark: ['#4ea3dd', '#ff8a3d', '#22c08f', '#eaa3c6', '#e6c229', '#9ad4f5', '#d9739f', '#c0c0c0'],
};

export const surfaces = {
  light: {background: '#ffffff', ink: '#1b2330', soft: '#596475', grid: '#e3e7ed', neutral: '#9aa4b2'},
  dark: {background: '#171c24', ink: '#e8ecf2', soft: '#a9b4c4', grid: '#2d3643', neutral: '#6d7889'},
};

/** The Vega-Lite configuration all charts share. */
export function chartConfig(theme) {
  const {background, ink, soft, grid} = surfaces[theme];
  const font = 'system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';
  return {
    background,
    font,
    padding: 4,
    view: {stroke: null},
    axis: {
      labelColor: soft, titleColor: ink, gridColor: grid, domainColor: soft, tickColor: soft,
      labelFontSize: 12, titleFontSize: 12, titleFontWeight: 500, labelLimit: 160,
    },
    axisQuantitative: {labelFlush: false},  // a last label that is moved inwards lies on the one before
    legend: {labelColor: ink, titleColor: ink, labelFontSize: 12, titleFontSize: 12, titleFontWeight: 500, labelLimit: 160},
    title: {color: ink, fontSize: 13, fontWeight: 600},
    text: {color: ink},
  };
}
