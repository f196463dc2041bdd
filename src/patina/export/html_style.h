// The style sheet of every page: system fonts, light and dark, colours that the colour-blind can
// tell apart (after Okabe and Ito. Color Universal Design. 2008).
#pragma once

namespace patina {

// --series-0 is the ink (the truth); 1 to 6 are told apart by hue and lightness.
inline constexpr const char* kPageStyle = R"css(
:root {
  color-scheme: light dark;
  --paper: #fdfdfb; --panel: #f4f4f0; --ink: #1d2125; --soft: #5b646c; --rule: #d9dad4;
  --grid: #e8e8e3; --accent: #0a5f8a; --mark: #eef4f7;
  --series-0: #1d2125; --series-1: #c77700; --series-2: #0072b2; --series-3: #00805d;
  --series-4: #a34a7f; --series-5: #c2410c; --series-6: #3f9bd0;
  --channel-0: #c8322b; --channel-1: #2c8a3d; --channel-2: #2563c9;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #15181b; --panel: #1d2125; --ink: #e6e8e6; --soft: #9aa4ab; --rule: #353b41;
    --grid: #272c31; --accent: #6cb8de; --mark: #1c2a33;
    --series-0: #e6e8e6; --series-1: #f0ad3d; --series-2: #56a8e0; --series-3: #3fc39a;
    --series-4: #d98bb8; --series-5: #f2795a; --series-6: #8fd0f5;
    --channel-0: #f0736b; --channel-1: #67c476; --channel-2: #78a5f5;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0 auto; padding: 2.5rem 1.5rem 5rem; max-width: 72rem; background: var(--paper);
  color: var(--ink); line-height: 1.55;
  font: 400 1rem/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "Liberation Sans",
    sans-serif;
  font-variant-numeric: tabular-nums; text-rendering: optimizeLegibility;
}
h1 { font-size: 2.1rem; line-height: 1.15; letter-spacing: -0.02em; font-weight: 650; margin: 0.2rem 0 0.8rem; }
h2 { font-size: 1.4rem; letter-spacing: -0.01em; font-weight: 650; margin: 0 0 0.6rem; }
h3 { font-size: 1.05rem; font-weight: 650; margin: 2rem 0 0.6rem; }
p { max-width: 46rem; margin: 0 0 1rem; }
.eyebrow { color: var(--accent); font-weight: 650; font-size: 0.8rem; letter-spacing: 0.14em; text-transform: uppercase; margin: 0; }
.lead { font-size: 1.12rem; color: var(--soft); }
header { border-bottom: 2px solid var(--ink); padding-bottom: 1.4rem; }
nav { display: flex; flex-wrap: wrap; gap: 0.2rem 1.4rem; padding: 0.8rem 0; border-bottom: 1px solid var(--rule); font-size: 0.9rem; }
a { color: var(--accent); text-decoration: none; } a:hover { text-decoration: underline; }
section { padding-top: 2.6rem; }
.facts { display: flex; flex-wrap: wrap; gap: 0.4rem 2.4rem; margin: 1rem 0 0; font-size: 0.9rem; }
.facts div { display: flex; gap: 0.6rem; } .facts dt { color: var(--soft); } .facts dd { margin: 0; }
code { font: 0.92em ui-monospace, "SF Mono", Menlo, Consolas, "Liberation Mono", monospace; }
details { margin-top: 0.8rem; font-size: 0.9rem; } summary { cursor: pointer; color: var(--accent); }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(13rem, 1fr)); gap: 1rem; margin: 0.4rem 0 0.6rem; }
.tile { background: var(--panel); border-top: 3px solid var(--accent); padding: 0.9rem 1.1rem; }
.tile b { display: block; font-size: 1.9rem; line-height: 1.2; font-weight: 600; letter-spacing: -0.02em; }
.tile span { display: block; color: var(--soft); font-size: 0.86rem; line-height: 1.4; }
.tile .what { color: var(--ink); font-weight: 600; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.92rem; margin: 0.4rem 0 0.6rem; border-top: 1.5px solid var(--ink); border-bottom: 1.5px solid var(--ink); }
th, td { padding: 0.3rem 0.95rem; text-align: right; white-space: nowrap; font-weight: 400; }
th:first-child { text-align: left; padding-left: 0.2rem; }
thead th { color: var(--soft); font-size: 0.84rem; border-bottom: 1px solid var(--rule); vertical-align: bottom; }
thead .groups th + th { border-left: 1px solid var(--rule); }
thead .groups th { color: var(--ink); font-weight: 650; text-align: center; border-bottom: 1px solid var(--rule); }
td.start { border-left: 1px solid var(--rule); }
table.dense { font-size: 0.86rem; } .dense th + th, .dense td { padding-left: 0.55rem; padding-right: 0.55rem; }
tbody tr.heading th { font-weight: 650; padding-top: 0.9rem; text-align: left; }
tbody tr:not(.heading) + tr:not(.heading) { border-top: 1px solid var(--grid); }
tbody tr.strong th, tbody tr.strong td { font-weight: 650; background: var(--mark); }
figure { margin: 1.2rem 0 1.8rem; }
figcaption { color: var(--soft); font-size: 0.9rem; max-width: 52rem; margin-top: 0.5rem; }
.row { display: flex; flex-wrap: wrap; gap: 1.2rem 1.6rem; align-items: flex-start; }
.legend { display: flex; flex-wrap: wrap; gap: 0.2rem 1.4rem; font-size: 0.88rem; margin: 0 0 0.6rem; padding: 0; list-style: none; }
.legend li { display: flex; align-items: center; gap: 0.5rem; }
.pictures { display: grid; gap: 0.7rem 0.8rem; align-items: center; margin-bottom: 0.9rem; }
.pictures .head { font-size: 0.88rem; font-weight: 650; align-self: end; }
.pictures .name { font-size: 0.88rem; } .pictures .name small, .head small { display: block; color: var(--soft); font-weight: 400; font-size: 0.94em; }
img { display: block; width: 100%; height: auto; background: #808080; }
img.coarse { image-rendering: pixelated; }
.stack { display: flex; height: 0.5rem; max-width: 40rem; margin: 0.3rem 0; background: var(--panel); } .stack i { display: block; }
.swatch { width: 0.85rem; height: 0.85rem; display: inline-block; }
svg { display: block; max-width: 100%; height: auto; font: 12px system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "Liberation Sans", sans-serif; }
svg.bar { margin-left: -0.7rem; max-width: calc(100% + 1.4rem); }
svg text { fill: var(--ink); font-variant-numeric: tabular-nums; } svg .tick { fill: var(--soft); font-size: 11px; }
svg .title { font-weight: 650; font-size: 13px; } svg .frame { stroke: var(--soft); stroke-width: 1; fill: none; }
svg .grid { stroke: var(--grid); stroke-width: 1; } svg .marker { stroke: var(--soft); stroke-width: 1; stroke-dasharray: 2 3; }
svg .curve { fill: none; stroke-width: 1.8; stroke-linejoin: round; stroke-linecap: round; }
svg .dashed { stroke-dasharray: 6 4; }
svg .lamp { fill: none; stroke: var(--soft); stroke-width: 1; } svg .inverse { fill: var(--paper); font-weight: 650; font-size: 10px; }
@media print { body { padding: 0; max-width: none; } nav { display: none; } figure, table { break-inside: avoid; } }
)css";

}  // namespace patina
