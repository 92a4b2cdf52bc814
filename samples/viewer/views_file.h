// Camera bookmarks, recorded camera paths and edited lights in a JSON file.
//
// {"scene": "builtin:atrium",
//  "bookmarks": [{"name": "door", "position": [0, 1.6, 4], "orientation": [x, y, z, w], "yfov": 0.8, "znear": 0.01}],
//  "paths": [{"name": "walk", "keys": [{"seconds": 0, "position": …}, …]}],
//  "lights": [{"name": "sun", "type": "directional", "direction": …, "intensity": …, "motion": "circle", "period": 4, …}],
//  "sky": [0.1, 0.1, 0.1]}
//
// Positions are metres relative to the scene's origin; cameras look along −z of their orientation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "samples/viewer/lamps.h"

namespace radivox::viewer {

struct Bookmark {
  std::string name;
  scene::CameraDescription camera;
};

struct CameraPath {
  struct Key {
    double seconds = 0;
    scene::CameraDescription camera;
  };
  std::string name;
  std::vector<Key> keys;  ///< seconds ascending
  double seconds() const { return keys.empty() ? 0.0 : keys.back().seconds; }
  /// Between the two keys about that time; the first or last one outside. Not of an empty path.
  scene::CameraDescription at(double seconds) const;
};

struct ViewsFile {
  std::string scene;
  std::vector<Bookmark> bookmarks;
  std::vector<CameraPath> paths;
  std::optional<Lamps> lamps;
  /// Throws BadInput naming `source` and the names there are.
  const CameraPath& findPath(const std::string& name, const std::string& source) const;
};

/// Throws BadInput naming the file and the place in it. No such file: empty, unless `mustExist`.
ViewsFile readViews(const std::string& path, bool mustExist);
void writeViews(const std::string& path, const ViewsFile& views);

}  // namespace radivox::viewer
