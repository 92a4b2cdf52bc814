// consumer COLOR_AND_DEPTH.exr FOGGY.exr DENSITY RADIANCE: whether the second is the first in such fog (samples/embed/plugin), and how many
// node types the installed modules have.
#include "all_headers.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

using namespace radivox;

namespace {

image::Image take(const char* file, const std::string& name) {
  for (image::Layer& layer : image::readExr(file)) {
    if (layer.name == name) return std::move(layer.image);
  }
  throw Error(ErrorCode::BadInput, std::string(file) + ": no layer " + name);
}

int run(char** argv) {
  plugin::Registry registry;
  registerModules(registry);
  std::printf("%zu node types\n", registry.types().size());
  const image::Image clear = take(argv[1], "color"), depth = take(argv[1], "depth"), foggy = take(argv[2], "color");
  const float density = std::strtof(argv[3], nullptr), radiance = std::strtof(argv[4], nullptr);
  double largest = 0, changed = 0;
  for (size_t i = 0; i < foggy.data.size(); ++i) {
    const float share = std::exp(-density * depth.data[i / 3]);
    const float expected = radiance * (1 - share) + clear.data[i] * share;
    largest = std::fmax(largest, std::fabs(foggy.data[i] - expected) / (std::fabs(expected) + 1e-3));
    changed += foggy.data[i] != clear.data[i] ? 1 : 0;
  }
  std::printf("largest relative difference %g, %g values changed\n", largest, changed);
  // exp() of a GPU may be off by 3 + 2 |x| units in the last place, here of x up to 1: 6e-7 of a share, more of a sum darker than its parts.
  return foggy.data.size() == clear.data.size() && largest < 4e-6 && changed > 0.5 * static_cast<double>(foggy.data.size()) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  try {
    return run(argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "consumer: %s\n", e.what());
    return 1;
  }
}
