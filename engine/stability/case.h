// Cases of `radivox stability`: a small problem, stiff or extreme, whose answer is known, and how far from it a method may be. The command
// brings cases for every method; a module adds those of its own stages with Registry::addStabilityCase.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace radivox::stability {

class Bench;

enum class Verdict : uint8_t {
  Pass,      ///< error within tolerance
  Degraded,  ///< beyond it, within the bound that the case states, with the reason (Row::why)
  Refused,   ///< one clear error instead of a picture, where the case allows that (Case::mayRefuse)
  Shown,     ///< measured beside ours for comparison; no claim is made (the paper's own estimator)
  Skipped,   ///< not run: the time limit was over
  Fail,
};
const char* printVerdict(Verdict verdict);

/// One line of the table. The case fills what is above `seconds`, the runner the rest.
struct Row {
  double expected = 0;
  double result = 0;
  double error = 0;
  double tolerance = 0;
  double bound = 0;    ///< 0: none; else errors up to it are `Degraded`, and `why` says what degrades
  bool shown = false;  ///< for comparison only
  std::string why;
  std::string note;  ///< what else was found

  double seconds = 0;
  double iterations = -1;  ///< of the method's solver; −1: it has none
  double residual = -1;
  Verdict verdict = Verdict::Fail;

  /// |result − expected| over `scale` (0: absolute).
  void judge(double expectedValue, double resultValue, double toleranceValue, double scale = 0);
};

struct Case {
  std::string group;   ///< "stiff" or "extreme", or a module's word
  std::string name;    ///< "furnace, albedo 0.99": unique within the group
  std::string answer;  ///< the known answer in words: "E_indirect = albedo at every pixel"
  std::function<void(Bench&, Row&)> run;
  std::string method;      ///< the graph it belongs to; empty: every method
  bool fast = false;       ///< part of the subset that tests run (--fast)
  bool mayRefuse = false;  ///< a request that may be too large: an error that says what fits is an answer
};

}  // namespace radivox::stability
