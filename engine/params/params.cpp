#include "engine/params/params.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "engine/text.h"

namespace radivox::params {
namespace {

/// The shortest decimal text that reads back as the same float.
std::string printFloat(float value) {
  char text[32];
  const auto result = std::to_chars(text, text + sizeof text, value);
  return std::string(text, result.ptr);
}

/// Limits of a range: whole numbers without a point.
std::string printLimit(double value) {
  if (value == std::floor(value) && std::abs(value) < 1e15) {
    return std::to_string(static_cast<long long>(value));
  }
  return printNumber(value);
}

std::string describeAllowed(const Param& param) {
  switch (param.type) {
    case Type::Bool:
      return "give true or false";
    case Type::UInt:
      return "give a whole number from " + printLimit(param.range.min) + " to " + printLimit(param.range.max);
    case Type::Float:
      return "give a number from " + printLimit(param.range.min) + " to " + printLimit(param.range.max);
    case Type::Choice:
    case Type::Text:
      break;
  }
  std::string text = "give one of";
  for (size_t i = 0; i < param.choices.size(); ++i) text += (i == 0 ? " " : ", ") + param.choices[i];
  return text;
}

template <class T>
bool parseNumber(std::string_view text, T& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

/// The number for Param::setNumber; empty and `why` when the text is no value of the parameter.
bool parseValue(const Param& param, std::string_view text, double& value, std::string& why) {
  switch (param.type) {
    case Type::Bool: {
      const bool yes = text == "true" || text == "on" || text == "1";
      const bool no = text == "false" || text == "off" || text == "0";
      value = yes ? 1 : 0;
      why = "not true or false";
      return yes || no;
    }
    case Type::Choice: {
      const auto found = std::find(param.choices.begin(), param.choices.end(), text);
      value = static_cast<double>(found - param.choices.begin());
      why = "no such choice";
      const std::string near = nearestName(text, param.choices);
      if (!near.empty()) why += " (did you mean " + near + "?)";
      return found != param.choices.end();
    }
    case Type::UInt:
    case Type::Float:
    case Type::Text:
      break;
  }
  if (!parseNumber(text, value) || std::isnan(value)) {
    why = "not a number";
    return false;
  }
  if (!std::isfinite(value)) {
    why = "not finite";
    return false;
  }
  if (param.type == Type::UInt && value != std::floor(value)) {
    why = "not a whole number";
    return false;
  }
  if (value < param.range.min || value > param.range.max) {
    why = "out of range";
    return false;
  }
  return true;
}

}  // namespace

Param flag(std::string name, bool* value, std::string help, Invalidates invalidates) {
  Param p;
  p.name = std::move(name);
  p.type = Type::Bool;
  p.range = {0, 1};
  p.help = std::move(help);
  p.invalidates = invalidates;
  p.get = [value] { return std::string(*value ? "true" : "false"); };
  p.setNumber = [value](double v) { *value = v != 0; };
  p.defaultValue = p.get();
  return p;
}

Param number(std::string name, uint32_t* value, Range range, std::string help, Invalidates invalidates) {
  Param p;
  p.name = std::move(name);
  p.type = Type::UInt;
  p.range = {std::max(range.min, 0.0), std::min(range.max, double(std::numeric_limits<uint32_t>::max()))};
  p.help = std::move(help);
  p.invalidates = invalidates;
  p.get = [value] { return std::to_string(*value); };
  p.setNumber = [value](double v) { *value = static_cast<uint32_t>(v); };
  p.defaultValue = p.get();
  return p;
}

Param number(std::string name, float* value, Range range, std::string help, Invalidates invalidates) {
  Param p;
  p.name = std::move(name);
  p.type = Type::Float;
  p.range = range;
  p.help = std::move(help);
  p.invalidates = invalidates;
  p.get = [value] { return printFloat(*value); };
  p.setNumber = [value](double v) { *value = static_cast<float>(v); };
  p.defaultValue = p.get();
  return p;
}

Param choiceIndex(std::string name, std::function<uint32_t()> get, std::function<void(uint32_t)> set, std::vector<std::string> names,
                  std::string help, Invalidates invalidates) {
  Param p;
  p.name = std::move(name);
  p.type = Type::Choice;
  p.choices = std::move(names);
  p.help = std::move(help);
  p.invalidates = invalidates;
  p.get = [get = std::move(get), choices = p.choices] { return choices.at(get()); };
  p.setNumber = [set = std::move(set)](double v) { set(static_cast<uint32_t>(v)); };
  p.defaultValue = p.get();
  return p;
}

Param text(std::string name, std::string* value, std::string help, Invalidates invalidates, std::function<void(const std::string&)> check) {
  Param p;
  p.name = std::move(name);
  p.type = Type::Text;
  p.help = std::move(help);
  p.invalidates = invalidates;
  p.get = [value] { return *value; };
  p.setText = [value, check = std::move(check)](const std::string& v) {
    if (check) check(v);
    *value = v;
  };
  p.defaultValue = *value;
  return p;
}

Param swept(Param param, std::vector<std::string> values, std::string exact) {
  param.sweep = std::move(values);
  param.exact = std::move(exact);
  return param;
}

Invalidates Table::set(std::string_view owner, std::string_view name, std::string_view text) {
  const std::string place = std::string(owner) + "." + std::string(name);
  const auto param = std::find_if(params_.begin(), params_.end(), [&](const Param& p) { return p.name == name; });
  if (param == params_.end()) {
    std::vector<std::string> names;
    for (const Param& p : params_) names.push_back(p.name);
    std::string message = place + ": no such parameter; ";
    const std::string near = nearestName(name, names);
    if (!near.empty()) {
      message += "did you mean " + near + "?";
    } else if (names.empty()) {
      message += std::string(owner) + " has none";
    } else {
      message += std::string(owner) + " has";
      for (size_t i = 0; i < names.size(); ++i) message += (i == 0 ? " " : ", ") + names[i];
    }
    throw Error(ErrorCode::BadInput, message);
  }
  const std::string before = param->get();
  if (param->type == Type::Text) {
    try {
      param->setText(std::string(text));
    } catch (const Error& error) {
      throw Error(error.code(), place + " = " + std::string(text) + ": " + error.what());
    }
  } else {
    double value = 0;
    std::string why;
    if (!parseValue(*param, text, value, why)) {
      throw Error(ErrorCode::BadInput, place + " = " + std::string(text) + ": " + why + "; " + describeAllowed(*param));
    }
    param->setNumber(value);
  }
  if (param->get() != before && param->invalidates != Invalidates::Frame) {
    ++version_;
    if (param->invalidates == Invalidates::Plan) ++planVersion_;
  }
  return param->invalidates;
}

std::string Table::print() const {
  std::string text;
  for (const Param& p : params_) text += (text.empty() ? "" : " ") + p.name + "=" + p.get();
  return text;
}

std::string nearestName(std::string_view name, const std::vector<std::string>& candidates) {
  std::string best;
  size_t bestDistance = std::numeric_limits<size_t>::max();
  std::vector<size_t> before, last, row;  // rows i − 1, i and i + 1 of the table of distances
  for (const std::string& candidate : candidates) {
    // Insertions, deletions, replacements, and two neighbours swapped ("uot"), which is how names are mistyped.
    row.resize(candidate.size() + 1);
    for (size_t j = 0; j <= candidate.size(); ++j) row[j] = j;
    last = row;
    for (size_t i = 0; i < name.size(); ++i) {
      before = last;
      last = row;
      row[0] = i + 1;
      for (size_t j = 0; j < candidate.size(); ++j) {
        row[j + 1] = std::min({last[j] + (name[i] == candidate[j] ? 0 : 1), row[j] + 1, last[j + 1] + 1});
        if (i > 0 && j > 0 && name[i] == candidate[j - 1] && name[i - 1] == candidate[j]) {
          row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
        }
      }
    }
    const size_t distance = row.back();
    if (2 * distance <= std::max(name.size(), candidate.size()) && distance < bestDistance) {
      bestDistance = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace radivox::params
