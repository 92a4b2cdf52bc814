// The table of built-in scenes.
#include "engine/scene/builtin.h"

#include "engine/error.h"
#include "engine/params/params.h"
#include "engine/scene/builtin_mesh.h"

namespace radivox::scene {

namespace {

using Build = void (*)(MeshBuilder&, BuiltinParameters&);

struct Entry {
  BuiltinInfo info;
  Build build;
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> table = {
      {{"atrium",
        "a two-storey arcaded court with curtains, open to the sky, in the sun; cameras court and gallery",
        {"triangles=60000", "sky=0.4"}},
       buildAtrium},
      {{"cornell", "a box with a red and a green wall, two blocks and a one-sided emissive quad under the ceiling", {}},
       [](MeshBuilder& m, BuiltinParameters& p) { buildCornell(m, p, false); }},
      {{"cornell_point", "the same, lit by a point light", {}}, [](MeshBuilder& m, BuiltinParameters& p) { buildCornell(m, p, true); }},
      {{"furnace",
        "a closed cube whose walls emit L_e = (1 - albedo)/pi, so that radiosity is 1 everywhere",
        {"albedo=0.5", "subdivisions=1"}},
       buildFurnace},
      {{"two_rooms", "two rooms, a door of that width between them (0: none), a lamp in the first", {"door=1"}}, buildTwoRooms},
      {{"thin_wall", "one upright two-triangle sheet without thickness, lit by the sun from the front", {"albedo=0.5"}}, buildThinWall},
      {{"box", "a unit cube seen from inside, a lamp in its centre", {"albedo=0.5", "subdivisions=1"}}, buildBox},
      {{"plane", "a horizontal square, the sun above", {"albedo=0.5", "size=10", "subdivisions=1"}}, buildPlane},
      {{"sphere", "a ball in the sun; inward=1: a hollow sphere, a lamp in its centre", {"albedo=0.5", "radius=1", "rings=32", "inward=0"}},
       buildSphere},
      {{"ramp", "a square aslant by that many degrees about two axes, the sun above: no light may bounce", {"albedo=0.5", "angle=20"}},
       buildRamp},
      {{"staircase", "a solid staircase in the sun", {"albedo=0.5", "steps=10"}}, buildStaircase},
      {{"empty", "no triangles at all", {}}, [](MeshBuilder&, BuiltinParameters&) {}},
  };
  return table;
}

}  // namespace

std::vector<BuiltinInfo> builtinScenes() {
  std::vector<BuiltinInfo> out;
  for (const Entry& entry : entries()) {
    out.push_back(entry.info);
    out.back().parameters.insert(out.back().parameters.end(), {"scale=1", "offset=0"});
  }
  return out;
}

Scene makeBuiltin(const std::string& name, const std::map<std::string, std::string>& values) {
  std::vector<std::string> names;
  for (const Entry& entry : entries()) {
    names.push_back(entry.info.name);
    if (entry.info.name != name) continue;
    BuiltinParameters parameters(name, values);
    MeshBuilder mesh("builtin:" + name);
    // Asked for first, so that a misspelt key costs no time in a large scene.
    const double scale = parameters.number("scale", 1, 1e-6, 1e6);
    const double offset = parameters.number("offset", 0, -1e9, 1e9);
    entry.build(mesh, parameters);
    parameters.checkAllKnown();
    return mesh.finish(scale, glm::dvec3(offset));
  }
  const std::string nearest = params::nearestName(name, names);
  std::string list;
  for (const std::string& n : names) list += (list.empty() ? "" : ", ") + n;
  throw Error(ErrorCode::BadInput, "builtin:" + name + ": no such scene" +
                                       (nearest.empty() ? "" : "; did you mean builtin:" + nearest + "?") +
                                       (nearest.empty() ? "; there are: " : " There are: ") + list);
}

}  // namespace radivox::scene
