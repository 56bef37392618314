// SPDX-License-Identifier: GPL-3.0-or-later
// Colors of values: a map in which equal steps look equal, and classes for patches and levels.
"use strict";

// Nine colors of viridis (S. van der Walt, N. Smith, E. Firing).
const VIRIDIS = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"];
const NO_VALUE = "#9d9d9d";
const N_SHADES = 256;
const SUPERSCRIPTS = {"-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹"};

function rgb(color) { return [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16)); }

function shade(t) {
  const place = Math.min(Math.max(t, 0), 1) * (VIRIDIS.length - 1);
  const i = Math.min(Math.floor(place), VIRIDIS.length - 2);
  const a = rgb(VIRIDIS[i]), b = rgb(VIRIDIS[i + 1]);
  return a.map((value, k) => Math.round(value + (place - i) * (b[k] - value)));
}

// RGBA of the colors that a coloring chooses from: shades or classes.
function paletteBytes(classes) {
  const bytes = new Uint8Array(4 * N_SHADES);
  for (let i = 0; i < N_SHADES; ++i)
    bytes.set([...(classes ? rgb(classes[i % classes.length]) : shade(i / (N_SHADES - 1))), 255], 4 * i);
  return bytes;
}

// How the elements of a view are colored: `classes` by number, or else `from` to `to`.
class Coloring {
  constructor(name, unit, classes, labels) {
    Object.assign(this, {name, unit, classes, labels, from: Infinity, to: -Infinity, log: false});
  }

  include(values) {
    for (const value of values)
      if (Number.isFinite(value)) {
        if (value < this.from) this.from = value;
        if (value > this.to) this.to = value;
      }
  }

  // Place in the palette, 0 to 1; -1 for no value.
  place(value) {
    if (this.classes) return (value % N_SHADES + 0.5) / N_SHADES;
    if (Number.isNaN(value)) return -1;
    const {from, to} = this;
    if (!(to > from)) return 0.5;
    if (!this.log) return Math.min(Math.max((value - from) / (to - from), 0), 1);
    if (!(value > 0)) return 0;
    const low = from > 0 ? from : to * 1e-6;
    return Math.min(Math.max(Math.log(value / low) / Math.log(to / low), 0), 1);
  }
}

// Six significant digits, as in the tables of the page, or fewer; a power of ten where the zeros would have to be counted.
function shortNumber(value, digits = 6) {
  if (value === undefined || value === null || Number.isNaN(value)) return "none";
  const size = Math.abs(value);
  if (!Number.isFinite(value) || Number.isInteger(value) && size < 1e6) return String(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(digits)));
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  return `${Number(mantissa)} × 10${[...String(Number(exponent))].map((sign) => SUPERSCRIPTS[sign]).join("")}`;
}

// Three digits, or as many as tell the values apart.
function scaleNumbers(values) {
  for (let digits = 3; ; ++digits) {
    const texts = values.map((value) => shortNumber(value, digits));
    if (digits === 6 || new Set(texts).size === new Set(values).size) return texts;
  }
}

function addText(parent, tag, text, className) {
  const element = document.createElement(tag);
  element.textContent = text;
  if (className) element.className = className;
  parent.append(element);
  return element;
}

function drawLegend(element, coloring) {
  element.replaceChildren();
  addText(element, "strong", coloring.name + (coloring.unit ? `, ${coloring.unit}` : "") + (coloring.log ? " (log)" : ""));
  if (coloring.classes) {
    const list = addText(element, "div", "", "classes");
    coloring.labels.forEach((label, i) => {
      const line = addText(list, "div", "");
      const swatch = addText(line, "span", "", "swatch");
      swatch.style.background = coloring.classes[i % coloring.classes.length];
      line.append(label);
    });
    return;
  }
  const bar = addText(element, "div", "", "bar");
  bar.style.background = `linear-gradient(to right, ${VIRIDIS.join(", ")})`;
  const ends = addText(element, "div", "", "ends");
  const {from, to} = coloring;
  const low = coloring.log && !(from > 0) ? to * 1e-6 : from;
  const middle = coloring.log ? Math.sqrt(low * to) : (low + to) / 2;
  for (const text of scaleNumbers(Number.isFinite(from) ? [low, middle, to] : [NaN])) addText(ends, "span", text);
}
