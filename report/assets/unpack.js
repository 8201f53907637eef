// Columns of doubles from the text that `report/src/live/pack.rs` makes of them, to the bit.
"use strict";
const acro = {};

// The values of a packed column: a Float64Array, or an array with null for "no number" and undefined for "no point here".
acro.unpack = function (packed) {
  const text = atob(packed.data);
  const rows = packed.rows;
  const value = new Float64Array(rows);
  const word = new Uint32Array(value.buffer); // low word first on every machine with a browser
  const guess = new Float64Array(1);
  const guessed = new Uint32Array(guess.buffer);
  let at = (rows + 1) >> 1;
  let holes = null;
  for (let row = 0; row < rows; row++) {
    const order = Math.min(packed.order, row);
    let next = 0;
    if (order === 1) next = value[row - 1];
    else if (order === 2) next = 2 * value[row - 1] - value[row - 2];
    else if (order === 3) next = 3 * value[row - 1] - 3 * value[row - 2] + value[row - 3];
    else if (order === 4) next = 4 * value[row - 1] - 6 * value[row - 2] + 4 * value[row - 3] - value[row - 4];
    if (Number.isFinite(next)) guess[0] = next; else [guessed[0], guessed[1]] = [word[2 * row - 2], word[2 * row - 1]];
    const length = (text.charCodeAt(row >> 1) >> (4 * (row & 1))) & 15;
    let low = 0, high = 0;
    for (let byte = 0; byte < length; byte++) {
      const bits = text.charCodeAt(at++);
      if (byte < 4) low |= bits << (8 * byte); else high |= bits << (8 * (byte - 4));
    }
    word[2 * row] = low ^ guessed[0];
    word[2 * row + 1] = high ^ guessed[1];
    if (!Number.isFinite(value[row])) (holes = holes || []).push([row, word[2 * row] === 0xd1]);
  }
  if (!holes) return value;
  const list = Array.from(value);
  for (const [row, missing] of holes) list[row] = missing ? undefined : null;
  return list;
};

// The JSON of a data block of the page.
acro.data = (id) => JSON.parse(document.getElementById(id).textContent);
