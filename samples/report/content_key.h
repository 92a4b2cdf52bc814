// A name for content: what goes in decides it, bit for bit. For caches, not for secrets.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "engine/scene/scene.h"

namespace radivox::report {

class ContentKey {
 public:
  ContentKey& add(const void* bytes, size_t count);
  /// With its length, so that "ab" + "c" is not "a" + "bc".
  ContentKey& add(std::string_view text);
  ContentKey& add(uint64_t value) { return add(&value, sizeof value); }
  ContentKey& add(const scene::Scene& scene);  ///< all that light and eye can meet; not its names
  ContentKey& add(const scene::CameraDescription& camera);
  std::string print() const;  ///< 32 hexadecimal digits

 private:
  template <class T>
  void addArray(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(values.size());
    add(values.data(), values.size() * sizeof(T));
  }
  uint64_t high_ = 0x6a09e667f3bcc908u, low_ = 0xbb67ae8584caa73bu;
};

/// Of the running program: a figure measured by another build is another figure.
std::string programKey();

}  // namespace radivox::report
