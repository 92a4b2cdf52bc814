#include "samples/cli/assets.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "engine/error.h"
#include "engine/params/params.h"

namespace radivox::cli {

namespace {

Source findAsset(const std::string& kind, const std::vector<Asset>& assets, const std::string& nameOrFile) {
  namespace fs = std::filesystem;
  if (nameOrFile.find('/') != std::string::npos || fs::path(nameOrFile).extension() == ".json") {
    std::ifstream file(nameOrFile, std::ios::binary);
    if (!file || fs::is_directory(nameOrFile)) {
      throw Error(ErrorCode::BadInput,
                  "cannot read " + kind + " '" + nameOrFile + "': no such file, or it is not readable; check the path or give a name");
    }
    std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    return {std::move(text), fs::path(nameOrFile).stem().string(), nameOrFile};
  }
  std::vector<std::string> names;
  for (const Asset& asset : assets) {
    if (asset.name == nameOrFile) return {asset.text, asset.name, kind + " " + asset.name};
    names.push_back(asset.name);
  }
  failUnknown(kind, nameOrFile, names);
}

}  // namespace

Source findGraph(const std::string& nameOrFile) { return findAsset("graph", graphs(), nameOrFile); }
Source findPreset(const std::string& nameOrFile) { return findAsset("preset", presets(), nameOrFile); }

void failUnknown(const std::string& kind, const std::string& name, const std::vector<std::string>& candidates) {
  std::string message = "unknown " + kind + " '" + name + "'; ";
  const std::string near = params::nearestName(name, candidates);
  if (!near.empty()) message += "did you mean '" + near + "'? ";
  message += candidates.empty() ? "there is none" : "there is";
  for (size_t i = 0; i < candidates.size(); ++i) message += (i == 0 ? " " : ", ") + candidates[i];
  throw Error(ErrorCode::BadInput, message);
}

}  // namespace radivox::cli
