#include "samples/stability/table.h"

#include <cmath>

#include "engine/text.h"

namespace radivox::stability {

namespace {

/// A solver's figure, where there is one.
std::string printFigure(double value) { return value < 0 ? "" : printNumber(value); }

std::string quote(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c == '\n' ? ' ' : c);
  return quoted + "\"";
}

std::string escape(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else
      escaped += c;
  }
  return escaped;
}

std::string printRow(const TableRow& r) {
  std::string remark = r.row.verdict == Verdict::Degraded ? r.row.why : "";
  if (!r.row.note.empty()) remark += (remark.empty() ? "" : "; ") + r.row.note;
  const bool measured = r.row.verdict != Verdict::Skipped && r.row.verdict != Verdict::Refused;
  const auto cell = [](const std::string& text) { return "<td>" + text + "</td>"; };
  // Four digits are what a person reads; the table has them all.
  const auto number = [&](double value) { return cell(measured ? printNumber(value, 4) : ""); };
  const auto figure = [&](double value) { return cell(value < 0 ? "" : printNumber(value, 4)); };
  const std::string verdict = printVerdict(r.row.verdict);
  return "<tr class=\"" + verdict + "\"><td class=\"text\">" + escape(r.group) + "</td><td class=\"text\">" + escape(r.name) +
         "</td><td class=\"text soft\">" + escape(r.answer) + "</td>" + number(r.row.expected) + number(r.row.result) +
         number(r.row.error) + number(r.row.tolerance) + figure(r.row.iterations) + figure(r.row.residual) +
         cell(printNumber(r.row.seconds, 3)) + "<td class=\"text verdict\">" + verdict + "</td><td class=\"text soft\">" + escape(remark) +
         "</td></tr>\n";
}

}  // namespace

size_t Table::count(Verdict verdict) const {
  size_t n = 0;
  for (const TableRow& r : rows) n += r.row.verdict == verdict ? 1 : 0;
  return n;
}

std::string printCsv(const Table& table) {
  std::string csv = "method,group,case,answer,expected,result,error,tolerance,bound,iterations,residual,seconds,verdict,why,note\n";
  for (const TableRow& r : table.rows) {
    csv += quote(r.method) + "," + quote(r.group) + "," + quote(r.name) + "," + quote(r.answer) + "," + printNumber(r.row.expected) + "," +
           printNumber(r.row.result) + "," + printNumber(r.row.error) + "," + printNumber(r.row.tolerance) + "," +
           printNumber(r.row.bound) + "," + printFigure(r.row.iterations) + "," + printFigure(r.row.residual) + "," +
           printNumber(r.row.seconds) + "," + printVerdict(r.row.verdict) + "," + quote(r.row.why) + "," + quote(r.row.note) + "\n";
  }
  return csv;
}

std::string printPage(const Table& table) {
  std::string page = R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Radivox: stability</title>
<style>
body { margin: 0; font: 15px/1.5 system-ui, sans-serif; color: #222; background: #fff; }
main { max-width: 1600px; margin: 0 auto; padding: 24px; }
h1 { font-size: 26px; margin: 0 0 4px; } h2 { font-size: 21px; margin: 36px 0 8px; border-top: 2px solid #222; padding-top: 12px; }
.soft { color: #666; } p { max-width: 80em; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 13px; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: 3px 8px; border-bottom: 1px solid #eee; vertical-align: top; }
th { position: sticky; top: 0; background: #f7f7f5; border-bottom: 1px solid #bbb; }
td { white-space: nowrap; } td.text, th.text { text-align: left; white-space: normal; }
.verdict { font-weight: 600; }
tr.pass .verdict { color: #00734d; } tr.degraded .verdict { color: #b35c00; } tr.refused .verdict { color: #0060a0; }
tr.fail td { background: #fbe3dc; } tr.fail .verdict { color: #a00000; } tr.shown .verdict, tr.skipped .verdict { color: #777; }
</style>
</head>
<body>
<main>
<h1>Radivox: stability</h1>
)";
  page += "<p class=\"soft\">" + escape(table.device) + " (" + escape(table.driver) + "), Radivox " RADIVOX_VERSION ", " +
          std::to_string(static_cast<int>(table.seconds)) + " s.</p>\n<p>";
  const std::pair<Verdict, const char*> kinds[] = {{Verdict::Pass, "passed"},     {Verdict::Degraded, "degraded as stated"},
                                                   {Verdict::Refused, "refused"}, {Verdict::Shown, "shown for comparison"},
                                                   {Verdict::Skipped, "not run"}, {Verdict::Fail, "failed"}};
  std::string counts;
  for (const auto& [verdict, words] : kinds) {
    if (table.count(verdict) > 0) counts += (counts.empty() ? "" : ", ") + std::to_string(table.count(verdict)) + " " + words;
  }
  page += std::to_string(table.rows.size()) + " cases: " + counts +
          R"(.</p>
<p class="soft">Each row is a small scene whose answer is known. <b>Pass</b>: the error is within the tolerance. <b>Degraded</b>: it is not, but within the
bound that the case states, for the reason given. <b>Refused</b>: one clear error says what would fit. <b>Shown</b>: another estimator, measured beside ours.
Any value that is not finite, any validation message and any other error is a failure. Iterations and residual are the solver's.</p>
)";
  std::string method;
  bool open = false;
  for (const TableRow& r : table.rows) {
    if (!open || r.method != method) {
      if (open) page += "</table></div>\n";
      method = r.method;
      open = true;
      page += "<h2>" + escape(method) +
              "</h2>\n<div class=\"scroll\"><table><tr><th class=\"text\">group</th><th class=\"text\">case</th><th class=\"text\">known "
              "answer</th>"
              "<th>expected</th><th>result</th><th>error</th><th>tolerance</th><th>iterations</th><th>residual</th><th>seconds</th>"
              "<th class=\"text\">verdict</th><th class=\"text\">remark</th></tr>\n";
    }
    page += printRow(r);
  }
  if (open) page += "</table></div>\n";
  return page + "</main>\n</body>\n</html>\n";
}

}  // namespace radivox::stability
