// SPDX-License-Identifier: Apache-2.0
#include "sim/plot/report_style.h"

namespace v2vouch::evaluation {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0; background: #eef0f3; color: #2d333b;
  font: 15px/1.5 "Segoe UI", "Helvetica Neue", Arial, "Liberation Sans", sans-serif; }
main { max-width: 1140px; margin: 0 auto; padding: 28px 12px 60px; }
h1 { font-size: 26px; margin: 0 0 2px; letter-spacing: -0.3px; }
h2 { font-size: 18px; margin: 0 0 4px; }
p { margin: 4px 0 10px; max-width: 100ch; }
.sub { color: #6b7480; margin-bottom: 18px; }
.card { background: #fff; border: 1px solid #dde1e6; border-radius: 8px; padding: 20px 24px;
  margin: 18px 0; overflow-x: auto; }
.note { color: #6b7480; font-size: 13.5px; }
.gates { display: grid; grid-template-columns: repeat(3, 1fr); gap: 10px; margin-top: 12px; }
.gate { border: 1px solid #dde1e6; border-left: 5px solid #17855a; border-radius: 6px;
  padding: 8px 12px; }
.gate.miss { border-left-color: #c0392b; }
.gate b { font-size: 20px; font-variant-numeric: tabular-nums; }
.gate .what { font-size: 13px; color: #6b7480; }
.gate .limit { font-size: 13px; color: #6b7480; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; width: 100%;
  margin: 10px 0 4px; }
th, td { padding: 5px 7px; text-align: right; border-bottom: 1px solid #eceef1; }
th { font-weight: 600; font-size: 13px; color: #6b7480; border-bottom: 1px solid #c9ced6; }
th:first-child, td:first-child { text-align: left; }
table.text { width: auto; } table.text th, table.text td { text-align: left; padding-right: 22px; }
tr.list td { font-weight: 600; background: #f5f6f8; }
tr.ours td { font-weight: 600; }
tr.bound td { color: #6b7480; font-style: italic; }
.local { color: #2b6cb0; } .v2v { color: #b5651d; } .priority { color: #17855a; }
.pictures { display: flex; gap: 10px; flex-wrap: wrap; justify-content: space-between; }
svg { display: block; }
svg text { font-family: "Segoe UI", "Helvetica Neue", Arial, "Liberation Sans", sans-serif; }
.tick { font-size: 12px; fill: #5c6570; }
.label { font-size: 12.5px; fill: #5c6570; }
.legend { font-size: 13px; fill: #2d333b; }
.caption { font-size: 14px; font-weight: 600; fill: #2d333b; }
.ring { font-size: 10px; fill: #98a1ac; }
.id { font-size: 11px; fill: #2d333b; paint-order: stroke; stroke: #f7f8fa; stroke-width: 3px; }
.story { font-size: 17px; line-height: 1.6; max-width: 90ch; }
.liar { color: #c0392b; font-weight: 600; }
pre { overflow-x: auto; font-size: 13px; }
.critical { font-weight: 700; font-size: 12.5px; fill: #c0392b; }
)";

}  // namespace

const char* ReportStyle() { return kStyle; }

}  // namespace v2vouch::evaluation
