// What to try: every method as it is, its parameters one by one, each at its most exact, and then beside whatever did best.
#pragma once

#include <map>
#include <optional>

#include "engine/gpu/device.h"
#include "samples/cli/job.h"
#include "samples/report/row.h"

namespace radivox::report {

/// A parameter that trades time for quality (params::Param::sweep).
struct Knob {
  std::string name;                 ///< "visibility.rays"
  std::vector<std::string> values;  ///< cheapest first
  std::string exact;
  std::string help;
};

/// A graph with its own values, or with a preset's.
struct Method {
  std::string graph, preset;
  std::string bounces;                        ///< Setting::bounces
  bool hasIndirect = false;                   ///< it can give irradiance_indirect; else that is black
  std::vector<Knob> knobs;                    ///< of the nodes that this scene needs
  std::map<std::string, std::string> values;  ///< every parameter as the method has it; its own bounces, else the truth's
};

struct Trial {
  Setting setting;
  std::string reason;  ///< why::…
  std::string about;   ///< the knob turned
  double effort = 1;   ///< a guess: how much longer it takes than the method as it is
};

/// Graphs and presets of the command, those of `names` (names or files) if there are any. `options` has size, sets, modules, and the bounces of the
/// truth.
/// A graph that gives no color is left out, with a line in `notes`. Throws BadInput with the nearest name.
std::vector<Method> findMethods(const cli::Options& options, const std::vector<std::string>& names, const scene::Scene& scene,
                                const gpu::Capabilities& capabilities, std::vector<std::string>& notes);

/// Best first: methods as they are, stages of graphs at their most exact, knobs of graphs one by one, knobs of presets.
std::vector<Trial> planTrials(const std::vector<Method>& methods);

/// One knob up or down from `setting`.
std::vector<Trial> neighbours(const std::vector<Method>& methods, const Setting& setting);

/// The command line that this setting is: sets, bounces, supersampling, AOVs.
cli::Options optionsFor(const cli::Options& base, const Method& method, const Setting& setting);

}  // namespace radivox::report
