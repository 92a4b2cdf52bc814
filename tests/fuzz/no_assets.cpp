// The fuzz target reads files only: no graph or preset has a name.
#include "samples/cli/assets.h"

namespace radivox::cli {

const std::vector<Asset>& graphs() {
  static const std::vector<Asset> none;
  return none;
}
const std::vector<Asset>& presets() { return graphs(); }

}  // namespace radivox::cli
