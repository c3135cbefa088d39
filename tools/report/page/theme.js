// Colours and fonts. Every agent keeps its colour, dash and place in all charts; the colours follow Okabe-Ito and Tol
// and differ in lightness too, with one variant for a light and one for a dark background.

const known = {
  'min-height': {light: '#2a9fd0', dark: '#56b4e9', dash: [1, 0]},
  'constant-60': {light: '#8a7d00', dark: '#d6c84a', dash: [2, 2]},
  'constant-120': {light: '#882255', dark: '#d9739f', dash: [6, 3]},
  'constant-240': {light: '#6f4fa8', dark: '#b39ddb', dash: [8, 2, 2, 2]},
  'random-walk': {light: '#7a7a7a', dark: '#a6a6a6', dash: [2, 3]},
  'one-step-ahead': {light: '#0058a3', dark: '#6f9fe8', dash: [5, 2]},
  'optimal-height': {light: '#00805c', dark: '#22c08f', dash: [1, 0]},
  planner: {light: '#c05f94', dark: '#eaa3c6', dash: [4, 2]},
  'local-bandit': {light: '#d18f00', dark: '#f2b632', dash: [1, 0]},
  dqn: {light: '#d5500a', dark: '#ff8a3d', dash: [1, 0]},
};

const spare = [
  {light: '#117733', dark: '#66c285', dash: [3, 2]},
  {light: '#aa3377', dark: '#e07ab0', dash: [6, 2]},
  {light: '#4477aa', dark: '#88b4dd', dash: [3, 1]},
  {light: '#997700', dark: '#d9b84a', dash: [5, 3]},
  {light: '#444444', dark: '#d0d0d0', dash: [7, 2]},
  {light: '#994455', dark: '#e08a99', dash: [2, 1]},
];

/** Vega-Lite scales {domain, range} of colour and dash for these agents, in the report's order. */
export function agentScales(data, theme, names) {
  const others = data.agents.filter((agent) => !known[agent.name]).map((agent) => agent.name);
  const look = (name) => known[name] ?? spare[others.indexOf(name) % spare.length];
  const domain = data.agents.map((agent) => agent.name).filter((name) => names.includes(name));
  return {
    colour: {domain, range: domain.map((name) => look(name)[theme])},
    dash: {domain, range: domain.map((name) => look(name).dash)},
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
    legend: {labelColor: ink, titleColor: ink, labelFontSize: 12, titleFontSize: 12, titleFontWeight: 500, labelLimit: 160},
    title: {color: ink, fontSize: 13, fontWeight: 600},
    text: {color: ink},
  };
}
