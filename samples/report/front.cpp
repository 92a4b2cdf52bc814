#include "samples/report/front.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace radivox::report {

std::vector<size_t> paretoFront(const std::vector<std::pair<double, double>>& points) {
  std::vector<size_t> order(points.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return points[a] < points[b]; });
  std::vector<size_t> front;
  double best = std::numeric_limits<double>::infinity();
  for (const size_t i : order) {
    if (!(points[i].second < best)) continue;
    best = points[i].second;
    front.push_back(i);
  }
  return front;
}

void markFronts(std::vector<Row*>& rows) {
  std::vector<Row*> methods;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(methods), [](const Row* row) { return !row->isPathTracer(); });
  const auto mark = [&](bool Row::*flag, auto time, ErrorFigures Row::*errors) {
    std::vector<std::pair<double, double>> points;
    for (Row* row : methods) {
      row->*flag = false;
      points.emplace_back(time(row->cost), (row->*errors).relRmse);
    }
    for (const size_t i : paretoFront(points)) methods[i]->*flag = true;
  };
  const auto total = [](const Cost& c) { return c.totalMs(); };
  const auto frame = [](const Cost& c) { return c.everyFrameMs(); };
  mark(&Row::frontTotalFull, total, &Row::full);
  mark(&Row::frontTotalIndirect, total, &Row::indirect);
  mark(&Row::frontFrameFull, frame, &Row::full);
  mark(&Row::frontFrameIndirect, frame, &Row::indirect);
}

}  // namespace radivox::report
