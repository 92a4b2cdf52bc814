#include "samples/viewer/views_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "engine/image/image.h"
#include "samples/cli/assets.h"
#include "samples/viewer/walk.h"

namespace radivox::viewer {

namespace {

using nlohmann::ordered_json;

const std::vector<std::string> kLightTypes = {"directional", "point", "spot"};

/// A value and where it stands in the file, for errors.
struct Place {
  const ordered_json& json;
  std::string where;

  [[noreturn]] void refuse(const std::string& what) const { throw Error(ErrorCode::BadInput, where + ": " + what); }
  bool has(const char* key) const { return json.is_object() && json.contains(key); }
  Place at(const char* key) const {
    if (!has(key)) refuse(std::string("'") + key + "' is missing; save the view again, or add it");
    return {json.at(key), where + "." + key};
  }
  std::vector<Place> items() const {
    if (!json.is_array()) refuse("not a list; write [ ]");
    std::vector<Place> all;
    for (size_t i = 0; i < json.size(); ++i) all.push_back({json[i], where + "[" + std::to_string(i) + "]"});
    return all;
  }
  std::string text() const {
    if (!json.is_string()) refuse("not a text; write \"…\"");
    return json.get<std::string>();
  }
  double number() const {
    if (!json.is_number() || !std::isfinite(json.get<double>())) refuse("not a number");
    return json.get<double>();
  }
  template <int N>
  glm::vec<N, float> vector() const {
    if (!json.is_array() || json.size() != N) refuse("not " + std::to_string(N) + " numbers; write [x, y, …]");
    glm::vec<N, float> v;
    for (int i = 0; i < N; ++i)
      v[i] = static_cast<float>(Place{json[static_cast<size_t>(i)], where + "[" + std::to_string(i) + "]"}.number());
    return v;
  }
  float numberOr(const char* key, float otherwise) const { return has(key) ? static_cast<float>(at(key).number()) : otherwise; }
};

size_t indexOf(const Place& place, const std::vector<std::string>& names, const char* kind) {
  const std::string name = place.text();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    std::string list;
    for (const std::string& known : names) list += " " + known;
    place.refuse(std::string("unknown ") + kind + " '" + name + "'; there is" + list);
  }
  return static_cast<size_t>(found - names.begin());
}

ordered_json print(const glm::vec3& v) { return {v.x, v.y, v.z}; }

void print(const scene::CameraDescription& camera, ordered_json& to) {
  const glm::quat& q = camera.orientation;
  to["position"] = print(camera.position);
  to["orientation"] = {q.x, q.y, q.z, q.w};
  if (camera.orthographic) {
    to["ymag"] = camera.ymag;
    to["zfar"] = camera.zfar;
  } else {
    to["yfov"] = camera.yfov;
  }
  to["znear"] = camera.znear;
}

scene::CameraDescription readCamera(const Place& place) {
  scene::CameraDescription camera;
  camera.position = place.at("position").vector<3>();
  const Place orientation = place.at("orientation");
  const auto q = orientation.vector<4>();
  if (!(glm::length(q) > 1e-6f)) orientation.refuse("a quaternion of length 0; write [0, 0, 0, 1] to look along −z");
  camera.orientation = glm::normalize(glm::quat(q.w, q.x, q.y, q.z));
  camera.orthographic = place.has("ymag");
  camera.ymag = place.numberOr("ymag", camera.ymag);
  camera.yfov = place.numberOr("yfov", camera.yfov);
  camera.znear = place.numberOr("znear", camera.znear);
  camera.zfar = place.numberOr("zfar", camera.zfar);
  if (!(camera.yfov > 0.f && camera.yfov < 3.1f)) place.refuse("yfov is not between 0 and 3.1 rad");
  if (!(camera.ymag > 0.f) || !(camera.znear > 0.f)) place.refuse("ymag and znear must be above 0");
  return camera;
}

ordered_json print(const Lamp& lamp) {
  const scene::PunctualLight& light = lamp.light;
  return {{"name", light.name},
          {"type", kLightTypes.at(light.type)},
          {"position", print(light.position)},
          {"direction", print(light.direction)},
          {"intensity", print(light.intensity)},
          {"range", light.range},
          {"cones", {light.innerConeAngle, light.outerConeAngle}},
          {"on", lamp.on},
          {"motion", motionNames().at(static_cast<size_t>(lamp.motion))},
          {"period", lamp.period},
          {"reach", lamp.reach}};
}

Lamp readLamp(const Place& place) {
  Lamp lamp;
  scene::PunctualLight& light = lamp.light;
  if (place.has("name")) light.name = place.at("name").text();
  light.type = static_cast<uint32_t>(indexOf(place.at("type"), kLightTypes, "type of light"));
  if (place.has("position")) light.position = place.at("position").vector<3>();
  if (place.has("direction")) light.direction = place.at("direction").vector<3>();
  if (!(glm::length(light.direction) > 1e-6f)) place.refuse("a direction of length 0; write [0, −1, 0] for straight down");
  light.direction = glm::normalize(light.direction);
  light.intensity = place.at("intensity").vector<3>();
  if (light.intensity.x < 0 || light.intensity.y < 0 || light.intensity.z < 0) place.refuse("intensity below 0");
  light.range = place.numberOr("range", 0.f);
  if (place.has("cones")) {
    const auto cones = place.at("cones").vector<2>();
    if (!(cones.x >= 0 && cones.x <= cones.y && cones.y <= 1.5708f)) place.refuse("cones: write [inner, outer], 0 to 1.57 rad");
    light.innerConeAngle = cones.x;
    light.outerConeAngle = cones.y;
  }
  if (place.has("on")) lamp.on = place.at("on").json == true;
  if (place.has("motion")) lamp.motion = static_cast<Motion>(indexOf(place.at("motion"), motionNames(), "motion"));
  lamp.period = place.numberOr("period", lamp.period);
  lamp.reach = place.numberOr("reach", lamp.reach);
  return lamp;
}

}  // namespace

scene::CameraDescription CameraPath::at(double time) const {
  const auto after = std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.seconds > time; });
  if (after == keys.begin()) return keys.front().camera;
  if (after == keys.end()) return keys.back().camera;
  const Key& before = *(after - 1);
  return mixCameras(before.camera, after->camera, static_cast<float>((time - before.seconds) / (after->seconds - before.seconds)));
}

const CameraPath& ViewsFile::findPath(const std::string& name, const std::string& source) const {
  std::vector<std::string> names;
  for (const CameraPath& path : paths) {
    if (path.name == name) return path;
    names.push_back(path.name);
  }
  cli::failUnknown("path in " + source, name, names);
}

ViewsFile readViews(const std::string& path, bool mustExist) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) {
    if (!mustExist && !std::filesystem::exists(path)) return {};
    throw Error(ErrorCode::BadInput, "cannot read '" + path + "': no such file, or it is not readable; check the path");
  }
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  ordered_json json = ordered_json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) throw Error(ErrorCode::BadInput, path + ": not a JSON object; mend or delete the file");
  const Place root{json, path};
  ViewsFile views;
  if (root.has("scene")) views.scene = root.at("scene").text();
  if (root.has("bookmarks")) {
    for (const Place& place : root.at("bookmarks").items()) {
      views.bookmarks.push_back({place.at("name").text(), readCamera(place)});
      views.bookmarks.back().camera.name = views.bookmarks.back().name;
    }
  }
  if (root.has("paths")) {
    for (const Place& place : root.at("paths").items()) {
      CameraPath camera{place.at("name").text(), {}};
      for (const Place& key : place.at("keys").items()) {
        camera.keys.push_back({key.at("seconds").number(), readCamera(key)});
        const size_t last = camera.keys.size() - 1;
        if (last > 0 && !(camera.keys[last].seconds > camera.keys[last - 1].seconds)) key.refuse("seconds must rise from key to key");
      }
      if (camera.keys.empty()) place.refuse("a path without keys");
      views.paths.push_back(std::move(camera));
    }
  }
  if (root.has("lights")) {
    Lamps lamps;
    for (const Place& place : root.at("lights").items()) lamps.lamps.push_back(readLamp(place));
    if (root.has("sky")) lamps.sky = root.at("sky").vector<3>();
    views.lamps = lamps;
  }
  return views;
}

void writeViews(const std::string& path, const ViewsFile& views) {
  ordered_json json = {{"scene", views.scene}, {"bookmarks", ordered_json::array()}, {"paths", ordered_json::array()}};
  for (const Bookmark& bookmark : views.bookmarks) {
    ordered_json entry = {{"name", bookmark.name}};
    print(bookmark.camera, entry);
    json["bookmarks"].push_back(std::move(entry));
  }
  for (const CameraPath& camera : views.paths) {
    ordered_json keys = ordered_json::array();
    for (const CameraPath::Key& key : camera.keys) {
      ordered_json entry = {{"seconds", key.seconds}};
      print(key.camera, entry);
      keys.push_back(std::move(entry));
    }
    json["paths"].push_back({{"name", camera.name}, {"keys", std::move(keys)}});
  }
  if (views.lamps) {
    json["lights"] = ordered_json::array();
    for (const Lamp& lamp : views.lamps->lamps) json["lights"].push_back(print(lamp));
    json["sky"] = print(views.lamps->sky);
  }
  image::writeFileAtomically(path, json.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace radivox::viewer
