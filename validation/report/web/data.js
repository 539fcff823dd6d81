// Arrays of the page, and a few vectors. All files of web/ are parts of one function (see web_assets.hpp.in).

/// The JSON and the bytes (deflated, base64) that two script elements hold; null where the page has none.
async function pageData(name) {
  const index = document.getElementById(name + "-index");
  if (!index) return null;
  const text = atob(document.getElementById(name + "-data").textContent.trim());
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return { index: JSON.parse(index.textContent), bytes: await new Response(stream).arrayBuffer() };
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const unit = (a) => scaled(a, 1 / Math.hypot(a[0], a[1], a[2]));
const clamp = (v, low, high) => Math.min(high, Math.max(low, v));

/// `element("b", { className: "x" }, "text", child)`
function element(name, properties, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

const rgb = (c) => `rgb(${c.map(Math.round).join(",")})`;
const isWide = () => window.matchMedia("(min-width: 821px)").matches;
