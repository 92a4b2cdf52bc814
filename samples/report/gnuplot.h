// Runs gnuplot on a script.
#pragma once

#include <string>

namespace radivox::report {

/// Throws Unsupported, naming the package, where it is not installed.
void checkGnuplot();

/// Writes FOLDER/NAME.gp and FOLDER/NAME.svg (both stay, for whoever wants another plot) and returns the SVG, from "<svg" on, with every id
/// made its own by `name`. `script` plots; terminal and output are set here. Throws Unsupported (no gnuplot), BadInput (the folder).
std::string runGnuplot(const std::string& folder, const std::string& name, int width, int height, const std::string& script);

}  // namespace radivox::report
