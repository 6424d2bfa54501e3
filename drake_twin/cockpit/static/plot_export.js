// Plots as files: their numbers for a spreadsheet, and their pictures.

import { element } from "./dom.js";

const CELL = /[",\n\r]/;
const ROW = 18; // px of a line of the legend
const EDGE = 10; // px

export function save(blob, name) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const cell = (text) => (CELL.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

// Curves, { label, unit, times, values }, as CSV: a column of times and one for each curve, which is empty where that has
// no sample at a time, and nan where its value is no finite number.
export function csvOf(curves) {
  const head = ["time [s]", ...curves.map(({ label, unit }) => (unit ? `${label} [${unit}]` : label))];
  const rows = new Map();
  curves.forEach(({ times, values }, column) => {
    times.forEach((time, index) => {
      if (!rows.has(time)) rows.set(time, new Array(curves.length).fill(""));
      rows.get(time)[column] = values[index] === null ? "nan" : String(values[index]);
    });
  });
  const ordered = [...rows].sort(([one], [other]) => one - other);
  return [head.map(cell), ...ordered.map(([time, values]) => [time, ...values])].map((row) => `${row.join(",")}\r\n`).join("");
}

// A picture of a plot with its legend, { text, color, dashed }, in the colors of the page.
export function pictureOf(plotted, legend, { background, text }) {
  const scale = devicePixelRatio;
  const picture = document.createElement("canvas");
  picture.width = plotted.width;
  picture.height = plotted.height + (ROW * legend.length + 2 * EDGE) * scale;
  const draw = picture.getContext("2d");
  draw.fillStyle = background;
  draw.fillRect(0, 0, picture.width, picture.height);
  draw.drawImage(plotted, 0, 0);
  draw.scale(scale, scale);
  draw.font = "12px system-ui, sans-serif";
  draw.textBaseline = "middle";
  legend.forEach(({ text: line, color, dashed }, index) => {
    const y = plotted.height / scale + EDGE + ROW * (index + 0.5);
    draw.strokeStyle = color;
    draw.lineWidth = 3;
    draw.setLineDash(dashed ? [5, 3] : []);
    draw.beginPath();
    draw.moveTo(EDGE, y);
    draw.lineTo(EDGE + 20, y);
    draw.stroke();
    draw.fillStyle = text;
    draw.fillText(line, EDGE + 28, y, plotted.width / scale - 2 * EDGE - 28);
  });
  return picture;
}
