// The table as files: stability.csv and the page stability.html.
#pragma once

#include <string>
#include <vector>

#include "engine/stability/case.h"

namespace radivox::stability {

struct TableRow {
  std::string method, group, name, answer;
  Row row;
};

struct Table {
  std::string device, driver;
  double seconds = 0;
  std::vector<TableRow> rows;
  size_t count(Verdict verdict) const;
};

std::string printCsv(const Table& table);
std::string printPage(const Table& table);

}  // namespace radivox::stability
