// The one clock of the page, set to the server's: a lab computer may be minutes off, and "3 min
// ago" must not say "in 4 min".

export const clock = $state({ now: Date.now() });

let offset = 0;

setInterval(() => {
  clock.now = Date.now() + offset;
}, 1000);

/** Takes the `Date` header of an answer, which is exact to a second. */
export function setServerTime(date: string | null): void {
  if (!date) return;
  const difference = Date.parse(date) + 500 - Date.now();
  // Below two seconds the header's own rounding and the network's delay are all there is.
  offset = Number.isFinite(difference) && Math.abs(difference) > 2000 ? difference : 0;
}
