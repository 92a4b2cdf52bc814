#include "samples/report/row_cache.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace radivox::report {

bool RowCache::find(const std::string& key, const std::string& pictures, Row& row) const {
  std::ifstream file(folder_ + "/" + key + ".json", std::ios::binary);
  for (const char* picture : {".color.png", ".color_error.png", ".indirect.png", ".indirect_error.png"}) {
    if (!file || !std::filesystem::exists(pictures + "/" + key + picture)) return false;
  }
  try {
    Row found = rowFromJson(nlohmann::json::parse(file));
    if (found.key != key) return false;
    row.cost = std::move(found.cost);
    row.full = found.full;
    row.indirect = found.indirect;
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;  // cut short, or of another version: measured again
  }
}

void RowCache::keep(const Row& row) const { image::writeFileAtomically(folder_ + "/" + row.key + ".json", toJson(row).dump(1) + "\n"); }

}  // namespace radivox::report
