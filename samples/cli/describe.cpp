#include "samples/cli/describe.h"

#include "engine/text.h"

namespace radivox::cli {

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
