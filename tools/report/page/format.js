// Numbers and texts as the report shows them.

/** A number with a fixed count of decimals, "–" for nothing. */
export function number(value, decimals = 2) {
  return Number.isFinite(value) ? value.toFixed(decimals) : '–';
}

export function signed(value, decimals = 2) {
  if (!Number.isFinite(value)) return '–';
  return (value < 0 ? '−' : '+') + Math.abs(value).toFixed(decimals);
}

export function interval(pair, decimals = 2) {
  return pair ? `${number(pair[0], decimals)} … ${number(pair[1], decimals)}` : '–';
}

export function signedInterval(pair, decimals = 2) {
  return pair ? `${signed(pair[0], decimals)} … ${signed(pair[1], decimals)}` : '–';
}

export function percent(share, decimals = 0) {
  return Number.isFinite(share) ? `${(100 * share).toFixed(decimals)} %` : '–';
}

/** A condition's name as a part of a file name. */
export function slug(text) {
  return text.toLowerCase().replace(/[^a-z0-9.]+/g, '-').replace(/^-+|-+$/g, '');
}
