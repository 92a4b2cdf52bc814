#include "samples/cli/describe.h"

#include <cstdio>

namespace radivox::cli {

namespace {

std::string printNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace

std::string printAllowed(const params::Param& param) {
  std::string allowed;
  switch (param.type) {
    case params::Type::Bool:
      allowed = "true, false";
      break;
    case params::Type::UInt:
    case params::Type::Float:
      allowed = printNumber(param.range.min) + " to " + printNumber(param.range.max);
      break;
    case params::Type::Choice:
      for (const std::string& choice : param.choices) allowed += (allowed.empty() ? "" : ", ") + choice;
      break;
    case params::Type::Text:
      allowed = "text";
      break;
  }
  return allowed;
}

}  // namespace radivox::cli
