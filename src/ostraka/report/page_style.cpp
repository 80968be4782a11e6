// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/page_style.hpp"

#include "ostraka/report/palette.hpp"

namespace ostraka {
namespace {

// The page is 1120 pixels wide: two plots of half width (plot_size.hpp) and a gap.
constexpr const char* kText = R"(
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0 auto;max-width:1176px;padding:40px 28px 64px;background:var(--paper);color:var(--ink);
font:16px/1.55 system-ui,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif}
header{border-bottom:1px solid var(--grid);margin-bottom:24px;padding-bottom:18px}
header p{color:var(--quiet);font-size:17px;margin:6px 0 0}
h1,h2,h3,h4{line-height:1.25;letter-spacing:-0.01em;break-after:avoid}
h1{font-size:32px;font-weight:650;margin:0}
h2{font-size:23px;font-weight:650;margin:52px 0 12px}
h3{font-size:18px;font-weight:600;margin:34px 0 8px}
h4{font-size:16px;font-weight:600;margin:26px 0 6px}
p,li{max-width:46em}
p{margin:0 0 14px}
ul{margin:0 0 14px;padding-left:1.3em}
a{color:var(--s0)}
nav ol{display:flex;flex-wrap:wrap;gap:4px 24px;list-style:none;margin:0;padding:0;font-size:14.5px}
nav a{text-decoration:none}
nav a:hover{text-decoration:underline}
.note,figcaption,footer{color:var(--quiet);font-size:13.5px;line-height:1.5}
footer{border-top:1px solid var(--grid);margin-top:56px;padding-top:14px}
pre{background:var(--plate);border-radius:6px;padding:14px 16px;overflow-x:auto;
font:13px/1.5 ui-monospace,SFMono-Regular,Menlo,Consolas,'DejaVu Sans Mono',monospace}
)";

constexpr const char* kBlocks = R"(
.facts{display:grid;grid-template-columns:repeat(auto-fit,minmax(200px,1fr));gap:16px;margin:22px 0}
.facts div{background:var(--plate);border-radius:8px;padding:16px 20px;display:flex;flex-direction:column;
break-inside:avoid}
.facts dt{color:var(--quiet);font-size:14px;order:1}
.facts dd{margin:0;order:2}
.facts .value{font-size:34px;font-weight:600;line-height:1.2;letter-spacing:-0.02em;order:0;
font-variant-numeric:tabular-nums}
.facts .note{margin-top:6px}
.table{overflow-x:auto;margin:18px 0 24px}
table{border-collapse:collapse;font-size:14.5px;font-variant-numeric:tabular-nums lining-nums}
caption{text-align:left;font-weight:600;padding-bottom:8px;font-size:14px}
th,td{padding:7px 0 7px 22px;text-align:right;vertical-align:baseline;font-weight:400;white-space:nowrap}
th:first-child{padding-left:10px;text-align:left;min-width:7em;overflow-wrap:break-word;white-space:normal}
th:last-child,td:last-child{padding-right:10px}
td:first-child{padding-left:10px}
th.text,td.text{text-align:left;white-space:normal}
thead th{color:var(--quiet);font-size:13px;font-weight:600;border-bottom:1.5px solid var(--axis);
vertical-align:bottom}
tbody th,tbody td{border-bottom:1px solid var(--grid)}
tr.strong th,tr.strong td{font-weight:650}
tr.good th:first-child::before{content:"\2713\00a0";color:var(--good);font-weight:700}
tr.bad th:first-child::before{content:"\2717\00a0";color:var(--bad);font-weight:700}
tr.good td,tr.good th{background:color-mix(in srgb,var(--good) 8%,transparent)}
tr.bad td,tr.bad th{background:color-mix(in srgb,var(--bad) 9%,transparent)}
details{border:1px solid var(--grid);border-radius:8px;margin:16px 0}
summary{cursor:pointer;font-weight:600;font-size:15px;padding:11px 16px}
details>div{padding:2px 16px 8px}
details>div>:first-child{margin-top:4px}
)";

constexpr const char* kFigures = R"(
figure{margin:20px 0 26px;break-inside:avoid}
figcaption{margin-top:8px;max-width:52em}
figure svg{display:block;max-width:100%;height:auto}
img{display:block;max-width:100%;height:auto;border-radius:4px;background:var(--plate)}
.figures{display:grid;grid-template-columns:repeat(2,minmax(0,1fr));gap:20px 40px;align-items:start;
margin:20px 0 34px}
.pictures{display:grid;grid-template-columns:repeat(var(--columns),minmax(0,1fr));gap:16px;align-items:start;
margin:20px 0 26px}
.figures figure,.pictures figure{margin:0 0 10px}
.pictures img{width:100%}
.plot text{font-variant-numeric:tabular-nums}
.plot .halo{paint-order:stroke;stroke:var(--paper);stroke-width:3px;stroke-linejoin:round}
.plot .tl{fill:var(--inverse)}
@media screen and (prefers-color-scheme:dark){.plot .tl{fill:var(--ink)}.plot .td{fill:var(--inverse)}}
@media screen and (max-width:860px){body{padding:24px 16px 40px}h1{font-size:26px}
.figures,.pictures{grid-template-columns:minmax(0,1fr)}}
@media print{@page{margin:14mm}
*{print-color-adjust:exact;-webkit-print-color-adjust:exact}
body{max-width:none;padding:0;font-size:10.5pt}h2{margin-top:28pt}nav{display:none}
.figures{grid-template-columns:minmax(0,1fr)}
.facts{grid-template-columns:repeat(auto-fit,minmax(38mm,1fr));gap:3mm}.facts .value{font-size:20pt}
table{font-size:9pt}th,td{padding:1.2mm 0 1.2mm 5mm}tr{break-inside:avoid}caption,thead{break-after:avoid}thead{display:table-header-group}
pre{white-space:pre-wrap;overflow-wrap:anywhere}.table{overflow:visible}
details::details-content{content-visibility:visible;display:block}}
)";

}  // namespace

std::string page_css() {
    return palette_css() + kText + kBlocks + kFigures;
}

}  // namespace ostraka
