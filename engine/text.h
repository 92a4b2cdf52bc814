// Numbers as people read them.
#pragma once

#include <cstdio>
#include <string>

namespace radivox {

/// At most that many significant digits, and no zeros at the end: "0.5", "1e-06".
inline std::string printNumber(double value, int digits = 6) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace radivox
