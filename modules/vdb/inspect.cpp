#include "modules/vdb/inspect.h"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <set>

#include "engine/text.h"
#include "modules/vdb/reader.h"

namespace radivox::vdb {

namespace {

double lengthOf(float v) { return std::abs(static_cast<double>(v)); }
double lengthOf(double v) { return std::abs(v); }
template <class T>
double lengthOf(const openvdb::math::Vec3<T>& v) {
  return std::sqrt(static_cast<double>(v.x()) * static_cast<double>(v.x()) + static_cast<double>(v.y()) * static_cast<double>(v.y()) +
                   static_cast<double>(v.z()) * static_cast<double>(v.z()));
}
template <class T>
double distanceOf(const T& a, const T& b) {
  if (a == b) return 0.0;  // equal infinities too
  return lengthOf(T(a - b));
}
double distanceOf(int32_t a, int32_t b) { return std::abs(static_cast<double>(a) - static_cast<double>(b)); }
double distanceOf(int64_t a, int64_t b) { return std::abs(static_cast<double>(a) - static_cast<double>(b)); }
double distanceOf(bool a, bool b) { return a == b ? 0.0 : 1.0; }

double printable(float v) { return static_cast<double>(v); }
double printable(double v) { return v; }
double printable(int32_t v) { return v; }
double printable(int64_t v) { return static_cast<double>(v); }
double printable(bool v) { return v ? 1.0 : 0.0; }
template <class T>
double printable(const openvdb::math::Vec3<T>& v) {
  return lengthOf(v);
}

using Known = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid, openvdb::Int64Grid, openvdb::BoolGrid,
                                openvdb::Vec3fGrid, openvdb::Vec3dGrid, openvdb::Vec3IGrid>;

/// Smallest, mean and largest value; of vectors, their lengths.
struct Spread {
  uint64_t count = 0;
  double least = 0, most = 0, sum = 0;
  void add(double value, uint64_t times) {
    least = count == 0 ? value : std::min(least, value);
    most = count == 0 ? value : std::max(most, value);
    sum += value * static_cast<double>(times);
    count += times;
  }
  std::string print() const {
    if (count == 0) return "no active voxel";
    return printNumber(least) + " … " + printNumber(most) + ", mean " + printNumber(sum / static_cast<double>(count));
  }
};

Spread spreadOf(const openvdb::GridBase& base) {
  Spread spread;
  base.apply<Known>([&spread](const auto& grid) {
    for (auto value = grid.cbeginValueOn(); value; ++value) spread.add(printable(*value), value.getVoxelCount());
  });
  return spread;
}

std::string printCoord(const openvdb::Coord& c) {
  return "(" + std::to_string(c.x()) + ", " + std::to_string(c.y()) + ", " + std::to_string(c.z()) + ")";
}

std::string printPoint(const openvdb::Vec3d& p) {
  return "(" + printNumber(p.x()) + ", " + printNumber(p.y()) + ", " + printNumber(p.z()) + ")";
}

std::string textOf(const openvdb::MetaMap& metadata, const char* name) {
  const openvdb::Metadata::ConstPtr value = metadata[name];
  return value ? value->str() : "";
}

std::string describe(const openvdb::GridBase& grid) {
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  const openvdb::GridClass gridClass = grid.getGridClass();
  std::string text = grid.getName() + ": " + grid.valueType() + ", " + openvdb::GridBase::gridClassToString(gridClass) + ", " +
                     std::to_string(grid.activeVoxelCount()) + " active voxels";
  if (!box.empty()) text += " in " + printCoord(box.min()) + " … " + printCoord(box.max());
  text += "; " + spreadOf(grid).print();
  const std::string unit = textOf(grid, "radivox_unit"), meaning = textOf(grid, "radivox_meaning");
  if (!unit.empty()) text += " [" + unit + "]";
  if (!meaning.empty()) text += "; " + meaning;
  return text + "\n";
}

/// Where voxel 0 lies and where the three index axes go, in metres.
std::string describePlace(const openvdb::math::Transform& transform) {
  const openvdb::Vec3d edge = transform.voxelSize();
  return "voxels of " + printPoint(edge) + ", the centre of voxel (0, 0, 0) at " + printPoint(transform.indexToWorld(openvdb::Vec3d(0.0)));
}

/// `others`: voxels that are active in `a` and not in `b`.
template <class GridType>
struct Comparison {
  uint64_t onlyA = 0, onlyB = 0, common = 0, different = 0;
  double most = 0, sum = 0;
  openvdb::Coord where;

  Comparison(const GridType& a, const GridType& b) {
    const auto inB = b.getConstAccessor();
    // Tiles are taken voxel by voxel: a solid block in one file may be voxels in the other.
    forEachVoxel(a, [&](const openvdb::Coord& at, const typename GridType::ValueType& value) {
      typename GridType::ValueType other;
      if (!inB.probeValue(at, other)) {
        ++onlyA;
        return;
      }
      ++common;
      const double distance = distanceOf(value, other);
      if (distance == 0.0) return;
      ++different;
      sum += distance;
      if (distance > most || std::isnan(distance)) {
        most = distance;
        where = at;
      }
    });
    onlyB = b.activeVoxelCount() - common;
  }

  template <class Visit>
  static void forEachVoxel(const GridType& grid, const Visit& visit) {
    for (auto value = grid.cbeginValueOn(); value; ++value) {
      openvdb::CoordBBox box;
      value.getBoundingBox(box);
      for (auto at = box.begin(); at; ++at) visit(*at, *value);
    }
  }
};

std::string compareGrids(const openvdb::GridBase& a, const openvdb::GridBase& b, bool& identical) {
  const std::string name = a.getName() + ": ";
  std::string text;
  if (a.type() != b.type()) {
    identical = false;
    return name + "of " + a.valueType() + " in A and " + b.valueType() + " in B\n";
  }
  if (a.transform() != b.transform()) {
    identical = false;
    text += name + "A has " + describePlace(a.transform()) + "; B has " + describePlace(b.transform()) + "\n";
  }
  bool known = a.apply<Known>([&](const auto& gridA) {
    using GridType = std::decay_t<decltype(gridA)>;
    const Comparison<GridType> c(gridA, static_cast<const GridType&>(b));
    if (c.onlyA == 0 && c.onlyB == 0 && c.different == 0) {
      text += name + "same\n";
      return;
    }
    identical = false;
    text += name;
    if (c.onlyA > 0) text += std::to_string(c.onlyA) + " voxels only in A, ";
    if (c.onlyB > 0) text += std::to_string(c.onlyB) + " only in B, ";
    text += std::to_string(c.different) + " of " + std::to_string(c.common) + " common ones differ";
    if (c.different > 0) {
      text += ", by at most " + printNumber(c.most) + " at " + printCoord(c.where) + ", mean of all " +
              printNumber(c.sum / static_cast<double>(c.common));
    }
    text += "\n";
  });
  if (!known) {
    identical = false;
    text += name + "grids of " + a.valueType() + " cannot be compared\n";
  }
  return text;
}

}  // namespace

std::string printFile(const std::string& file, const Checkpoint& checkpoint) {
  const std::unique_ptr<Reader> reader = Reader::open(file);
  std::string text = file + ": " + std::to_string(reader->names().size()) + " grids\n";
  const openvdb::MetaMap metadata = reader->metadata();
  for (auto entry = metadata.beginMeta(); entry != metadata.endMeta(); ++entry) {
    text += "  " + entry->first + " = " + entry->second->str() + "\n";
  }
  std::string place;
  for (size_t i = 0; i < reader->names().size(); ++i) {
    if (checkpoint) checkpoint(static_cast<double>(i) / static_cast<double>(reader->names().size()));
    const openvdb::GridBase::Ptr grid = reader->read(i);
    const std::string here = describePlace(grid->transform());
    if (here != place) text += here + "\n";
    place = here;
    text += "  " + describe(*grid);
  }
  return text;
}

Difference diffFiles(const std::string& a, const std::string& b, const Checkpoint& checkpoint) {
  const std::unique_ptr<Reader> readA = Reader::open(a), readB = Reader::open(b);
  const std::vector<std::string>&namesA = readA->names(), &namesB = readB->names();
  Difference result;
  result.identical = true;
  result.text = "A: " + a + "\nB: " + b + "\n";
  const auto indexIn = [](const std::vector<std::string>& names, const std::string& name) {
    return static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  for (size_t i = 0; i < namesA.size(); ++i) {
    if (checkpoint) checkpoint(static_cast<double>(i) / static_cast<double>(namesA.size()));
    const size_t j = indexIn(namesB, namesA[i]);
    if (j == namesB.size()) {
      result.identical = false;
      result.text += namesA[i] + ": only in A\n";
      continue;
    }
    result.text += compareGrids(*readA->read(i), *readB->read(j), result.identical);
  }
  for (const std::string& name : namesB) {
    if (indexIn(namesA, name) != namesA.size()) continue;
    result.identical = false;
    result.text += name + ": only in B\n";
  }
  result.text += result.identical ? "identical\n" : "different\n";
  return result;
}

}  // namespace radivox::vdb
