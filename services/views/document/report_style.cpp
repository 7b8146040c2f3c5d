#include "services/views/document/report_sections.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::string_view style = R"(
@page {
  size: A4; margin: 21mm 15mm 19mm 15mm;
  @top-left { content: string(issuer); font-size: 7.5pt; color: #5a6672; }
  @top-right { content: string(subject); font-size: 7.5pt; color: #5a6672; }
  @bottom-left { content: string(foot); font-size: 7.5pt; color: #5a6672; }
  @bottom-right { content: string(page) " " counter(page) " " string(of) " " counter(pages);
    font-size: 7.5pt; color: #5a6672; }
}
@page :first { margin-top: 15mm; @top-left { content: none; } @top-right { content: none; } }
.issuer-text { string-set: issuer content(); }
.subject-text { string-set: subject content(); }
.foot-text { string-set: foot content(); }
.page-text { string-set: page content(); }
.of-text { string-set: of content(); }
.part + .part { break-before: page; }
.running { position: absolute; width: 1px; height: 1px; overflow: hidden; color: transparent;
  font-size: 1px; }
.draft { position: fixed; top: 95mm; left: 0; right: 0; text-align: center; font-size: 90pt;
  font-weight: bold; color: rgba(179, 84, 30, 0.13); transform: rotate(-35deg); }
.several { font-size: 54pt; }
.end { text-align: center; color: #5a6672; margin-top: 6mm; }
* { box-sizing: border-box; }
html { font-family: "Liberation Sans", Arial, Helvetica, "DejaVu Sans", sans-serif;
  font-size: 9.2pt; line-height: 1.38; color: #1c2329; background: #ffffff; }
body { margin: 0; }
main { max-width: 190mm; margin: 0 auto; }
header { display: flex; justify-content: space-between; align-items: flex-start;
  border-bottom: 1.6pt solid #14507a; padding-bottom: 4mm; margin-bottom: 5mm; }
.issuer { max-width: 58%; }
.logo { max-height: 17mm; max-width: 60mm; margin-bottom: 2mm; display: block; }
.issuer .name { font-weight: bold; font-size: 11.5pt; margin: 0 0 1mm 0; }
.address { margin: 0; font-size: 8.4pt; color: #46525d; line-height: 1.45; }
.title { text-align: right; }
h1 { font-size: 17pt; margin: 0 0 2mm 0; color: #14507a; letter-spacing: 0.1pt;
  font-weight: bold; line-height: 1.15; }
h2 { font-size: 11.5pt; color: #14507a; margin: 6mm 0 2mm 0; padding-bottom: 0.8mm;
  border-bottom: 0.5pt solid #b9c8d4; break-after: avoid; }
h3 { font-size: 9.8pt; margin: 4.5mm 0 1.2mm 0; break-after: avoid; }
h4 { font-size: 8.8pt; margin: 3mm 0 1mm 0; font-weight: bold; color: #46525d;
  break-after: avoid; }
p { margin: 0 0 1.6mm 0; }
aside { border-left: 2.2pt solid #b3541e; background: #fbf3ec; padding: 2mm 3mm 1mm 3mm;
  margin: 0 0 4mm 0; break-inside: avoid; }
.warning { color: #8c3b0c; font-weight: bold; }
table { border-collapse: collapse; width: 100%; margin: 0 0 2.5mm 0;
  font-variant-numeric: tabular-nums; }
thead { display: table-header-group; }
tr { break-inside: avoid; }
.facts th { text-align: left; vertical-align: top; font-weight: normal; color: #5a6672;
  width: 34mm; padding: 0.7mm 3mm 0.7mm 0; }
.facts td { padding: 0.7mm 0; overflow-wrap: anywhere; }
.values, .budget, .single { font-size: 8pt; }
.values th, .budget th, .single th, .legend th { background: #eef3f7; font-weight: bold;
  border-top: 0.6pt solid #14507a; border-bottom: 0.6pt solid #14507a; padding: 1mm 1.4mm; }
.values td, .budget td, .single td { padding: 0.55mm 1.4mm; text-align: right;
  border-bottom: 0.3pt solid #dde5eb; white-space: nowrap; }
.values th, .budget th, .single th { text-align: right; }
.values td:first-child, .budget td:first-child { font-weight: bold; }
.budget, .single { font-size: 7.2pt; }
.model { font-size: 7.4pt; }
.model th { background: #eef3f7; text-align: left; vertical-align: bottom; padding: 1mm 1.2mm;
  border-top: 0.6pt solid #14507a; border-bottom: 0.6pt solid #14507a; }
.model td { padding: 0.6mm 1.2mm; border-bottom: 0.3pt solid #dde5eb; vertical-align: top; }
.model td + td, .model th + th { text-align: right; }
.model td + td { white-space: nowrap; }
.model td:first-child { width: 58mm; }
.model tr.sum td { border-top: 0.6pt solid #14507a; font-weight: bold; }
.legend { font-size: 8pt; }
.legend th { text-align: left; }
.legend td { padding: 0.7mm 1.4mm; vertical-align: top; border-bottom: 0.3pt solid #dde5eb;
  overflow-wrap: anywhere; }
.legend td:first-child { white-space: nowrap; }
.values tbody tr:nth-child(even), .budget tbody tr:nth-child(even),
.single tbody tr:nth-child(even) { background: #f8fafc; }
figure { margin: 3mm 0 3mm 0; text-align: center; break-inside: avoid; }
figure svg, figure img { width: 100%; max-width: 165mm; height: auto; }
figcaption { font-size: 7.8pt; color: #5a6672; text-align: center; }
code, pre { font-family: "Liberation Mono", "DejaVu Sans Mono", monospace; font-size: 7.4pt; }
code { overflow-wrap: anywhere; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; background: #f6f8fa; padding: 3mm;
  border: 0.3pt solid #dde5eb; line-height: 1.35; }
.signatures { break-inside: avoid; margin-top: 12mm; }
.signatures .place { margin-bottom: 14mm; }
.signers { display: flex; flex-wrap: wrap; }
.signer { width: 62mm; margin: 0 14mm 10mm 0; }
.signer .line { border-top: 0.7pt solid #1c2329; margin-bottom: 1.2mm; }
.signer p { margin: 0; }
.signer .name { font-weight: bold; }
@media screen {
  html { background: #e9eef2; }
  main { background: #ffffff; padding: 15mm; margin: 8mm auto; width: 210mm; max-width: 100%;
    box-shadow: 0 1px 6px rgba(0, 0, 0, 0.18); }
  .values, .budget, .single, .legend { overflow-x: auto; }
}
)";

} // namespace

std::string_view report_style() {
  return style;
}

} // namespace dyncal::inline views
